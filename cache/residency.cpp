#include "cache/residency.h"

#include "cache/kept_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

namespace pagoda::cache {
namespace {

template <typename T>
uint64_t bytesOf(const std::vector<T>& items) {
    return items.size() * sizeof(T);
}

std::string tooLarge(uint64_t bytes, const char* memory, uint64_t budgetBytes) {
    return fmt::format("page takes {} bytes of {} memory, more than the whole budget of {}", bytes,
                       memory, budgetBytes);
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
    dropFromGpu(evicted);
}

uint64_t Residency::evictBeforeFrame(bool isPrefetch) const {
    return isPrefetch ? spareFrame(frameIndex_) : keepSinceFrame(frameIndex_);
}

void Residency::beginFrame(uint64_t frameIndex, double nowS) {
    frameIndex_ = frameIndex;
    nowS_ = nowS;
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
        bool isPrefetch;
        double priority;
        PageId id;
    };
    // What nobody wants any more stays in host memory while there is room.
    std::erase_if(waiting_, [&](const auto& item) {
        return item.second.frame + kKeptFrames < frameIndex_ || !decoded_.contains(item.first);
    });
    std::vector<Candidate> candidates;
    for (const auto& [id, wanted] : waiting_) {
        candidates.push_back({prefetched_.contains(id), wanted.priority, id});
    }
    std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        if (a.isPrefetch != b.isPrefetch) return b.isPrefetch;
        return a.priority != b.priority ? a.priority > b.priority : a.id < b.id;
    });
    const uint64_t bytesBefore = counters_.bytesUploaded;
    toUpload_ = {};
    bool isFull = false;
    for (const Candidate& candidate : candidates) {
        const ooc::Page& page = decoded_.at(candidate.id);
        const uint64_t sizeBytes = gpu_.sizeBytes(page);
        const uint64_t doneBytes = counters_.bytesUploaded - bytesBefore;
        const uint64_t leftBytes = boundBytes - std::min(boundBytes, doneBytes);
        // Once one does not fit, none behind it goes: the best must not starve.
        isFull =
            isFull || (doneBytes > 0 && sizeBytes > leftBytes) || !uploadOne(candidate.id, page);
        if (isFull) toUpload_.of(candidate.isPrefetch) += sizeBytes;
    }
}

// False when there is no room for it yet.
bool Residency::uploadOne(PageId id, const ooc::Page& page) {
    const uint64_t sizeBytes = gpu_.sizeBytes(page);
    const bool isPrefetch = prefetched_.contains(id);
    const uint64_t before = evictBeforeFrame(isPrefetch);
    std::vector<PageId> evicted;
    if (sizeBytes > gpuLru_.budgetBytes()) {  // longer than its record foretold
        fail(id, tooLarge(sizeBytes, "GPU", gpuLru_.budgetBytes()));
        return true;
    }
    if (!gpuLru_.makeRoom(sizeBytes, evicted, before)) return false;
    GpuPages::Upload done = GpuPages::Upload::NoRoom;
    do {
        counters_.evictedPages += evicted.size();
        for (const PageId& gone : evicted) history_.noteEvicted(gone, id, frameIndex_);
        dropFromGpu(evicted);
        done = gpu_.upload(id, page);
    } while (done == GpuPages::Upload::NoRoom && gpuLru_.evictOldest(evicted, before));
    if (done == GpuPages::Upload::NoRoom) {
        if (gpuLru_.pageCount() > 0) return false;
        fail(id, tooLarge(sizeBytes, "GPU", gpuLru_.budgetBytes()));  // gaps are shorter than that
        return true;
    }
    waiting_.erase(id);
    if (done == GpuPages::Upload::Refused) {
        fail(id, "page has more vertices than can be drawn");
        return true;
    }
    // Prefetched, it is as old as what is kept, so that it is never in the way.
    gpuLru_.insert(id, sizeBytes, isPrefetch ? spareFrame(frameIndex_) : frameIndex_);
    history_.noteUploaded(id, frameIndex_);
    ++counters_.uploadedPages;
    counters_.bytesUploaded += sizeBytes;
    return true;
}

PageState Residency::want(const PageRequest& request, bool isStandIn) {
    const PageId id = request.id;
    if (!prefetched_.empty()) {
        if (const auto found = prefetched_.find(id); found != prefetched_.end()) {
            counters_.prefetch[found->second.reason].usedBytes += found->second.bytes;
            prefetched_.erase(found);
        }
    }
    if (const auto used = gpuLru_.use(id, frameIndex_, !isStandIn, request.slot)) {
        if (used->isNewDemand) demandBytes_ += used->sizeBytes;
        return PageState::Resident;
    }
    if (failed_.contains(id) || !couldFit(request)) return PageState::Failed;
    bool isFirst = false;
    if (decoded_.contains(id)) {
        hostLru_.touch(id, frameIndex_);
        const auto [found, isNew] = waiting_.try_emplace(id);
        if (isNew) toUpload_.wantedBytes += gpu_.sizeBytes(request.node);
        Wanted& wanted = found->second;
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

void Residency::keep(PageId page, uint32_t slot) {
    gpuLru_.refresh(page, keepSinceFrame(frameIndex_), slot);
}

void Residency::prefetch(const PageRequest& request, uint8_t reason) {
    assert(reason < kPrefetchReasons);
    if (gpuLru_.contains(request.id) || decoded_.contains(request.id) ||
        failed_.contains(request.id) || !couldFit(request)) {
        return;
    }
    requests_.ask(
        {keyOf(request.id), pageRange(request.node), request.priority, true, request.node, reason});
}

// Fails it when it never can.
bool Residency::couldFit(const PageRequest& request) {
    const uint64_t gpuBytes = gpu_.sizeBytes(request.node);
    const uint64_t hostBytes = request.node.pageBytes + decodedBytes(request.node);
    if (gpuBytes > gpuLru_.budgetBytes()) {
        fail(request.id, tooLarge(gpuBytes, "GPU", gpuLru_.budgetBytes()));
    } else if (hostBytes > hostLru_.budgetBytes()) {
        fail(request.id, tooLarge(hostBytes, "host", hostLru_.budgetBytes()));
    } else {
        return true;
    }
    return false;
}

bool Residency::admit(const Request& request) {
    const uint64_t gpuBytes = gpu_.sizeBytes(request.node);
    uint64_t comingBytes = gpuBytes + sent_.wantedBytes + toUpload_.wantedBytes;
    if (request.isPrefetch) comingBytes += sent_.prefetchedBytes + toUpload_.prefetchedBytes;
    if (!gpuLru_.hasRoom(comingBytes, evictBeforeFrame(request.isPrefetch))) return false;
    const uint64_t hostBytes = request.range.bytes + decodedBytes(request.node);
    std::vector<PageId> evicted;
    // Decoded pages that wait to be uploaded were touched lately; the others are copies.
    if (!hostLru_.makeRoom(hostBytes, evicted, frameIndex_)) return false;
    dropFromHost(evicted);
    hostLru_.reserve(hostBytes);
    reserved_[request.key] = {hostBytes, gpuBytes, request.isPrefetch};
    sent_.of(request.isPrefetch) += gpuBytes;
    return true;
}

void Residency::arrive(RequestQueue::Arrival& arrival) {
    const Request& request = arrival.request;
    const PageId id{request.key.database, request.node.id};
    const auto found = reserved_.find(request.key);
    const Reservation reservation = found->second;
    reserved_.erase(found);
    hostLru_.release(reservation.hostBytes);
    sent_.of(reservation.isPrefetch) -= reservation.gpuBytes;
    if (!arrival.result.page) {
        if (!arrival.result.fault.empty()) fail(id, std::move(arrival.result.fault));
        return;
    }
    count(request, arrival.result);
    const uint64_t sizeBytes = decodedBytes(*arrival.result.page);
    if (sizeBytes > hostLru_.budgetBytes()) {  // longer than its record foretold
        fail(id, tooLarge(sizeBytes, "host", hostLru_.budgetBytes()));
        return;
    }
    std::vector<PageId> evicted;
    if (!hostLru_.makeRoom(sizeBytes, evicted)) return;  // strips longer than foretold: asked again
    dropFromHost(evicted);
    hostLru_.insert(id, sizeBytes, frameIndex_);
    decoded_.emplace(id, std::move(*arrival.result.page));
    if (request.isPrefetch) prefetched_[id] = {request.range.bytes, request.reason};
    toUpload_.of(request.isPrefetch) += reservation.gpuBytes;
    const uint64_t askedFrame = frameIndex_ - std::min(frameIndex_, arrival.framesSinceAsked);
    waiting_[id] = {askedFrame, request.priority};
}

void Residency::count(const Request& request, const LoadResult& result) {
    const PageId id{request.key.database, request.node.id};
    counters_.bytesRead += request.range.bytes;
    ++counters_.loadedPages;
    if (!everLoaded_.insert(id).second) {
        ++counters_.reloadedPages;
        counters_.bytesReloaded += request.range.bytes;
    }
    if (request.isPrefetch) counters_.prefetch[request.reason].bytes += request.range.bytes;
    history_.noteRead(id, frameIndex_, nowS_);
    CodecSums& sums = codecs_[static_cast<size_t>(result.codec)];
    ++sums.pages;
    sums.triangles += result.page->mesh.triangleCount();
    sums.vertices += result.page->mesh.vertexCount();
    sums.encodedBytes += request.range.bytes;
    sums.decodedBytes += decodedBytes(*result.page);
    sums.decodeS += result.decodeS;
}

void Residency::fail(PageId id, std::string what) {
    waiting_.erase(id);
    if (!failed_.insert(id).second) return;
    faults_.push_back({id, std::move(what)});
    ++counters_.failedPages;
}

void Residency::dropFromGpu(std::vector<PageId>& evicted) {
    for (const PageId& page : evicted) {
        gpu_.drop(page);
        if (!decoded_.contains(page)) prefetched_.erase(page);
    }
    evicted.clear();
}

void Residency::dropFromHost(std::vector<PageId>& evicted) {
    for (const PageId& page : evicted) {
        decoded_.erase(page);
        if (!gpuLru_.contains(page)) prefetched_.erase(page);
    }
    evicted.clear();
}

}  // namespace pagoda::cache
