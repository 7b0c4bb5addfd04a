#include "tests/fuzz/input_file.h"

#include "tests/fuzz/targets.h"

#include <unistd.h>

#include <fstream>
#include <string>

namespace pagoda::fuzz {
namespace {

class OwnFolder {
public:
    OwnFolder() {
        std::filesystem::path parent = "/dev/shm";
        if (access(parent.c_str(), W_OK) != 0) parent = std::filesystem::temp_directory_path();
        path = parent / ("pagoda-fuzz-" + std::to_string(getpid()));
        std::filesystem::create_directories(path);
    }
    ~OwnFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
    }
    OwnFolder(const OwnFolder&) = delete;
    OwnFolder& operator=(const OwnFolder&) = delete;

    std::filesystem::path path;
};

}  // namespace

const std::filesystem::path& inputFolder() {
    static const OwnFolder folder;
    return folder.path;
}

std::filesystem::path writeInput(std::span<const std::byte> bytes, std::string_view extension) {
    const std::filesystem::path path = inputFolder() / ("input" + std::string(extension));
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    file.close();
    require(static_cast<bool>(file), "the input can be written");
    return path;
}

}  // namespace pagoda::fuzz
