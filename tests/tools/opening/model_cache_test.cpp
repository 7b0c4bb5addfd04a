#include "tools/opening/model_cache.h"

#include "hlod/build/build.h"
#include "ooc/base/error.h"
#include "ooc/base/file.h"
#include "tests/hlod/build/test_meshes.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

namespace pagoda::tools {
namespace {

namespace fs = std::filesystem;
using pagoda::test::TemporaryFolder;

constexpr int64_t kLaterNs = 10'000'000'000;

void write(const fs::path& path, const std::string& text) {
    fs::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
}

std::string quad(double height) {
    return "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 " + std::to_string(height) +
           "\nv 0 1 0\nusemtl m\nf 1 2 3\nf 1 3 4\n";
}

struct Rig {
    TemporaryFolder folder;
    Progress progress;
    int builds = 0;
    std::vector<std::string> notes;
    // Later than any file: all are settled.
    ModelCache::Options options{.folder = folder / "cache", .settings = "test", .nowNs = [] {
                                    return systemNs() + kLaterNs;
                                }};

    // As `view` does; returns the database.
    fs::path open(const fs::path& model) {
        ModelCache cache(options);
        const auto inputs = hlod::expandInputs({model.string()});
        if (const auto known = cache.findKnown(inputs)) return *known;
        if (const auto found = cache.find(inputs, progress)) return *found;
        ++builds;
        hlod::BuildOptions build;
        build.inputs = inputs;
        build.target = cache.buildTarget();
        build.force = true;
        build.threads = 1;
        return cache.take(hlod::buildDatabase(build, progress).companions, progress, notes);
    }
};

TEST(ModelCache, WhatWasBuiltIsFoundAgainWhereverTheFileLies) {
    Rig rig;
    write(rig.folder / "a.obj", quad(0.5));
    const fs::path first = rig.open(rig.folder / "a.obj");
    EXPECT_EQ(rig.open(rig.folder / "a.obj"), first);
    write(rig.folder / "elsewhere" / "b.obj", quad(0.5));
    EXPECT_EQ(rig.open(rig.folder / "elsewhere" / "b.obj"), first);
    EXPECT_EQ(rig.builds, 1);
}

TEST(ModelCache, AChangedFileIsBuiltAnewAlsoWhenItsSizeAndTimeStay) {
    Rig rig;
    const fs::path model = rig.folder / "a.obj";
    write(model, quad(0.5));
    const fs::path first = rig.open(model);
    const auto time = fs::last_write_time(model);
    write(model, quad(0.25));
    fs::last_write_time(model, time);  // its time of change tells
    const fs::path second = rig.open(model);
    EXPECT_NE(first, second);
    write(model, quad(0.5));
    EXPECT_EQ(rig.open(model), first);
    EXPECT_EQ(rig.builds, 2);
}

TEST(ModelCache, KnownFilesAreNotReadAgainAndYoungOnesAre) {
    Rig rig;
    const fs::path model = rig.folder / "a.obj";
    write(model, quad(0.5));
    const auto inputs = hlod::expandInputs({model.string()});
    const fs::path database = rig.open(model);
    EXPECT_EQ(ModelCache(rig.options).findKnown(inputs), database);

    Rig young;
    young.options.nowNs = systemNs;  // could still be written at the same time as it was
    write(young.folder / "a.obj", quad(0.5));
    (void)young.open(young.folder / "a.obj");
    ModelCache cache(young.options);
    const auto same = hlod::expandInputs({(young.folder / "a.obj").string()});
    EXPECT_FALSE(cache.findKnown(same));
    EXPECT_TRUE(cache.find(same, young.progress));
}

TEST(ModelCache, SettingsAndPlacementsAreDifferentDatabases) {
    Rig rig;
    const fs::path model = rig.folder / "a.obj";
    write(model, quad(0.5));
    const fs::path plain = rig.open(model);
    const fs::path turned = rig.open(model.string() + "@up=y");
    const fs::path scaled = rig.open(model.string() + "@unit=mm");
    rig.options.settings = "another version";
    const fs::path later = rig.open(model);
    EXPECT_EQ(rig.builds, 4);
    EXPECT_EQ((std::set{plain, turned, scaled, later}.size()), 4u);
}

TEST(ModelCache, AMaterialFileThatComesChangesOrGoesCounts) {
    Rig rig;
    const fs::path model = rig.folder / "a.obj", materials = rig.folder / "a.mtl";
    write(model, quad(0.5));
    (void)rig.open(model);  // without
    write(materials, "newmtl m\nKd 1 0 0\n");
    (void)rig.open(model);
    EXPECT_EQ(rig.builds, 2);
    write(materials, "newmtl m\nKd 0 1 0\n");
    (void)rig.open(model);
    (void)rig.open(model);
    EXPECT_EQ(rig.builds, 3);
    fs::remove(materials);
    (void)rig.open(model);
    EXPECT_EQ(rig.builds, 4);
}

TEST(ModelCache, AnInputThatChangesWhileItIsBuiltLeavesNothing) {
    Rig rig;
    const fs::path model = rig.folder / "a.obj";
    write(model, quad(0.5));
    ModelCache cache(rig.options);
    const auto inputs = hlod::expandInputs({model.string()});
    ASSERT_FALSE(cache.find(inputs, rig.progress));
    write(cache.buildTarget(), "as if built");
    write(model, quad(0.75));
    EXPECT_THROW((void)cache.take({}, rig.progress, rig.notes), Error);
    EXPECT_FALSE(fs::exists(cache.buildTarget()));
    EXPECT_FALSE(cache.find(inputs, rig.progress));
}

TEST(ModelCache, AMaterialFileThatChangesWhileItIsBuiltLeavesNothing) {
    Rig rig;
    rig.options.nowNs = systemNs;
    const fs::path model = rig.folder / "a.obj", materials = rig.folder / "a.mtl";
    write(model, quad(0.5));
    ModelCache cache(rig.options);
    const auto inputs = hlod::expandInputs({model.string()});
    ASSERT_FALSE(cache.find(inputs, rig.progress));
    write(cache.buildTarget(), "as if built");
    // The file system's clock ticks seldom: until it shows the change.
    do {
        write(materials, "newmtl m\n");
    } while (fs::last_write_time(materials) <= fs::last_write_time(cache.buildTarget()));
    EXPECT_THROW((void)cache.take({materials}, rig.progress, rig.notes), Error);
    EXPECT_FALSE(fs::exists(cache.buildTarget()));
}

TEST(ModelCache, AFolderAmongTheCompanionsIsAsIfItWereNotThere) {
    Rig rig;
    write(rig.folder / "a.obj", quad(0.5));
    fs::create_directories(rig.folder / "a.mtl");
    const fs::path first = rig.open(rig.folder / "a.obj");
    EXPECT_EQ(rig.open(rig.folder / "a.obj"), first);
    EXPECT_EQ(rig.builds, 1);
}

// Root may read all: it works as another user meanwhile.
class OrdinaryUser {
public:
    explicit OrdinaryUser(const fs::path& folder) {
        fs::permissions(folder, fs::perms::all);
        if (before_ == 0 && ::seteuid(65534) != 0) throw std::runtime_error("cannot be another");
    }
    ~OrdinaryUser() { (void)!::seteuid(before_); }
    OrdinaryUser(const OrdinaryUser&) = delete;
    OrdinaryUser& operator=(const OrdinaryUser&) = delete;

private:
    uid_t before_ = ::geteuid();
};

TEST(ModelCache, ACompanionThatMayNotBeReadIsAsIfItWereNotThere) {
    Rig rig;
    const OrdinaryUser user(rig.folder / "");
    write(rig.folder / "a.obj", quad(0.5));
    write(rig.folder / "a.mtl", "newmtl m\n");
    fs::permissions(rig.folder / "a.mtl", fs::perms::none);
    const fs::path first = rig.open(rig.folder / "a.obj");
    EXPECT_EQ(rig.open(rig.folder / "a.obj"), first);
    EXPECT_EQ(rig.builds, 1);
    fs::permissions(rig.folder / "a.mtl", fs::perms::owner_read);
    (void)rig.open(rig.folder / "a.obj");
    EXPECT_EQ(rig.builds, 2) << "it can be read now";
}

TEST(ModelCache, ReadingACompanionIsCountedAndCanBeStopped) {
    struct Counting : Progress {
        void advance(uint64_t units) override { bytes += units; }
        uint64_t bytes = 0;
    };
    Rig rig;
    const fs::path known = rig.folder / "cache" / "known";
    write(rig.folder / "a.obj", quad(0.5));
    (void)rig.open(rig.folder / "a.obj");
    ASSERT_EQ(std::distance(fs::directory_iterator(known), fs::directory_iterator()), 1);
    const fs::path ofModel = fs::directory_iterator(known)->path();
    write(rig.folder / "a.mtl", "newmtl m\n");
    (void)rig.open(rig.folder / "a.obj");
    const auto forgetCompanion = [&] {
        for (const auto& file : fs::directory_iterator(known)) {
            if (file.path() != ofModel) fs::remove(file.path());
        }
    };
    const auto inputs = hlod::expandInputs({(rig.folder / "a.obj").string()});
    ModelCache cache(rig.options);
    EXPECT_TRUE(cache.findKnown(inputs));
    forgetCompanion();
    EXPECT_FALSE(cache.findKnown(inputs)) << "it would have to be read";
    Counting counting;
    EXPECT_TRUE(cache.find(inputs, counting));
    EXPECT_EQ(counting.bytes, fs::file_size(rig.folder / "a.mtl"));
    forgetCompanion();
    Progress stopped;
    stopped.requestStop();
    EXPECT_THROW((void)cache.find(inputs, stopped), Interrupted);
}

TEST(ModelCache, WhatIsKnownOfFilesThatAreGoneIsForgotten) {
    Rig rig;
    const auto countKnown = [&] {
        return std::distance(fs::directory_iterator(rig.folder / "cache" / "known"),
                             fs::directory_iterator());
    };
    write(rig.folder / "a.obj", quad(0.5));
    write(rig.folder / "b.obj", quad(0.6));
    (void)rig.open(rig.folder / "a.obj");
    EXPECT_EQ(countKnown(), 1);
    fs::remove(rig.folder / "a.obj");
    (void)rig.open(rig.folder / "b.obj");
    EXPECT_EQ(countKnown(), 1) << "b's, not a's";
}

TEST(ModelCache, AnEntryWithoutItsDatabaseIsRemovedOnceItIsOld) {
    Rig rig;
    const fs::path old = rig.folder / "cache" / "old.json",
                   young = rig.folder / "cache" / "young.json";
    write(old, "{}");
    write(young, "{}");
    fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(48));
    ModelCache cache(rig.options);
    EXPECT_FALSE(fs::exists(old));
    EXPECT_TRUE(fs::exists(young));
}

TEST(ModelCache, AnEntryThatCannotBeWrittenLeavesNeitherTheNewNorTheOldDatabase) {
    Rig rig;
    const fs::path model = rig.folder / "a.obj", material = rig.folder / "a.mtl";
    write(model, quad(0.5));
    write(material, "newmtl m\nKd 1 0 0\n");
    const fs::path database = rig.open(model);
    write(material, "newmtl m\nKd 0 1 0\n");
    fs::path entry = database;
    entry.replace_extension(".json");
    fs::remove(entry);
    write(entry / "in the way", "");  // a folder, not empty
    EXPECT_THROW(rig.open(model), Error);
    EXPECT_FALSE(fs::exists(database));
    EXPECT_TRUE(fs::is_empty(rig.options.folder / "building"));
    fs::remove_all(entry);
    EXPECT_EQ(rig.open(model), database);
    EXPECT_EQ(rig.builds, 3);
}

TEST(ModelCache, OfSeveralFilesItCountsWhereTheyLie) {
    Rig rig;
    for (const char* folder : {"A", "B", "C"}) write(rig.folder / folder / "a.obj", quad(0.5));
    write(rig.folder / "B" / "a.mtl", "newmtl m\nKd 1 0 0\n");
    write(rig.folder / "C" / "a.mtl", "newmtl m\nKd 0 1 0\n");
    const auto keyOf = [&](const char* second) {
        ModelCache cache(rig.options);
        const auto inputs = hlod::expandInputs(
            {(rig.folder / "A" / "a.obj").string(), (rig.folder / second / "a.obj").string()});
        (void)cache.find(inputs, rig.progress);
        return cache.buildTarget();
    };
    EXPECT_NE(keyOf("B"), keyOf("C"));
    EXPECT_EQ(keyOf("B"), keyOf("B"));
}

TEST(ModelCache, ADamagedDatabaseIsMadeAnew) {
    Rig rig;
    const fs::path model = rig.folder / "a.obj";
    write(model, quad(0.5));
    const fs::path database = rig.open(model);
    write(database, "no database");
    EXPECT_EQ(rig.open(model), database);
    EXPECT_EQ(rig.builds, 2);
}

TEST(ModelCache, AboveItsSizeTheLeastRecentlyOpenedGoAndAreNamed) {
    Rig rig;
    std::vector<fs::path> models, databases;
    for (int i = 0; i < 3; ++i) {
        models.push_back(rig.folder / ("m" + std::to_string(i) + ".obj"));
        write(models.back(), quad(0.1 * (i + 1)));
    }
    databases.push_back(rig.open(models[0]));
    databases.push_back(rig.open(models[1]));
    EXPECT_TRUE(rig.notes.empty());
    // The first was opened last.
    fs::path entry = databases[1];
    entry.replace_extension(".json");
    fs::last_write_time(entry, fs::last_write_time(entry) - std::chrono::hours(1));
    rig.options.mostBytes = fs::file_size(databases[0]) * 5 / 2;
    databases.push_back(rig.open(models[2]));
    EXPECT_TRUE(fs::exists(databases[0]));
    EXPECT_FALSE(fs::exists(databases[1]));
    EXPECT_TRUE(fs::exists(databases[2]));
    ASSERT_EQ(rig.notes.size(), 1u);
    EXPECT_NE(rig.notes[0].find("m1.obj"), std::string::npos) << rig.notes[0];
    // The new one stays even when it alone is too large.
    rig.options.mostBytes = 1;
    write(models[0], quad(0.9));
    EXPECT_TRUE(fs::exists(rig.open(models[0])));
    EXPECT_FALSE(fs::exists(databases[2]));
}

TEST(ModelCache, WhatAKilledBuildLeftIsRemoved) {
    Rig rig;
    const fs::path part = rig.folder / "cache" / "building" / ".x.pagoda.part-1";
    write(part, "half a database");
    ModelCache cache(rig.options);
    EXPECT_FALSE(fs::exists(part));
}

TEST(ModelCache, AFolderThatCannotBeMadeIsRefusedByName) {
    Rig rig;
    write(rig.folder / "file", "x");
    rig.options.folder = rig.folder / "file";
    try {
        ModelCache cache(rig.options);
        FAIL() << "a file is no folder";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("--cache"), std::string::npos);
    }
}

}  // namespace
}  // namespace pagoda::tools
