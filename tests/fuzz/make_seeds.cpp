// Writes the seeds that need an encoder: Draco files, pages of every codec, databases, meshes.
//   pagoda_fuzz_seeds tests/fuzz/corpus
#include "ooc/codecs/page_codec.h"
#include "tests/ooc/store_fixture.h"

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <string>

namespace {

using namespace pagoda;

void write(const std::filesystem::path& path, const void* data, size_t size) {
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path, std::ios::binary)
        .write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
}

void writePages(const std::filesystem::path& folder) {
    std::mt19937 random(1);
    for (const ooc::Codec codec : {ooc::Codec::Raw, ooc::Codec::Meshopt, ooc::Codec::Draco}) {
        for (const bool isRich : {false, true}) {
            ooc::Page page;
            page.mesh = ooc::test::randomMesh(random, {.triangleCount = isRich ? 20u : 4u,
                                                       .hasColours = isRich,
                                                       .hasNormals = isRich,
                                                       .hasTranslucent = isRich});
            if (isRich)
                page.zippers.push_back({.neighbour = 0x80,
                                        .positions = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}},
                                        .indices = {0, 1, 2}});
            const auto bytes = ooc::encodePage(page, codec);
            write(folder / (std::string(ooc::codecName(codec)) + (isRich ? "-rich" : "-plain")),
                  bytes.data(), bytes.size());
        }
    }
}

void writeDatabases(const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    for (const ooc::Codec codec : {ooc::Codec::Raw, ooc::Codec::Meshopt, ooc::Codec::Draco}) {
        const auto path = folder / std::string(ooc::codecName(codec));
        std::filesystem::remove(path);
        (void)ooc::test::writeDatabase(path, {.codec = codec, .depth = 1, .childrenPerNode = 2});
    }
}

void writeDraco(const std::filesystem::path& folder) {
    for (const bool isSequential : {false, true}) {
        draco::TriangleSoupMeshBuilder builder;
        constexpr int kFaces = 4;
        constexpr float kCorners[kFaces][9] = {{0, 0, 0, 0, 1, 0, 1, 0, 0},
                                               {0, 0, 0, 1, 0, 0, 0, 0, 1},
                                               {1, 0, 0, 0, 1, 0, 0, 0, 1},
                                               {0, 0, 0, 0, 0, 1, 0, 1, 0}};
        constexpr uint8_t kColour[12] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 128};
        builder.Start(kFaces);
        const int position =
            builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
        const int colour =
            builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8);
        for (int face = 0; face < kFaces; ++face) {
            const float* p = kCorners[face];
            builder.SetAttributeValuesForFace(
                position, draco::FaceIndex(static_cast<uint32_t>(face)), p, p + 3, p + 6);
            builder.SetAttributeValuesForFace(colour, draco::FaceIndex(static_cast<uint32_t>(face)),
                                              kColour, kColour + 4, kColour + 8);
        }
        const auto mesh = builder.Finalize();
        draco::Encoder encoder;
        encoder.SetEncodingMethod(isSequential ? draco::MESH_SEQUENTIAL_ENCODING
                                               : draco::MESH_EDGEBREAKER_ENCODING);
        if (!isSequential) encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 11);
        draco::EncoderBuffer buffer;
        if (!encoder.EncodeMeshToBuffer(*mesh, &buffer).ok()) continue;
        write(folder / (isSequential ? "sequential" : "edgebreaker"), buffer.data(), buffer.size());
    }
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    const std::filesystem::path corpus = argv[1];
    writePages(corpus / "page");
    writeDatabases(corpus / "database");
    writeDraco(corpus / "drc");
    std::mt19937 random(2);
    for (const size_t size : {40u, 400u}) {
        std::string bytes;
        while (bytes.size() < size) bytes.push_back(static_cast<char>(random()));
        write(corpus / "mesh" / ("random-" + std::to_string(size)), bytes.data(), bytes.size());
    }
    return 0;
}
