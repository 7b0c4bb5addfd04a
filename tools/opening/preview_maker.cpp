#include "tools/opening/preview_maker.h"

#include <algorithm>
#include <utility>

namespace pagoda::tools {
namespace {

// The first picture comes early; then each time that much more is known, and never so often that
// making pictures takes more than a tenth of the time.
constexpr uint64_t kFirstTriangles = 40'000;
constexpr double kGrowth = 1.5;
constexpr int kShareOfTime = 10;
constexpr std::chrono::milliseconds kLongestWait{500};

hlod::UpAxis axisOf(ooc::UpAxis up) {
    return up == ooc::UpAxis::Y ? hlod::UpAxis::Y : hlod::UpAxis::Z;
}

}  // namespace

void PreviewMaker::beginSample(ooc::UpAxis databaseUp) {
    up_ = axisOf(databaseUp);
    isSample_ = true;
    nextTriangles_ = kFirstTriangles;
    nextTime_ = std::chrono::steady_clock::now() + kLongestWait;
}

void PreviewMaker::endSample() {
    if (sketch_.trianglesSeen() > 0) showNow(false);
}

// What a sample has shown stays: the reading meets it again, which changes no mean.
void PreviewMaker::beginSurvey(ooc::UpAxis databaseUp) {
    up_ = axisOf(databaseUp);
    sampledTriangles_ = sketch_.trianglesSeen();
    objects_ = 0;
    colours_.clear();
    nextTriangles_ = std::max(nextTriangles_, kFirstTriangles);
    nextTime_ = std::chrono::steady_clock::now() + kLongestWait;
}

void PreviewMaker::endSurvey() {
    isSample_ = false;
    if (sketch_.trianglesSeen() > 0) showNow(true);
}

uint32_t PreviewMaker::addMaterial(const ooc::MaterialInfo& material) {
    colours_.push_back(material.colour);
    return static_cast<uint32_t>(colours_.size() - 1);
}

void PreviewMaker::addTriangles(const ooc::TriangleBatch& batch) {
    const uint32_t own = batch.material < colours_.size() ? colours_[batch.material] : 0xFFFFFFFFu;
    for (size_t corner = 0; corner < batch.positions.size(); corner += 3) {
        sketch_.add(batch.positions[corner], batch.positions[corner + 1],
                    batch.positions[corner + 2],
                    batch.colours.empty() ? own : batch.colours[corner]);
    }
    showInTime();
}

void PreviewMaker::showInTime() {
    const auto now = std::chrono::steady_clock::now();
    const bool isDue = sketch_.trianglesSeen() >= nextTriangles_ || now >= nextTime_;
    if (!isDue || now < earliest_ || sketch_.trianglesSeen() == 0) return;
    showNow(false);
}

void PreviewMaker::showNow(bool isWhole) {
    const auto began = std::chrono::steady_clock::now();
    auto picture = std::make_shared<viewer::Preview>(sketch_.picture(isSample_));
    picture->up = up_;
    picture->isWhole = isWhole;
    // What was sampled is met again: until the reading has caught up, it is what is known.
    picture->trianglesSeen =
        std::max(sampledTriangles_, sketch_.trianglesSeen() - sampledTriangles_);
    {
        const std::scoped_lock lock(pictureMutex_);
        picture_ = std::move(picture);
    }
    const auto ended = std::chrono::steady_clock::now();
    earliest_ = ended + kShareOfTime * (ended - began);
    nextTime_ = ended + kLongestWait;
    nextTriangles_ =
        static_cast<uint64_t>(kGrowth * static_cast<double>(sketch_.trianglesSeen())) + 1;
}

std::shared_ptr<const viewer::Preview> PreviewMaker::take() {
    const std::scoped_lock lock(pictureMutex_);
    return std::exchange(picture_, nullptr);
}

}  // namespace pagoda::tools
