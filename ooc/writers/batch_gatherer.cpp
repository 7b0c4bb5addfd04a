#include "ooc/writers/batch_gatherer.h"

#include <algorithm>

namespace pagoda::ooc {
namespace {

template <typename T>
void appendRange(std::vector<T>& to, const std::vector<T>& from, size_t begin, size_t end) {
    if (from.empty()) return;
    to.insert(to.end(), from.begin() + static_cast<std::ptrdiff_t>(begin),
              from.begin() + static_cast<std::ptrdiff_t>(end));
}

}  // namespace

void BatchGatherer::add(const TriangleBatch& batch) {
    const Key key{batch.object, batch.material, !batch.colours.empty(), !batch.normals.empty()};
    TriangleBatch& pending = pending_[key];
    pending.object = batch.object;
    pending.material = batch.material;
    for (size_t done = 0; done < batch.triangleCount();) {
        const size_t room = maxTriangles_ - pending.triangleCount();
        const size_t count = std::min(room, batch.triangleCount() - done);
        appendPart(pending, batch, done, done + count);
        done += count;
        if (pending.triangleCount() < maxTriangles_) continue;
        emit_(pending);
        pendingTriangles_ -= pending.triangleCount();
        pending.clear();
    }
    if (pendingTriangles_ >= maxPending_) drain();
}

void BatchGatherer::drain() {
    for (const auto& [key, pending] : pending_) {
        if (pending.triangleCount() > 0) emit_(pending);
    }
    pending_.clear();
    pendingTriangles_ = 0;
}

void BatchGatherer::appendPart(TriangleBatch& pending, const TriangleBatch& batch, size_t begin,
                               size_t end) {
    appendRange(pending.positions, batch.positions, 3 * begin, 3 * end);
    appendRange(pending.colours, batch.colours, 3 * begin, 3 * end);
    appendRange(pending.normals, batch.normals, 3 * begin, 3 * end);
    pendingTriangles_ += end - begin;
}

}  // namespace pagoda::ooc
