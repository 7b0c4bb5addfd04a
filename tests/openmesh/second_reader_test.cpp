// Our readers against OpenMesh's, on every valid PLY, OBJ, OFF and STL file of the test data:
// the same triangles at the same places.
// Places are compared as float, which is what OpenMesh keeps. Triangles with two corners at one
// place are left out on both sides: OpenMesh's STL reader drops them.
#include "tests/ooc/readers/collecting_sink.h"
#include "tests/ooc/readers/test_files.h"
#include "tests/openmesh/soup_importer.h"

#include <gtest/gtest.h>
#include <OpenMesh/Core/IO/Options.hh>
#include <OpenMesh/Core/IO/reader/OBJReader.hh>
#include <OpenMesh/Core/IO/reader/OFFReader.hh>
#include <OpenMesh/Core/IO/reader/PLYReader.hh>
#include <OpenMesh/Core/IO/reader/STLReader.hh>

#include <algorithm>
#include <array>
#include <cctype>
#include <iostream>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace pagoda {
namespace {

using Place = std::array<float, 3>;
using Triangle = std::array<Place, 3>;

// How OpenMesh 9.0 fares with a file on which we do not simply agree.
enum class Fate : uint8_t {
    NotGiven,  // it would take garbage, from memory it never wrote, for counts and indices
    Refused,   // it says so itself
    Differs,   // it reads, but less than there is
    OtherCut,  // the same faces; concave ones are cut otherwise: areas and corners agree
};
struct Known {
    Fate fate;
    const char* why;
};

constexpr const char* kConcave = "concave polygons: a fan here, ears in our readers";
constexpr const char* kRepeated =
    "OBJ: a corner that a face names twice (a hole's bridge) is left out the second time";
constexpr const char* kIndexType =
    "PLY lists counted or indexed by such types (int32, short, ...): not known to it";

const std::map<std::string, Known> kKnown = {
    {"geo/zurich-lod2-double.ply", {Fate::OtherCut, kConcave}},
    {"geo/zurich-lod2.obj", {Fate::Differs, kRepeated}},
    {"zoo/obj/concave_polygon.obj", {Fate::Differs, kRepeated}},
    {"zoo/obj/space_in_material_name.obj", {Fate::Differs, kRepeated}},
    {"zoo/obj/trimesh/polygonfaces.obj", {Fate::OtherCut, kConcave}},
    {"zoo/off/L.off", {Fate::OtherCut, kConcave}},
    {"zoo/ply/suzanne.ply", {Fate::OtherCut, kConcave}},
    {"zoo/obj/box_longline.obj", {Fate::Differs, kRepeated}},
    {"zoo/obj/trimesh/wallhole.obj", {Fate::Differs, kRepeated}},
    {"zoo/obj/box_UTF16BE.obj", {Fate::Differs, "UTF-16 is not known to it: an empty mesh"}},
    {"scan/igea-tristrips.ply", {Fate::Differs, "tristrips are not known to it: points only"}},
    {"zoo/off/comments.off", {Fate::NotGiven, "comments before the counts"}},
    {"zoo/off/whitespace.off", {Fate::NotGiven, "counts behind white space, OFF and a comment"}},
    {"zoo/ply/cube_binary_header_with_RN_newline.ply",
     {Fate::NotGiven, "binary behind CR LF: takes the LF for the first byte"}},
    {"zoo/ply/draco-cube_att.ply",
     {Fate::NotGiven, "ASCII: a second list in faces is not skipped"}},
    {"zoo/ply/fuze_ascii.ply", {Fate::NotGiven, "ASCII: a second list in faces is not skipped"}},
    {"zoo/ply/draco-delim_test.ply", {Fate::Refused, "lines that end with CR alone"}},
    {"zoo/ply/magnum-whitespace.ply", {Fate::Refused, "white space before the keywords"}},
    {"zoo/ply/magnum-crlf.ply", {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-custom-components-be.ply", {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-custom-components-duplicate.ply", {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-custom-components.ply", {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-per-face-colors-be.ply", {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-per-face-normals-objectid.ply", {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-positions-char-colors4-ushort-texcoords-uchar-indices-short-be.ply",
     {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-positions-colors-normals-texcoords-float-objectid-uint-indices-int-be.ply",
     {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-positions-colors-normals-texcoords-float-objectid-uint-indices-int.ply",
     {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-positions-colors4-float-indices-int.ply", {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-positions-float-indices-uint.ply", {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-positions-short-colors-uchar-texcoords-ushort-indices-char.ply",
     {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-positions-ushort-normals-short-objectid-uchar-indices-uchar-be.ply",
     {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-triangle-fast-path-be.ply", {Fate::Refused, kIndexType}},
    {"zoo/ply/magnum-positions-colors4-normals-texcoords-float-indices-int-be-unaligned.ply",
     {Fate::NotGiven, "a property before the list in faces, and a list counted by int32"}},
    {"zoo/ply/magnum-positions-uchar-normals-char-objectid-short-indices-ushort.ply",
     {Fate::NotGiven, "vertices of bytes: not converted, not skipped"}},
};

std::string extensionOf(const std::string& name) {
    std::string extension = std::filesystem::path(name).extension().string();
    for (char& letter : extension) letter = static_cast<char>(std::tolower(letter));
    return extension;
}

OpenMesh::IO::BaseReader* openMeshReader(const std::string& extension) {
    if (extension == ".ply") return &OpenMesh::IO::PLYReader();
    if (extension == ".obj") return &OpenMesh::IO::OBJReader();
    if (extension == ".off") return &OpenMesh::IO::OFFReader();
    if (extension == ".stl") return &OpenMesh::IO::STLReader();
    return nullptr;
}

// Starts with the least corner, sense kept.
void addTriangle(std::vector<Triangle>& triangles, Triangle corners) {
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) return;
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    triangles.push_back(corners);
}

std::vector<Triangle> ourTriangles(const std::filesystem::path& path) {
    std::vector<Triangle> triangles;
    for (const ooc::test::CollectedTriangle& triangle : ooc::test::readAll(path).triangles) {
        Triangle corners;
        for (size_t i = 0; i < 3; ++i) {
            const Vec3f point(triangle.corner[i]);
            corners[i] = {point.x, point.y, point.z};
        }
        addTriangle(triangles, corners);
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

// Polygons as fans from their first corner, as we cut convex ones.
std::vector<Triangle> trianglesOf(const test::SoupImporter& soup) {
    std::vector<Triangle> triangles;
    const auto place = [&](uint32_t vertex) {
        const OpenMesh::Vec3d& point = soup.points.at(vertex);
        return Place{static_cast<float>(point[0]), static_cast<float>(point[1]),
                     static_cast<float>(point[2])};
    };
    for (const std::vector<uint32_t>& face : soup.faces) {
        for (size_t i = 2; i < face.size(); ++i) {
            addTriangle(triangles, {place(face[0]), place(face[i - 1]), place(face[i])});
        }
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

struct Reading {
    bool isRefused = false;
    std::vector<Triangle> triangles;
};

Reading theirTriangles(const std::filesystem::path& path) {
    test::SoupImporter soup;
    OpenMesh::IO::Options options;
    Reading reading;
    reading.isRefused =
        !openMeshReader(extensionOf(path.string()))->read(path.string(), soup, options);
    if (!reading.isRefused) reading.triangles = trianglesOf(soup);
    return reading;
}

std::string counts(const std::vector<Triangle>& ours, const std::vector<Triangle>& theirs) {
    std::vector<Triangle> common;
    std::set_intersection(ours.begin(), ours.end(), theirs.begin(), theirs.end(),
                          std::back_inserter(common));
    return std::to_string(ours.size()) + " triangles of ours, " + std::to_string(theirs.size()) +
           " of OpenMesh, " + std::to_string(common.size()) + " alike";
}

// What does not depend on how polygons are cut: the areas' vectors, and the places of corners.
struct Outline {
    Vec3d areaVector{0.0};
    double area = 0;
    std::set<Place> places;
};

Outline outlineOf(const std::vector<Triangle>& triangles) {
    Outline outline;
    if (triangles.empty()) return outline;
    const Place& zero = triangles.front()[0];
    for (const Triangle& triangle : triangles) {
        std::array<Vec3d, 3> p;
        for (size_t i = 0; i < 3; ++i) {
            for (int axis = 0; axis < 3; ++axis) {
                const auto k = static_cast<size_t>(axis);
                p[i][axis] = static_cast<double>(triangle[i][k]) - static_cast<double>(zero[k]);
            }
            outline.places.insert(triangle[i]);
        }
        const Vec3d cross = glm::cross(p[1] - p[0], p[2] - p[0]);
        outline.areaVector += cross;
        outline.area += glm::length(cross);
    }
    return outline;
}

void expectSameOutline(const std::vector<Triangle>& ours, const std::vector<Triangle>& theirs) {
    const Outline a = outlineOf(ours), b = outlineOf(theirs);
    EXPECT_LE(glm::length(a.areaVector - b.areaVector), 1e-9 * a.area);
    EXPECT_TRUE(a.places == b.places);
    EXPECT_FALSE(ours == theirs) << "alike by now: take it off the list";
}

void compareKnown(const std::filesystem::path& path, const std::string& name, const Known& known) {
    const std::vector<Triangle> ours = ourTriangles(path);
    EXPECT_FALSE(ours.empty());
    std::string found = "not given to it";
    if (known.fate != Fate::NotGiven) {
        const Reading theirs = theirTriangles(path);
        found = theirs.isRefused ? "refused" : counts(ours, theirs.triangles);
        EXPECT_EQ(theirs.isRefused, known.fate == Fate::Refused);
        if (known.fate == Fate::Differs) {
            EXPECT_LT(theirs.triangles.size(), ours.size());
        } else if (known.fate == Fate::OtherCut) {
            expectSameOutline(ours, theirs.triangles);
        }
    }
    std::cout << name << ": " << found << " (" << known.why << ")\n";
}

TEST(SecondReader, openMeshFindsTheSameTrianglesInEveryValidFile) {
    PAGODA_REQUIRE_TEST_DATA();
    const auto stats =
        nlohmann::json::parse(ooc::test::contentsOf(ooc::test::testData() / "stats.json"));
    size_t alike = 0, listed = 0, triangles = 0;
    for (const auto& [name, figures] : stats.items()) {
        if (openMeshReader(extensionOf(name)) == nullptr || name.starts_with("malformed/"))
            continue;
        SCOPED_TRACE(name);
        const std::filesystem::path path = ooc::test::testData() / name;
        if (const auto known = kKnown.find(name); known != kKnown.end()) {
            compareKnown(path, name, known->second);
            ++listed;
            continue;
        }
        const std::vector<Triangle> ours = ourTriangles(path);
        const Reading theirs = theirTriangles(path);
        EXPECT_FALSE(theirs.isRefused);
        EXPECT_TRUE(ours == theirs.triangles) << counts(ours, theirs.triangles);
        ++alike;
        triangles += ours.size();
    }
    EXPECT_EQ(listed, kKnown.size()) << "the list names files that are not there";
    EXPECT_GT(alike, 90u);
    std::cout << alike << " files with " << triangles << " triangles alike; " << listed
              << " listed above\n";
}

}  // namespace
}  // namespace pagoda
