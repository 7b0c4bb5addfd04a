#include "tests/soak/soak_rig.h"

#include <optional>

namespace pagoda::hlod::test {
namespace {

// All leaves, drawn by the rasteriser alone: no cache, no cut, no strategy.
class Leaves {
public:
    explicit Leaves(const RoomScene& scene) : lattice_(scene.lattice), raster_(scene.lattice) {
        for (const ooc::IndexBlock& block : scene.blocks) {
            for (const ooc::NodeRecord& node : block.nodes) {
                if (!node.isLeaf()) continue;
                const ooc::PageMesh& mesh = scene.pages.at(node.id.value).mesh;
                leaves_.push_back(
                    {node.id, lattice_.toModel(node.box), {mesh.positions, mesh.indices}});
                sceneBox_.extend(leaves_.back().boxModel);
            }
        }
    }
    // The same camera once more costs nothing.
    const SoftwarePicture& seenFrom(const Camera& camera) {
        if (camera_ == camera) return raster_.picture();
        camera_ = camera;
        const View view(camera, sceneBox_);
        raster_.begin(view);
        for (const Leaf& leaf : leaves_) {
            if (view.intersectsFrustum(leaf.boxModel)) raster_.draw(leaf.mesh, leaf.id);
        }
        return raster_.picture();
    }

private:
    struct Leaf {
        ooc::NodeId id;
        Box3d boxModel;
        SoftwareMesh mesh;
    };
    ooc::Lattice lattice_;
    std::vector<Leaf> leaves_;
    Box3d sceneBox_;
    TriangleRaster raster_;
    std::optional<Camera> camera_;
};

class SoftwareSoakRig final : public SoakRig {
public:
    SoftwareSoakRig(const RoomScene& scene, Leaves& leaves, const SoakOptions& options)
        : leaves_(leaves), rig_(scene, options.rig) {
        rig_.device.setCounting(true, options.isPollFree);
        rig_.runner.setPrefetch(options.doesPrefetch);
    }
    FrameRecord run(const Camera& camera, Strategy& strategy, double tauPx) override {
        return rig_.live(camera, strategy, tauPx);
    }
    FrameRunner& runner() override { return rig_.runner; }
    uint64_t gpuBytes() override { return rig_.device.pages().usedBytes(); }
    bool contains(cache::PageId page) override { return rig_.device.pages().contains(page); }
    uint64_t holes(const Camera& camera) override {
        return test::holes(rig_, leaves_.seenFrom(camera));
    }
    uint64_t pagesRead() const override { return rig_.loads.pageCount(); }

private:
    Leaves& leaves_;
    Rig rig_;
};

class SoftwareSoakDevice final : public SoakDevice {
public:
    explicit SoftwareSoakDevice(const RoomScene& scene) : scene_(scene), leaves_(scene) {}
    std::unique_ptr<SoakRig> makeRig(const SoakOptions& options) override {
        return std::make_unique<SoftwareSoakRig>(scene_, leaves_, options);
    }
    uint64_t leastHostBytes() const override { return 0; }
    uint64_t leastGpuBytes() const override { return 0; }

private:
    const RoomScene& scene_;
    Leaves leaves_;
};

}  // namespace

std::unique_ptr<SoakDevice> makeSoftwareDevice(const RoomScene& scene) {
    return std::make_unique<SoftwareSoakDevice>(scene);
}

}  // namespace pagoda::hlod::test
