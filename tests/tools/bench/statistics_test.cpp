#include "tools/bench/statistics.h"

#include <gtest/gtest.h>

#include <vector>

namespace pagoda::tools {
namespace {

TEST(Statistics, QuantilesLieBetweenTheirNeighboursInProportion) {
    const std::vector<double> sorted = {10, 20, 30, 50};
    EXPECT_DOUBLE_EQ(quantile(sorted, 0.0), 10);
    EXPECT_DOUBLE_EQ(quantile(sorted, 0.5), 25);
    EXPECT_DOUBLE_EQ(quantile(sorted, 0.9), 44);  // place 2.7
    EXPECT_DOUBLE_EQ(quantile(sorted, 1.0), 50);
    EXPECT_DOUBLE_EQ(quantile({7}, 0.95), 7);
    EXPECT_DOUBLE_EQ(quantile({}, 0.95), 0);
}

TEST(Statistics, ASpreadDoesNotDependOnTheOrderOfItsValues) {
    std::vector<double> values;
    for (int i = 0; i <= 100; ++i) values.push_back((i * 37) % 101);  // 0..100, shuffled
    const Spread spread = spreadOf(values);
    EXPECT_DOUBLE_EQ(spread.median, 50);
    EXPECT_DOUBLE_EQ(spread.p95, 95);
    EXPECT_DOUBLE_EQ(spread.p99, 99);
    EXPECT_DOUBLE_EQ(spread.max, 100);
    EXPECT_DOUBLE_EQ(spread.mean, 50);
}

TEST(Statistics, ASpreadOfNothingIsZero) {
    const Spread spread = spreadOf({});
    EXPECT_EQ(spread.median, 0);
    EXPECT_EQ(spread.max, 0);
}

TEST(Statistics, PairsInOneProportionHaveThatRatioAndNoDoubt) {
    const std::vector<double> a = {2, 4, 10, 1}, b = {1, 2, 5, 0.5};
    const Ratio ratio = ratioOf(a, b);
    EXPECT_DOUBLE_EQ(ratio.value, 2);
    EXPECT_NEAR(ratio.low, 2, 1e-12);
    EXPECT_NEAR(ratio.high, 2, 1e-12);
    EXPECT_EQ(ratio.pairs, 4u);
}

TEST(Statistics, TheRatioIsOfSumsAndNotAMeanOfRatios) {
    EXPECT_DOUBLE_EQ(ratioOf(std::vector<double>{1, 30}, std::vector<double>{1, 10}).value,
                     31.0 / 11.0);
}

// The mean of n values with deviation s has the deviation s / sqrt(n), and 95% of a normal
// distribution lie within 1.96 deviations: here n = 400, s = 1.
TEST(Statistics, TheIntervalIsThatOfTheNormalDistributionForManyPairs) {
    std::vector<double> a, b(400, 1.0);
    for (int i = 0; i < 400; ++i) a.push_back(i % 2 == 0 ? 1 : 3);
    const Ratio ratio = ratioOf(a, b);
    EXPECT_DOUBLE_EQ(ratio.value, 2);
    // 1000 resamples leave their quantiles uncertain by a tenth of the deviation 0.05.
    EXPECT_NEAR(ratio.low, 2 - 1.96 * 0.05, 0.015);
    EXPECT_NEAR(ratio.high, 2 + 1.96 * 0.05, 0.015);
}

TEST(Statistics, TheSameNumbersGiveTheSameInterval) {
    const std::vector<double> a = {3, 1, 4, 1, 5, 9}, b = {2, 7, 1, 8, 2, 8};
    const Ratio first = ratioOf(a, b), second = ratioOf(a, b);
    EXPECT_EQ(first.low, second.low);
    EXPECT_EQ(first.high, second.high);
    EXPECT_LT(first.low, first.value);
    EXPECT_GT(first.high, first.value);
}

TEST(Statistics, NothingToDivideByIsARatioOfZero) {
    EXPECT_EQ(ratioOf({}, {}).value, 0);
    const std::vector<double> zeros(2, 0.0), ones(2, 1.0);
    EXPECT_EQ(ratioOf(ones, zeros).value, 0);
}

}  // namespace
}  // namespace pagoda::tools
