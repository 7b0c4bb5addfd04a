// batch_gatherer.h: joins small batches of the same object and material into larger ones.
// A cut of a database comes node by node, each with a few triangles of many objects; formats that
// pay by the batch (glTF) want them together. Memory is bounded: when it is full, everything goes
// on, in order of (object, material), so that the result does not depend on chance.
#pragma once

#include "ooc/readers/reader.h"

#include <cstddef>
#include <functional>
#include <map>
#include <tuple>

namespace pagoda::ooc {

class BatchGatherer {
public:
    using Emit = std::function<void(const TriangleBatch&)>;

    // Emitted batches hold at most `maxTriangles`; all pending ones together about `maxPending`.
    BatchGatherer(size_t maxTriangles, size_t maxPending, Emit emit)
        : maxTriangles_(maxTriangles), maxPending_(maxPending), emit_(std::move(emit)) {}

    void add(const TriangleBatch& batch);
    void drain();  // emits all that is pending

private:
    // Object, material, has colours, has normals.
    using Key = std::tuple<uint32_t, uint32_t, bool, bool>;

    void appendPart(TriangleBatch& pending, const TriangleBatch& batch, size_t begin, size_t end);

    size_t maxTriangles_, maxPending_;
    Emit emit_;
    std::map<Key, TriangleBatch> pending_;
    size_t pendingTriangles_ = 0;
};

}  // namespace pagoda::ooc
