// inspection.h: what the window knows of an open database beside its picture: what was clicked, at
// the resolution of the screen and, a little later, of the leaves; the objects, and which of them
// are hidden. Main thread only; reads go on in threads of its own.
#pragma once

#include "ooc/store/object_reader.h"
#include "viewer/exact_pick.h"
#include "viewer/object_visibility.h"
#include "viewer/window/scene.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pagoda::viewer {

// What one click found at full resolution.
struct ExactHit {
    hlod::LeafHit hit;
    double distanceModelUnits = 0.0;  // along the direction of view, as Pick's
    std::vector<std::string> faults;  // of leaves that could not be read: one may lie nearer
    std::vector<std::string> path;    // names from the root of the tree down; empty: on their way
    std::optional<double> fromLastModelUnits;  // between the exact points of two clicks
};

class Inspection {
public:
    // `scene` outlives it; `wake` may come from any thread.
    Inspection(Scene& scene, const std::function<void()>& wake);

    // Once a step: takes what has arrived. What of it has to be seen or told:
    struct News {
        bool isAny = false;         // panels must be drawn again
        bool isVisibility = false;  // so must the scene
        bool isExact = false;       // exact() and its path are known now
    };
    [[nodiscard]] News update();

    void pickAt(glm::dvec2 px);
    void dismissPick();
    [[nodiscard]] const std::optional<Pick>& pick() const noexcept { return pick_; }
    // Nothing while leaves are read, and where the ray meets nothing.
    [[nodiscard]] const std::optional<ExactHit>& exact() const noexcept { return exact_; }
    // Of a click whose ray met nothing: leaves that could not be read.
    [[nodiscard]] const std::vector<std::string>& faultsWithoutHit() const noexcept {
        return faultsWithoutHit_;
    }
    [[nodiscard]] bool isReadingLeaves() const noexcept { return isReadingLeaves_; }
    [[nodiscard]] bool hasAsked() const noexcept { return pick_ || exact_ || isReadingLeaves_; }

    [[nodiscard]] ooc::ObjectReader& objects() noexcept { return objects_; }
    [[nodiscard]] ObjectVisibility& visibility() noexcept { return visibility_; }
    [[nodiscard]] const ObjectVisibility& visibility() const noexcept { return visibility_; }

private:
    void takeHit(const hlod::LeafRayResult& result);
    [[nodiscard]] bool findPath();

    Scene& scene_;
    ooc::ObjectReader objects_;
    ObjectVisibility visibility_;
    ExactPick rays_;
    std::optional<Pick> pick_;
    std::optional<ExactHit> exact_;
    std::optional<Vec3d> lastExactModel_;
    std::vector<std::string> faultsWithoutHit_;
    bool isReadingLeaves_ = false, isPathWanted_ = false;
};

}  // namespace pagoda::viewer
