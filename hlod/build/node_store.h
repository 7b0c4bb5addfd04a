// node_store.h: finished nodes while the tree is being built: records in memory, pages in scratch.
// Any thread may add and read. The order of adding does not matter: sorted() gives the file's
// order.
#pragma once

#include "hlod/build/soup.h"
#include "ooc/base/file.h"
#include "ooc/codecs/page_codec.h"
#include "ooc/store/records.h"

#include <filesystem>
#include <mutex>
#include <span>
#include <unordered_map>
#include <vector>

namespace pagoda::hlod {

class NodeStore {
public:
    NodeStore(const std::filesystem::path& scratchFolder, ooc::Codec codec);

    // Encodes and keeps a node. `record` holds id, childMask, error, subtreeTriangles, sloppy and
    // stuck flags, and the box of all below it; box, counts, flags and page fields are completed
    // from `mesh`.
    ooc::NodeRecord add(ooc::NodeRecord record, ooc::PageMesh mesh);

    // Keeps what a clustered node's parent clusters from (SimplifyResult::proxy).
    void addProxy(ooc::NodeId id, std::span<const SoupTriangle> proxy);
    [[nodiscard]] std::vector<SoupTriangle> readProxy(ooc::NodeId id) const;  // empty: none

    [[nodiscard]] ooc::NodeRecord find(ooc::NodeId id) const;  // must be there
    [[nodiscard]] bool contains(ooc::NodeId id) const;
    [[nodiscard]] ooc::PageMesh readMesh(const ooc::NodeRecord& record) const;
    [[nodiscard]] std::vector<std::byte> readPage(const ooc::NodeRecord& record) const;

    // Root first, level by level, the children of each node side by side (octants, then extra
    // leaves).
    [[nodiscard]] std::vector<ooc::NodeRecord> inFileOrder() const;
    [[nodiscard]] uint64_t pageBytes() const;

private:
    ooc::Codec codec_;
    mutable std::mutex nodesMutex_;  // guards nodes_, proxyRanges_ and both byte counts
    std::unordered_map<uint64_t, ooc::NodeRecord> nodes_;
    uint64_t pageBytes_ = 0;
    File pages_;
    struct Range {
        uint64_t offset = 0, count = 0;
    };
    std::unordered_map<uint64_t, Range> proxyRanges_;  // by node, in proxies_
    uint64_t proxyBytes_ = 0;
    File proxies_;
};

}  // namespace pagoda::hlod
