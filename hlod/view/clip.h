// clip.h: what of a scene is left out of a frame whatever the camera sees. Plain data, pure
// functions: any thread.
#pragma once

#include "ooc/base/box.h"
#include "ooc/store/object_tree.h"

#include <memory>
#include <optional>

namespace pagoda::hlod {

// A half-space, model units: points with dot(normal, point) <= offset are kept. A unit normal.
struct SectionPlane {
    Vec3d normal{0.0, 0.0, 1.0};
    double offset = 0.0;
    // Signed distance above the plane: what is positive is cut away.
    [[nodiscard]] double above(const Vec3d& point) const {
        return glm::dot(normal, point) - offset;
    }
    [[nodiscard]] bool operator==(const SectionPlane&) const = default;
};

struct Clip {
    std::optional<SectionPlane> section;  // what is drawn is cut along it
    // Nothing outside of it is to be seen, so that whole nodes beside it are not looked at. Devices
    // do not cut along it. An empty box leaves out all.
    std::optional<Box3d> box;
    // Objects whose triangles are not drawn: they neither hide anything nor can be picked. Null:
    // none. Another set is another object: sets are compared by their address.
    std::shared_ptr<const ooc::ObjectSet> hidden;

    // Is all of the box left out? Never of one that reaches into what is kept.
    [[nodiscard]] bool removes(const Box3d& boxModel) const {
        if (section) {
            const Vec3d centre = 0.5 * (boxModel.min + boxModel.max);
            const Vec3d halfSize = 0.5 * (boxModel.max - boxModel.min);
            const double reach = glm::dot(glm::abs(section->normal), halfSize);
            if (section->above(centre) > reach) return true;
        }
        return box && (glm::any(glm::lessThan(boxModel.max, box->min)) ||
                       glm::any(glm::lessThan(box->max, boxModel.min)));
    }
    [[nodiscard]] bool operator==(const Clip&) const = default;
};

}  // namespace pagoda::hlod
