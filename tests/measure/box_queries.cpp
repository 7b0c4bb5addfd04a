// pagoda_box_queries DB --path P [--frames N] [--strategy NAME]: two ways to count the visible
// pixels of many boxes, on the boxes that a strategy asks about in real frames: a query object a
// box (viewer/box_queries.h), and one instanced draw whose fragments add to a counter of their box.
// Each frame is settled; its boxes are asked once more, together, against the finished depths, both
// ways in turn. The counts must be equal. Prints CPU time of the whole process (software GL draws
// in threads) a box, by the box's area.
#include "cache/clock.h"
#include "cache/thread_loads.h"
#include "hlod/strategies/strategies.h"
#include "hlod/view/camera_path.h"
#include "hlod/view/frame_runner.h"
#include "hlod/view/screen_box.h"
#include "ooc/base/error.h"
#include "viewer/gl_context.h"
#include "viewer/gl_device.h"
#include "viewer/lattice_view.h"
#include "viewer/node_program.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

namespace {

using namespace pagoda;

constexpr int kRepeats = 5;

double processCpuMs() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[values.size() / 2];
}

// The arithmetic of BoxQueries, with the box out of a buffer.
constexpr const char* kVertex = R"(#version 450 core
struct Box { vec4 least, size; };
layout(std430, binding = 4) readonly buffer Boxes { Box boxes[]; };
layout(location = 2) uniform vec3 rowX;
layout(location = 3) uniform vec3 rowY;
layout(location = 4) uniform vec3 rowW;
layout(location = 5) uniform float nearSteps;
layout(location = 0) flat out uint box;
const int corners[36] = int[36](0,4,6, 0,6,2, 1,3,7, 1,7,5, 0,1,5, 0,5,4,
                                2,6,7, 2,7,3, 0,2,3, 0,3,1, 4,5,7, 4,7,6);
void main() {
    int corner = corners[gl_VertexID];
    box = uint(gl_InstanceID);
    vec3 least = boxes[box].least.xyz, size = boxes[box].size.xyz;
    vec3 p = least + size * vec3(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    gl_Position = vec4(dot(rowX, p), dot(rowY, p), nearSteps, dot(rowW, p));
}
)";
constexpr const char* kFragment = R"(#version 450 core
layout(early_fragment_tests) in;
layout(std430, binding = 5) buffer Counts { uint counts[]; };
layout(location = 0) flat in uint box;
void main() { atomicAdd(counts[box], 1u); }
)";

void setVec3(viewer::GlId program, GLint location, const Vec3f& value) {
    glProgramUniform3f(program, location, value.x, value.y, value.z);
}

class BatchedCounts {
public:
    BatchedCounts()
        : program_(viewer::linkProgram(kVertex, kFragment)),
          boxes_(viewer::makeBuffer()),
          counts_(viewer::makeBuffer()),
          array_(viewer::makeVertexArray()) {}

    std::vector<uint64_t> count(const hlod::View& view, const viewer::LatticeView& latticeView,
                                const ooc::Lattice& lattice, const std::vector<Box3d>& boxes) {
        std::vector<glm::vec4> corners;
        for (const Box3d& box : boxes) addBox(view, lattice, box, corners);
        const auto countBytes = static_cast<GLsizeiptr>(boxes.size() * sizeof(GLuint));
        const auto boxBytes = static_cast<GLsizeiptr>(corners.size() * sizeof(glm::vec4));
        glNamedBufferData(boxes_.id(), boxBytes, corners.data(), GL_STREAM_DRAW);
        glNamedBufferData(counts_.id(), countBytes, nullptr, GL_STREAM_READ);
        glClearNamedBufferData(counts_.id(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
        const viewer::GlId program = program_.id();
        setVec3(program, 2, latticeView.rowX);
        setVec3(program, 3, latticeView.rowY);
        setVec3(program, 4, latticeView.rowW);
        glProgramUniform1f(program, 5, latticeView.nearSteps);
        for (GLuint output = 0; output < 3; ++output) {
            glColorMaski(output, GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
        }
        glDepthMask(GL_FALSE);
        glDepthFunc(GL_GEQUAL);
        glEnable(GL_DEPTH_CLAMP);
        glEnable(GL_CULL_FACE);
        glUseProgram(program);
        glBindVertexArray(array_.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 4, boxes_.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 5, counts_.id());
        glDrawArraysInstanced(GL_TRIANGLES, 0, 36, static_cast<GLsizei>(boxes.size()));
        glDisable(GL_CULL_FACE);
        glDisable(GL_DEPTH_CLAMP);
        glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
        std::vector<GLuint> counts(boxes.size());
        glGetNamedBufferSubData(counts_.id(), 0, countBytes, counts.data());
        return {counts.begin(), counts.end()};
    }

private:
    // As BoxQueries grows them: half a pixel, and 1e-5 of the coordinate.
    static void addBox(const hlod::View& view, const ooc::Lattice& lattice, const Box3d& box,
                       std::vector<glm::vec4>& corners) {
        const Vec3d least = box.min - view.eye(), most = box.max - view.eye();
        const Vec3d centre = 0.5 * (box.min + box.max) - view.eye();
        const double pixel = 0.5 * 2.0 * view.tanY() / view.camera().heightPx;
        const Vec3d grow = glm::max(Vec3d(pixel * glm::length(centre)),
                                    1e-5 * glm::max(glm::abs(least), glm::abs(most)));
        corners.emplace_back(Vec3f((least - grow) / lattice.step()), 0.0f);
        corners.emplace_back(Vec3f((most - least + 2.0 * grow) / lattice.step()), 0.0f);
    }

    viewer::GlProgram program_;
    viewer::GlBuffer boxes_, counts_;
    viewer::GlVertexArray array_;
};

// Passes everything on, and notes the boxes that are asked about.
class NotingDevice final : public hlod::Device, public hlod::CountingVisibility {
public:
    explicit NotingDevice(viewer::GlDevice& device) : device_(device) {}
    void beginFrame(const hlod::View& view) override {
        boxes.clear();
        device_.beginFrame(view);
    }
    void draw(const hlod::Node& node) override { device_.draw(node); }
    CountingVisibility* counting() override { return this; }
    hlod::PyramidVisibility* pyramid() override { return device_.pyramid(); }
    void endFrame(const hlod::FrameCut& cut, hlod::FrameRecord& record) override {
        device_.endFrame(cut, record);
    }
    hlod::QueryTicket query(const hlod::QueryShape& shape) override {
        boxes.push_back(std::get<Box3d>(shape));
        return device_.counting()->query(shape);
    }
    std::optional<uint64_t> poll(hlod::QueryTicket ticket) override {
        return device_.counting()->poll(ticket);
    }
    uint64_t wait(hlod::QueryTicket ticket) override { return device_.counting()->wait(ticket); }
    bool isPollFree() const override { return device_.counting()->isPollFree(); }

    std::vector<Box3d> boxes;

private:
    viewer::GlDevice& device_;
};

// All boxes of a frame; the hidden ones; the others by the area of their outline.
enum Group : size_t { kAll, kHidden, kTiny, kSmall, kMiddle, kLarge, kGroups };
constexpr std::array<const char*, kGroups> kNames = {"all of a frame",  "hidden",
                                                     "seen, < 8x8 px",  "seen, < 32x32",
                                                     "seen, < 128x128", "seen, larger"};

Group groupOf(double outlinePx, uint64_t visiblePx) {
    if (visiblePx == 0) return kHidden;
    if (outlinePx < 8 * 8) return kTiny;
    if (outlinePx < 32 * 32) return kSmall;
    return outlinePx < 128 * 128 ? kMiddle : kLarge;
}

struct Sums {
    double frames = 0, boxes = 0, pixels = 0, objectsMs = 0, batchMs = 0;
};

struct Setup {
    std::string database, path, strategy = "coh";
    size_t frames = 60;
};

class Measurement {
public:
    explicit Measurement(const ooc::Lattice& lattice)
        : lattice_(lattice), objects_([] {}, [] {}, false) {}

    // True when both ways count the same.
    bool measure(const hlod::View& view, const std::vector<Box3d>& all) {
        latticeView_ = viewer::makeLatticeView(view, lattice_);
        std::array<std::vector<Box3d>, kGroups> groups;
        groups[kAll] = all;
        const std::vector<uint64_t> visiblePx = countByObjects(view, all);
        for (size_t i = 0; i < all.size(); ++i) {
            groups[groupOf(hlod::boxPixels(view, all[i]), visiblePx[i])].push_back(all[i]);
        }
        for (size_t i = 0; i < groups.size(); ++i) {
            if (!groups[i].empty() && !measureGroup(view, groups[i], sums_[i])) return false;
        }
        return true;
    }
    void print() const {
        std::printf("%-16s %12s %10s %14s %14s %14s\n", "boxes", "a frame", "px a box",
                    "objects ms", "batch ms", "objects/batch");
        for (size_t i = 0; i < sums_.size(); ++i) {
            const Sums& sum = sums_[i];
            if (!(sum.boxes > 0)) continue;
            std::printf("%-16s %12.1f %10.1f %14.5f %14.5f %14.2f\n", kNames[i],
                        sum.boxes / sum.frames, sum.pixels / sum.boxes, sum.objectsMs / sum.boxes,
                        sum.batchMs / sum.boxes, sum.objectsMs / sum.batchMs);
        }
    }

private:
    bool measureGroup(const hlod::View& view, const std::vector<Box3d>& boxes, Sums& sum) {
        std::vector<double> objectsMs, batchMs;
        std::vector<uint64_t> byObjects, byBatch;
        for (int repeat = 0; repeat <= kRepeats; ++repeat) {  // the first one warms up
            const double begin = processCpuMs();
            byObjects = countByObjects(view, boxes);
            const double between = processCpuMs();
            byBatch = batch_.count(view, latticeView_, lattice_, boxes);
            const double end = processCpuMs();
            if (byObjects != byBatch) return false;
            if (repeat == 0) continue;
            objectsMs.push_back(between - begin);
            batchMs.push_back(end - between);
        }
        sum.frames += 1;
        sum.boxes += static_cast<double>(boxes.size());
        for (const uint64_t pixels : byBatch) sum.pixels += static_cast<double>(pixels);
        sum.objectsMs += median(objectsMs);
        sum.batchMs += median(batchMs);
        return true;
    }
    std::vector<uint64_t> countByObjects(const hlod::View& view, const std::vector<Box3d>& boxes) {
        objects_.beginFrame(view, latticeView_, lattice_);
        std::vector<hlod::QueryTicket> tickets;
        tickets.reserve(boxes.size());
        for (const Box3d& box : boxes) tickets.push_back(objects_.query(box));
        std::vector<uint64_t> counts;
        counts.reserve(boxes.size());
        for (const hlod::QueryTicket ticket : tickets) counts.push_back(objects_.wait(ticket));
        return counts;
    }

    ooc::Lattice lattice_;
    viewer::BoxQueries objects_;
    BatchedCounts batch_;
    viewer::LatticeView latticeView_;
    std::array<Sums, kGroups> sums_{};
};

int run(const Setup& setup) {
    std::ifstream in(setup.path);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const hlod::CameraPath path = hlod::parseCameraPath(text, {}, setup.path);
    const auto strategy = hlod::makeStrategy(setup.strategy);
    if (!strategy) throw Error("", "", "no such strategy", "see `pagoda render --help`");
    const viewer::GlContext context = viewer::GlContext::headless();
    const ooc::Database database = ooc::Database::open(setup.database);
    const cache::DatabaseSource source(database);
    const ooc::Lattice& lattice = database.header().lattice;
    constexpr uint64_t kBudgetBytes = uint64_t{2} << 30;
    cache::WallClock clock;
    cache::ThreadLoads loads({&source}, 2);
    viewer::GlDevice device(lattice, kBudgetBytes);
    NotingDevice noting(device);
    const cache::SceneDatabase scene{lattice, &source};
    cache::Streaming streaming(std::span(&scene, 1), loads, device.store(), clock,
                               {.hostBytes = kBudgetBytes, .gpuBytes = kBudgetBytes});
    hlod::NodeTree tree(lattice, streaming.index());
    hlod::FrameRunner runner(streaming, tree, noting);
    static_cast<void>(runner.root());
    Measurement measurement(lattice);
    for (size_t i = 0; i < std::min(setup.frames, path.frames.size()); ++i) {
        static_cast<void>(runner.settle(path.frames[i], *strategy, {1.0}));
        const hlod::View view(path.frames[i], runner.sceneBoxModel());
        if (noting.boxes.empty()) continue;
        if (!measurement.measure(view, noting.boxes)) {
            std::fprintf(stderr, "frame %zu: the counts differ\n", i);
            return 1;
        }
        viewer::throwOnGlError("counting boxes");
    }
    std::printf("%s, strategy %s\n", context.rendererName().c_str(), setup.strategy.c_str());
    measurement.print();
    return 0;
}

}  // namespace

int main(int count, char** arguments) {
    Setup setup;
    for (int i = 1; i < count; ++i) {
        const std::string argument = arguments[i];
        const bool hasValue = i + 1 < count;
        if (argument == "--path" && hasValue) {
            setup.path = arguments[++i];
        } else if (argument == "--strategy" && hasValue) {
            setup.strategy = arguments[++i];
        } else if (argument == "--frames" && hasValue) {
            setup.frames = std::stoul(arguments[++i]);
        } else {
            setup.database = argument;
        }
    }
    if (setup.database.empty() || setup.path.empty()) return 2;
    try {
        return run(setup);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
