#include "viewer/picture.h"

#include "ooc/base/error.h"

#include <fmt/format.h>
#include <png.h>

#include <bit>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

namespace pagoda::viewer {
namespace {

static_assert(std::endian::native == std::endian::little,
              "files are written as they lie in memory");

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
    throw Error(path.string(), "", what,
                "check the folder, its permissions and the space on the disk");
}

class OutputFile {
public:
    explicit OutputFile(const std::filesystem::path& path)
        : path_(path), file_(std::fopen(path.c_str(), "wb"), &std::fclose) {
        if (!file_) refuse(path, std::string("cannot be written: ") + std::strerror(errno));
    }
    [[nodiscard]] std::FILE* handle() const { return file_.get(); }
    void write(const void* bytes, size_t count) {
        if (std::fwrite(bytes, 1, count, file_.get()) != count)
            refuse(path_, "cannot be written to its end");
    }
    // Only a closed file is a written one: a full disk may say so this late.
    void close() {
        if (std::fclose(file_.release()) != 0) refuse(path_, "cannot be written to its end");
    }

private:
    std::filesystem::path path_;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
};

}  // namespace

uint64_t Picture::coveredPixels() const {
    uint64_t count = 0;
    for (size_t i = 0; i < pixelCount(); ++i) count += colours[4 * i + 3] != 0 ? 1u : 0u;
    return count;
}

void writePng(const Picture& picture, const std::filesystem::path& path) {
    OutputFile file(path);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(picture.widthPx);
    image.height = static_cast<png_uint_32>(picture.heightPx);
    image.format = PNG_FORMAT_RGB;
    std::vector<uint8_t> rgb(picture.pixelCount() * 3);
    for (size_t i = 0; i < picture.pixelCount(); ++i) {
        std::memcpy(&rgb[3 * i], &picture.colours[4 * i], 3);
    }
    if (png_image_write_to_stdio(&image, file.handle(), 0, rgb.data(), 0, nullptr) == 0) {
        refuse(path, std::string("cannot be written: ") + image.message);
    }
    file.close();
}

void writeDepth(const Picture& picture, const std::filesystem::path& path) {
    OutputFile file(path);
    // A negative scale means little-endian; PFM's rows run from bottom to top.
    const std::string header = fmt::format("Pf\n{} {}\n-1.0\n", picture.widthPx, picture.heightPx);
    file.write(header.data(), header.size());
    const auto width = static_cast<size_t>(picture.widthPx);
    for (auto row = static_cast<size_t>(picture.heightPx); row-- > 0;) {
        file.write(&picture.depthsModelUnits[row * width], width * sizeof(float));
    }
    file.close();
}

void writeIds(const Picture& picture, const std::filesystem::path& path) {
    OutputFile file(path);
    std::vector<uint32_t> pairs(picture.pixelCount() * 2);
    for (size_t i = 0; i < picture.pixelCount(); ++i) {
        pairs[2 * i] = picture.nodeOrdinals[i];
        pairs[2 * i + 1] = picture.triangles[i];
    }
    file.write(pairs.data(), pairs.size() * sizeof(uint32_t));
    file.close();

    std::string json =
        fmt::format(R"({{"width":{},"height":{},"nodes":[)", picture.widthPx, picture.heightPx);
    for (size_t i = 0; i < picture.nodes.size(); ++i) {
        json += fmt::format("{}\"{:#x}\"", i == 0 ? "" : ",", picture.nodes[i].value);
    }
    json += "]}\n";
    OutputFile sidecar(path.string() + ".json");
    sidecar.write(json.data(), json.size());
    sidecar.close();
}

}  // namespace pagoda::viewer
