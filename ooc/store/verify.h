// verify.h: is a database sound, to the last byte? What `pagoda verify` runs.
// Checks every byte (the parts tile the file, all checksums, header equals footer) and the
// structure: every page decodes and agrees with its record, boxes are tight and contain what is
// below, errors never shrink upwards, counts and the triangles' order-free sum are those that the
// builder announced. It does not measure errors again: that is `--deep`.
#pragma once

#include "ooc/base/progress.h"
#include "ooc/node_id.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pagoda::ooc {

// As faults name it: the octants from the root down, "node /0/5", "node /0/5 extra 2".
[[nodiscard]] std::string nodeName(NodeId id);

struct VerifyFault {
    std::string place;  // "index block 3", "node /0/5 (page at byte 1234)"
    std::string what;
};

struct VerifyReport {
    static constexpr size_t kMaxListed = 1000;

    std::vector<VerifyFault> faults;  // the first kMaxListed, in the order of the file's parts
    uint64_t faultCount = 0;
    uint64_t bytesChecked = 0, nodesChecked = 0, trianglesChecked = 0;  // triangles of the leaves

    [[nodiscard]] bool isSound() const { return faultCount == 0; }
    void add(std::string place, std::string what);
};

// Throws Error only when there is no such file or it cannot be read at all, and Interrupted. Totals
// are compared only where nothing below them is broken: one flipped bit is one fault, not five.
// Memory: a thousand pages' results and 32 bytes an object, whatever the size of the database.
[[nodiscard]] VerifyReport verifyDatabase(const std::filesystem::path& path, size_t threadCount,
                                          Progress& progress);

}  // namespace pagoda::ooc
