// Cameras as JSON, checked: they come from the command line and from files.
#include "hlod/view/camera_json.h"

#include "ooc/base/error.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace pagoda::hlod {
namespace {

using nlohmann::json;

constexpr int kMaxPicturePx = 16384;  // the smallest limit of GL textures we have met

// Where the text comes from, for errors.
struct Origin {
    const std::string& source;
    const std::string& place;

    [[noreturn]] void refuse(const std::string& what) const {
        throw Error(
            source, place, what,
            R"(a camera looks like {"eye":[1,2,3], "target":[0,0,0], "up":[0,1,0], "fovy":45})");
    }
};

double number(const json& value, const std::string& key, const Origin& origin) {
    if (!value.is_number()) origin.refuse("'" + key + "' is not a number");
    const double result = value.get<double>();
    if (!std::isfinite(result)) origin.refuse("'" + key + "' is not finite");
    return result;
}

Vec3d vector3(const json& value, const std::string& key, const Origin& origin) {
    if (!value.is_array() || value.size() != 3) origin.refuse("'" + key + "' is not [x,y,z]");
    return {number(value[0], key, origin), number(value[1], key, origin),
            number(value[2], key, origin)};
}

int pixels(const json& value, const std::string& key, const Origin& origin) {
    const double result = number(value, key, origin);
    if (result < 1 || result > kMaxPicturePx || result != std::floor(result)) {
        origin.refuse("'" + key + "' is not a whole number from 1 to 16384");
    }
    return static_cast<int>(result);
}

void setKey(Camera& camera, const std::string& key, const json& value, const Origin& origin) {
    if (key == "eye") {
        camera.eye = vector3(value, key, origin);
    } else if (key == "target") {
        camera.target = vector3(value, key, origin);
    } else if (key == "up") {
        camera.up = vector3(value, key, origin);
    } else if (key == "fovy") {
        camera.fovyDegrees = number(value, key, origin);
    } else if (key == "width") {
        camera.widthPx = pixels(value, key, origin);
    } else if (key == "height") {
        camera.heightPx = pixels(value, key, origin);
    } else if (key == "near") {
        camera.nearModelUnits = number(value, key, origin);
    } else {
        origin.refuse("a camera has no '" + key + "'");
    }
}

}  // namespace

Camera cameraFromJson(const json& value, const Camera& defaults, const std::string& source,
                      const std::string& place) {
    const Origin origin{source, place};
    if (!value.is_object()) origin.refuse("not a JSON object");
    Camera camera = defaults;
    for (const auto& [key, item] : value.items()) setKey(camera, key, item, origin);
    if (camera.eye == camera.target) origin.refuse("eye and target are the same point");
    if (camera.up == Vec3d(0.0)) origin.refuse("'up' has no direction");
    if (!(camera.fovyDegrees > 0.0 && camera.fovyDegrees < 180.0)) {
        origin.refuse("'fovy' is not between 0 and 180 degrees");
    }
    if (camera.nearModelUnits < 0.0) origin.refuse("'near' is negative");
    return camera;
}

Camera parseCamera(std::string_view text, const Camera& defaults, const std::string& source) {
    return cameraFromJson(json::parse(text, nullptr, false), defaults, source, "");
}

std::string cameraToJson(const Camera& camera) {
    const auto array = [](const Vec3d& v) { return json::array({v.x, v.y, v.z}); };
    json value = {{"eye", array(camera.eye)}, {"target", array(camera.target)},
                  {"up", array(camera.up)},   {"fovy", camera.fovyDegrees},
                  {"width", camera.widthPx},  {"height", camera.heightPx}};
    if (camera.nearModelUnits > 0.0) value["near"] = camera.nearModelUnits;
    return value.dump();
}

UpAxis upAxisOf(const std::string& metadataJson) {
    const auto metadata = json::parse(metadataJson, nullptr, false);
    const bool isY = metadata.is_object() && metadata.contains("up") && metadata["up"] == "y";
    return isY ? UpAxis::Y : UpAxis::Z;
}

}  // namespace pagoda::hlod
