#include "ooc/readers/gltf_files.h"

#include <set>

namespace pagoda::ooc::gltf {
namespace {

int hexValue(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

// "scheme:" by RFC 3986; one letter is no scheme (a drive).
bool hasScheme(const std::string& uri) {
    const size_t colon = uri.find(':');
    return colon != std::string::npos && colon > 1 && uri.find('/') > colon;
}

}  // namespace

std::string percentDecoded(const std::string& uri) {
    std::string decoded;
    for (size_t i = 0; i < uri.size(); ++i) {
        const int high = i + 2 < uri.size() && uri[i] == '%' ? hexValue(uri[i + 1]) : -1;
        const int low = high >= 0 ? hexValue(uri[i + 2]) : -1;
        if (low < 0) {
            decoded += uri[i];
            continue;
        }
        decoded += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return decoded;
}

std::optional<std::filesystem::path> pathBeside(const SourceFile& source, const std::string& uri) {
    const std::string name = percentDecoded(uri);
    const std::filesystem::path relative(name);
    if (hasScheme(uri) || relative.is_absolute() || name.find('\0') != std::string::npos) {
        return std::nullopt;
    }
    return std::filesystem::path(source.path()).parent_path() / relative;
}

std::vector<std::filesystem::path> filesBeside(const SourceFile& source, const Document& document) {
    std::set<std::filesystem::path> files;
    const auto add = [&](const std::string& uri) {
        if (uri.empty() || uri.starts_with("data:")) return;
        if (const auto path = pathBeside(source, uri)) files.insert(*path);
    };
    for (const BufferSource& buffer : document.extras.buffers) add(buffer.uri);
    for (const ImageSource& image : document.extras.images) add(image.uri);
    return {files.begin(), files.end()};
}

}  // namespace pagoda::ooc::gltf
