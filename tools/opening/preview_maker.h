// preview_maker.h: turns triangles as they are read into pictures now and then, for another thread
// to take. Fed by a sample, then by the first reading of a build (SurveyWatcher); the newest
// picture replaces one that was not taken.
#pragma once

#include "hlod/build/survey.h"
#include "tools/opening/surface_sketch.h"

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

namespace pagoda::tools {

class PreviewMaker final : public hlod::SurveyWatcher {
public:
    // The most it takes: the sketch, a coarser copy of it, one picture to be taken and one being
    // made, and the window's own on the GPU.
    static constexpr uint64_t kMostBytes = uint64_t{64} << 20;

    // Is told the axis first; then addTriangles() come from a sample.
    void beginSample(ooc::UpAxis databaseUp);
    // The sample has ended: shows what it gave.
    void endSample();

    void beginSurvey(ooc::UpAxis databaseUp) override;
    void endSurvey() override;
    uint32_t addObject(const ooc::ObjectInfo&) override { return objects_++; }
    uint32_t addMaterial(const ooc::MaterialInfo& material) override;
    void addTriangles(const ooc::TriangleBatch& batch) override;
    void dropped(ooc::DropReason, uint64_t) override {}
    void ignored(std::string_view, uint64_t) override {}
    void advance(uint64_t) override {}

    // From any thread: one that is newer than the last that was taken, or null.
    [[nodiscard]] std::shared_ptr<const viewer::Preview> take();

private:
    void showNow(bool isWhole);
    void showInTime();

    SurfaceSketch sketch_;
    bool isSample_ = false;
    hlod::UpAxis up_ = hlod::UpAxis::Z;
    uint32_t objects_ = 0;
    uint64_t sampledTriangles_ = 0;  // before the survey
    std::vector<uint32_t> colours_;  // by material
    uint64_t nextTriangles_ = 0;     // a picture is due when so many were seen
    std::chrono::steady_clock::time_point earliest_{}, nextTime_{};  // of the next picture

    std::mutex pictureMutex_;  // guards picture_
    std::shared_ptr<const viewer::Preview> picture_;
};

}  // namespace pagoda::tools
