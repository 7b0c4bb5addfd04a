#include "viewer/window/state_log.h"

#include "ooc/base/error.h"

#include <nlohmann/json.hpp>

#include <chrono>

namespace pagoda::viewer {

StateLog::StateLog(const std::filesystem::path& path) {
    if (path.empty()) return;
    file_.open(path, std::ios::trunc);
    if (!file_) throw Error(path.string(), "", "cannot be written", "choose another --log-state");
}

void StateLog::write(const char* event, nlohmann::json line) {
    if (!isOn()) return;
    line["event"] = event;
    line["steady_s"] =
        std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    file_ << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
    file_.flush();
}

}  // namespace pagoda::viewer
