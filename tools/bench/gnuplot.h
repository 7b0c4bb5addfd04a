// gnuplot.h: drawings by the program gnuplot, a child process that reads and writes files in a
// folder of its own among the system's temporary ones, which goes with the object. One thread.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pagoda::tools {

class Gnuplot {
public:
    Gnuplot() = default;
    ~Gnuplot();
    Gnuplot(const Gnuplot&) = delete;
    Gnuplot& operator=(const Gnuplot&) = delete;

    struct Size {
        int width = 0, height = 0;  // CSS pixels
    };
    // What `commands` plot, as an <svg> element that can stand inside an HTML page: no prolog, and
    // ids that begin with `id` (letters and digits, another one for each drawing of a page).
    // Empty when gnuplot is missing or fails; problem() then says so, and later calls return at
    // once.
    [[nodiscard]] std::string svg(const std::string& commands, Size size, const std::string& id);

    // One line, with what to do about it; empty as long as all went well.
    [[nodiscard]] const std::string& problem() const noexcept { return problem_; }

private:
    void run(const std::string& commands, Size size);

    std::filesystem::path folder_;
    std::string problem_;
};

// `text` as a string of gnuplot's language: in single quotes, nothing in it is interpreted.
// Control characters become spaces.
[[nodiscard]] std::string gnuplotQuoted(std::string_view text);

}  // namespace pagoda::tools
