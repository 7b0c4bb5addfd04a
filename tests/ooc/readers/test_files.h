// test_files.h: files that tests write themselves, in a folder that goes with the test.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace pagoda::ooc::test {

class TempFolder {
public:
    TempFolder() {
        std::string name = (std::filesystem::temp_directory_path() / "pagoda-test-XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr) ADD_FAILURE() << "no temporary folder";
        path_ = name;
    }
    ~TempFolder() {
        std::error_code code;
        std::filesystem::remove_all(path_, code);
    }
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;

    std::filesystem::path write(const std::string& name, std::string_view bytes) const {
        const std::filesystem::path path = path_ / name;
        std::filesystem::create_directories(path.parent_path());
        std::ofstream(path, std::ios::binary) << bytes;
        return path;
    }
    [[nodiscard]] const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

// The bytes of a value, in the byte order asked for.
template <typename Value>
std::string bytesOf(Value value, bool bigEndian = false) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    if (bigEndian) bytes.assign(bytes.rbegin(), bytes.rend());
    return bytes;
}

[[nodiscard]] inline std::string contentsOf(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

// Where the models are. Tests that need them skip without.
[[nodiscard]] inline std::filesystem::path testData() {
    return PAGODA_TEST_DATA;
}

}  // namespace pagoda::ooc::test

// First line of a test that reads models.
#define PAGODA_REQUIRE_TEST_DATA()                                                 \
    if (!std::filesystem::exists(pagoda::ooc::test::testData() / "stats.json"))    \
    GTEST_SKIP() << "SKIPPED: no models at PAGODA_TEST_DATA (" << PAGODA_TEST_DATA \
                 << "): set it to the folder of stats.json"
