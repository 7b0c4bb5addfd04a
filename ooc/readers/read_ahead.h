// read_ahead.h: asks the system to bring a file into its page cache, in order and at once, for who
// is about to read from all over it: one by one, such reads cost a disk's latency each.
#pragma once

#include "ooc/base/file.h"

#include <fcntl.h>

#include <algorithm>

namespace pagoda::ooc {

// Of a large file the beginning: the rest of the cache belongs to others. Waits for no data, but
// for room in the disk's queue where that is full: not for a thread that draws.
inline void readAhead(const File& file) {
    constexpr uint64_t kMostBytes = uint64_t{1} << 30;
    (void)::posix_fadvise(file.descriptor(), 0,
                          static_cast<off_t>(std::min(file.sizeBytes(), kMostBytes)),
                          POSIX_FADV_WILLNEED);  // advice: what it answers does not matter
}

}  // namespace pagoda::ooc
