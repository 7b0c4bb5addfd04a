// survey.h: the first reading of the input, which fixes the lattice.
#pragma once

#include "hlod/build/inputs.h"
#include "ooc/base/progress.h"
#include "ooc/lattice.h"

#include <array>
#include <map>
#include <optional>
#include <string>

namespace pagoda::hlod {

// Sees the first reading as it goes, for who wants to show what has been read so far. Called on the
// thread that builds.
class SurveyWatcher : public ooc::TriangleSink {
public:
    // Before all else: the axis that is up in what comes.
    virtual void beginSurvey(ooc::UpAxis databaseUp) = 0;
    // Everything has been read.
    virtual void endSurvey() = 0;
};

// What one reading of all inputs showed, before anything is snapped.
struct Survey {
    Box3d bounds;  // of finite triangles' corners
    uint64_t triangles = 0;
    std::map<std::string, uint64_t> dropped, ignored;  // as the readers said it, by reason
    bool hasColours = false, hasNormals = false;
    // Triangles by the exponent of their longest edge (longest edge in [2^(i - kBias), twice
    // that)).
    static constexpr int kBias = 1100;
    std::array<uint64_t, 2200> longestEdgeExponents{};
};

// `watcher`, if any, is told all that is read.
[[nodiscard]] Survey surveyInputs(InputSet& inputs, SurveyWatcher* watcher, Progress& progress);

// The step: `precision` when given, else the coarser of extent / 2^18 and the finest detail / 16,
// where the finest detail is the longest edge that all but 0.1% of the triangles reach; never finer
// than extent / 2^30. `refinement` (0, 2, 4, ...) makes it 2^refinement finer, for when too much
// collapsed. Throws Error that names `inputName` for bounds beyond double's exact range.
[[nodiscard]] ooc::Lattice chooseLattice(const Survey& survey, const std::string& inputName,
                                         std::optional<double> precision, int refinement);

}  // namespace pagoda::hlod
