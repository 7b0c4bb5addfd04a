// upright.h: the frame in which paths are made: z up, whatever the model's own up axis is.
#pragma once

#include "hlod/view/camera.h"

namespace pagoda::tools {

// A rotation, so lengths are the model's.
class Upright {
public:
    explicit Upright(hlod::UpAxis up) : isYUp_(up == hlod::UpAxis::Y) {}

    [[nodiscard]] Vec3d fromModel(const Vec3d& v) const {
        return isYUp_ ? Vec3d(v.x, -v.z, v.y) : v;
    }
    [[nodiscard]] Vec3d toModel(const Vec3d& v) const { return isYUp_ ? Vec3d(v.x, v.z, -v.y) : v; }
    [[nodiscard]] Box3d fromModel(const Box3d& box) const {
        Box3d turned;
        turned.extend(fromModel(box.min));
        turned.extend(fromModel(box.max));
        return turned;
    }

private:
    bool isYUp_;
};

}  // namespace pagoda::tools
