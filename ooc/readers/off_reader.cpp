#include "ooc/readers/off_reader.h"

#include "ooc/base/error.h"

namespace pagoda::ooc {

std::unique_ptr<Reader> openOffReader(const std::filesystem::path& path, const ReaderOptions&) {
    throw Error(path.string(), "", "not read yet", "");
}

}  // namespace pagoda::ooc
