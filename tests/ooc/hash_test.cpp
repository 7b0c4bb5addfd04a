#include "ooc/base/hash.h"

#include "ooc/store/triangle_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <random>
#include <string_view>
#include <vector>

namespace pagoda {
namespace {

std::span<const std::byte> bytesOf(std::string_view text) {
    return std::as_bytes(std::span(text));
}

// From xxhash's own self-test: XXH3_64bits of nothing, seed 0, and of what the tool xxhsum -H3
// says.
TEST(Hash64, IsXxh3) {
    EXPECT_EQ(hash64({}), 0x2D06800538D394C2u);
    EXPECT_NE(hash64(bytesOf("a")), hash64(bytesOf("b")));
    EXPECT_NE(hash64(bytesOf("a"), 1), hash64(bytesOf("a"), 2));
}

TEST(OrderFreeSum, IsTheSameInAnyOrderAndGrouping) {
    std::mt19937 random(7);
    std::vector<std::array<uint32_t, 5>> items(1000);
    for (auto& item : items) std::generate(item.begin(), item.end(), std::ref(random));
    OrderFreeSum whole;
    for (const auto& item : items) whole.add(std::as_bytes(std::span(item)));

    std::shuffle(items.begin(), items.end(), random);
    OrderFreeSum parts[3];
    for (size_t i = 0; i < items.size(); ++i) parts[i % 3].add(std::as_bytes(std::span(items[i])));
    parts[2].add(parts[0]);
    parts[2].add(parts[1]);
    EXPECT_EQ(parts[2], whole);
}

TEST(OrderFreeSum, ChangesWhenAnItemIsLostDoubledOrReplaced) {
    const auto sumOf = [](std::initializer_list<std::string_view> items) {
        OrderFreeSum sum;
        for (const std::string_view item : items) sum.add(bytesOf(item));
        return sum;
    };
    EXPECT_NE(sumOf({"a", "b"}), sumOf({"a"}));
    EXPECT_NE(sumOf({"a", "b"}), sumOf({"a", "b", "b"}));
    EXPECT_NE(sumOf({"a", "b"}), sumOf({"a", "c"}));
    EXPECT_NE(sumOf({"a", "a", "a", "b"}), sumOf({"a", "b", "b", "b"}));
}

TEST(OrderFreeSum, CarriesFromTheLowHalfToTheHigh) {
    OrderFreeSum sum{.low = UINT64_MAX, .high = 4};
    sum.add(OrderFreeSum{.low = 2, .high = 10});
    EXPECT_EQ(sum, (OrderFreeSum{.low = 1, .high = 15}));
}

TEST(TriangleSum, DoesNotDependOnWhichCornerComesFirstButOnWindingAndOwner) {
    const Vec3i a{1, 2, 3}, b{1, 2, 4}, c{0, 9, 9};
    const auto sumOf = [](const Vec3i& p, const Vec3i& q, const Vec3i& r, uint32_t object,
                          uint32_t material) {
        OrderFreeSum sum;
        ooc::addTriangle(sum, p, q, r, object, material);
        return sum;
    };
    const OrderFreeSum sum = sumOf(a, b, c, 1, 2);
    EXPECT_EQ(sumOf(b, c, a, 1, 2), sum);
    EXPECT_EQ(sumOf(c, a, b, 1, 2), sum);
    EXPECT_NE(sumOf(a, c, b, 1, 2), sum);
    EXPECT_NE(sumOf(a, b, c, 2, 2), sum);
    EXPECT_NE(sumOf(a, b, c, 1, 1), sum);
}

}  // namespace
}  // namespace pagoda
