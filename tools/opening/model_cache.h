// model_cache.h: databases that `view` made of raw models, kept in one folder and found again by
// what the model holds, wherever it lies and whatever it is called.
//   FOLDER/KEY.pagoda       the database; KEY: of the model's bytes and what the result depends on
//   FOLDER/KEY.json         the other files that it was made from, with their hashes; its time of
//                           change is when the database was last opened
//   FOLDER/known/PLACE.json the key of a file that was hashed, by its path, with size, times and
//                           inode: so long as these stay, its bytes are not read again (as git
//                           does)
//   FOLDER/building/        databases that are being written
// Everything appears by rename: several processes may use one folder. An open database may be
// removed under its readers. Small enough to be looked at by hand, and safe to delete.
#pragma once

#include "hlod/build/inputs.h"
#include "ooc/base/progress.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace pagoda::tools {

// $XDG_CACHE_HOME/pagoda, else $HOME/.cache/pagoda, else a folder of this user's among the
// temporary files.
[[nodiscard]] std::filesystem::path defaultCacheFolder();

[[nodiscard]] int64_t systemNs();

class ModelCache {
public:
    struct Options {
        std::filesystem::path folder;
        uint64_t mostBytes = uint64_t{16} << 30;  // of all databases; the least recently opened go
        std::string settings;                     // all else that the bytes of a database depend on
        // Nanoseconds of the clock that file times are of.
        std::function<int64_t()> nowNs = systemNs;
    };
    // Makes the folder. Throws Error where it cannot be made or written.
    explicit ModelCache(Options options);

    // The database of `inputs`, if it is here and nothing of what it was made from has changed.
    // Reads whole files that it does not know (progress in bytes, stage "look in the cache").
    [[nodiscard]] std::optional<std::filesystem::path> find(
        const std::vector<hlod::InputSpec>& inputs, Progress& progress);
    // The same, but nothing where files would have to be read. Quick.
    [[nodiscard]] std::optional<std::filesystem::path> findKnown(
        const std::vector<hlod::InputSpec>& inputs);

    // After find() found nothing. Where the database is to be built, replacing what is there.
    [[nodiscard]] std::filesystem::path buildTarget() const;
    // Takes the database that was built there in; returns where it is from now on. Throws Error,
    // and removes it, when an input or companion has changed since find(). Removes the least
    // recently opened ones beyond `mostBytes`, never this one; appends a line for each to `notes`.
    [[nodiscard]] std::filesystem::path take(const std::vector<std::filesystem::path>& companions,
                                             Progress& progress, std::vector<std::string>& notes);

private:
    // What tells that a file is the same as before without reading it.
    struct Stamp {
        uint64_t sizeBytes = 0, inode = 0;
        int64_t modifiedNs = 0, changedNs = 0;
        [[nodiscard]] bool operator==(const Stamp&) const = default;
    };
    struct Source {
        std::filesystem::path path;
        Stamp stamp;
        uint64_t hash = 0;
    };
    [[nodiscard]] static std::optional<Stamp> stampOf(const std::filesystem::path& path);
    // Nothing: not an entry of known/.
    [[nodiscard]] static std::optional<Stamp> rememberedStamp(const nlohmann::json& entry);
    [[nodiscard]] std::filesystem::path knownPath(const std::filesystem::path& path) const;
    [[nodiscard]] std::optional<uint64_t> knownHash(const Source& source) const;
    void remember(const Source& source) const;
    [[nodiscard]] uint64_t hashOf(const Source& source, Progress& progress) const;
    [[nodiscard]] std::string keyOf(const std::vector<hlod::InputSpec>& inputs) const;
    [[nodiscard]] std::filesystem::path databaseOf(const std::string& key) const;
    // Without `progress` nothing is read: what is not known counts as changed.
    [[nodiscard]] std::optional<std::filesystem::path> lookUp(Progress* progress);
    [[nodiscard]] bool areCompanionsSame(const nlohmann::json& made, Progress* progress) const;
    [[nodiscard]] std::filesystem::path moveIn(const std::vector<std::filesystem::path>& companions,
                                               Progress& progress, std::vector<std::string>& notes);
    void writeEntry(const std::vector<std::filesystem::path>& companions, Progress& progress) const;
    void trim(std::vector<std::string>& notes) const;
    void forgetChanged() const;
    void removeAbandoned() const;

    Options options_;
    std::vector<Source> sources_;  // of the last find()
    std::string key_;              // of them
    int64_t foundNs_ = 0;          // when find() had ended, by the system's clock
};

}  // namespace pagoda::tools
