#include "hlod/view/camera_path.h"

#include "hlod/view/camera_json.h"
#include "ooc/base/error.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

namespace pagoda::hlod {
namespace {

using nlohmann::json;

constexpr const char* kRemedy = "`pagoda path` writes such files; see `pagoda path --help`";

[[noreturn]] void refuse(const std::string& source, const std::string& what) {
    throw Error(source, "", what, kRemedy);
}

json parseText(std::string_view text, const std::string& source) {
    if (text.size() > kMaxPathBytes) {
        refuse(source, "larger than " + std::to_string(kMaxPathBytes >> 20) + " MiB");
    }
    try {
        return json::parse(text);
    } catch (const json::parse_error& error) {
        throw Error(source, "byte " + std::to_string(error.byte), "not JSON", kRemedy);
    } catch (const json::exception&) {  // 1e999
        refuse(source, "has a number beyond all bounds");
    }
}

double positive(const json& value, const std::string& key, const std::string& source) {
    const double result = value.is_number() ? value.get<double>() : 0.0;
    if (!(result > 0.0 && std::isfinite(result))) {
        refuse(source, "'" + key + "' is not a number above 0");
    }
    return result;
}

std::string word(const json& value, const std::string& key, const std::string& source) {
    if (!value.is_string()) refuse(source, "'" + key + "' is no text");
    return value.get<std::string>();
}

void readModel(const json& model, CameraPath& path, const std::string& source) {
    if (!model.is_object()) refuse(source, "'model' is not an object");
    for (const auto& [key, value] : model.items()) {
        if (key == "name") {
            path.modelName = word(value, "model.name", source);
        } else if (key == "diagonal") {
            path.modelDiagonalModelUnits = positive(value, "model.diagonal", source);
        } else {
            refuse(source, "a path's model has no '" + key + "'");
        }
    }
}

void readKey(const std::string& key, const json& value, CameraPath& path,
             const std::string& source) {
    if (key == "kind") {
        path.kind = word(value, key, source);
    } else if (key == "seed") {
        if (!value.is_number_unsigned()) refuse(source, "'seed' is not a whole number from 0");
        path.seed = value.get<uint64_t>();
    } else if (key == "fps") {
        path.framesPerSecond = positive(value, key, source);
    } else if (key == "model") {
        readModel(value, path, source);
    } else if (key != "frames" && key != "width" && key != "height") {
        refuse(source, "a path has no '" + key + "'");
    }
}

// Both or none; checked as any camera's.
void readSize(const json& value, CameraPath& path, Camera& defaults, const std::string& source) {
    if (value.contains("width") != value.contains("height")) {
        refuse(source, "'width' and 'height' go together");
    }
    if (!value.contains("width")) return;
    const json size{{"width", value["width"]}, {"height", value["height"]}};
    defaults = cameraFromJson(size, defaults, source, "");
    path.widthPx = defaults.widthPx;
    path.heightPx = defaults.heightPx;
}

void readFrames(const json& frames, const Camera& defaults, CameraPath& path,
                const std::string& source) {
    if (!frames.is_array() || frames.empty()) refuse(source, "'frames' is not a list of cameras");
    if (frames.size() > kMaxPathFrames) {
        refuse(source, "more than " + std::to_string(kMaxPathFrames) + " frames");
    }
    path.frames.reserve(frames.size());
    for (size_t i = 0; i < frames.size(); ++i) {
        const std::string place = "frame " + std::to_string(i);
        const json& frame = frames[i];
        const auto fail = [&](const char* what) { throw Error(source, place, what, kRemedy); };
        if (!frame.is_object()) fail("not a JSON object");
        if (!frame.contains("eye") || !frame.contains("target")) fail("has no eye or no target");
        if (frame.contains("width") || frame.contains("height")) {
            fail("has a size of its own; all frames of a path share one");
        }
        path.frames.push_back(cameraFromJson(frame, defaults, source, place));
    }
}

void append(std::string& text, double value) {
    char digits[32];
    // + 0.0 turns -0 into 0, which readers of JSON may take for the integer.
    const auto end = std::to_chars(digits, digits + sizeof digits, value + 0.0).ptr;
    text.append(digits, end);
}

void append(std::string& text, const char* key, const Vec3d& value) {
    text.append(key).append("[");
    for (int axis = 0; axis < 3; ++axis) {
        if (axis > 0) text += ',';
        append(text, value[axis]);
    }
    text += ']';
}

std::string quoted(const std::string& text) {
    return json(text).dump(-1, ' ', true, json::error_handler_t::replace);
}

void append(std::string& text, const Camera& camera) {
    append(text, "{\"eye\":", camera.eye);
    append(text, ",\"target\":", camera.target);
    append(text, ",\"up\":", camera.up);
    append(text.append(",\"fovy\":"), camera.fovyDegrees);
    if (camera.nearModelUnits > 0) append(text.append(",\"near\":"), camera.nearModelUnits);
    text += '}';
}

}  // namespace

CameraPath parseCameraPath(std::string_view text, const Camera& defaults,
                           const std::string& source) {
    const json value = parseText(text, source);
    if (!value.is_object()) refuse(source, "not a JSON object");
    if (!value.contains("frames")) refuse(source, "has no 'frames'");
    CameraPath path;
    for (const auto& [key, item] : value.items()) readKey(key, item, path, source);
    Camera sized = defaults;
    readSize(value, path, sized, source);
    readFrames(value["frames"], sized, path, source);
    return path;
}

std::string cameraPathToJson(const CameraPath& path) {
    std::string text = "{\"kind\":" + quoted(path.kind) + ",\"seed\":" + std::to_string(path.seed);
    append(text.append(",\"fps\":"), path.framesPerSecond);
    if (!path.modelName.empty() || path.modelDiagonalModelUnits > 0) {
        text += ",\"model\":{\"name\":" + quoted(path.modelName);
        if (path.modelDiagonalModelUnits > 0) {
            append(text.append(",\"diagonal\":"), path.modelDiagonalModelUnits);
        }
        text += '}';
    }
    if (path.widthPx > 0) {
        text += ",\"width\":" + std::to_string(path.widthPx) +
                ",\"height\":" + std::to_string(path.heightPx);
    }
    text += ",\"frames\":[";
    for (size_t i = 0; i < path.frames.size(); ++i) {
        text += i == 0 ? "\n" : ",\n";
        append(text, path.frames[i]);
    }
    return text + "\n]}\n";
}

CameraPath atSpeed(const CameraPath& path, double factor) {
    assert(factor >= 1.0);
    CameraPath fast = path;
    fast.frames.clear();
    for (size_t i = 0;; ++i) {
        const double at = std::floor(static_cast<double>(i) * factor);
        if (!(at < static_cast<double>(path.frames.size()))) return fast;
        fast.frames.push_back(path.frames[static_cast<size_t>(at)]);
    }
}

PathStep stepBetween(const Camera& from, const Camera& to) {
    const Vec3d a = from.target - from.eye, b = to.target - to.eye;
    // By atan2: acos has no digits left for small angles.
    const double radians = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
    return {radians * 180.0 / std::numbers::pi, glm::length(to.eye - from.eye)};
}

}  // namespace pagoda::hlod
