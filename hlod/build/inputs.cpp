#include "hlod/build/inputs.h"

#include "ooc/base/error.h"
#include "ooc/readers/reader_extras.h"

#include <glob.h>

#include <algorithm>
#include <charconv>

namespace pagoda::hlod {
namespace {

namespace fs = std::filesystem;

std::string lowerExtension(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

std::string formatOf(const fs::path& path) {
    const std::string extension = lowerExtension(path);
    for (const ooc::ReaderFormat& format : ooc::readerFormats()) {
        if (std::find(format.extensions.begin(), format.extensions.end(), extension) !=
            format.extensions.end()) {
            return std::string(format.name);
        }
    }
    return {};
}

[[noreturn]] void badOption(const std::string& argument, const std::string& what) {
    throw Error(
        argument, "", what,
        "write INPUT@up=y|z,unit=FACTOR|mm|cm|m|km|in|ft,move=X:Y:Z,matrix=16 numbers by row");
}

double parseNumber(const std::string& argument, const std::string& text) {
    double value = 0;
    const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (code != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) {
        badOption(argument, "'" + text + "' is not a number");
    }
    return value;
}

std::vector<double> parseNumbers(const std::string& argument, const std::string& text,
                                 size_t count) {
    std::vector<double> numbers;
    size_t begin = 0;
    while (begin <= text.size()) {
        const size_t end = std::min(text.find(':', begin), text.size());
        numbers.push_back(parseNumber(argument, text.substr(begin, end - begin)));
        begin = end + 1;
    }
    if (numbers.size() != count) {
        badOption(argument, std::to_string(count) + " numbers are needed, not " +
                                std::to_string(numbers.size()));
    }
    return numbers;
}

double parseUnit(const std::string& argument, const std::string& text) {
    static const std::map<std::string, double> kUnits = {
        {"mm", 0.001}, {"cm", 0.01}, {"m", 1.0}, {"km", 1000.0}, {"in", 0.0254}, {"ft", 0.3048}};
    if (const auto unit = kUnits.find(text); unit != kUnits.end()) return unit->second;
    const double factor = parseNumber(argument, text);
    if (factor <= 0) badOption(argument, "a unit is a factor above 0");
    return factor;
}

void applyOption(InputSpec& spec, const std::string& argument, const std::string& key,
                 const std::string& value) {
    if (key == "up") {
        if (value != "y" && value != "z") badOption(argument, "up is y or z, not '" + value + "'");
        spec.up = value == "y" ? ooc::UpAxis::Y : ooc::UpAxis::Z;
    } else if (key == "unit") {
        spec.unit = parseUnit(argument, value);
    } else if (key == "move") {
        const std::vector<double> by = parseNumbers(argument, value, 3);
        for (int axis = 0; axis < 3; ++axis)
            spec.transform[3][axis] += by[static_cast<size_t>(axis)];
        spec.isTransformed = true;
    } else if (key == "matrix") {
        const std::vector<double> rows = parseNumbers(argument, value, 16);
        glm::dmat4 matrix;
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                matrix[column][row] =
                    rows[4 * static_cast<size_t>(row) + static_cast<size_t>(column)];
            }
        }
        spec.transform = matrix * spec.transform;
        spec.isTransformed = true;
    } else {
        badOption(argument, "unknown option '" + key + "'");
    }
}

InputSpec parseSuffix(const std::string& argument, std::string& pathText) {
    InputSpec spec;
    pathText = argument;
    const size_t mark = argument.rfind('@');
    if (mark == std::string::npos || fs::exists(argument) ||
        argument.find('=', mark) == std::string::npos) {
        return spec;
    }
    pathText = argument.substr(0, mark);
    size_t begin = mark + 1;
    while (begin < argument.size()) {
        const size_t end = std::min(argument.find(',', begin), argument.size());
        const std::string part = argument.substr(begin, end - begin);
        const size_t equals = part.find('=');
        if (equals == std::string::npos) badOption(argument, "'" + part + "' has no '='");
        applyOption(spec, argument, part.substr(0, equals), part.substr(equals + 1));
        begin = end + 1;
    }
    return spec;
}

void addFolder(const InputSpec& like, const fs::path& folder, std::vector<InputSpec>& specs) {
    size_t found = 0;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
        if (!entry.is_regular_file() || formatOf(entry.path()).empty()) continue;
        InputSpec spec = like;
        spec.path = entry.path();
        specs.push_back(spec);
        ++found;
    }
    if (found == 0) {
        throw Error(folder.string(), "", "no file of a known format in this folder",
                    "name a folder with .ply, .obj, .stl, .off, .gltf, .glb or .drc files");
    }
}

void addGlob(const InputSpec& like, const std::string& pattern, std::vector<InputSpec>& specs) {
    glob_t matches{};
    const int code = ::glob(pattern.c_str(), 0, nullptr, &matches);
    if (code != 0 || matches.gl_pathc == 0) {
        ::globfree(&matches);
        throw Error(pattern, "", "no such file", "check the path");
    }
    for (size_t i = 0; i < matches.gl_pathc; ++i) {
        const fs::path path = matches.gl_pathv[i];
        if (fs::is_directory(path)) {
            addFolder(like, path, specs);
        } else {
            InputSpec spec = like;
            spec.path = path;
            specs.push_back(spec);
        }
    }
    ::globfree(&matches);
}

// Passes everything on, placed and renumbered; counts what the source held.
class PlacingSink : public ooc::TriangleSink {
public:
    PlacingSink(ooc::TriangleSink& target, const glm::dmat4& placement, bool isPlaced,
                uint32_t objectOffset, uint32_t materialOffset, uint32_t parentOfTop)
        : target_(target),
          placement_(placement),
          normalPlacement_(glm::transpose(glm::inverse(glm::dmat3(placement)))),
          isPlaced_(isPlaced),
          isMirrored_(glm::determinant(glm::dmat3(placement)) < 0),
          objectOffset_(objectOffset),
          materialOffset_(materialOffset),
          parentOfTop_(parentOfTop) {}

    uint32_t addObject(const ooc::ObjectInfo& object) override {
        ooc::ObjectInfo renumbered = object;
        renumbered.parent = object.parent == ooc::ObjectInfo::kNoParent
                                ? parentOfTop_
                                : object.parent + objectOffset_;
        return target_.addObject(renumbered) - objectOffset_;
    }
    uint32_t addMaterial(const ooc::MaterialInfo& material) override {
        return target_.addMaterial(material) - materialOffset_;
    }
    void addTriangles(const ooc::TriangleBatch& batch) override {
        triangles += batch.triangleCount();
        if (!isPlaced_ && objectOffset_ == 0 && materialOffset_ == 0) {
            target_.addTriangles(batch);
            return;
        }
        placed_ = batch;
        placed_.object += objectOffset_;
        placed_.material += materialOffset_;
        if (isPlaced_) place();
        target_.addTriangles(placed_);
    }
    void dropped(ooc::DropReason reason, uint64_t count) override {
        triangles += count;
        target_.dropped(reason, count);
    }
    void ignored(std::string_view what, uint64_t count) override { target_.ignored(what, count); }
    void advance(uint64_t bytes) override { target_.advance(bytes); }

    uint64_t triangles = 0;

private:
    void place() {
        for (Vec3d& position : placed_.positions)
            position = Vec3d(placement_ * glm::dvec4(position, 1.0));
        for (Vec3f& normal : placed_.normals) {
            const Vec3d turned = normalPlacement_ * Vec3d(normal);
            const double length = glm::length(turned);
            normal = length > 0 ? Vec3f(turned / length) : Vec3f(0.0f);
        }
        if (!isMirrored_) return;
        for (size_t corner = 0; corner < placed_.positions.size(); corner += 3) {
            std::swap(placed_.positions[corner + 1], placed_.positions[corner + 2]);
            if (!placed_.colours.empty())
                std::swap(placed_.colours[corner + 1], placed_.colours[corner + 2]);
            if (!placed_.normals.empty())
                std::swap(placed_.normals[corner + 1], placed_.normals[corner + 2]);
        }
    }

    ooc::TriangleSink& target_;
    glm::dmat4 placement_;
    glm::dmat3 normalPlacement_;
    bool isPlaced_, isMirrored_;
    uint32_t objectOffset_, materialOffset_, parentOfTop_;
    ooc::TriangleBatch placed_;
};

// Counts the ids given out, so that the next file's ids can follow.
class CountingSink : public ooc::TriangleSink {
public:
    explicit CountingSink(ooc::TriangleSink& target) : target_(target) {}
    uint32_t addObject(const ooc::ObjectInfo& object) override {
        ++objects;
        return target_.addObject(object);
    }
    uint32_t addMaterial(const ooc::MaterialInfo& material) override {
        ++materials;
        return target_.addMaterial(material);
    }
    void addTriangles(const ooc::TriangleBatch& batch) override { target_.addTriangles(batch); }
    void dropped(ooc::DropReason reason, uint64_t count) override {
        target_.dropped(reason, count);
    }
    void ignored(std::string_view what, uint64_t count) override { target_.ignored(what, count); }
    void advance(uint64_t bytes) override { target_.advance(bytes); }

    uint32_t objects = 0, materials = 0;

private:
    ooc::TriangleSink& target_;
};

}  // namespace

std::vector<InputSpec> expandInputs(const std::vector<std::string>& arguments) {
    std::vector<InputSpec> specs;
    for (const std::string& argument : arguments) {
        std::string pathText;
        InputSpec spec = parseSuffix(argument, pathText);
        if (fs::is_directory(pathText)) {
            addFolder(spec, pathText, specs);
        } else if (fs::exists(pathText)) {
            spec.path = pathText;
            specs.push_back(spec);
        } else {
            addGlob(spec, pathText, specs);
        }
    }
    std::stable_sort(specs.begin(), specs.end(),
                     [](const InputSpec& a, const InputSpec& b) { return a.path < b.path; });
    return specs;
}

InputSet::InputSet(std::vector<InputSpec> specs, const ooc::ReaderOptions& options,
                   ooc::UpAxis databaseUp)
    : databaseUp_(databaseUp) {
    for (InputSpec& spec : specs) {
        std::unique_ptr<ooc::Reader> reader = ooc::openReader(spec.path, options);
        totalBytes_ += fs::file_size(spec.path);
        Entry entry{.spec = std::move(spec), .reader = std::move(reader)};
        if (entry.spec.up == ooc::UpAxis::Unknown) entry.spec.up = entry.reader->upAxis();
        if (databaseUp_ == ooc::UpAxis::Unknown) databaseUp_ = entry.spec.up;
        entries_.push_back(std::move(entry));
    }
    if (databaseUp_ == ooc::UpAxis::Unknown) databaseUp_ = ooc::UpAxis::Z;
    for (Entry& entry : entries_) {
        glm::dmat4 turn(1.0);
        if (entry.spec.up == ooc::UpAxis::Unknown) entry.spec.up = databaseUp_;
        if (entry.spec.up != databaseUp_) {
            // y up to z up: (x, y, z) -> (x, -z, y); the other way is its inverse.
            turn = glm::dmat4(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);
            if (databaseUp_ == ooc::UpAxis::Y) turn = glm::transpose(turn);
        }
        glm::dmat4 scale(entry.spec.unit);
        scale[3][3] = 1.0;
        entry.placement = entry.spec.transform * scale * turn;
        entry.isPlaced =
            entry.spec.isTransformed || entry.spec.unit != 1.0 || entry.spec.up != databaseUp_;
        sources_.push_back({.name = entry.spec.path.filename().string(),
                            .format = formatOf(entry.spec.path),
                            .attribution = {},
                            .up = entry.spec.up,
                            .unit = entry.spec.unit,
                            .transform = entry.spec.transform,
                            .trianglesIn = 0});
    }
}

void InputSet::read(ooc::TriangleSink& sink) {
    CountingSink counting(sink);
    firstObject_.clear();
    for (size_t i = 0; i < entries_.size(); ++i) {
        firstObject_.push_back(counting.objects);
        uint32_t top = ooc::ObjectInfo::kNoParent;
        if (entries_.size() > 1) top = counting.addObject({.name = sources_[i].name});
        PlacingSink placing(counting, entries_[i].placement, entries_[i].isPlaced, counting.objects,
                            counting.materials, top);
        entries_[i].reader->read(placing);
        sources_[i].trianglesIn = placing.triangles;
        sources_[i].attribution = entries_[i].reader->attribution();
    }
}

bool InputSet::sample(ooc::TriangleSink& sink, uint64_t triangles,
                      const std::function<bool()>& isEnough) {
    if (entries_.size() != 1) return false;
    const Entry& entry = entries_.front();
    PlacingSink placing(sink, entry.placement, entry.isPlaced, 0, 0, ooc::ObjectInfo::kNoParent);
    auto* const sampled = dynamic_cast<ooc::SampledReader*>(entry.reader.get());
    return sampled != nullptr && sampled->sample(placing, triangles, isEnough);
}

std::vector<std::filesystem::path> InputSet::companions() const {
    std::vector<std::filesystem::path> all;
    for (const Entry& entry : entries_) {
        const auto* const reader = dynamic_cast<const ooc::CompanionReader*>(entry.reader.get());
        if (reader == nullptr) continue;
        const std::vector<std::filesystem::path> some = reader->companions();
        all.insert(all.end(), some.begin(), some.end());
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
}

uint32_t InputSet::sourceOfObject(uint32_t object) const {
    const auto after = std::upper_bound(firstObject_.begin(), firstObject_.end(), object);
    return static_cast<uint32_t>(after - firstObject_.begin() - 1);
}

}  // namespace pagoda::hlod
