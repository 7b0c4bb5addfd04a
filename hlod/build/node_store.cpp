#include "hlod/build/node_store.h"

#include "ooc/base/error.h"

#include <utility>

namespace pagoda::hlod {

NodeStore::NodeStore(const std::filesystem::path& scratchFolder, ooc::Codec codec)
    : codec_(codec),
      pages_(File::createScratch(scratchFolder)),
      proxies_(File::createScratch(scratchFolder)) {
}

ooc::NodeRecord NodeStore::add(ooc::NodeRecord record, ooc::PageMesh mesh) {
    record.box.extend(mesh.box());
    record.triangleCount = mesh.triangleCount();
    record.opaqueTriangleCount = mesh.opaqueTriangleCount();
    record.vertexCount = mesh.vertexCount();
    const auto flag = [&](bool isSet, ooc::NodeFlags bit) {
        if (isSet) record.flags = static_cast<uint16_t>(record.flags | bit);
    };
    flag(!mesh.colours.empty(), ooc::kNodeHasColours);
    flag(!mesh.normals.empty(), ooc::kNodeHasNormals);
    flag(mesh.opaqueTriangleCount() < mesh.triangleCount(), ooc::kNodeHasTranslucent);

    const std::vector<std::byte> bytes =
        encodePage({.mesh = std::move(mesh), .zippers = {}}, codec_);
    record.pageBytes = static_cast<uint32_t>(bytes.size());
    record.pageChecksum = hash64(bytes);
    {
        const std::scoped_lock lock(nodesMutex_);
        record.pageOffset = pageBytes_;
        pageBytes_ += bytes.size();
    }
    pages_.writeAt(record.pageOffset, bytes);
    const std::scoped_lock lock(nodesMutex_);
    nodes_.emplace(record.id.value, record);
    return record;
}

void NodeStore::addProxy(ooc::NodeId id, std::span<const SoupTriangle> proxy) {
    Range range{.offset = 0, .count = proxy.size()};
    {
        const std::scoped_lock lock(nodesMutex_);
        range.offset = proxyBytes_;
        proxyBytes_ += proxy.size_bytes();
        proxyRanges_.emplace(id.value, range);
    }
    proxies_.writeAt(range.offset, std::as_bytes(proxy));
}

std::vector<SoupTriangle> NodeStore::readProxy(ooc::NodeId id) const {
    Range range;
    {
        const std::scoped_lock lock(nodesMutex_);
        const auto found = proxyRanges_.find(id.value);
        if (found == proxyRanges_.end()) return {};
        range = found->second;
    }
    std::vector<SoupTriangle> proxy(range.count);
    proxies_.readAt(range.offset, std::as_writable_bytes(std::span(proxy)));
    return proxy;
}

ooc::NodeRecord NodeStore::find(ooc::NodeId id) const {
    const std::scoped_lock lock(nodesMutex_);
    return nodes_.at(id.value);
}

bool NodeStore::contains(ooc::NodeId id) const {
    const std::scoped_lock lock(nodesMutex_);
    return nodes_.contains(id.value);
}

std::vector<std::byte> NodeStore::readPage(const ooc::NodeRecord& record) const {
    std::vector<std::byte> bytes(record.pageBytes);
    pages_.readAt(record.pageOffset, bytes);
    if (hash64(bytes) != record.pageChecksum) {
        throw Error(pages_.path(), "byte " + std::to_string(record.pageOffset),
                    "scratch does not hold what was written", "check the disk");
    }
    return bytes;
}

ooc::PageMesh NodeStore::readMesh(const ooc::NodeRecord& record) const {
    ooc::DecodeResult result = ooc::decodePage(readPage(record));
    if (!result.page) throw std::logic_error("a page of our own does not decode: " + result.fault);
    return std::move(result.page->mesh);
}

std::vector<ooc::NodeRecord> NodeStore::inFileOrder() const {
    const std::scoped_lock lock(nodesMutex_);
    std::vector<ooc::NodeRecord> order = {nodes_.at(ooc::NodeId::root().value)};
    order.reserve(nodes_.size());
    for (size_t i = 0; i < order.size(); ++i) {
        const ooc::NodeRecord parent = order[i];
        for (uint32_t octant = 0; octant < 8; ++octant) {
            if (parent.childMask & (1u << octant))
                order.push_back(nodes_.at(parent.id.child(octant).value));
        }
        for (uint32_t slot = 1; slot <= parent.extraLeafCount(); ++slot) {
            order.push_back(nodes_.at(parent.id.extra(slot).value));
        }
    }
    return order;
}

uint64_t NodeStore::pageBytes() const {
    const std::scoped_lock lock(nodesMutex_);
    return pageBytes_;
}

}  // namespace pagoda::hlod
