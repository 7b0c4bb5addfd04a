// intake.h: the second reading: snaps every triangle, drops and counts the bad, spills the rest to
// scratch in input order. docs/build.md, step 3.
#pragma once

#include "hlod/build/inputs.h"
#include "hlod/build/soup.h"
#include "ooc/base/hash.h"
#include "ooc/base/progress.h"
#include "ooc/store/records.h"

#include <map>
#include <string>
#include <vector>

namespace pagoda::hlod {

// Accepted triangles in one scratch file, and all that is said of them.
struct Intake {
    SoupLayout layout;
    File spill;
    uint64_t accepted = 0;
    uint64_t trianglesIn = 0;
    std::map<std::string, uint64_t> dropped, ignored;
    uint64_t collapsed = 0;  // of dropped: smaller than the lattice resolves
    OrderFreeSum sum;
    std::vector<ooc::ObjectRecord> objects;
    std::vector<ooc::MaterialRecord> materials;
    std::vector<bool> isTranslucent;  // by material
    // Where the collapsed ones were, to name outliers.
    Box3d collapsedBounds;
};

[[nodiscard]] Intake takeIn(InputSet& inputs, const ooc::Lattice& lattice, SoupLayout layout,
                            const std::filesystem::path& scratchFolder, Progress& progress);

}  // namespace pagoda::hlod
