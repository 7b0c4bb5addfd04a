// report.h: what a build says of itself: the report's node figures and the database's metadata.
#pragma once

#include "hlod/build/build.h"
#include "ooc/lattice.h"
#include "ooc/store/records.h"

#include <span>
#include <string>

namespace pagoda::hlod {

// Fills nodes, leaves, levels and the sloppy and stuck counts.
void summariseNodes(std::span<const ooc::NodeRecord> nodes, BuildReport& report);

// The database's metadata: what depends on input and settings alone (no times, no paths beyond file
// names).
[[nodiscard]] std::string makeMetadata(const BuildOptions& options, const ooc::Lattice& lattice,
                                       const InputSet& inputs, const BuildReport& report);

}  // namespace pagoda::hlod
