#include "tools/opening/raw_opening.h"

#include "hlod/build/build.h"
#include "ooc/base/error.h"
#include "ooc/readers/reader_extras.h"
#include "ooc/store/database.h"
#include "tools/console_progress.h"
#include "tools/opening/preview_maker.h"

#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

namespace pagoda::tools {
namespace {

// Enough that each cell of the finest sketch has met several.
constexpr uint64_t kSampleTriangles = 1'200'000;
// A slow disk gives less; then the build's reading shows the rest.
constexpr std::chrono::milliseconds kLongestSample{1500};
// While the window draws too, half of the way from ordinary to the least.
constexpr int kNiceness = 10;

double steadySeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

// Keeps what a build says for the window to ask.
class KeptProgress final : public Progress {
public:
    void beginStage(std::string_view name, uint64_t totalUnits, std::string_view unit) override {
        const std::scoped_lock lock(stageMutex_);
        stage_ = name;
        unit_ = unit;
        totalUnits_ = totalUnits;
        beganSeconds_ = steadySeconds();
        doneUnits_ = 0;
    }
    void advance(uint64_t units) override { doneUnits_ += units; }
    void note(std::string_view line) override {
        const std::scoped_lock lock(stageMutex_);
        notes_.emplace_back(line);
    }
    void warn(std::string_view line) override { note(line); }

    [[nodiscard]] viewer::OpeningProgress now() const {
        const std::scoped_lock lock(stageMutex_);
        const uint64_t done = doneUnits_;
        const double share =
            totalUnits_ > 0
                ? std::min(1.0, static_cast<double>(done) / static_cast<double>(totalUnits_))
                : -1.0;
        return {.stage = stage_,
                .detail = progressDetail(done, totalUnits_, unit_, steadySeconds() - beganSeconds_),
                .share = share};
    }
    [[nodiscard]] std::vector<std::string> takeNotes() {
        const std::scoped_lock lock(stageMutex_);
        return std::exchange(notes_, {});
    }

private:
    std::atomic<uint64_t> doneUnits_{0};
    mutable std::mutex stageMutex_;  // guards all below
    std::string stage_ = "open", unit_;
    uint64_t totalUnits_ = 0;
    double beganSeconds_ = steadySeconds();
    std::vector<std::string> notes_;
};

class RawOpening final : public viewer::Opening {
public:
    RawOpening(std::string name, std::vector<hlod::InputSpec> inputs,
               const RawOpenerOptions& options)
        : name_(std::move(name)),
          inputs_(std::move(inputs)),
          options_(options),
          worker_([this] { run(); }) {}
    ~RawOpening() override {
        progress_.requestStop();
        worker_.join();
    }

    [[nodiscard]] const std::string& name() const override { return name_; }
    [[nodiscard]] State state() const override { return state_; }
    [[nodiscard]] viewer::OpeningProgress progress() const override { return progress_.now(); }
    [[nodiscard]] std::shared_ptr<const viewer::Preview> takePreview() override {
        return previews_.take();
    }
    [[nodiscard]] std::vector<std::string> takeNotes() override { return progress_.takeNotes(); }
    void cancel() override { progress_.requestStop(); }
    [[nodiscard]] std::filesystem::path database() const override { return database_; }
    [[nodiscard]] bool isBuilt() const override { return isBuilt_; }
    [[nodiscard]] std::string error() const override { return error_; }

private:
    void run();
    void open();
    void sample();
    void build(ModelCache& cache);

    std::string name_;
    std::vector<hlod::InputSpec> inputs_;
    RawOpenerOptions options_;
    KeptProgress progress_;
    PreviewMaker previews_;
    // Written by the worker before state_, read by others after it.
    std::filesystem::path database_;
    bool isBuilt_ = false;
    std::string error_;
    std::atomic<State> state_{State::Working};
    std::thread worker_;  // last: begins when all else is there
};

// Nothing may leave a thread: what is thrown becomes the state.
void RawOpening::run() {
    State end = State::Failed;
    try {
        open();
        end = State::Done;
    } catch (const Interrupted&) {
        end = State::Cancelled;
    } catch (const std::bad_alloc&) {
        error_ = "out of memory; give a smaller --memory, or close other programs";
    } catch (const std::exception& error) {  // Error among them
        error_ = error.what();
    }
    state_ = end;
}

void RawOpening::open() {
    ModelCache cache(options_.cache);
    if (const auto known = cache.findKnown(inputs_)) {
        database_ = *known;
        return;
    }
    sample();
    ::setpriority(PRIO_PROCESS, 0, kNiceness);  // Linux: of this thread and those it begins
    if (const auto found = cache.find(inputs_, progress_)) {
        database_ = *found;
        return;
    }
    build(cache);
}

void RawOpening::sample() {
    if (inputs_.size() != 1) return;
    if (!ooc::mayBeSampled(ooc::readerFormatOf(inputs_.front().path))) return;
    progress_.beginStage("look all over the file", 0, "triangles");
    hlod::InputSet set(inputs_, {.memoryBytes = options_.memoryBytes}, ooc::UpAxis::Unknown);
    previews_.beginSample(set.databaseUp());
    const auto deadline = std::chrono::steady_clock::now() + kLongestSample;
    const bool isSampled = set.sample(previews_, kSampleTriangles, [&] {
        progress_.check();
        return std::chrono::steady_clock::now() > deadline;
    });
    if (isSampled) previews_.endSample();
}

void RawOpening::build(ModelCache& cache) {
    hlod::BuildOptions options;
    options.inputs = inputs_;
    options.target = cache.buildTarget();
    options.force = true;
    options.memoryBytes =
        std::max(hlod::kMinMemoryBytes,
                 options_.memoryBytes - std::min(options_.memoryBytes, PreviewMaker::kMostBytes));
    options.threads = options_.threads;
    options.watcher = &previews_;
    const hlod::BuildReport report = hlod::buildDatabase(options, progress_);
    std::vector<std::string> notes;
    database_ = cache.take(report.companions, progress_, notes);
    for (const std::string& note : notes) progress_.note(note);
    isBuilt_ = true;
}

bool isDatabase(const std::filesystem::path& path) {
    try {
        (void)ooc::Database::open(path);
        return true;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

std::unique_ptr<viewer::Opening> RawOpener::open(const std::filesystem::path& model) {
    if (model.extension() == ".pagoda") return nullptr;
    std::vector<hlod::InputSpec> inputs = hlod::expandInputs({model.string()});
    try {
        for (const hlod::InputSpec& input : inputs) (void)ooc::readerFormatOf(input.path);
    } catch (const Error&) {
        if (isDatabase(model)) return nullptr;  // by another name
        throw;
    }
    // Without the suffix that says how it is placed; of a folder or a glob, its own name.
    std::string name =
        inputs.size() == 1 ? inputs.front().path.stem().string() : model.filename().string();
    return std::make_unique<RawOpening>(std::move(name), std::move(inputs), options_);
}

}  // namespace pagoda::tools
