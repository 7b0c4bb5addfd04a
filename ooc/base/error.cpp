#include "ooc/base/error.h"

namespace pagoda {
namespace {

std::string message(const std::string& path, const std::string& place, const std::string& what,
                    const std::string& remedy) {
    std::string text;
    if (!path.empty()) text += path + ":";
    if (!place.empty()) text += place + ":";
    if (!text.empty()) text += " ";
    text += what;
    if (!remedy.empty()) text += "; " + remedy;
    return text;
}

}  // namespace

Error::Error(std::string path, std::string place, std::string what, std::string remedy)
    : std::runtime_error(message(path, place, what, remedy)),
      path_(std::move(path)),
      place_(std::move(place)),
      problem_(std::move(what)),
      remedy_(std::move(remedy)) {
}

}  // namespace pagoda
