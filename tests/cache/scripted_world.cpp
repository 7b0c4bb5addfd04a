#include "tests/cache/scripted_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace pagoda::cache::test {

Tree::Tree(const Options& options) {
    const auto add = [&](ooc::NodeId id, bool isLeaf) {
        ooc::NodeRecord node;
        node.id = id;
        node.childMask = isLeaf ? 0 : 0xFF;
        node.vertexCount = options.vertices;
        node.pageBytes = options.pageBytes;
        node.pageOffset = 1000 + records.size() * (options.pageBytes + options.gapBytes);
        records.push_back(node);
    };
    const ooc::NodeId root = ooc::NodeId::root();
    add(root, false);
    for (uint32_t i = 0; i < 8; ++i) add(root.child(i), false);
    for (uint32_t i = 0; i < 64; ++i) add(root.child(i / 8).child(i % 8), true);
}

void ScriptedLoads::send(std::vector<LoadItem> items) {
    ASSERT_FALSE(items.empty());
    waiting_.push_back(reads.size());
    reads.push_back(std::move(items));
}

LoadResult ScriptedLoads::resultOf(const LoadItem& item) const {
    LoadResult result;
    result.ticket = item.ticket;
    const uint64_t id = item.isBlock ? item.block : item.node.id.value;
    if (empty.contains(id)) return result;
    if (failing.contains(id)) {
        result.fault = "scripted fault";
    } else if (item.isBlock) {
        result.block.emplace().nodes.resize(nodesPerBlock);
    } else {
        const auto longer = longerBy.find(id);
        const uint32_t more = longer == longerBy.end() ? 0 : longer->second;
        result.page.emplace().mesh.positions.resize(item.node.vertexCount + more);
    }
    return result;
}

void ScriptedLoads::answer(size_t read) {
    ASSERT_EQ(std::erase(waiting_, read), 1u) << "read " << read << " is not on its way";
    for (auto item = reads[read].rbegin(); item != reads[read].rend(); ++item) {
        due_.push_back(resultOf(*item));
    }
}

void ScriptedLoads::answerAllInReverse() {
    while (!waiting_.empty()) answer(waiting_.back());
}

void ScriptedLoads::collect(std::vector<LoadResult>& arrived) {
    while (!isHeld_ && !waiting_.empty()) answer(waiting_.front());
    std::move(due_.begin(), due_.end(), std::back_inserter(arrived));
    due_.clear();
}

bool ScriptedLoads::waitForArrival() {
    return !due_.empty() || (!isHeld_ && !waiting_.empty());
}

GpuPages::Upload CountingGpu::upload(PageId id, const ooc::Page& page) {
    if (refused.contains(id)) return Upload::Refused;
    if (noRoom != 0) {
        noRoom -= noRoom > 0;
        return Upload::NoRoom;
    }
    EXPECT_TRUE(resident.emplace(id, sizeBytes(page)).second) << "uploaded twice";
    uploaded.push_back(id);
    return Upload::Done;
}

void CountingGpu::drop(PageId id) {
    EXPECT_EQ(resident.erase(id), 1u) << "dropped, but not there";
    dropped.push_back(id);
}

uint64_t CountingGpu::usedBytes() const {
    return std::accumulate(resident.begin(), resident.end(), uint64_t{0},
                           [](uint64_t sum, const auto& page) { return sum + page.second; });
}

void World::take() {
    std::vector<RequestQueue::Arrival> arrivals;
    requests.collect(arrivals);
    for (RequestQueue::Arrival& arrival : arrivals) residency.arrive(arrival);
}

void World::begin() {
    take();
    requests.beginFrame();
    residency.beginFrame(++frame);
}

void World::end() {
    requests.send([this](const Request& request) { return residency.admit(request); });
}

void World::frames(int count, const std::vector<const ooc::NodeRecord*>& wanted) {
    for (int i = 0; i < count; ++i) {
        begin();
        double priority = static_cast<double>(wanted.size());
        for (const ooc::NodeRecord* node : wanted) want(*node, priority--);
        end();
    }
}

}  // namespace pagoda::cache::test
