// gltf_files.h: the files beside a glTF document that its URIs name.
#pragma once

#include "ooc/readers/gltf_document.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pagoda::ooc::gltf {

// "%20" and the like as the bytes they stand for.
[[nodiscard]] std::string percentDecoded(const std::string& uri);

// Where the file lies that `uri` names by a path relative to the model's folder. Nothing for what
// names none: an absolute path, another scheme.
[[nodiscard]] std::optional<std::filesystem::path> pathBeside(const SourceFile& source,
                                                              const std::string& uri);

// The files that the document's buffers and images name: sorted, none twice, there or not.
[[nodiscard]] std::vector<std::filesystem::path> filesBeside(const SourceFile& source,
                                                             const Document& document);

}  // namespace pagoda::ooc::gltf
