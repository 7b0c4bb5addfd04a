// camera_json.h: a camera from parsed JSON, for the two readers of cameras (camera_json.cpp,
// camera_path.cpp). Kept out of camera.h so that its callers need no JSON library.
#pragma once

#include "hlod/view/camera.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace pagoda::hlod {

// As parseCamera(), with `place` as the place in its errors.
[[nodiscard]] Camera cameraFromJson(const nlohmann::json& value, const Camera& defaults,
                                    const std::string& source, const std::string& place);

}  // namespace pagoda::hlod
