#include "tools/bench/report_page.h"

#include "tools/session.h"

#include <fmt/format.h>

#include <cmath>

namespace pagoda::tools {
namespace {

// Readable on a screen and on A4; on paper, tables get smaller and figures do not.
constexpr const char* kStyle = R"(
body { font: 15px/1.45 "Liberation Sans", Arial, Helvetica, sans-serif; color: #1a1a1a;
  background: #fff; max-width: 74rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; margin-bottom: .2rem; }
h2 { break-after: avoid; font-size: 1.15rem; margin: 2.2rem 0 .5rem; }
dl { display: grid; grid-template-columns: max-content 1fr; gap: .15rem 1rem; margin: 1rem 0; }
dt { color: #555; } dd { margin: 0; }
code { font: .87em "Liberation Mono", Consolas, monospace; overflow-wrap: anywhere; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: 12px; font-variant-numeric: tabular-nums; }
th, td { padding: 2px 6px; text-align: right; white-space: nowrap; }
th { font-weight: normal; color: #444; vertical-align: bottom; }
td:first-child, th:first-child { text-align: left; }
thead tr:first-child th { text-align: center; border-bottom: 1px solid #bbb; }
thead tr:last-child th { border-bottom: 1px solid #333; }
tbody th { text-align: left; padding-top: 8px; font-weight: bold; color: #1a1a1a; }
tbody tr:last-child td { border-bottom: 1px solid #bbb; }
.part { border-left: 1px solid #ddd; }
.note, figcaption { color: #444; font-size: .87rem; max-width: 46rem; }
figure { margin: 1.6rem 0 2.2rem; max-width: 720px; break-inside: avoid; }
figure h3 { font-size: 1rem; margin: 0 0 .2rem; }
svg { width: 100%; height: auto; display: block; }
@media print { @page { size: A4; margin: 12mm; } body { margin: 0; max-width: none; }
  table { font-size: 8.5px; } th, td { padding: 1px 2.5px; } .wide { overflow: visible; } }
)";

}  // namespace

std::string escapedHtml(std::string_view text) {
    std::string html;
    for (const char c : text) {
        switch (c) {
            case '&':
                html += "&amp;";
                break;
            case '<':
                html += "&lt;";
                break;
            case '>':
                html += "&gt;";
                break;
            case '"':
                html += "&quot;";
                break;
            case '\'':
                html += "&#39;";
                break;
            default:
                html += static_cast<unsigned char>(c) < 0x20 && c != '\n' ? ' ' : c;
        }
    }
    return html;
}

std::string htmlPage(const std::string& title, const std::string& body) {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
        "<meta name=\"viewport\" content=\"width=device-width\">\n"
        "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<h1>{0}</h1>\n{2}"
        "</body>\n</html>\n",
        escapedHtml(title), kStyle, body);
}

std::string shownHtml(double value) {
    if (value == 0) return "0";
    const double size = std::abs(value);
    if (size < 0.01) return fmt::format("{:.1e}", value);
    if (size < 10) return fmt::format("{:.2f}", value);
    if (size < 100) return fmt::format("{:.1f}", value);
    if (size < 1e15) return formatCount(static_cast<uint64_t>(std::llround(size)));
    return fmt::format("{:.2e}", value);
}

std::string megabytesHtml(uint64_t bytes) {
    return shownHtml(static_cast<double>(bytes) * 1e-6);
}

std::string termHtml(const char* name, const std::string& html) {
    return fmt::format("<dt>{}</dt><dd>{}</dd>\n", name, html);
}

void HtmlRow::cell(const std::string& html, bool isFirstOfPart) {
    html_ += fmt::format("<td{}>{}</td>", isFirstOfPart ? " class=\"part\"" : "", html);
}

void HtmlRow::shaded(const std::string& html, std::string_view colour) {
    if (colour.empty()) return cell(html);
    html_ += fmt::format("<td style=\"background:{}\">{}</td>", colour, html);
}

void HtmlRow::spread(const Spread& spread) {
    cell(shownHtml(spread.median), true);
    for (const double value : {spread.p95, spread.p99, spread.max}) cell(shownHtml(value));
}

std::string figuresHtml(const Figures& figures) {
    std::string html = "<h2>Figures</h2>\n";
    if (!figures.problem.empty()) {
        html += fmt::format(
            "<p class=\"note\">No figures: {}. Install the package gnuplot-nox and "
            "run the command again.</p>\n",
            escapedHtml(figures.problem));
    }
    for (const Figure& figure : figures.figures) {
        html += fmt::format("<figure>\n<h3>{}</h3>\n{}<figcaption>{}</figcaption>\n</figure>\n",
                            escapedHtml(figure.heading), figure.svg, escapedHtml(figure.caption));
    }
    return html;
}

}  // namespace pagoda::tools
