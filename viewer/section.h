// section.h: the plane that a model is cut along, as hands set it. Plain data and pure
// functions.
#pragma once

#include "hlod/view/clip.h"

namespace pagoda::viewer {

struct Section {
    bool isOn = false;
    // Of what is cut away, seen from the plane: around the z axis from x, and up from the xy plane.
    double azimuthDegrees = 0.0, elevationDegrees = 0.0;
    double share = 0.5;  // where between the model's first and last point along that

    [[nodiscard]] Vec3d normal() const;
    [[nodiscard]] hlod::SectionPlane plane(const Box3d& sceneBox) const;
    void setNormal(const Vec3d& normal);  // not zero; `share` stays
    // The plane through a point with this normal.
    void setPlane(const Vec3d& normal, const Vec3d& point, const Box3d& sceneBox);
    void flip();  // the same plane, the other side
};

}  // namespace pagoda::viewer
