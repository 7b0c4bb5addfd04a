#include "ooc/base/file.h"

#include "ooc/base/error.h"
#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string_view>

namespace pagoda {
namespace {

using ooc::test::TemporaryFolder;

std::vector<std::byte> bytesOf(std::string_view text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

Error errorOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const Error& error) {
        return error;
    }
    ADD_FAILURE() << "nothing thrown";
    return {"", "", "", ""};
}

TEST(File, ReadsWhatWasWrittenAndAppended) {
    const TemporaryFolder folder;
    File file = File::create(folder.path() / "a");
    EXPECT_EQ(file.append(bytesOf("hello ")), 0u);
    EXPECT_EQ(file.append(bytesOf("world")), 6u);
    file.writeAt(0, bytesOf("J"));
    EXPECT_EQ(file.sizeBytes(), 11u);
    EXPECT_EQ(readWholeFile(folder.path() / "a", 11), bytesOf("Jello world"));
}

TEST(File, SaysWhereAFileWasCutShort) {
    const TemporaryFolder folder;
    File file = File::create(folder.path() / "a");
    file.append(bytesOf("0123456789"));
    std::vector<std::byte> out(8);
    const Error error = errorOf([&] { file.readAt(5, out); });
    EXPECT_EQ(error.path(), (folder.path() / "a").string());
    EXPECT_EQ(error.place(), "byte 10");
    EXPECT_EQ(file.readSomeAt(5, out), 5u);
    EXPECT_EQ(file.readSomeAt(10, out), 0u);
}

TEST(File, NamesTheFileThatIsMissingAndTheFolderThatIsNone) {
    const TemporaryFolder folder;
    const Error missing = errorOf([&] { (void)File::openForReading(folder.path() / "no"); });
    EXPECT_EQ(missing.path(), (folder.path() / "no").string());
    EXPECT_FALSE(missing.remedy().empty());
    EXPECT_THROW((void)File::openForReading(folder.path()), Error);
}

TEST(File, NeverReplacesAFileByCreating) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "a") << "mine";
    EXPECT_THROW((void)File::create(folder.path() / "a"), Error);
    EXPECT_EQ(readWholeFile(folder.path() / "a", 100), bytesOf("mine"));
}

TEST(File, RefusesAWholeFileBeyondTheLimit) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "a") << "12345";
    EXPECT_EQ(readWholeFile(folder.path() / "a", 5).size(), 5u);
    EXPECT_THROW((void)readWholeFile(folder.path() / "a", 4), Error);
}

TEST(File, ReservesAndCutsBack) {
    const TemporaryFolder folder;
    File file = File::create(folder.path() / "a");
    file.reserve(100000);
    file.truncate(3);
    EXPECT_EQ(file.sizeBytes(), 3u);
    EXPECT_THROW(file.reserve(uint64_t{1} << 62), Error);
}

TEST(File, LeavesNoNameBehindForScratch) {
    const TemporaryFolder folder;
    File file = File::createScratch(folder.path());
    file.append(bytesOf("gone with us"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(File, GivesAnotherStampOnceItsSizeChanged) {
    const TemporaryFolder folder;
    File file = File::create(folder.path() / "a");
    const uint64_t before = file.changeStamp();
    file.append(bytesOf("x"));
    EXPECT_NE(file.changeStamp(), before);
}

TEST(ScratchArray, HoldsAllThatWasAppendedAfterEachSeal) {
    const TemporaryFolder folder;
    ScratchArray array(folder.path());
    array.seal();
    EXPECT_TRUE(array.bytes().empty());
    std::vector<std::byte> expected;
    for (uint32_t i = 0; i < 3000; ++i) {
        const auto item = bytesOf(std::to_string(i) + std::string(i % 1500, 'x'));
        array.append(item);
        expected.insert(expected.end(), item.begin(), item.end());
        if (i % 1000 != 999) continue;
        array.seal();
        ASSERT_EQ(array.sizeBytes(), expected.size());
        ASSERT_TRUE(std::equal(expected.begin(), expected.end(), array.bytes().begin(),
                               array.bytes().end()));
    }
}

}  // namespace
}  // namespace pagoda
