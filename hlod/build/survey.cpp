#include "hlod/build/survey.h"

#include "ooc/base/error.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace pagoda::hlod {
namespace {

// Default resolution of the extent. A page of 1/4 of the extent still has 16-bit coordinates.
constexpr int kDefaultExtentBits = 18;
// Steps in the finest detail: a snap moves a point by at most 0.87 steps, 5% of such an edge.
constexpr double kStepsPerDetail = 16.0;
// The share of triangles that may be finer than the finest detail.
constexpr double kFineShare = 0.001;

bool isFinite(const Vec3d& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

class SurveySink : public ooc::TriangleSink {
public:
    SurveySink(Survey& survey, SurveyWatcher* watcher, Progress& progress)
        : survey_(survey), watcher_(watcher), progress_(progress) {}

    uint32_t addObject(const ooc::ObjectInfo& object) override {
        if (watcher_ != nullptr) (void)watcher_->addObject(object);  // it counts as we do
        return objects_++;
    }
    uint32_t addMaterial(const ooc::MaterialInfo& material) override {
        if (watcher_ != nullptr) (void)watcher_->addMaterial(material);
        return materials_++;
    }
    void addTriangles(const ooc::TriangleBatch& batch) override {
        if (watcher_ != nullptr) watcher_->addTriangles(batch);
        for (size_t corner = 0; corner < batch.positions.size(); corner += 3) {
            addTriangle(batch.positions[corner], batch.positions[corner + 1],
                        batch.positions[corner + 2]);
        }
        survey_.triangles += batch.triangleCount();
        survey_.hasColours |= !batch.colours.empty();
        survey_.hasNormals |= !batch.normals.empty();
    }
    void dropped(ooc::DropReason reason, uint64_t count) override {
        if (count > 0) survey_.dropped[std::string(dropReasonName(reason))] += count;
    }
    void ignored(std::string_view what, uint64_t count) override {
        survey_.ignored[std::string(what)] += count;
    }
    void advance(uint64_t bytes) override {
        if (watcher_ != nullptr) watcher_->advance(bytes);
        progress_.advance(bytes);
        progress_.check();
    }

private:
    void addTriangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
        if (!isFinite(a) || !isFinite(b) || !isFinite(c)) {
            dropped(ooc::DropReason::NonFinite, 1);
            return;
        }
        survey_.bounds.extend(a);
        survey_.bounds.extend(b);
        survey_.bounds.extend(c);
        const auto squared = [](const Vec3d& v) { return glm::dot(v, v); };
        const double longest = std::max({squared(b - a), squared(c - b), squared(a - c)});
        if (!(longest > 0)) return;
        const int exponent = std::isfinite(longest) ? std::ilogb(longest) >> 1 : 1000;
        const int index = std::clamp(exponent + Survey::kBias, 0, 2199);
        ++survey_.longestEdgeExponents[static_cast<size_t>(index)];
    }

    Survey& survey_;
    SurveyWatcher* watcher_;
    Progress& progress_;
    uint32_t objects_ = 0, materials_ = 0;
};

// The exponent e such that all but kFineShare of the triangles have a longest edge >= 2^e.
int finestDetailExponent(const Survey& survey) {
    uint64_t total = 0;
    for (const uint64_t count : survey.longestEdgeExponents) total += count;
    uint64_t finer = 0;
    for (size_t i = 0; i < survey.longestEdgeExponents.size(); ++i) {
        finer += survey.longestEdgeExponents[i];
        if (static_cast<double>(finer) > kFineShare * static_cast<double>(total)) {
            return static_cast<int>(i) - Survey::kBias;
        }
    }
    return 0;
}

}  // namespace

Survey surveyInputs(InputSet& inputs, SurveyWatcher* watcher, Progress& progress) {
    Survey survey;
    SurveySink sink(survey, watcher, progress);
    if (watcher != nullptr) watcher->beginSurvey(inputs.databaseUp());
    progress.beginStage("survey", inputs.totalBytes(), "B");
    inputs.read(sink);
    if (watcher != nullptr) watcher->endSurvey();
    return survey;
}

ooc::Lattice chooseLattice(const Survey& survey, const std::string& inputName,
                           std::optional<double> precision, int refinement) {
    const Vec3d size = survey.bounds.max - survey.bounds.min;
    const double extent = std::max({size.x, size.y, size.z});
    if (!std::isfinite(extent)) {
        throw Error(inputName, "", "coordinates up to 1e308 leave no finite extent",
                    "remove the outliers");
    }
    // A plane, a line or a point along the axes: any positive extent does.
    const int extentExponent =
        extent > 0 ? std::ilogb(extent) + 1 : 0;  // extent < 2^extentExponent
    const int finest = extentExponent - ooc::kMaxExtentBits + 1;
    int exponent = 0;
    if (precision) {
        exponent = std::ilogb(*precision);
        if (exponent < finest) {
            throw Error(inputName, "", "--precision is finer than 2^-29 of the extent of the input",
                        "use " + std::to_string(std::ldexp(1.0, finest)) + " or more");
        }
    } else {
        const int byExtent = extentExponent - kDefaultExtentBits;
        const int byDetail = finestDetailExponent(survey) - std::ilogb(kStepsPerDetail);
        exponent = std::max(std::min(byExtent, byDetail) - refinement, finest);
    }
    ooc::Lattice lattice;
    lattice.stepExponent = exponent;
    const double step = lattice.step();
    lattice.origin = glm::floor(survey.bounds.min / step) * step;
    const double farthest =
        std::max(glm::length(survey.bounds.min), glm::length(survey.bounds.max));
    if (farthest / step >= 0x1p52) {
        throw Error(
            inputName, "",
            "the model lies so far from the origin that double cannot tell its points apart",
            "move it nearer (INPUT@move=X:Y:Z) or give a coarser --precision");
    }
    const Vec3i last = lattice.snap(survey.bounds.max);
    const int32_t largest = std::max({last.x, last.y, last.z, 1});
    lattice.extentBits = std::clamp(
        static_cast<int>(std::bit_width(static_cast<uint32_t>(largest))), 1, ooc::kMaxExtentBits);
    return lattice;
}

}  // namespace pagoda::hlod
