#include "ooc/readers/stl_reader.h"

#include "ooc/base/error.h"

namespace pagoda::ooc {

std::unique_ptr<Reader> openStlReader(const std::filesystem::path& path, const ReaderOptions&) {
    throw Error(path.string(), "", "not read yet", "");
}

}  // namespace pagoda::ooc
