#include "tools/opening/model_cache.h"

#include "ooc/base/error.h"
#include "ooc/base/file.h"
#include "ooc/base/hash.h"
#include "ooc/base/number_text.h"
#include "ooc/store/database.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <system_error>

namespace pagoda::tools {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr size_t kHashBlockBytes = size_t{4} << 20;
constexpr uint64_t kMaxEntryBytes = uint64_t{16} << 20;
// A file that was written so lately could be written again at the same time, as its file system
// counts it: it is not remembered (git: racy entries).
constexpr int64_t kSettledNs = 2'000'000'000;
constexpr std::chrono::hours kAbandonedAfter{24};

int64_t nanoseconds(const timespec& time) {
    return int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

uint64_t hashOfText(const std::string& text) {
    return hash64(std::as_bytes(std::span(text)));
}

std::optional<std::string> environment(const char* name) {
    // Before any thread begins.
    const char* const value = std::getenv(name);                 // NOLINT(concurrency-mt-unsafe)
    if (value == nullptr || *value != '/') return std::nullopt;  // XDG: relative ones do not count
    return std::string(value);
}

// Nothing where it is not there or is not what was written: the cache does without.
std::optional<json> readJson(const fs::path& path) {
    std::error_code code;
    if (!fs::is_regular_file(path, code)) return std::nullopt;
    try {
        const std::vector<std::byte> bytes = readWholeFile(path, kMaxEntryBytes);
        json value =
            json::parse(reinterpret_cast<const char*>(bytes.data()),
                        reinterpret_cast<const char*>(bytes.data()) + bytes.size(), nullptr, false);
        if (value.is_object()) return value;
    } catch (const Error&) {  // removed meanwhile, or not ours
    }
    return std::nullopt;
}

// By rename, so that nobody reads half of it. False: it could not be written.
bool writeJson(const fs::path& path, const json& value) {
    const fs::path part = path.string() + fmt::format(".{}.part", ::getpid());
    const std::string text = value.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
    std::error_code code;
    fs::remove(part, code);
    try {
        File file = File::create(part);
        file.append(std::as_bytes(std::span(text)));
        file.close();
        fs::rename(part, path);
        return true;
    } catch (const std::runtime_error&) {  // Error, filesystem_error: a full disk
        fs::remove(part, code);
        return false;
    }
}

std::string placementText(const hlod::InputSpec& input) {
    std::string text = fmt::format("up={} unit={} move=", static_cast<int>(input.up), input.unit);
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) text += fmt::format("{},", input.transform[column][row]);
    }
    return text;
}

}  // namespace

int64_t systemNs() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
}

fs::path defaultCacheFolder() {
    if (const auto folder = environment("XDG_CACHE_HOME")) return fs::path(*folder) / "pagoda";
    if (const auto home = environment("HOME")) return fs::path(*home) / ".cache" / "pagoda";
    return fs::temp_directory_path() / fmt::format("pagoda-{}", ::getuid());
}

ModelCache::ModelCache(Options options) : options_(std::move(options)) {
    for (const char* part : {"known", "building"}) {
        std::error_code code;
        fs::create_directories(options_.folder / part, code);
        if (code || ::access((options_.folder / part).c_str(), W_OK | X_OK) != 0) {
            throw Error(options_.folder.string(), "", "models cannot be kept in this folder",
                        "name another one with --cache");
        }
    }
    removeAbandoned();
}

std::optional<ModelCache::Stamp> ModelCache::stampOf(const fs::path& path) {
    struct stat status {};
    // Folders cannot be read, and opening a pipe would wait for ever: as if there were nothing.
    if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
    // So is what may not be read.
    if (::faccessat(AT_FDCWD, path.c_str(), R_OK, AT_EACCESS) != 0) return std::nullopt;
    return Stamp{.sizeBytes = static_cast<uint64_t>(status.st_size),
                 .inode = static_cast<uint64_t>(status.st_ino),
                 .modifiedNs = nanoseconds(status.st_mtim),
                 .changedNs = nanoseconds(status.st_ctim)};
}

fs::path ModelCache::knownPath(const fs::path& path) const {
    return options_.folder / "known" /
           fmt::format("{:016x}.json", hashOfText(fs::absolute(path).lexically_normal().string()));
}

std::optional<ModelCache::Stamp> ModelCache::rememberedStamp(const json& entry) {
    try {
        return Stamp{.sizeBytes = entry.at("size").get<uint64_t>(),
                     .inode = entry.at("inode").get<uint64_t>(),
                     .modifiedNs = entry.at("modified_ns").get<int64_t>(),
                     .changedNs = entry.at("changed_ns").get<int64_t>()};
    } catch (const json::exception&) {  // someone else's
        return std::nullopt;
    }
}

std::optional<uint64_t> ModelCache::knownHash(const Source& source) const {
    const auto entry = readJson(knownPath(source.path));
    if (!entry) return std::nullopt;
    try {
        const bool isSame = rememberedStamp(*entry) == source.stamp &&
                            entry->value("path", std::string()) ==
                                fs::absolute(source.path).lexically_normal().string();
        if (isSame && entry->contains("hash")) return entry->at("hash").get<uint64_t>();
    } catch (const json::exception&) {  // someone else's
    }
    return std::nullopt;
}

void ModelCache::remember(const Source& source) const {
    if (source.stamp.changedNs > options_.nowNs() - kSettledNs) return;
    (void)writeJson(knownPath(source.path),
                    {{"path", fs::absolute(source.path).lexically_normal().string()},
                     {"size", source.stamp.sizeBytes},
                     {"inode", source.stamp.inode},
                     {"modified_ns", source.stamp.modifiedNs},
                     {"changed_ns", source.stamp.changedNs},
                     {"hash", source.hash}});
}

// Of the whole file; each block's hash is the next one's seed.
uint64_t ModelCache::hashOf(const Source& source, Progress& progress) const {
    const File file = File::openForReading(source.path);
    std::vector<std::byte> block(kHashBlockBytes);
    uint64_t hash = source.stamp.sizeBytes;
    for (uint64_t offset = 0;;) {
        const size_t got = file.readSomeAt(offset, block);
        if (got == 0) return hash;
        hash = hash64(std::span(block).first(got), hash);
        offset += got;
        progress.advance(got);
        progress.check();
    }
}

std::string ModelCache::keyOf(const std::vector<hlod::InputSpec>& inputs) const {
    std::string text = options_.settings + "\n";
    const fs::path folder = fs::absolute(inputs.front().path).parent_path();
    for (size_t i = 0; i < inputs.size(); ++i) {
        // Of several, their names are those of objects, and where they lie says whose companions
        // are whose. The ending says how a file is read.
        const fs::path name = inputs.size() > 1
                                  ? fs::absolute(inputs[i].path).lexically_relative(folder)
                                  : inputs[i].path.extension();
        text += fmt::format("{} {:016x} {} {}\n", sources_[i].stamp.sizeBytes, sources_[i].hash,
                            name.string(), placementText(inputs[i]));
    }
    return fmt::format("{:016x}{:016x}", hashOfText(text),
                       hash64(std::as_bytes(std::span(text)), 1));
}

fs::path ModelCache::databaseOf(const std::string& key) const {
    return options_.folder / (key + ".pagoda");
}

std::optional<fs::path> ModelCache::findKnown(const std::vector<hlod::InputSpec>& inputs) {
    sources_.clear();
    for (const hlod::InputSpec& input : inputs) {
        const auto stamp = stampOf(input.path);
        if (!stamp) return std::nullopt;
        Source source{.path = input.path, .stamp = *stamp};
        const auto hash = knownHash(source);
        if (!hash) return std::nullopt;
        source.hash = *hash;
        sources_.push_back(source);
    }
    key_ = keyOf(inputs);
    return lookUp(nullptr);
}

std::optional<fs::path> ModelCache::find(const std::vector<hlod::InputSpec>& inputs,
                                         Progress& progress) {
    sources_.clear();
    uint64_t bytes = 0;
    for (const hlod::InputSpec& input : inputs) {
        const auto stamp = stampOf(input.path);
        if (!stamp) throw Error(input.path.string(), "", "is gone", "check the path");
        sources_.push_back({.path = input.path, .stamp = *stamp});
        bytes += stamp->sizeBytes;
    }
    progress.beginStage("look in the cache", bytes, "B");
    for (Source& source : sources_) {
        const auto known = knownHash(source);
        source.hash = known ? *known : hashOf(source, progress);
        if (stampOf(source.path) != source.stamp) {
            throw Error(source.path.string(), "", "is being written", "open it when it is whole");
        }
        if (!known) remember(source);
    }
    key_ = keyOf(inputs);
    foundNs_ = options_.nowNs();
    return lookUp(&progress);
}

std::optional<fs::path> ModelCache::lookUp(Progress* progress) {
    const fs::path database = databaseOf(key_), entry = options_.folder / (key_ + ".json");
    std::error_code code;
    if (!fs::is_regular_file(database, code)) return std::nullopt;
    const auto made = readJson(entry);
    if (!made || !areCompanionsSame(*made, progress)) return std::nullopt;
    try {
        (void)ooc::Database::open(database);
    } catch (const Error&) {  // damaged, or of another version: it is made anew
        return std::nullopt;
    }
    ::utimensat(AT_FDCWD, entry.c_str(), nullptr, 0);  // opened now
    return database;
}

// Companions are named from the first input's folder.
bool ModelCache::areCompanionsSame(const json& made, Progress* progress) const {
    const fs::path folder = fs::absolute(sources_.front().path).parent_path();
    try {
        for (const auto& [name, hash] : made.at("companions").items()) {
            const auto stamp = stampOf(folder / name);
            if (stamp.has_value() == hash.is_null()) return false;
            if (!stamp) continue;
            Source source{.path = folder / name, .stamp = *stamp};
            const auto known = knownHash(source);
            if (!known && progress == nullptr) return false;  // it would have to be read
            source.hash = known ? *known : hashOf(source, *progress);
            if (!known) remember(source);
            if (hash.get<uint64_t>() != source.hash) return false;
        }
        return true;
    } catch (const json::exception&) {
        return false;
    } catch (const Error&) {  // cannot be read
        return false;
    }
}

fs::path ModelCache::buildTarget() const {
    return options_.folder / "building" / (key_ + ".pagoda");
}

fs::path ModelCache::take(const std::vector<fs::path>& companions, Progress& progress,
                          std::vector<std::string>& notes) {
    try {
        return moveIn(companions, progress, notes);
    } catch (...) {
        std::error_code code;
        fs::remove(buildTarget(), code);  // a whole database that nothing would ever count
        throw;
    }
}

fs::path ModelCache::moveIn(const std::vector<fs::path>& companions, Progress& progress,
                            std::vector<std::string>& notes) {
    const auto refuse = [](const fs::path& changed) {
        throw Error(changed.string(), "", "has changed while it was read", "open it again");
    };
    // What was made of other companions goes first: beside the new entry it would seem current.
    fs::path database = databaseOf(key_);
    std::error_code code;
    fs::remove(database, code);
    writeEntry(companions, progress);
    for (const Source& source : sources_) {
        if (stampOf(source.path) != source.stamp) refuse(source.path);
    }
    for (const fs::path& companion : companions) {
        const auto stamp = stampOf(companion);
        if (stamp && stamp->changedNs > foundNs_) refuse(companion);
    }
    fs::rename(buildTarget(), database, code);
    // Another process that built the same may have moved it just now.
    if (code && !fs::is_regular_file(database)) {
        throw Error(database.string(), "", "cannot be written: " + code.message(),
                    "check the folder, or name another one with --cache");
    }
    trim(notes);
    forgetChanged();
    return database;
}

void ModelCache::writeEntry(const std::vector<fs::path>& companions, Progress& progress) const {
    uint64_t bytes = 0;
    for (const fs::path& companion : companions) {
        if (const auto stamp = stampOf(companion)) bytes += stamp->sizeBytes;
    }
    progress.beginStage("remember what it was made of", bytes, "B");
    const fs::path folder = fs::absolute(sources_.front().path).parent_path();
    json named = json::object();
    for (const fs::path& companion : companions) {
        const fs::path path = fs::absolute(companion).lexically_normal();
        const auto stamp = stampOf(path);
        json& hash = named[path.lexically_relative(folder.lexically_normal()).string()];
        if (!stamp) continue;
        Source source{.path = path, .stamp = *stamp};
        source.hash = hashOf(source, progress);
        remember(source);
        hash = source.hash;
    }
    const fs::path entry = options_.folder / (key_ + ".json");
    if (!writeJson(entry, {{"model", fs::absolute(sources_.front().path).string()},
                           {"companions", named}})) {
        throw Error(entry.string(), "", "cannot be written",
                    "is the disk full? name another folder with --cache");
    }
}

void ModelCache::trim(std::vector<std::string>& notes) const {
    struct Entry {
        fs::file_time_type opened;
        fs::path database;
        uint64_t bytes;
    };
    std::vector<Entry> entries;
    uint64_t total = 0;
    std::error_code code;
    for (const fs::directory_entry& file : fs::directory_iterator(options_.folder, code)) {
        if (file.path().extension() != ".pagoda") continue;
        const uint64_t bytes = file.file_size(code);
        if (code) continue;  // gone meanwhile
        fs::path entry = file.path();
        const auto opened = fs::last_write_time(entry.replace_extension(".json"), code);
        total += bytes;
        if (file.path() == databaseOf(key_)) continue;
        entries.push_back({code ? fs::file_time_type::min() : opened, file.path(), bytes});
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
        return a.opened != b.opened ? a.opened < b.opened : a.database < b.database;
    });
    for (const Entry& entry : entries) {
        if (total <= options_.mostBytes) return;
        fs::path described = entry.database;
        described.replace_extension(".json");
        const auto made = readJson(described);
        const bool hasName = made && made->contains("model") && (*made)["model"].is_string();
        const std::string model = hasName ? (*made)["model"].get<std::string>() : "?";
        if (!fs::remove(entry.database, code)) continue;
        fs::remove(described, code);
        total -= entry.bytes;
        notes.push_back(fmt::format("cache above {}: removed what was made of {} ({})",
                                    formatBytes(options_.mostBytes), model,
                                    formatBytes(entry.bytes)));
    }
}

// Of files that are gone or no longer what they were.
void ModelCache::forgetChanged() const {
    std::error_code code;
    for (const fs::directory_entry& file :
         fs::directory_iterator(options_.folder / "known", code)) {
        const auto entry = readJson(file.path());
        const auto remembered = entry ? rememberedStamp(*entry) : std::nullopt;
        if (!remembered || !entry->contains("path") || !(*entry)["path"].is_string()) continue;
        if (stampOf((*entry)["path"].get<std::string>()) != remembered) {
            fs::remove(file.path(), code);
        }
    }
}

// What a process that was killed left: its lock died with it (DatabaseWriter holds one).
void ModelCache::removeAbandoned() const {
    std::error_code code;
    for (const fs::directory_entry& file : fs::directory_iterator(options_.folder, code)) {
        if (file.path().extension() != ".json") continue;
        fs::path database = file.path();
        // A young one may be another process's that is about to move its database in.
        const auto age = fs::file_time_type::clock::now() - file.last_write_time(code);
        if (code || age < kAbandonedAfter) continue;
        if (!fs::exists(database.replace_extension(".pagoda"), code)) fs::remove(file.path(), code);
    }
    for (const fs::directory_entry& file :
         fs::directory_iterator(options_.folder / "building", code)) {
        const int descriptor =
            ::open(file.path().c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
        if (descriptor < 0) continue;
        // A whole database that is not old may be on its way out of here.
        const bool isWhole = file.path().extension() == ".pagoda";
        const auto age = fs::file_time_type::clock::now() - file.last_write_time(code);
        if (isWhole && (code || age < kAbandonedAfter)) {
            ::close(descriptor);
            continue;
        }
        if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0) fs::remove(file.path(), code);
        ::close(descriptor);
    }
}

}  // namespace pagoda::tools
