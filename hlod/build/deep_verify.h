// deep_verify.h: are the errors that a database states the errors its meshes have? What
// `pagoda verify --deep` adds to ooc/store/verify.h.
// Measures every inner node again as the builder does: its children's triangles against its own,
// both ways, plus the largest stored error below. The distances are sampled (sampledDistance(),
// 4096 places a direction), so that a pass says the builder kept its word, not that no point of the
// input is farther away.
#pragma once

#include "ooc/base/progress.h"
#include "ooc/store/database.h"
#include "ooc/store/verify.h"

#include <cstddef>
#include <cstdint>

namespace pagoda::hlod {

struct DeepReport {
    uint64_t innerNodes = 0, leaves = 0;  // looked at
    uint64_t tooSmall = 0;                // of them: state less than was measured
    double largestRatio = 0;              // measured / stated, over inner nodes; 0: there are none
};

// Adds to `faults` every inner node whose stated error is below the measured one, every leaf whose
// error is below half a lattice diagonal (what the snap alone may move a point), and what cannot be
// read. Made for a database that verifyDatabase() found sound: each page is decoded twice.
// Throws Interrupted. Memory: a hundred families' records and one decoded family a thread.
[[nodiscard]] DeepReport verifyErrors(const ooc::Database& database, size_t threadCount,
                                      Progress& progress, ooc::VerifyReport& faults);

}  // namespace pagoda::hlod
