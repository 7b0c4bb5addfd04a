#include "tools/paths/tour.h"

#include "tools/paths/poses.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <tuple>
#include <utility>

namespace pagoda::tools {
namespace {

constexpr uint32_t kNone = FloorPlan::kNone;
constexpr float kFar = std::numeric_limits<float>::infinity();

}  // namespace

Tour::Tour(const Occupancy& solid, const FloorPlan& plan, const TourStyle& style, uint64_t seed,
           Progress& progress)
    : solid_(solid), plan_(plan), style_(style), random_(Random(seed).fork(3)) {
    isChosen_.assign(plan.size(), false);
    chooseFloor(progress);
    choosePlaces();
    if (isEmpty()) return;
    isVisited_.assign(places_.size(), false);
    cost_.assign(plan.size(), kFar);
    from_.assign(plan.size(), kNone);
    way_.push_back(places_[random_.next() % places_.size()]);
    markVisited(way_.back());
}

Vec3d Tour::eyeAt(uint32_t spot) const {
    // The floor lies in the solid cell below, about its middle.
    const Vec3i& cell = plan_.cell(spot);
    return solid_.cellMin(cell) + solid_.cellSize() * Vec3d(0.5, 0.5, style_.eyeHeight - 0.5);
}

void Tour::chooseFloor(Progress& progress) {
    std::vector<bool> isSeen(plan_.size(), false);
    std::vector<uint32_t> best;
    double bestScore = 0;
    progress.beginStage("Finding the way", plan_.size(), "spots");
    for (uint32_t start = 0; start < plan_.size(); ++start) {
        if (isSeen[start] || plan_.clearance(start) < style_.bodyRadius) continue;
        std::vector<uint32_t> spots{start};
        isSeen[start] = true;
        for (size_t i = 0; i < spots.size(); ++i) {
            for (const uint32_t next : plan_.neighbours(spots[i])) {
                if (next == kNone || isSeen[next]) continue;
                if (plan_.clearance(next) < style_.bodyRadius) continue;
                isSeen[next] = true;
                spots.push_back(next);
            }
        }
        progress.check();
        progress.advance(spots.size());
        const double size = static_cast<double>(spots.size());
        if (size <= bestScore || size < style_.placeSpacing * style_.placeSpacing / 2) continue;
        const double score = buildingScore(spots);
        if (score <= bestScore) continue;
        bestScore = score;
        best = std::move(spots);
    }
    for (const uint32_t spot : best) isChosen_[spot] = true;
    floorCells_ = static_cast<double>(best.size());
}

// Its cells, less what is open to the sides, less what can be seen at one look: a hall of rooms
// beats a larger tank or a field under a roof.
double Tour::buildingScore(const std::vector<uint32_t>& spots) const {
    constexpr size_t kSamples = 48;
    std::vector<Vec3d> eyes;
    for (size_t i = 0; i < kSamples; ++i) eyes.push_back(eyeAt(spots[i * spots.size() / kSamples]));
    const double reach = 25 * style_.eyeHeight * solid_.cellSize();
    size_t blocked = 0, hidden = 0;
    for (const Vec3d& eye : eyes) {
        for (int i = 0; i < 8; ++i) {
            const Vec3d direction(std::cos(i * 0.785), std::sin(i * 0.785), 0.0);
            blocked += solid_.freeLength(eye, direction, reach) < reach ? 1u : 0u;
        }
        for (const Vec3d& other : eyes) hidden += solid_.isClear(eye, other) ? 0u : 1u;
    }
    const double enclosed = static_cast<double>(blocked) / (8.0 * kSamples);
    const double divided = static_cast<double>(hidden) / (1.0 * kSamples * kSamples);
    return static_cast<double>(spots.size()) * enclosed * enclosed * (0.05 + 0.95 * divided);
}

double Tour::openness(uint32_t spot) const {
    const Vec3d eye = eyeAt(spot);
    const double reach = 5 * style_.eyeHeight * solid_.cellSize();
    double sum = 0;
    for (int i = 0; i < 16; ++i) {
        sum += solid_.viewLength(eye, directionOf(i * 0.3927, 0.0), reach);
    }
    return sum / (16 * solid_.cellSize());
}

// The spot with most open space around it in each square of the floor; none in corners and behind
// cupboards; of two in view of each other and close, the one with more.
void Tour::choosePlaces() {
    constexpr int kEvery = 4;  // cells: looking around from each spot would take minutes
    std::map<std::tuple<int, int, int>, std::pair<double, uint32_t>> squares;
    const double tall = 1.5 * style_.eyeHeight;
    for (uint32_t spot = 0; spot < plan_.size(); ++spot) {
        const Vec3i& cell = plan_.cell(spot);
        if (!isChosen_[spot] || cell.x % kEvery != 0 || cell.y % kEvery != 0) continue;
        if (plan_.clearance(spot) < style_.placeClearance) continue;
        const double open = openness(spot);
        if (open < style_.placeOpenness) continue;
        const Vec3d at = Vec3d(cell) / Vec3d(style_.placeSpacing, style_.placeSpacing, tall);
        const auto key =
            std::tuple(static_cast<int>(at.z), static_cast<int>(at.y), static_cast<int>(at.x));
        const auto found = squares.emplace(key, std::pair(open, spot)).first;
        if (open > found->second.first) found->second = {open, spot};
    }
    std::vector<std::pair<double, uint32_t>> sorted;
    for (const auto& [key, place] : squares) sorted.push_back(place);
    std::stable_sort(sorted.begin(), sorted.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    for (const auto& [open, spot] : sorted) {
        const Vec3d eye = eyeAt(spot);
        const bool isNear = std::any_of(places_.begin(), places_.end(), [&](uint32_t other) {
            const Vec3d there = eyeAt(other);
            return glm::length(eye - there) < 0.6 * style_.placeSpacing * solid_.cellSize() &&
                   solid_.isClear(eye, there);
        });
        if (!isNear) places_.push_back(spot);
    }
    placeOf_.assign(plan_.size(), kNone);
    for (uint32_t i = 0; i < places_.size(); ++i) placeOf_[places_[i]] = i;
}

void Tour::markVisited(uint32_t spot) {
    const Vec3d eye = eyeAt(spot);
    for (size_t i = 0; i < places_.size(); ++i) {
        if (isVisited_[i]) continue;
        const Vec3d there = eyeAt(places_[i]);
        if (glm::length(there - eye) <= style_.seenRadius * solid_.cellSize() &&
            solid_.isClear(eye, there)) {
            isVisited_[i] = true;
        }
    }
}

// Places not yet visited, nearest first, by Dijkstra's search from the end of the way: those out of
// sight from there, as they lie in other rooms, up to 2; if there are none, the others.
std::vector<uint32_t> Tour::nextPlaces() {
    using Entry = std::pair<float, uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    for (const uint32_t spot : reached_) cost_[spot] = kFar;
    reached_.clear();
    std::vector<uint32_t> found, inView;
    const Vec3d eye = eyeAt(way_.back());
    const auto reach = [&](uint32_t spot, float cost, uint32_t from) {
        if (cost >= cost_[spot]) return;
        if (cost_[spot] == kFar) reached_.push_back(spot);
        cost_[spot] = cost;
        from_[spot] = from;
        open.emplace(cost, spot);
    };
    reach(way_.back(), 0, kNone);
    while (!open.empty() && found.size() < 2 && inView.size() < 40) {
        const auto [cost, spot] = open.top();
        open.pop();
        if (cost > cost_[spot]) continue;
        if (placeOf_[spot] != kNone && !isVisited_[placeOf_[spot]] && spot != way_.back()) {
            (solid_.isClear(eye, eyeAt(spot)) ? inView : found).push_back(spot);
        }
        const std::array<uint32_t, 8> around = plan_.neighbours(spot);
        for (size_t i = 0; i < 8; ++i) {
            const uint32_t next = around[i];
            if (next == kNone || !isChosen_[next]) continue;
            const double lack = std::max(0.0, 1 - plan_.clearance(next) / style_.likedClearance);
            const double length = i % 2 == 0 ? 1.0 : 1.4142;
            reach(next, cost + static_cast<float>(length * (1 + 4 * lack * lack)), spot);
        }
    }
    inView.resize(std::min<size_t>(inView.size(), 3));
    return found.empty() ? inView : found;
}

void Tour::extend() {
    std::vector<uint32_t> next = nextPlaces();
    if (next.empty()) {  // all visited: once more from the beginning
        std::fill(isVisited_.begin(), isVisited_.end(), false);
        markVisited(way_.back());
        next = nextPlaces();
    }
    if (next.empty()) {  // all places lie close together
        std::fill(isVisited_.begin(), isVisited_.end(), false);
        next = nextPlaces();
    }
    const uint32_t target = next[random_.next() % next.size()];
    std::vector<uint32_t> leg;
    for (uint32_t spot = target; spot != way_.back(); spot = from_[spot]) leg.push_back(spot);
    for (size_t i = 0; i < leg.size(); i += 8) markVisited(leg[i]);
    way_.insert(way_.end(), leg.rbegin(), leg.rend());
}

}  // namespace pagoda::tools
