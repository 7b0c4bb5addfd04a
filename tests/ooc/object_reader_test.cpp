#include "ooc/store/object_reader.h"

#include "ooc/store/layout.h"
#include "tests/ooc/store_fixture.h"

#include <gtest/gtest.h>

#include <fstream>
#include <random>

namespace pagoda::ooc {
namespace {

using test::TemporaryFolder;
using test::writeDatabase;

// A reader whose news can be waited for.
class Rig {
public:
    explicit Rig(const Database& database)
        : reader(database, [this] {
              const std::lock_guard lock(mutex_);
              ++news_;
              hasNews_.notify_one();
          }) {}
    template <typename Condition>
    void until(Condition&& condition) {
        while (true) {
            reader.update();
            if (condition()) return;
            std::unique_lock lock(mutex_);
            hasNews_.wait(lock, [this] { return news_ > 0; });
            news_ = 0;
        }
    }

private:
    std::mutex mutex_;
    std::condition_variable hasNews_;
    int news_ = 0;

public:
    ObjectReader reader;  // last: its thread uses what is above
};

// A table of `count` objects below the three of writeDatabase: houses of up to nine rooms.
std::vector<ObjectRecord> manyObjects(uint32_t count, std::vector<ObjectRecord> objects) {
    std::mt19937 random(7);
    while (objects.size() < count) {
        ObjectRecord object;
        const auto number = static_cast<uint32_t>(objects.size());
        const bool isHouse = number < 10 || random() % 10 == 0;
        object.name = (isHouse ? "House " : "room ") + std::to_string(number);
        if (!isHouse) object.parent = 3 + static_cast<uint32_t>(random() % (number - 3));
        object.box = {Vec3i(static_cast<int32_t>(number % 1000)),
                      Vec3i(static_cast<int32_t>(number % 1000 + 5))};
        object.triangleCount = 12;
        objects.push_back(object);
    }
    return objects;
}

struct Made {
    TemporaryFolder folder;
    std::vector<ObjectRecord> objects;
    std::filesystem::path path;
    explicit Made(uint32_t count) : path(folder.path() / "a.pagoda") {
        static_cast<void>(writeDatabase(path, {.spoil = [&](DatabaseWriter::Content& content) {
                                            content.objects = objects =
                                                manyObjects(count, content.objects);
                                        }}));
    }
};

TEST(ObjectReader, GathersTheTreeThatTheTableStates) {
    const Made made(20'000);
    const Database database = Database::open(made.path);
    Rig rig(database);
    rig.reader.wantTree();
    rig.until([&] { return rig.reader.isTreeWhole(); });
    const ObjectTree& tree = rig.reader.tree();
    std::vector<std::vector<uint32_t>> children(made.objects.size());
    std::vector<uint32_t> roots;
    for (uint32_t i = 0; i < made.objects.size(); ++i) {
        ASSERT_EQ(tree.parent(i), made.objects[i].parent);
        (made.objects[i].parent == kNoObject ? roots : children[made.objects[i].parent])
            .push_back(i);
    }
    std::vector<uint32_t> found;
    tree.childrenOf(kNoObject, 0, found);
    EXPECT_EQ(found, roots);
    for (uint32_t i = 0; i < made.objects.size(); i += 37) {
        found.clear();
        tree.childrenOf(i, 0, found);
        ASSERT_EQ(found, children[i]);
        ASSERT_EQ(tree.hasChildren(i), !children[i].empty());
    }
}

TEST(ObjectReader, NamesAreReadWhenTheyAreAskedFor) {
    const Made made(20'000);
    const Database database = Database::open(made.path);
    Rig rig(database);
    EXPECT_EQ(rig.reader.record(20'000), nullptr);
    for (const uint32_t object : {0u, 4095u, 4096u, 19'999u, 12'345u}) {
        rig.until([&] { return rig.reader.record(object) != nullptr; });
        EXPECT_EQ(rig.reader.record(object)->name, made.objects[object].name);
        EXPECT_EQ(rig.reader.record(object)->parent, made.objects[object].parent);
    }
    EXPECT_EQ(rig.reader.tree().size(), 0u) << "the tree was read though nobody wanted it";
}

TEST(ObjectReader, FindsNamesWhateverTheirCaseInTheOrderOfTheTable) {
    const Made made(20'000);
    const Database database = Database::open(made.path);
    Rig rig(database);
    rig.reader.search("nothing of that name");
    rig.reader.search("HOUSE 1");  // forgets the other one
    rig.until([&] { return !rig.reader.isSearching(); });
    std::vector<uint32_t> expected, found;
    for (uint32_t i = 0; i < made.objects.size(); ++i) {
        if (made.objects[i].name.starts_with("House 1")) expected.push_back(i);
    }
    for (const ObjectMatch& match : rig.reader.matches()) {
        found.push_back(match.object);
        EXPECT_EQ(match.name, made.objects[match.object].name);
    }
    EXPECT_EQ(found, expected);
    rig.reader.search("o");  // all houses and rooms
    rig.until([&] { return !rig.reader.isSearching(); });
    EXPECT_EQ(rig.reader.matches().size(), ObjectReader::kMaxMatches);
    rig.reader.search("");
    EXPECT_FALSE(rig.reader.isSearching());
    EXPECT_TRUE(rig.reader.matches().empty());
}

TEST(ObjectReader, BoundsWhatIsNotHidden) {
    const Made made(20'000);
    const Database database = Database::open(made.path);
    Rig rig(database);
    auto hidden = std::make_shared<ObjectSet>(20'000);
    Box3i expected;
    for (uint32_t i = 0; i < 20'000; ++i) {
        if (i == 5'017 || i == 13'030) {
            expected.extend(made.objects[i].box);
        } else {
            hidden->insert(i);
        }
    }
    rig.reader.wantVisibleBox(hidden);
    rig.until([&] { return rig.reader.visibleBox().has_value(); });
    EXPECT_EQ(*rig.reader.visibleBox(), database.header().lattice.toModel(expected));
}

TEST(ObjectReader, ABrokenBlockCostsItsNamesAlone) {
    const Made made(20'000);
    {
        const Database database = Database::open(made.path);
        const Database::Range& range = database.objectRanges()[1];
        std::fstream file(made.path, std::ios::binary | std::ios::in | std::ios::out);
        file.seekp(static_cast<std::streamoff>(range.offset + range.bytes / 2));
        file.put('\x55');
    }
    const Database database = Database::open(made.path);
    Rig rig(database);
    rig.reader.wantTree();
    rig.reader.search("room");
    rig.until([&] { return rig.reader.isTreeWhole() && !rig.reader.isSearching(); });
    ASSERT_EQ(rig.reader.faults().size(), 1u);
    EXPECT_NE(rig.reader.faults()[0].find("object block 1"), std::string::npos);
    EXPECT_EQ(rig.reader.tree().parent(4'100), kNoObject);
    EXPECT_EQ(rig.reader.tree().parent(9'000), made.objects[9'000].parent);
    EXPECT_EQ(rig.reader.matches().size(), ObjectReader::kMaxMatches);
    rig.until([&] { return rig.reader.record(4'100) != nullptr; });
    EXPECT_FALSE(rig.reader.record(4'100)->name.empty());
    // What cannot be bounded is not.
    auto hidden = std::make_shared<ObjectSet>(20'000);
    hidden->insert(0);
    rig.reader.wantVisibleBox(hidden);
    EXPECT_TRUE(rig.reader.isBoxPending());
    rig.until([&] { return !rig.reader.isBoxPending(); });
    EXPECT_FALSE(rig.reader.visibleBox());
}

TEST(ObjectReader, AMillionObjectsOpenAtOnceAndTakeFourBytesEach) {
    constexpr uint32_t kObjects = 1'000'000;
    const Made made(kObjects);
    const Database database = Database::open(made.path);
    Rig rig(database);
    rig.reader.update();
    EXPECT_EQ(rig.reader.tree().memoryBytes(), 0u);  // nothing before anyone asks
    // The first rows of the tree need the first block alone.
    rig.reader.wantTree();
    rig.until([&] { return rig.reader.tree().size() >= kObjectsPerBlock; });
    rig.until([&] { return rig.reader.isTreeWhole(); });
    EXPECT_LT(rig.reader.tree().memoryBytes(), uint64_t{9} * kObjects);
}

// Truth: walking up from each object.
TEST(ObjectSet, FamiliesAreWhoHasTheObjectAbove) {
    const std::vector<ObjectRecord> objects = manyObjects(3'000, {});
    ObjectTree tree;
    for (const ObjectRecord& object : objects) tree.append(std::span(&object.parent, 1));
    const auto isBelow = [&](uint32_t object, uint32_t ancestor) {
        while (object != kNoObject && object != ancestor) object = tree.parent(object);
        return object == ancestor;
    };
    for (const uint32_t chosen : {0u, 3u, 7u, 500u, 2'999u}) {
        ObjectSet family(3'000), others(3'000), back(3'000);
        family.insertFamily(tree, chosen);
        others.insertAllBut(tree, chosen);
        for (uint32_t i = 0; i < 3'000; ++i) back.insert(i);
        back.eraseFamily(tree, chosen);
        EXPECT_EQ(others, back);
        uint32_t count = 0;
        for (uint32_t i = 0; i < 3'000; ++i) {
            ASSERT_EQ(family.contains(i), isBelow(i, chosen));
            ASSERT_EQ(others.contains(i), !isBelow(i, chosen) && !isBelow(chosen, i));
            count += family.contains(i);
        }
        EXPECT_EQ(family.count(), count);
    }
}

}  // namespace
}  // namespace pagoda::ooc
