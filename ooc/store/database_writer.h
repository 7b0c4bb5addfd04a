// database_writer.h: writes one database beside its target and publishes it whole.
// Order of calls: addPage() for every node in file order, then publish() once. Until publish()
// ends, nothing exists under the target's name; a writer destroyed before that leaves nothing
// behind. One thread. docs/build.md, step 10.
#pragma once

#include "ooc/base/file.h"
#include "ooc/store/records.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace pagoda::ooc {

class DatabaseWriter {
public:
    // Throws Error when `target` exists and not `force`, or cannot be written.
    // `expectedPageBytes` are reserved on disk at once.
    DatabaseWriter(std::filesystem::path target, bool force, uint64_t expectedPageBytes);
    ~DatabaseWriter();
    DatabaseWriter(const DatabaseWriter&) = delete;
    DatabaseWriter& operator=(const DatabaseWriter&) = delete;

    // Appends one node's page; returns its offset in the file.
    uint64_t addPage(std::span<const std::byte> page);

    struct Content {
        Header header;                  // fileBytes and counts of tables are filled in here
        std::vector<NodeRecord> nodes;  // root first; the children of a node side by side, octants
                                        // first, then extra leaves; childBlock and childIndex are
                                        // filled in here
        std::vector<ObjectRecord> objects;
        std::vector<MaterialRecord> materials;
        std::string metadataJson;  // UTF-8
    };
    // Writes index, tables, metadata and footer, syncs and renames. Returns the file's size.
    uint64_t publish(Content content);

private:
    std::filesystem::path target_, temporary_;
    bool force_ = false;
    bool isPublished_ = false;
    File file_;
};

// What an earlier build that was killed left beside `target` (temporary files of this writer), to
// be said and removed.
[[nodiscard]] std::vector<std::filesystem::path> findLeftovers(const std::filesystem::path& target);

}  // namespace pagoda::ooc
