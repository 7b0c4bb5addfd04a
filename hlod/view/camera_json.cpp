// Cameras as JSON, checked: they come from the command line and from files.
#include "hlod/view/camera.h"
#include "ooc/base/error.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace pagoda::hlod {
namespace {

using nlohmann::json;

constexpr int kMaxPicturePx = 16384;  // the smallest limit of GL textures we have met

[[noreturn]] void refuse(const std::string& source, const std::string& what) {
    throw Error(
        source, "", what,
        R"(a camera looks like {"eye":[1,2,3], "target":[0,0,0], "up":[0,1,0], "fovy":45})");
}

double number(const json& value, const std::string& key, const std::string& source) {
    if (!value.is_number()) refuse(source, "'" + key + "' is not a number");
    const double result = value.get<double>();
    if (!std::isfinite(result)) refuse(source, "'" + key + "' is not finite");
    return result;
}

Vec3d vector3(const json& value, const std::string& key, const std::string& source) {
    if (!value.is_array() || value.size() != 3) refuse(source, "'" + key + "' is not [x,y,z]");
    return {number(value[0], key, source), number(value[1], key, source),
            number(value[2], key, source)};
}

int pixels(const json& value, const std::string& key, const std::string& source) {
    const double result = number(value, key, source);
    if (result < 1 || result > kMaxPicturePx || result != std::floor(result)) {
        refuse(source, "'" + key + "' is not a whole number from 1 to 16384");
    }
    return static_cast<int>(result);
}

void setKey(Camera& camera, const std::string& key, const json& value, const std::string& source) {
    if (key == "eye") {
        camera.eye = vector3(value, key, source);
    } else if (key == "target") {
        camera.target = vector3(value, key, source);
    } else if (key == "up") {
        camera.up = vector3(value, key, source);
    } else if (key == "fovy") {
        camera.fovyDegrees = number(value, key, source);
    } else if (key == "width") {
        camera.widthPx = pixels(value, key, source);
    } else if (key == "height") {
        camera.heightPx = pixels(value, key, source);
    } else if (key == "near") {
        camera.nearModelUnits = number(value, key, source);
    } else {
        refuse(source, "a camera has no '" + key + "'");
    }
}

}  // namespace

Camera parseCamera(std::string_view text, const Camera& defaults, const std::string& source) {
    const json value = json::parse(text, nullptr, false);
    if (!value.is_object()) refuse(source, "not a JSON object");
    Camera camera = defaults;
    for (const auto& [key, item] : value.items()) setKey(camera, key, item, source);
    if (camera.eye == camera.target) refuse(source, "eye and target are the same point");
    if (camera.up == Vec3d(0.0)) refuse(source, "'up' has no direction");
    if (!(camera.fovyDegrees > 0.0 && camera.fovyDegrees < 180.0)) {
        refuse(source, "'fovy' is not between 0 and 180 degrees");
    }
    if (camera.nearModelUnits < 0.0) refuse(source, "'near' is negative");
    return camera;
}

std::string cameraToJson(const Camera& camera) {
    const auto array = [](const Vec3d& v) { return json::array({v.x, v.y, v.z}); };
    json value = {{"eye", array(camera.eye)}, {"target", array(camera.target)},
                  {"up", array(camera.up)},   {"fovy", camera.fovyDegrees},
                  {"width", camera.widthPx},  {"height", camera.heightPx}};
    if (camera.nearModelUnits > 0.0) value["near"] = camera.nearModelUnits;
    return value.dump();
}

}  // namespace pagoda::hlod
