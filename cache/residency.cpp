#include "cache/residency.h"

#include <utility>

namespace pagoda::cache {
namespace {

template <typename T>
uint64_t bytesOf(const std::vector<T>& items) {
    return items.size() * sizeof(T);
}

}  // namespace

uint64_t decodedBytes(const ooc::Page& page) {
    const ooc::PageMesh& mesh = page.mesh;
    uint64_t bytes = sizeof(ooc::Page) + bytesOf(mesh.positions) + bytesOf(mesh.colours) +
                     bytesOf(mesh.normals) + bytesOf(mesh.indices) + bytesOf(mesh.runs);
    for (const ooc::Zipper& zipper : page.zippers) {
        bytes += sizeof(zipper) + bytesOf(zipper.positions) + bytesOf(zipper.indices);
    }
    return bytes;
}

Residency::Residency(Budgets budgets, PageSource& source, GpuPages& gpu)
    : source_(source), gpu_(gpu), hostLru_(budgets.hostBytes), gpuLru_(budgets.gpuBytes) {
}

Residency::~Residency() {
    gpuLru_.unpinAll();
    std::vector<PageId> evicted;
    while (gpuLru_.evictOldest(evicted)) {
    }
    for (const PageId& page : evicted) gpu_.drop(page);
}

void Residency::beginFrame(uint64_t frameIndex) {
    frameIndex_ = frameIndex;
    gpuLru_.unpinAll();
}

PageState Residency::want(const PageRequest& request) {
    if (gpuLru_.contains(request.id)) {
        gpuLru_.touch(request.id, frameIndex_);
        gpuLru_.pin(request.id);
        return PageState::Resident;
    }
    if (failed_.contains(request.id)) return PageState::Failed;
    ooc::Page loaded;
    const ooc::Page* page = decoded(request, loaded);
    if (page == nullptr) return PageState::Failed;
    const PageState state = upload(request.id, *page);
    if (state == PageState::NoRoom && page == &loaded)
        turnedAway_.emplace(request.id, std::move(loaded));
    return state;
}

// The page from host memory or the source; `loaded` holds it when host memory keeps no copy.
const ooc::Page* Residency::decoded(const PageRequest& request, ooc::Page& loaded) {
    if (const auto found = decoded_.find(request.id); found != decoded_.end()) {
        hostLru_.touch(request.id, frameIndex_);
        return &found->second;
    }
    if (!load(request, loaded)) return nullptr;
    const uint64_t sizeBytes = decodedBytes(loaded);
    std::vector<PageId> evicted;
    if (!hostLru_.makeRoom(sizeBytes, evicted)) return &loaded;
    for (const PageId& page : evicted) decoded_.erase(page);
    hostLru_.insert(request.id, sizeBytes, frameIndex_);
    return &decoded_.emplace(request.id, std::move(loaded)).first->second;
}

bool Residency::load(const PageRequest& request, ooc::Page& loaded) {
    if (turnedAway_ && turnedAway_->first == request.id) {
        loaded = std::move(turnedAway_->second);
        turnedAway_.reset();
        return true;
    }
    counters_.bytesRead += request.node.pageBytes;
    ooc::Loaded<ooc::Page> result = source_.loadPage(request.node);
    if (!result.value) {
        fail(request.id, std::move(result.fault));
        return false;
    }
    ++counters_.loadedPages;
    loaded = std::move(*result.value);
    return true;
}

PageState Residency::upload(PageId id, const ooc::Page& page) {
    const uint64_t sizeBytes = gpu_.sizeBytes(page);
    std::vector<PageId> evicted;
    if (!gpuLru_.makeRoom(sizeBytes, evicted)) return PageState::NoRoom;
    dropEvicted(evicted);
    GpuPages::Upload done = gpu_.upload(id, page);
    // Bytes are free but in gaps that are too short: joined by dropping more of the oldest.
    while (done == GpuPages::Upload::NoRoom && gpuLru_.evictOldest(evicted)) {
        dropEvicted(evicted);
        done = gpu_.upload(id, page);
    }
    if (done == GpuPages::Upload::NoRoom) return PageState::NoRoom;
    if (done == GpuPages::Upload::Refused)
        return fail(id, "page has more vertices than can be drawn");
    gpuLru_.insert(id, sizeBytes, frameIndex_);
    gpuLru_.pin(id);
    ++counters_.uploadedPages;
    counters_.bytesUploaded += sizeBytes;
    return PageState::Resident;
}

PageState Residency::fail(PageId id, std::string what) {
    failed_.insert(id);
    faults_.push_back({id, std::move(what)});
    ++counters_.failedPages;
    return PageState::Failed;
}

void Residency::dropEvicted(std::vector<PageId>& evicted) {
    for (const PageId& page : evicted) gpu_.drop(page);
    counters_.evictedPages += evicted.size();
    evicted.clear();
}

}  // namespace pagoda::cache
