#include "cache/page_source.h"

#include "ooc/base/error.h"

namespace pagoda::cache {

std::string DatabaseSource::read(uint64_t offset, std::span<std::byte> out) const {
    try {
        database_.file().readAt(offset, out);
        return {};
    } catch (const Error& error) {
        return error.place() + ": " + error.problem();
    }
}

}  // namespace pagoda::cache
