#include "hlod/build/intake.h"

#include "ooc/store/triangle_sum.h"

#include <cmath>

namespace pagoda::hlod {
namespace {

constexpr size_t kSpillBufferBytes = size_t{4} << 20;
// A triangle longer than this that has no area on the lattice is a sliver: its neighbours cover it
// to within a step. A shorter one is detail lost.
constexpr double kSliverSteps = 4.0;
// Corner normals within about 2.5 degrees of the face's: the triangle is flat, and its normal
// derivable.
constexpr float kFlatCosine = 0.999f;

bool isFinite(const Vec3d& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

class IntakeSink : public ooc::TriangleSink {
public:
    IntakeSink(Intake& intake, const ooc::Lattice& lattice, Progress& progress)
        : intake_(intake), lattice_(lattice), progress_(progress) {
        buffer_.reserve(kSpillBufferBytes + 64);
    }

    uint32_t addObject(const ooc::ObjectInfo& object) override {
        intake_.objects.push_back({.name = object.name, .parent = object.parent});
        return static_cast<uint32_t>(intake_.objects.size() - 1);
    }
    uint32_t addMaterial(const ooc::MaterialInfo& material) override {
        intake_.materials.push_back({material.name, material.colour, material.isTranslucent});
        intake_.isTranslucent.push_back(material.isTranslucent);
        return static_cast<uint32_t>(intake_.materials.size() - 1);
    }
    void addTriangles(const ooc::TriangleBatch& batch) override {
        intake_.trianglesIn += batch.triangleCount();
        for (size_t i = 0; i < batch.triangleCount(); ++i) addTriangle(batch, i);
    }
    void dropped(ooc::DropReason reason, uint64_t count) override {
        intake_.trianglesIn += count;
        drop(reason, count);
    }
    void ignored(std::string_view what, uint64_t count) override {
        intake_.ignored[std::string(what)] += count;
    }
    void advance(uint64_t bytes) override {
        progress_.advance(bytes);
        progress_.check();
    }
    void flush() {
        intake_.spill.append(buffer_);
        buffer_.clear();
    }

private:
    void drop(ooc::DropReason reason, uint64_t count) {
        if (count > 0) intake_.dropped[std::string(dropReasonName(reason))] += count;
    }
    void addTriangle(const ooc::TriangleBatch& batch, size_t number);
    void dropWithoutArea(const Vec3d& a, const Vec3d& b, const Vec3d& c);
    void fillNormals(const ooc::TriangleBatch& batch, size_t number, SoupTriangle& triangle) const;

    Intake& intake_;
    const ooc::Lattice& lattice_;
    Progress& progress_;
    std::vector<std::byte> buffer_;
};

void IntakeSink::dropWithoutArea(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    if (glm::cross(b - a, c - a) == Vec3d(0.0)) {
        drop(ooc::DropReason::Degenerate, 1);
        return;
    }
    const double longest =
        std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    if (longest >= kSliverSteps * lattice_.step()) {
        drop(ooc::DropReason::Sliver, 1);
        return;
    }
    drop(ooc::DropReason::Collapsed, 1);
    ++intake_.collapsed;
    intake_.collapsedBounds.extend(a);
}

// Flat triangles carry no normals: box corners then weld across their edges.
void IntakeSink::fillNormals(const ooc::TriangleBatch& batch, size_t number,
                             SoupTriangle& triangle) const {
    const Vec3d* p = &batch.positions[3 * number];
    const Vec3d cross = glm::cross(p[1] - p[0], p[2] - p[0]);
    const double length = glm::length(cross);
    if (!(length > 0)) return;
    const Vec3f face(cross / length);
    bool isFlat = true;
    for (size_t corner = 0; corner < 3; ++corner) {
        isFlat &= std::abs(glm::dot(batch.normals[3 * number + corner], face)) > kFlatCosine;
    }
    if (isFlat) return;
    for (size_t corner = 0; corner < 3; ++corner) {
        triangle.normals[corner] = ooc::encodeNormal(batch.normals[3 * number + corner]);
        if (triangle.normals[corner].isNone()) triangle.normals[corner] = ooc::encodeNormal(face);
    }
}

void IntakeSink::addTriangle(const ooc::TriangleBatch& batch, size_t number) {
    const Vec3d& a = batch.positions[3 * number];
    const Vec3d& b = batch.positions[3 * number + 1];
    const Vec3d& c = batch.positions[3 * number + 2];
    if (!isFinite(a) || !isFinite(b) || !isFinite(c)) {
        drop(ooc::DropReason::NonFinite, 1);
        return;
    }
    SoupTriangle triangle;
    triangle.corners = {lattice_.snap(a), lattice_.snap(b), lattice_.snap(c)};
    if (hasNoArea(triangle.corners)) {
        dropWithoutArea(a, b, c);
        return;
    }
    triangle.object = batch.object;
    triangle.material = batch.material;
    if (intake_.layout.hasColours) {
        for (size_t corner = 0; corner < 3; ++corner) {
            triangle.colours[corner] = batch.colours.empty()
                                           ? intake_.materials[batch.material].colour
                                           : batch.colours[3 * number + corner];
        }
    }
    if (!batch.normals.empty()) fillNormals(batch, number, triangle);

    ooc::addTriangle(intake_.sum, triangle.corners[0], triangle.corners[1], triangle.corners[2],
                     triangle.object, triangle.material);
    ooc::ObjectRecord& object = intake_.objects[triangle.object];
    for (const Vec3i& corner : triangle.corners) object.box.extend(corner);
    ++object.triangleCount;
    ++intake_.accepted;

    const size_t at = buffer_.size();
    buffer_.resize(at + intake_.layout.bytes());
    intake_.layout.store(triangle, buffer_.data() + at);
    if (buffer_.size() >= kSpillBufferBytes) flush();
}

}  // namespace

Intake takeIn(InputSet& inputs, const ooc::Lattice& lattice, SoupLayout layout,
              const std::filesystem::path& scratchFolder, Progress& progress) {
    Intake intake;
    intake.layout = layout;
    intake.spill = File::createScratch(scratchFolder);
    IntakeSink sink(intake, lattice, progress);
    progress.beginStage("read and snap", inputs.totalBytes(), "B");
    inputs.read(sink);
    sink.flush();
    for (uint32_t i = 0; i < intake.objects.size(); ++i)
        intake.objects[i].source = inputs.sourceOfObject(i);
    return intake;
}

}  // namespace pagoda::hlod
