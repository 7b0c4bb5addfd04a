// Publishing: a target is whole or not there, whatever happens on the way.
#include "ooc/store/database_writer.h"

#include "ooc/base/error.h"
#include "ooc/store/database.h"
#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>
#include <fstream>
#include <optional>

namespace pagoda::ooc {
namespace {

using test::TemporaryFolder;
using test::writeDatabase;

std::vector<std::byte> whole(const std::filesystem::path& path) {
    return readWholeFile(path, 1u << 24);
}

size_t filesIn(const std::filesystem::path& folder) {
    return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder), {}));
}

class Publish : public testing::Test {
protected:
    TemporaryFolder folder_;
    std::filesystem::path target_ = folder_.path() / "a.pagoda";
};

// Content of a database of one triangle, whose page is added to `writer`.
DatabaseWriter::Content contentFor(DatabaseWriter& writer) {
    std::mt19937 random(1);
    const PageMesh mesh = test::randomMesh(
        random,
        {.triangleCount = 1, .hasTranslucent = false, .objectCount = 1, .materialCount = 1});
    const std::vector<std::byte> page = encodePage({mesh, {}}, Codec::Raw);
    DatabaseWriter::Content content;
    NodeRecord& node = content.nodes.emplace_back();
    node.pageOffset = writer.addPage(page);
    node.pageBytes = static_cast<uint32_t>(page.size());
    node.pageChecksum = hash64(page);
    node.box = mesh.box();
    node.triangleCount = node.opaqueTriangleCount = 1;
    node.subtreeTriangles = 1;
    node.vertexCount = mesh.vertexCount();
    content.header.lattice.extentBits = 10;
    content.header.levelCount = 1;
    content.header.triangleCount = 1;
    return content;
}

TEST_F(Publish, ShowsNothingUnderTheTargetsNameBeforeItEnds) {
    DatabaseWriter writer(target_, false, 100000);
    DatabaseWriter::Content content = contentFor(writer);
    EXPECT_FALSE(std::filesystem::exists(target_));
    const uint64_t bytes = writer.publish(std::move(content));
    EXPECT_EQ(std::filesystem::file_size(target_), bytes);
    EXPECT_EQ(filesIn(folder_.path()), 1u);
}

TEST_F(Publish, WritesTheSameBytesWhateverWasReserved) {
    (void)DatabaseWriter(folder_.path() / "b", false, 0);
    for (const uint64_t reserved : {uint64_t{0}, uint64_t{1} << 20}) {
        DatabaseWriter writer(folder_.path() / std::to_string(reserved), false, reserved);
        writer.publish(contentFor(writer));
    }
    EXPECT_EQ(whole(folder_.path() / "0"), whole(folder_.path() / "1048576"));
}

TEST_F(Publish, LeavesNothingWhenTheWriterIsDestroyedBefore) {
    {
        DatabaseWriter writer(target_, false, 100000);
        (void)contentFor(writer);
    }
    EXPECT_EQ(filesIn(folder_.path()), 0u);
}

TEST_F(Publish, RefusesAnExistingTargetWithoutForceAndKeepsItsBytes) {
    std::ofstream(target_) << "precious";
    EXPECT_THROW(DatabaseWriter(target_, false, 0), Error);
    EXPECT_EQ(std::filesystem::file_size(target_), 8u);
    EXPECT_EQ(filesIn(folder_.path()), 1u);
}

TEST_F(Publish, NeverReplacesATargetThatAppearedMeanwhile) {
    DatabaseWriter writer(target_, false, 0);
    DatabaseWriter::Content content = contentFor(writer);
    std::ofstream(target_) << "precious";
    EXPECT_THROW(writer.publish(std::move(content)), Error);
    EXPECT_EQ(std::filesystem::file_size(target_), 8u);
}

TEST_F(Publish, ReplacesWithForceAndOnlyAtTheEnd) {
    std::ofstream(target_) << "precious";
    { const DatabaseWriter abandoned(target_, true, 0); }
    EXPECT_EQ(std::filesystem::file_size(target_), 8u);
    DatabaseWriter writer(target_, true, 0);
    writer.publish(contentFor(writer));
    EXPECT_EQ(Database::open(target_).header().triangleCount, 1u);
    EXPECT_EQ(filesIn(folder_.path()), 1u);
}

TEST_F(Publish, RefusesAFolderAsTargetAndAFolderThatIsNotThere) {
    EXPECT_THROW(DatabaseWriter(folder_.path(), true, 0), Error);
    EXPECT_THROW(DatabaseWriter(folder_.path() / "no" / "a", false, 0), Error);
}

// A limit on file sizes stands for the full disk.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) {
        ::getrlimit(RLIMIT_FSIZE, &old_);
        const rlimit limit{bytes, old_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        handler_ = std::signal(SIGXFSZ, SIG_IGN);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &old_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
    rlimit old_{};
    void (*handler_)(int);
};

TEST_F(Publish, SaysAFullDiskAtOnceWhereTheSizeIsExpected) {
    const FileSizeLimit limit(10000);
    EXPECT_THROW(DatabaseWriter(target_, false, 1000000), Error);
    EXPECT_EQ(filesIn(folder_.path()), 0u);
}

TEST_F(Publish, LeavesNothingWhereverTheDiskFills) {
    for (rlim_t bytes = 0; bytes < 1024; bytes += 24) {
        SCOPED_TRACE(bytes);
        const FileSizeLimit limit(bytes);
        std::optional<Error> error;
        try {
            DatabaseWriter writer(target_, false, 0);
            writer.publish(contentFor(writer));
        } catch (const Error& thrown) {
            error = thrown;
        }
        EXPECT_EQ(filesIn(folder_.path()), error ? 0u : 1u);
        std::filesystem::remove(target_);
    }
}

TEST_F(Publish, FindsWhatAKilledBuildLeftAndNotWhatARunningOneWrites) {
    EXPECT_TRUE(findLeftovers(target_).empty());
    const pid_t child = ::fork();
    if (child == 0) {
        DatabaseWriter writer(target_, false, 1000);
        ::_exit(0);  // no destructor: as if killed
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    const DatabaseWriter running(target_, false, 1000);
    EXPECT_EQ(filesIn(folder_.path()), 2u);
    const auto leftovers = findLeftovers(target_);
    ASSERT_EQ(leftovers.size(), 1u);
    EXPECT_TRUE(std::filesystem::remove(leftovers[0]));
    EXPECT_TRUE(findLeftovers(target_).empty());
}

TEST_F(Publish, CutsNamesThatAreTooLongBetweenCharacters) {
    DatabaseWriter writer(target_, false, 0);
    DatabaseWriter::Content content = contentFor(writer);
    std::string name(1, 'a');
    while (name.size() < 70000) name += "\xC3\xA4";  // two bytes each
    content.objects.emplace_back().name = name;
    content.materials.push_back({.name = name});
    writer.publish(std::move(content));
    const Database database = Database::open(target_);
    EXPECT_EQ(database.readObject(0).value->name, name.substr(0, 65535));
    EXPECT_EQ(database.materials()[0].name, name.substr(0, 65535));
}

}  // namespace
}  // namespace pagoda::ooc
