#include "ooc/store/verify.h"

#include "ooc/base/error.h"
#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

#include <fstream>
#include <functional>

namespace pagoda::ooc {
namespace {

using test::DatabaseOptions;
using test::TemporaryFolder;
using test::writeDatabase;

std::string list(const VerifyReport& report) {
    std::string text;
    for (const VerifyFault& fault : report.faults) text += fault.place + ": " + fault.what + "\n";
    return text;
}

class VerifyDatabase : public testing::Test {
protected:
    VerifyReport verify(size_t threadCount = 2) {
        return verifyDatabase(path_, threadCount, progress_);
    }
    [[nodiscard]] std::vector<char> read() const {
        std::ifstream in(path_, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    // Calls `broken` with one bit flipped; the file is whole again afterwards.
    void flip(size_t byte, unsigned bit, const std::function<void(VerifyReport)>& broken) {
        const auto poke = [&](char value) {
            std::fstream file(path_, std::ios::binary | std::ios::in | std::ios::out);
            file.seekp(static_cast<std::streamoff>(byte));
            file.put(value);
        };
        const char good = read()[byte];
        poke(static_cast<char>(good ^ (1 << bit)));
        broken(verify(1));
        poke(good);
    }

    TemporaryFolder folder_;
    std::filesystem::path path_ = folder_.path() / "a.pagoda";
    Progress progress_;
};

TEST_F(VerifyDatabase, FindsNothingInSoundDatabasesOfEveryCodec) {
    for (const Codec codec : {Codec::Raw, Codec::Meshopt, Codec::Draco}) {
        std::filesystem::remove(path_);
        const auto content =
            writeDatabase(path_, {.codec = codec, .depth = 4, .childrenPerNode = 6});
        const VerifyReport report = verify();
        EXPECT_TRUE(report.isSound()) << list(report);
        EXPECT_EQ(report.bytesChecked, std::filesystem::file_size(path_));
        EXPECT_EQ(report.nodesChecked, content.nodes.size());
        EXPECT_EQ(report.trianglesChecked, content.header.triangleCount);
    }
}

TEST_F(VerifyDatabase, FindsEveryFlippedBitOfATinyDatabaseAndCallsItOneFault) {
    (void)writeDatabase(path_, {.depth = 0, .leafTriangles = 1});
    for (size_t byte = 0; byte < std::filesystem::file_size(path_); ++byte) {
        for (unsigned bit = 0; bit < 8; ++bit) {
            flip(byte, bit, [&](const VerifyReport& report) {
                EXPECT_EQ(report.faultCount, 1u) << byte << ", bit " << bit << "\n" << list(report);
            });
        }
    }
}

TEST_F(VerifyDatabase, FindsAFlippedBitInEveryByteOfDatabasesOfEveryCodec) {
    for (const Codec codec : {Codec::Raw, Codec::Meshopt, Codec::Draco}) {
        std::filesystem::remove(path_);
        (void)writeDatabase(path_,
                            {.codec = codec, .depth = 1, .childrenPerNode = 2, .leafTriangles = 4});
        for (size_t byte = 0; byte < std::filesystem::file_size(path_); ++byte) {
            flip(byte, byte % 8, [&](const VerifyReport& report) {
                EXPECT_EQ(report.faultCount, 1u) << byte << "\n" << list(report);
            });
        }
    }
}

}  // namespace
}  // namespace pagoda::ooc
