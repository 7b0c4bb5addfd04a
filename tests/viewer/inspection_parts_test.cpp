// Parts of the window's inspection that need no window.
#include "tests/viewer/memory_scene.h"
#include "viewer/exact_pick.h"
#include "viewer/object_rows.h"
#include "viewer/section.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <random>

namespace pagoda::viewer {
namespace {

TEST(Section, ThePlaneIsWhereItWasSet) {
    const Box3d box{Vec3d(2'600'000.0, 1'200'000.0, 400.0), Vec3d(2'601'000.0, 1'200'700.0, 520.0)};
    std::mt19937 random(3);
    std::uniform_real_distribution<double> number(-1.0, 1.0);
    for (int i = 0; i < 200; ++i) {
        const Vec3d normal(number(random), number(random), number(random));
        const Vec3d point = glm::mix(
            box.min, box.max, 0.5 + 0.49 * Vec3d(number(random), number(random), number(random)));
        Section section;
        section.setPlane(normal, point, box);
        const hlod::SectionPlane plane = section.plane(box);
        EXPECT_NEAR(glm::distance(plane.normal, glm::normalize(normal)), 0.0, 1e-9);
        EXPECT_NEAR(plane.above(point), 0.0, 1e-6);
        section.flip();
        const hlod::SectionPlane flipped = section.plane(box);
        EXPECT_NEAR(glm::distance(plane.normal, -flipped.normal), 0.0, 1e-9);
        EXPECT_NEAR(flipped.above(point), 0.0, 1e-6);
    }
    for (int axis = 0; axis < 3; ++axis) {
        Vec3d normal(0.0);
        normal[axis] = -1.0;
        Section section;
        section.setNormal(normal);
        EXPECT_EQ(section.normal(), normal);
    }
}

// A forest in which every tenth object has children.
ooc::ObjectTree forest(uint32_t count) {
    std::mt19937 random(9);
    std::vector<uint32_t> parents;
    for (uint32_t i = 0; i < count; ++i) {
        parents.push_back(i < 5 || random() % 20 == 0
                              ? ooc::kNoObject
                              : static_cast<uint32_t>(random() % i) / 10 * 10);
    }
    ooc::ObjectTree tree;
    tree.append(parents);
    return tree;
}

// As one would write it down, by recursion.
void list(const ooc::ObjectTree& tree, const ObjectRows& rows, uint32_t above, uint32_t depth,
          std::vector<std::pair<uint32_t, uint32_t>>& out) {
    for (uint32_t object = 0; object < tree.size(); ++object) {
        if (tree.parent(object) != above) continue;
        out.emplace_back(object, depth);
        if (rows.isOpen(object)) list(tree, rows, object, depth + 1, out);
    }
}

TEST(ObjectRows, AreWhatIsOpenFromTheRootsDown) {
    const ooc::ObjectTree whole = forest(500);
    ooc::ObjectTree tree;
    ObjectRows rows;
    std::mt19937 random(5);
    for (uint32_t known = 0; known < 500; known += 50) {  // it grows while it is looked at
        std::vector<uint32_t> parents;
        for (uint32_t i = known; i < known + 50; ++i) parents.push_back(whole.parent(i));
        tree.append(parents);
        for (int i = 0; i < 5; ++i) rows.toggle(static_cast<uint32_t>(random() % tree.size()));
        if (known == 200) rows.reveal(tree, 187);
        rows.update(tree);
        std::vector<std::pair<uint32_t, uint32_t>> expected, shown;
        list(tree, rows, ooc::kNoObject, 0, expected);
        for (const ObjectRow& row : rows.rows()) shown.emplace_back(row.object, row.depth);
        ASSERT_EQ(shown, expected);
        if (known == 200) {
            EXPECT_LT(rows.rowOf(187), rows.rows().size());
        }
    }
}

TEST(ObjectRows, AMillionRootsAreAMillionRows) {
    ooc::ObjectTree tree;
    ObjectRows rows;
    const std::vector<uint32_t> roots(4096, ooc::kNoObject);
    while (tree.size() < 1'000'000) {
        tree.append(roots);
        rows.update(tree);
    }
    EXPECT_EQ(rows.rows().size(), tree.size());
}

TEST(ExactPick, AnswersTheLastRayAlone) {
    ooc::Lattice lattice;
    lattice.extentBits = 12;
    const auto scene =
        test::MemoryScene::make(lattice, test::bumpySphere(Vec3d(2'048), 1'000, 30), 50);
    std::mutex mutex;
    std::condition_variable hasAnswer;
    bool isThere = false;
    ExactPick pick(scene, lattice, [&] {
        const std::lock_guard lock(mutex);
        isThere = true;
        hasAnswer.notify_one();
    });
    hlod::LeafRay beside, at;
    beside.originModel = at.originModel = Vec3d(-5'000, 2'048, 2'048);
    beside.direction = Vec3d(-1, 0, 0);
    at.direction = Vec3d(1, 1e-3, 0);
    for (int i = 0; i < 20; ++i) {
        {
            const std::lock_guard lock(mutex);
            isThere = false;
        }
        pick.ask(beside);
        pick.ask(at);
        std::optional<hlod::LeafRayResult> answer;
        while (!(answer = pick.take())) {
            std::unique_lock lock(mutex);
            hasAnswer.wait(lock, [&] { return isThere; });
            isThere = false;
        }
        EXPECT_TRUE(answer->isHit);
        EXPECT_FALSE(pick.take());
    }
    pick.ask(at);
    pick.cancel();
    EXPECT_FALSE(pick.take());
}

}  // namespace
}  // namespace pagoda::viewer
