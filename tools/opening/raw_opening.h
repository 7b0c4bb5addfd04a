// raw_opening.h: a raw model on its way into the window: what viewer/window/model_opening.h asks.
// One worker thread, in order:
//   1. a model that the cache knows unread is done at once;
//   2. a sample from all over the file makes the first picture, where the format allows it
//      (binary PLY, binary STL); others show what the first reading of the build has met so far;
//   3. the file is hashed and looked for in the cache;
//   4. the build, whose own threads inherit a low priority: the hand at the window comes first.
#pragma once

#include "tools/opening/model_cache.h"
#include "viewer/window/model_opening.h"

#include <memory>

namespace pagoda::tools {

struct RawOpenerOptions {
    ModelCache::Options cache;
    uint64_t memoryBytes = uint64_t{1} << 30;  // of the build and the pictures of it together
    uint32_t threads = 0;                      // of the build; 0: as many as the machine has
};

class RawOpener final : public viewer::ModelOpener {
public:
    explicit RawOpener(RawOpenerOptions options) : options_(std::move(options)) {}
    // `model` as `build` takes inputs: with @up=..., a folder, a glob.
    [[nodiscard]] std::unique_ptr<viewer::Opening> open(
        const std::filesystem::path& model) override;

private:
    RawOpenerOptions options_;
};

}  // namespace pagoda::tools
