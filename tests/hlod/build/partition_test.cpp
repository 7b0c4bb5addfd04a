#include "hlod/build/partition.h"

#include "hlod/build/node_store.h"
#include "hlod/build/tree_builder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

namespace pagoda::hlod {
namespace {

using Triangles = std::vector<SoupTriangle>;  // object: its number in the input

ooc::Lattice latticeOf(int extentBits) {
    ooc::Lattice lattice;
    lattice.extentBits = extentBits;
    return lattice;
}

Intake spilled(const Triangles& triangles, SoupLayout layout) {
    Intake intake;
    intake.layout = layout;
    intake.spill = File::createScratch(std::filesystem::temp_directory_path());
    intake.accepted = triangles.size();
    std::vector<std::byte> bytes(triangles.size() * layout.bytes());
    for (size_t i = 0; i < triangles.size(); ++i) {
        layout.store(triangles[i], bytes.data() + i * layout.bytes());
    }
    intake.spill.append(bytes);
    return intake;
}

struct Cut {
    Partition partition;
    SoupLayout layout;
};

Cut cutIntoPieces(const Triangles& triangles, int extentBits, uint64_t pieceTriangles,
                  SoupLayout layout = {}, uint32_t nodeTriangles = 1) {
    Intake intake = spilled(triangles, layout);
    Progress silent;
    return {
        partitionTriangles(intake, latticeOf(extentBits), std::filesystem::temp_directory_path(),
                           pieceTriangles, nodeTriangles, silent),
        layout};
}

std::vector<std::byte> bytesOf(const Cut& cut, const Piece& piece) {
    const size_t stride = cut.layout.bytes();
    std::vector<std::byte> bytes(piece.triangleCount * stride);
    cut.partition.files[piece.file].readAt(piece.firstTriangle * stride, bytes);
    return bytes;
}

Triangles trianglesOf(const Cut& cut, const Piece& piece) {
    const std::vector<std::byte> bytes = bytesOf(cut, piece);
    Triangles triangles;
    for (size_t at = 0; at < bytes.size(); at += cut.layout.bytes()) {
        triangles.push_back(cut.layout.load(bytes.data() + at));
    }
    return triangles;
}

// What a piece should be; triangles by number, in input order.
struct ExpectedPiece {
    ooc::NodeId cell;
    bool isExtra = false;
    std::vector<uint32_t> numbers;

    bool operator==(const ExpectedPiece&) const = default;
};

std::ostream& operator<<(std::ostream& out, const ExpectedPiece& piece) {
    return out << std::oct << piece.cell.path() << std::dec << (piece.isExtra ? " extra" : "")
               << " with " << piece.numbers.size() << " from "
               << (piece.numbers.empty() ? 0 : piece.numbers[0]);
}

// The rules said plainly: a cell that holds more than the limit keeps what is longer than half a
// child's edge and hands the rest to the child that holds the centroid.
class BruteForce {
public:
    BruteForce(const Triangles& triangles, int extentBits, uint64_t limit)
        : triangles_(triangles), extentBits_(extentBits), limit_(limit) {
        std::vector<uint32_t> all;
        for (uint32_t i = 0; i < triangles.size(); ++i) all.push_back(i);
        cut(ooc::NodeId::root(), 0, glm::i64vec3(0), all);
    }

    std::vector<ExpectedPiece> pieces;
    std::set<uint64_t> topCells;

private:
    bool isLongerThan(const SoupTriangle& triangle, long double length) const {
        for (size_t i = 0; i < 3; ++i) {
            const glm::i64vec3 a(triangle.corners[i]), b(triangle.corners[(i + 1) % 3]);
            const auto x = static_cast<long double>(a.x - b.x),
                       y = static_cast<long double>(a.y - b.y),
                       z = static_cast<long double>(a.z - b.z);
            if (x * x + y * y + z * z > length * length) return true;
        }
        return false;
    }

    void cut(ooc::NodeId cell, int depth, const glm::i64vec3& low,
             const std::vector<uint32_t>& numbers) {
        if (numbers.empty()) return;
        if (numbers.size() <= limit_ || depth == std::min(extentBits_, ooc::kMaxDepth)) {
            pieces.push_back({cell, false, numbers});
            return;
        }
        topCells.insert(cell.value);
        const long double childEdge = std::ldexp(1.0L, extentBits_ - depth - 1);
        const glm::i64vec3 middle = low + (int64_t{1} << (extentBits_ - depth - 1));
        std::vector<uint32_t> own;
        std::array<std::vector<uint32_t>, 8> children;
        for (const uint32_t number : numbers) {
            const SoupTriangle& triangle = triangles_[number];
            if (isLongerThan(triangle, childEdge / 2)) {
                own.push_back(number);
                continue;
            }
            glm::i64vec3 sum(0);  // three times the centroid
            for (const Vec3i& corner : triangle.corners) sum += glm::i64vec3(corner);
            size_t octant = 0;
            for (int axis = 0; axis < 3; ++axis) {
                if (sum[axis] >= 3 * middle[axis]) octant |= size_t{1} << axis;
            }
            children[octant].push_back(number);
        }
        if (!own.empty()) pieces.push_back({cell, true, own});
        for (uint32_t octant = 0; octant < 8; ++octant) {
            glm::i64vec3 corner = low;
            for (int axis = 0; axis < 3; ++axis) {
                if (octant & (1u << axis)) corner[axis] = middle[axis];
            }
            cut(cell.child(octant), depth + 1, corner, children[octant]);
        }
    }

    const Triangles& triangles_;
    int extentBits_;
    uint64_t limit_;
};

void expectAsBruteForce(const Triangles& triangles, int extentBits, uint64_t limit,
                        SoupLayout layout = {}) {
    const Cut cut = cutIntoPieces(triangles, extentBits, limit, layout);
    const BruteForce expected(triangles, extentBits, limit);

    std::vector<ExpectedPiece> found;
    for (const Piece& piece : cut.partition.pieces) {
        ExpectedPiece& one = found.emplace_back();
        one.cell = piece.cell;
        one.isExtra = piece.isExtra;
        for (const SoupTriangle& triangle : trianglesOf(cut, piece)) {
            one.numbers.push_back(triangle.object);
        }
    }
    ASSERT_EQ(found.size(), expected.pieces.size());
    for (size_t i = 0; i < found.size(); ++i) ASSERT_EQ(found[i], expected.pieces[i]);

    std::set<uint64_t> seen;
    for (const ooc::NodeId cell : cut.partition.topCells) {
        EXPECT_TRUE(cell == ooc::NodeId::root() || seen.contains(cell.parent().value))
            << "a top cell before its parent";
        EXPECT_TRUE(seen.insert(cell.value).second) << "a top cell twice";
    }
    EXPECT_EQ(seen, expected.topCells);
    EXPECT_EQ(cut.partition.maxDepth, std::min(extentBits, ooc::kMaxDepth));
}

int32_t inLattice(int64_t value, int extentBits) {
    return static_cast<int32_t>(std::clamp<int64_t>(value, 0, int64_t{1} << extentBits));
}

// Half of it spread evenly, half in a few dense spots; sizes over all scales of the lattice, and
// corners on its far faces, which lie outside every half-open cell.
Triangles randomTriangles(size_t count, int extentBits, uint32_t seed) {
    std::mt19937_64 random(seed);
    const int64_t edge = int64_t{1} << extentBits;
    const auto below = [&](int64_t end) {
        return static_cast<int64_t>(random() % static_cast<uint64_t>(end));
    };
    std::array<glm::i64vec3, 3> spots;
    for (glm::i64vec3& spot : spots) {
        spot = {below(edge + 1), below(edge + 1), below(edge + 1)};
    }
    Triangles triangles;
    while (triangles.size() < count) {
        const int sizeBits =
            static_cast<int>(random() % static_cast<uint64_t>(extentBits + 1)) * 2 / 3;
        const int64_t size = int64_t{1} << sizeBits;
        glm::i64vec3 middle(below(edge + 1), below(edge + 1), below(edge + 1));
        if (random() % 2 == 0) {
            const int64_t spread = std::max<int64_t>(1, edge >> 12);
            middle =
                spots[random() % 3] + glm::i64vec3(below(spread), below(spread), below(spread));
        }
        SoupTriangle triangle;
        for (Vec3i& corner : triangle.corners) {
            for (int axis = 0; axis < 3; ++axis) {
                corner[axis] = inLattice(middle[axis] + below(2 * size + 1) - size, extentBits);
            }
        }
        if (hasNoArea(triangle.corners)) continue;
        triangle.object = static_cast<uint32_t>(triangles.size());
        triangles.push_back(triangle);
    }
    return triangles;
}

SoupTriangle triangleAt(const Vec3i& corner, int32_t length, uint32_t number) {
    SoupTriangle triangle;
    triangle.corners = {corner, corner + Vec3i(length, 0, 0), corner + Vec3i(length / 2, 1, 0)};
    triangle.object = number;
    return triangle;
}

TEST(Partition, everyTriangleIsInThePieceThatTheRulesSayInInputOrder) {
    uint32_t seed = 1;
    for (const int extentBits : {1, 3, 9, 20, 30}) {
        for (const uint64_t limit : {1u, 60u, 5000u}) {
            SCOPED_TRACE(testing::Message() << "extent bits " << extentBits << ", limit " << limit);
            expectAsBruteForce(randomTriangles(1000, extentBits, ++seed), extentBits, limit);
            if (HasFatalFailure()) return;
        }
    }
}

TEST(Partition, movesMoreThanItsBuffersHold) {
    const SoupLayout layout{.hasColours = true, .hasNormals = true};
    // Reading holds 4 MiB, writing 1 MiB a piece.
    const Triangles triangles = randomTriangles(150000, 12, 99);
    ASSERT_GT(triangles.size() * layout.bytes(), size_t{8} << 20);
    expectAsBruteForce(triangles, 12, 30000, layout);
}

TEST(Partition, recordsMoveWithAllTheirParts) {
    Triangles triangles = randomTriangles(300, 9, 5);
    std::mt19937 random(6);
    for (SoupTriangle& triangle : triangles) {
        triangle.material = static_cast<uint32_t>(random());
        for (size_t corner = 0; corner < 3; ++corner) {
            triangle.colours[corner] = static_cast<uint32_t>(random());
            triangle.normals[corner] = {static_cast<int8_t>(random()),
                                        static_cast<int8_t>(random())};
        }
    }
    const Cut cut = cutIntoPieces(triangles, 9, 20, {.hasColours = true, .hasNormals = true});
    size_t met = 0;
    for (const Piece& piece : cut.partition.pieces) {
        for (const SoupTriangle& triangle : trianglesOf(cut, piece)) {
            const SoupTriangle& source = triangles.at(triangle.object);
            EXPECT_EQ(triangle.corners, source.corners);
            EXPECT_EQ(triangle.material, source.material);
            EXPECT_EQ(triangle.colours, source.colours);
            EXPECT_EQ(triangle.normals, source.normals);
            ++met;
        }
    }
    EXPECT_EQ(met, triangles.size());
}

TEST(Partition, aTriangleLongerThanHalfAChildsEdgeByOneStepStaysInTheTopCell) {
    // The root's children have edge 512.
    const Cut cut =
        cutIntoPieces({triangleAt({0, 0, 0}, 256, 0), triangleAt({700, 700, 700}, 257, 1)}, 10, 1);
    ASSERT_EQ(cut.partition.pieces.size(), 2u);
    const Piece& extra = cut.partition.pieces[0];
    EXPECT_TRUE(extra.isExtra);
    EXPECT_EQ(extra.cell, ooc::NodeId::root());
    ASSERT_EQ(extra.triangleCount, 1u);
    EXPECT_EQ(trianglesOf(cut, extra)[0].object, 1u);
    const Piece& child = cut.partition.pieces[1];
    EXPECT_FALSE(child.isExtra);
    EXPECT_EQ(child.cell, ooc::NodeId::root().child(0));
    EXPECT_EQ(trianglesOf(cut, child)[0].object, 0u);
}

TEST(Partition, onlyExtraLeavesAndCellsThatCannotBeCutExceedTheLimit) {
    const Triangles triangles = randomTriangles(3000, 6, 12);
    const Cut cut = cutIntoPieces(triangles, 6, 4);
    bool anyAbove = false;
    for (const Piece& piece : cut.partition.pieces) {
        if (piece.triangleCount <= 4) continue;
        anyAbove = true;
        EXPECT_TRUE(piece.isExtra || piece.cell.depth() == 6);
    }
    EXPECT_TRUE(anyAbove) << "the input is too easy";
}

TEST(Partition, coincidentTrianglesStayTogetherAboveTheCellsTheyAreTooLongFor) {
    Triangles triangles;
    for (uint32_t i = 0; i < 500; ++i) triangles.push_back(triangleAt({1000, 2000, 3000}, 10, i));
    expectAsBruteForce(triangles, 20, 16);
    const Cut cut = cutIntoPieces(triangles, 20, 16);
    ASSERT_EQ(cut.partition.pieces.size(), 1u);
    EXPECT_EQ(cut.partition.pieces[0].triangleCount, 500u);
    EXPECT_TRUE(cut.partition.pieces[0].isExtra);
    // Longer than 8, at most 16: half a child's edge where the cell's edge is 32.
    EXPECT_EQ(cut.partition.pieces[0].cell.depth(), 20 - 5);
}

TEST(Partition, coincidentTrianglesOfTheLeastSizeFillADeepestCell) {
    Triangles triangles;
    for (uint32_t i = 0; i < 40; ++i) triangles.push_back(triangleAt({5, 6, 7}, 1, i));
    expectAsBruteForce(triangles, 30, 3);
    const Cut cut = cutIntoPieces(triangles, 30, 3);
    ASSERT_EQ(cut.partition.pieces.size(), 1u);
    EXPECT_EQ(cut.partition.pieces[0].cell.depth(), ooc::kMaxDepth);
}

TEST(Partition, oneTriangleIsOnePieceAndNothingIsAboveIt) {
    const Cut cut = cutIntoPieces({triangleAt({3, 4, 5}, 1000, 0)}, 10, 1);
    ASSERT_EQ(cut.partition.pieces.size(), 1u);
    EXPECT_EQ(cut.partition.pieces[0].cell, ooc::NodeId::root());
    EXPECT_FALSE(cut.partition.pieces[0].isExtra);
    EXPECT_EQ(cut.partition.pieces[0].triangleCount, 1u);
    EXPECT_TRUE(cut.partition.topCells.empty());
}

TEST(Partition, noTrianglesGiveNoPieces) {
    const Cut cut = cutIntoPieces({}, 10, 1);
    EXPECT_TRUE(cut.partition.pieces.empty());
    EXPECT_TRUE(cut.partition.topCells.empty());
    EXPECT_EQ(cut.partition.scratchBytes, 0u);
}

TEST(Partition, aPieceIsNeverSmallerThanANodeMayBe) {
    const Triangles triangles = randomTriangles(400, 10, 31);
    const Cut asked = cutIntoPieces(triangles, 10, 1, {}, 50);
    const Cut same = cutIntoPieces(triangles, 10, 50);
    ASSERT_EQ(asked.partition.pieces.size(), same.partition.pieces.size());
    for (size_t i = 0; i < asked.partition.pieces.size(); ++i) {
        EXPECT_EQ(asked.partition.pieces[i].cell, same.partition.pieces[i].cell);
        EXPECT_EQ(bytesOf(asked, asked.partition.pieces[i]),
                  bytesOf(same, same.partition.pieces[i]));
    }
}

// Every leaf's triangles, by the numbers that the input gave them.
using Leaves = std::map<uint64_t, std::vector<uint32_t>>;

Leaves buildLeaves(const Triangles& triangles, int extentBits, uint64_t pieceTriangles) {
    const Cut cut = cutIntoPieces(triangles, extentBits, pieceTriangles, {}, 32);
    TreeSettings settings;
    settings.lattice = latticeOf(extentBits);
    settings.nodeTriangles = 32;
    settings.maxDepth = cut.partition.maxDepth;
    settings.isTranslucent = {false};
    settings.materialColours = {0xFFFFFFFFu};
    NodeStore store(std::filesystem::temp_directory_path(), ooc::Codec::Meshopt);
    TreeBuilder builder(settings, store);
    for (const Piece& piece : cut.partition.pieces) {
        if (piece.isExtra) {
            builder.buildExtraLeaves(piece.cell, bytesOf(cut, piece));
        } else {
            builder.buildSubtree(piece.cell, bytesOf(cut, piece));
        }
    }
    std::vector<ooc::NodeId> top = cut.partition.topCells;
    std::reverse(top.begin(), top.end());
    for (const ooc::NodeId cell : top) builder.buildTopNode(cell);
    Leaves leaves;
    for (const ooc::NodeRecord& record : store.inFileOrder()) {
        if (!record.isLeaf()) continue;
        std::vector<uint32_t>& numbers = leaves[record.id.value];
        for (const SoupTriangle& triangle : unpackPage(store.readMesh(record))) {
            numbers.push_back(triangle.object);
        }
        std::sort(numbers.begin(), numbers.end());
    }
    return leaves;
}

TEST(Partition, theLeavesAreTheSameForEveryPieceSizeAndHoldEveryTriangleOnce) {
    const Triangles triangles = randomTriangles(3000, 14, 77);
    const Leaves whole = buildLeaves(triangles, 14, 3000);
    std::vector<int> met(triangles.size(), 0);
    for (const auto& [leaf, numbers] : whole) {
        for (const uint32_t number : numbers) ++met[number];
    }
    EXPECT_EQ(std::count(met.begin(), met.end(), 1), static_cast<ptrdiff_t>(met.size()));
    for (const uint64_t limit : {32u, 100u, 1000u}) {
        EXPECT_EQ(buildLeaves(triangles, 14, limit), whole) << "pieces of " << limit;
    }
}

}  // namespace
}  // namespace pagoda::hlod
