#include "ooc/readers/reader.h"

#include "ooc/base/error.h"
#include "ooc/readers/drc_reader.h"
#include "ooc/readers/gltf_reader.h"
#include "ooc/readers/obj_reader.h"
#include "ooc/readers/off_reader.h"
#include "ooc/readers/ply_reader.h"
#include "ooc/readers/reader_extras.h"
#include "ooc/readers/stl_reader.h"

#include <algorithm>
#include <array>

namespace pagoda::ooc {
namespace {

// Kinds that people bring and that we do not read: what turns them into one that we do.
struct ForeignFormat {
    std::string_view extension, name, remedy;
};
constexpr std::string_view kPointsRemedy =
    "it holds points, not triangles: make a mesh of them first (CloudCompare or MeshLab: Poisson "
    "reconstruction) and save it as .ply";
constexpr std::string_view kCadRemedy =
    "open it in FreeCAD and export the mesh as .glb, .obj or .stl";
constexpr std::string_view kSceneRemedy = "convert it with assimp export IN OUT.glb, or Blender";
constexpr std::array kForeignFormats = {
    ForeignFormat{".ifc", "IFC", "convert with IfcConvert (IfcOpenShell) to .glb"},
    ForeignFormat{".ifczip", "zipped IFC", "unzip, convert with IfcConvert (IfcOpenShell) to .glb"},
    ForeignFormat{".ifcxml", "IFC XML", "convert with IfcConvert (IfcOpenShell) to .glb"},
    ForeignFormat{".step", "STEP", kCadRemedy},
    ForeignFormat{".stp", "STEP", kCadRemedy},
    ForeignFormat{".iges", "IGES", kCadRemedy},
    ForeignFormat{".igs", "IGES", kCadRemedy},
    ForeignFormat{".brep", "OpenCASCADE BRep", kCadRemedy},
    ForeignFormat{".fcstd", "FreeCAD", kCadRemedy},
    ForeignFormat{".dwg", "DWG", "export it as .stl or .obj from a CAD program"},
    ForeignFormat{".dxf", "DXF", "export it as .stl or .obj from a CAD program (FreeCAD, Blender)"},
    ForeignFormat{".las", "LAS", kPointsRemedy},
    ForeignFormat{".laz", "LAZ", kPointsRemedy},
    ForeignFormat{".e57", "E57", kPointsRemedy},
    ForeignFormat{".pcd", "PCD", kPointsRemedy},
    ForeignFormat{".xyz", "XYZ points", kPointsRemedy},
    ForeignFormat{".fbx", "FBX", "convert with FBX2glTF or Blender to .glb"},
    ForeignFormat{".dae", "COLLADA", "convert with COLLADA2GLTF, assimp or Blender to .glb"},
    ForeignFormat{".3ds", "3DS", kSceneRemedy},
    ForeignFormat{".3mf", "3MF", "convert with assimp, or export .stl from the slicer"},
    ForeignFormat{".blend", "Blender", "export it from Blender as .glb"},
    ForeignFormat{".x3d", "X3D", kSceneRemedy},
    ForeignFormat{".wrl", "VRML", "convert with meshlabserver or Blender to .ply or .glb"},
    ForeignFormat{".usd", "USD", "convert with Blender or usd2gltf to .glb"},
    ForeignFormat{".usda", "USD", "convert with Blender or usd2gltf to .glb"},
    ForeignFormat{".usdc", "USD", "convert with Blender or usd2gltf to .glb"},
    ForeignFormat{".usdz", "USD", "convert with Blender or usd2gltf to .glb"},
    ForeignFormat{".xkt", "XKT", "convert the source it was made from (IFC: IfcConvert) to .glb"},
    ForeignFormat{".gml", "CityGML", "convert with citygml-tools to CityJSON, then cjio to .obj"},
    ForeignFormat{".b3dm", "3D Tiles", "convert with 3d-tiles-tools (b3dmToGlb) to .glb"},
    ForeignFormat{".ldr", "LDraw", "convert with Blender (ImportLDraw) to .glb"},
    ForeignFormat{".mpd", "LDraw", "convert with Blender (ImportLDraw) to .glb"},
    ForeignFormat{".rvm", "AVEVA RVM", "convert with rvmparser to .obj or .glb"},
    ForeignFormat{".nxs", "Nexus", "build from the mesh it was made from"},
    ForeignFormat{".json", "JSON",
                  "CityJSON: convert with cjio (cjio IN export obj OUT.obj) to .obj"},
    ForeignFormat{".city", "CityJSON", "convert with cjio (cjio IN export obj OUT.obj) to .obj"},
    ForeignFormat{".zip", "ZIP", "unpack it and name the models in it"},
    ForeignFormat{".gz", "gzip", "unpack it and name the models in it"},
};

std::string lowerExtension(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    return extension;
}

std::string knownExtensions() {
    std::string list;
    for (const ReaderFormat& format : readerFormats()) {
        for (const std::string_view extension : format.extensions) {
            if (!list.empty()) list += ", ";
            list += extension;
        }
    }
    return list;
}

}  // namespace

std::string_view dropReasonName(DropReason reason) {
    switch (reason) {
        case DropReason::NonFinite:
            return "non-finite";
        case DropReason::IndexOutOfRange:
            return "index out of range";
        case DropReason::TooFewCorners:
            return "too few corners";
        case DropReason::Degenerate:
            return "degenerate";
        case DropReason::Sliver:
            return "sliver";
        case DropReason::Collapsed:
            return "collapsed";
        case DropReason::Count:
            break;
    }
    return "unknown";
}

const std::vector<ReaderFormat>& readerFormats() {
    static const std::vector<ReaderFormat> formats = {
        {"PLY", {".ply"}, openPlyReader},
        {"OBJ", {".obj"}, openObjReader},
        {"STL", {".stl"}, openStlReader},
        {"OFF", {".off"}, openOffReader},
        {"glTF", {".gltf", ".glb"}, openGltfReader},
        {"Draco", {".drc"}, openDrcReader},
    };
    return formats;
}

const ReaderFormat& readerFormatOf(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    for (const ReaderFormat& format : readerFormats()) {
        if (std::ranges::find(format.extensions, extension) != format.extensions.end()) {
            return format;
        }
    }
    for (const ForeignFormat& foreign : kForeignFormats) {
        if (foreign.extension == extension) {
            throw Error(path.string(), "", std::string(foreign.name) + " files are not read",
                        std::string(foreign.remedy));
        }
    }
    throw Error(path.string(), "",
                extension.empty() ? "file without an extension: its kind is not known"
                                  : "files of kind \"" + extension + "\" are not known",
                "name one of " + knownExtensions());
}

bool mayBeSampled(const ReaderFormat& format) {
    return format.open == openPlyReader || format.open == openStlReader;
}

std::unique_ptr<Reader> openReader(const std::filesystem::path& path,
                                   const ReaderOptions& options) {
    return readerFormatOf(path).open(path, options);
}

}  // namespace pagoda::ooc
