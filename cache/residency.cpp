#include "cache/residency.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace pagoda::cache {
namespace {

// What was used in this many frames before the current one is not evicted for something else.
constexpr uint64_t kKeptFrames = 2;

template <typename T>
uint64_t bytesOf(const std::vector<T>& items) {
    return items.size() * sizeof(T);
}

RequestKey keyOf(PageId id) {
    return {id.database, false, id.node.value};
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

uint64_t decodedBytes(const ooc::NodeRecord& node) {
    const uint64_t vertexBytes =
        sizeof(Vec3i) + ((node.flags & ooc::kNodeHasColours) != 0 ? sizeof(uint32_t) : 0) +
        ((node.flags & ooc::kNodeHasNormals) != 0 ? sizeof(ooc::OctNormal) : 0);
    // Runs are as long in the page as in memory, so that its bytes bound theirs.
    uint64_t bytes = sizeof(ooc::Page) + node.vertexCount * vertexBytes +
                     3 * sizeof(uint32_t) * uint64_t{node.triangleCount} + node.pageBytes;
    if ((node.flags & ooc::kNodeHasZippers) != 0) bytes += 4 * uint64_t{node.pageBytes};
    return bytes;
}

Residency::Residency(Budgets budgets, RequestQueue& requests, GpuPages& gpu)
    : requests_(requests),
      gpu_(gpu),
      uploadBytesPerFrame_(budgets.uploadBytesPerFrame),
      hostLru_(budgets.hostBytes),
      gpuLru_(budgets.gpuBytes) {
}

Residency::~Residency() {
    dropAll();
}

void Residency::dropAll() {
    gpuLru_.unpinAll();
    std::vector<PageId> evicted;
    while (gpuLru_.evictOldest(evicted)) {
    }
    for (const PageId& page : evicted) gpu_.drop(page);
}

uint64_t Residency::keepSinceFrame() const {
    return frameIndex_ > kKeptFrames ? frameIndex_ - kKeptFrames : 0;
}

void Residency::beginFrame(uint64_t frameIndex) {
    frameIndex_ = frameIndex;
    gpuLru_.unpinAll();
    demandBytes_ = missingPages_ = 0;
    demanded_.clear();
    upload(uploadBytesPerFrame_ > 0 ? uploadBytesPerFrame_ : std::numeric_limits<uint64_t>::max());
}

void Residency::uploadArrived() {
    upload(std::numeric_limits<uint64_t>::max());
}

void Residency::upload(uint64_t boundBytes) {
    struct Candidate {
        double priority;
        PageId id;
    };
    std::vector<Candidate> candidates;
    for (auto entry = waiting_.begin(); entry != waiting_.end();) {
        if (entry->second.frame + kKeptFrames < frameIndex_ || !decoded_.contains(entry->first)) {
            entry =
                waiting_.erase(entry);  // wanted no more: stays in host memory while there is room
        } else {
            candidates.push_back({entry->second.priority, entry->first});
            ++entry;
        }
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return a.priority != b.priority ? a.priority > b.priority : a.id < b.id;
    });
    uint64_t uploadedBytes = 0;
    waitingBytes_ = 0;
    bool isFull = false;
    for (const Candidate& candidate : candidates) {
        const ooc::Page& page = decoded_.at(candidate.id);
        const uint64_t sizeBytes = gpu_.sizeBytes(page);
        const uint64_t leftBytes = boundBytes - std::min(boundBytes, uploadedBytes);
        // Once one does not fit, none behind it goes: the best must not starve.
        isFull = isFull || (uploadedBytes > 0 && sizeBytes > leftBytes) ||
                 !uploadOne(candidate.id, page);
        (isFull ? waitingBytes_ : uploadedBytes) += sizeBytes;
    }
}

// False when there is no room for it yet.
bool Residency::uploadOne(PageId id, const ooc::Page& page) {
    const uint64_t sizeBytes = gpu_.sizeBytes(page);
    std::vector<PageId> evicted;
    if (!gpuLru_.makeRoom(sizeBytes, evicted, keepSinceFrame())) return false;
    dropEvicted(evicted);
    GpuPages::Upload done = gpu_.upload(id, page);
    while (done == GpuPages::Upload::NoRoom && gpuLru_.evictOldest(evicted, keepSinceFrame())) {
        dropEvicted(evicted);
        done = gpu_.upload(id, page);
    }
    if (done == GpuPages::Upload::NoRoom) return false;
    waiting_.erase(id);
    if (done == GpuPages::Upload::Refused) {
        fail(id, "page has more vertices than can be drawn");
        return true;
    }
    gpuLru_.insert(id, sizeBytes, frameIndex_);
    ++counters_.uploadedPages;
    counters_.bytesUploaded += sizeBytes;
    return true;
}

PageState Residency::want(const PageRequest& request, bool isStandIn) {
    const PageId id = request.id;
    if (const auto found = prefetched_.find(id); found != prefetched_.end()) {
        counters_.usedPrefetchedBytes += found->second;
        prefetched_.erase(found);
    }
    if (gpuLru_.contains(id)) {
        gpuLru_.touch(id, frameIndex_);
        gpuLru_.pin(id);
        demand(id, gpuLru_.sizeBytes(id), isStandIn);
        return PageState::Resident;
    }
    if (failed_.contains(id)) return PageState::Failed;
    bool isFirst = false;
    if (decoded_.contains(id)) {
        hostLru_.touch(id, frameIndex_);
        Wanted& wanted = waiting_[id];
        isFirst = wanted.frame != frameIndex_;
        wanted.priority = isFirst ? request.priority : std::max(wanted.priority, request.priority);
        wanted.frame = frameIndex_;
    } else {
        isFirst = requests_.ask(
            {keyOf(id), pageRange(request.node), request.priority, false, request.node});
    }
    if (isFirst) ++missingPages_;
    demand(id, gpu_.sizeBytes(request.node), isStandIn);
    return PageState::Absent;
}

void Residency::demand(PageId id, uint64_t sizeBytes, bool isStandIn) {
    if (!isStandIn && demanded_.insert(id).second) demandBytes_ += sizeBytes;
}

void Residency::keep(PageId page) {
    if (gpuLru_.contains(page)) gpuLru_.refresh(page, keepSinceFrame());
}

void Residency::prefetch(const PageRequest& request) {
    if (gpuLru_.contains(request.id) || decoded_.contains(request.id) ||
        failed_.contains(request.id)) {
        return;
    }
    requests_.ask(
        {keyOf(request.id), pageRange(request.node), request.priority, true, request.node});
}

bool Residency::admit(const Request& request) {
    const uint64_t gpuBytes = gpu_.sizeBytes(request.node);
    const uint64_t hostBytes = request.range.bytes + decodedBytes(request.node);
    if (gpuBytes > gpuLru_.budgetBytes() || hostBytes > hostLru_.budgetBytes()) {
        fail({request.key.database, request.node.id}, "page is larger than a memory budget");
        return false;
    }
    if (!gpuLru_.hasRoom(gpuBytes + onTheirWayBytes_ + waitingBytes_, keepSinceFrame()))
        return false;
    std::vector<PageId> evicted;
    // Decoded pages that wait to be uploaded were touched lately; the others are copies.
    if (!hostLru_.makeRoom(hostBytes, evicted, frameIndex_)) return false;
    for (const PageId& page : evicted) decoded_.erase(page);
    hostLru_.reserve(hostBytes);
    reserved_[request.key] = hostBytes;
    onTheirWayBytes_ += gpuBytes;
    return true;
}

void Residency::arrive(RequestQueue::Arrival& arrival) {
    const Request& request = arrival.request;
    const PageId id{request.key.database, request.node.id};
    const auto reservation = reserved_.find(request.key);
    hostLru_.release(reservation->second);
    reserved_.erase(reservation);
    onTheirWayBytes_ -= gpu_.sizeBytes(request.node);
    if (!arrival.result.page) {
        if (!arrival.result.fault.empty()) fail(id, std::move(arrival.result.fault));
        return;
    }
    counters_.bytesRead += request.range.bytes;
    ++counters_.loadedPages;
    if (!everLoaded_.insert(id).second) {
        ++counters_.reloadedPages;
        counters_.bytesReloaded += request.range.bytes;
    }
    if (request.isPrefetch) {
        counters_.prefetchedBytes += request.range.bytes;
        prefetched_[id] = request.range.bytes;
    }
    const uint64_t sizeBytes = decodedBytes(*arrival.result.page);
    std::vector<PageId> evicted;
    if (!hostLru_.makeRoom(sizeBytes, evicted)) return;  // strips longer than foretold: asked again
    for (const PageId& page : evicted) decoded_.erase(page);
    hostLru_.insert(id, sizeBytes, frameIndex_);
    decoded_.emplace(id, std::move(*arrival.result.page));
    waitingBytes_ += gpu_.sizeBytes(request.node);
    waiting_[id] = {frameIndex_, request.isPrefetch ? -1.0 : request.priority};
}

void Residency::fail(PageId id, std::string what) {
    if (!failed_.insert(id).second) return;
    faults_.push_back({id, std::move(what)});
    ++counters_.failedPages;
}

void Residency::dropEvicted(std::vector<PageId>& evicted) {
    for (const PageId& page : evicted) gpu_.drop(page);
    counters_.evictedPages += evicted.size();
    evicted.clear();
}

}  // namespace pagoda::cache
