// report_page.h: what HTML reports share: one page that needs nothing else (no links, no scripts,
// figures as inline SVG), its look, numbers, rows. Readable on a screen and on A4. Pure functions.
#pragma once

#include "tools/bench/plots.h"
#include "tools/bench/statistics.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace pagoda::tools {

// `text` as it stands in HTML, between tags or in a quoted attribute; other control characters than
// newlines become spaces.
[[nodiscard]] std::string escapedHtml(std::string_view text);

// `title` is plain text, `body` HTML.
[[nodiscard]] std::string htmlPage(const std::string& title, const std::string& body);

// Three digits, more where they stand before the point: what differs further is noise.
[[nodiscard]] std::string shownHtml(double value);
[[nodiscard]] std::string megabytesHtml(uint64_t bytes);

// A term and its description in a <dl>; `html` is escaped already.
[[nodiscard]] std::string termHtml(const char* name, const std::string& html);

// A row of a table; cells are escaped already.
class HtmlRow {
public:
    void cell(const std::string& html, bool isFirstOfPart = false);
    // `colour` behind it: "#rrggbb"; empty: none.
    void shaded(const std::string& html, std::string_view colour);
    // Median, p95, p99, max.
    void spread(const Spread& spread);
    [[nodiscard]] std::string take() { return "<tr>" + html_ + "</tr>\n"; }

private:
    std::string html_;
};

// Under a heading of their own; where they are missing, how to get them.
[[nodiscard]] std::string figuresHtml(const Figures& figures);

}  // namespace pagoda::tools
