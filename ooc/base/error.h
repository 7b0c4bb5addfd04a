// error.h: the one exception of Pagoda.
// Thrown where outside input is opened or built, caught in main(), which prints
// `pagoda: PATH:PLACE: what; what to do` and exits with 1. Never thrown inside a frame and never
// across threads other than through ThreadPool, which rethrows on the waiting thread.
#pragma once

#include <stdexcept>
#include <string>

namespace pagoda {

class Error : public std::runtime_error {
public:
    // `path` may be empty (no file at fault); `place` is a line ("line 14"), a byte offset
    // ("byte 1024"), a page or empty; `remedy` says what the user can do, and may be empty.
    Error(std::string path, std::string place, std::string what, std::string remedy);

    [[nodiscard]] const std::string& path() const noexcept { return path_; }
    [[nodiscard]] const std::string& place() const noexcept { return place_; }
    [[nodiscard]] const std::string& problem() const noexcept { return problem_; }
    [[nodiscard]] const std::string& remedy() const noexcept { return remedy_; }

private:
    std::string path_, place_, problem_, remedy_;
};

// Thrown by Progress::check() after Ctrl-C; main() exits with 130.
class Interrupted : public std::runtime_error {
public:
    Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace pagoda
