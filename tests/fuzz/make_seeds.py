#!/usr/bin/env python3
"""Writes the seeds that a text editor could: PLY, OBJ, STL, OFF, glTF and GLB, a few features each.

    make_seeds.py tests/fuzz/corpus          standard library only; deterministic
"""
import base64
import json
import pathlib
import struct
import sys

CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def ply_header(kind, vertex, faces, extra=""):
    return (f"ply\nformat {kind} 1.0\ncomment seed\nelement vertex 4\n{vertex}"
            f"{extra}{faces}end_header\n").encode()


def plys():
    xyz = "".join(f"property float {a}\n" for a in "xyz")
    face = "element face 4\nproperty list uchar int vertex_indices\n"
    text = "".join("%d %d %d\n" % c for c in CORNERS)
    yield "ascii", ply_header("ascii", xyz, face) + (
        text + "".join("3 %d %d %d\n" % f for f in FACES)).encode()
    colours = xyz + "".join(f"property uchar {c}\n" for c in ("red", "green", "blue", "alpha"))
    for kind, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        body = b"".join(struct.pack(order + "3f4B", *c, 255, 128, 0, 255) for c in CORNERS)
        body += b"".join(struct.pack(order + "B3i", 3, *f) for f in FACES)
        yield kind, ply_header(kind, colours, face) + body
    doubles = "".join(f"property double {a}\n" for a in "xyz")
    doubles += "".join(f"property float n{a}\n" for a in "xyz") + "property list uchar short junk\n"
    body = b"".join(struct.pack("<3d3fB2h", *c, 0, 0, 1, 2, 7, 8) for c in CORNERS)
    body += struct.pack("<B4I", 4, 0, 1, 2, 3) + struct.pack("<BI", 1, 0) + struct.pack("<B3I", 3, 9, 1, 2)
    yield "double-polygons", ply_header("binary_little_endian", doubles,
                                        "element face 3\nproperty list uchar uint vertex_index\n") + body
    strips = "element tristrips 1\nproperty list int int vertex_indices\n"
    yield "tristrips", ply_header("binary_little_endian", xyz, strips) + b"".join(
        struct.pack("<3f", *c) for c in CORNERS) + struct.pack("<i8i", 8, 0, 1, 2, 3, -1, 1, 2, 3)


def objs():
    v = "".join("v %d %d %d\n" % c for c in CORNERS)
    yield "plain", v + "".join("f %d %d %d\n" % tuple(i + 1 for i in f) for f in FACES)
    yield "rich", ("mtllib none.mtl\no part\n" + v.replace("\n", " 1 0.5 0\n") +
                   "vn 0 0 1\nvt 0 0\ng a b\nusemtl red\ns 1\nf 1/1/1 2/1/1 3//1 4\nf -1 -2 -3\n"
                   "# comment\ng\nf 1 \\\n 2 3\nf 1 2\nf 1 2 99\nl 1 2\np 1\n")
    yield "hostile", "v nan 0 0\nv 1e999 0 0\nv 1\nf 1 2 3\nf 0 0 0\nf -9 -8 -7\nf a b c\n"


def stls():
    facets = "".join("facet normal 0 0 0\n outer loop\n" + "".join(
        "  vertex %d %d %d\n" % CORNERS[i] for i in f) + " endloop\nendfacet\n" for f in FACES)
    yield "ascii", "solid seed\n" + facets + "endsolid seed\n"
    yield "ascii-two", "solid a\n" + facets + "endsolid a\nsolid b\n" + facets + "endsolid b\n"
    body = b"".join(struct.pack("<12fH", 0, 0, 1, *(x for i in f for x in CORNERS[i]), 0) for f in FACES)
    yield "binary", b"seed".ljust(80, b"\0") + struct.pack("<I", len(FACES)) + body
    yield "binary-solid", b"solid".ljust(80, b" ") + struct.pack("<I", len(FACES)) + body


def offs():
    v = "".join("%d %d %d\n" % c for c in CORNERS)
    faces = "".join("3 %d %d %d\n" % f for f in FACES)
    yield "plain", f"OFF\n4 4 0\n{v}{faces}"
    yield "comments", f"# seed\nOFF # kind\n4 2 6\n{v}4 0 1 2 3 255 0 0\n3 0 1 2 0.5 0.5 0.5 1\n"
    yield "coff", "COFF\n4 4 0\n" + v.replace("\n", " 255 0 0 255\n") + faces
    yield "noff", "NOFF\n4 4 0\n" + v.replace("\n", " 0 0 1\n") + faces
    yield "counts-on-first-line", f"OFF 4 4 0\n{v}{faces}"
    yield "binary", b"OFF BINARY\n" + struct.pack(">3i", 4, 4, 0) + b"".join(
        struct.pack(">3f", *c) for c in CORNERS) + b"".join(struct.pack(">5i", 3, *f, 0) for f in FACES)


def gltf(**more):
    positions = b"".join(struct.pack("<3f", *c) for c in CORNERS)
    indices = b"".join(struct.pack("<3H", *f) for f in FACES)
    blob = positions + indices
    document = {
        "asset": {"version": "2.0", "copyright": "seed"}, "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "root", "children": [1], "scale": [-1, 1, 1]},
                  {"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "glass", "alphaMode": "BLEND",
                       "pbrMetallicRoughness": {"baseColorFactor": [1, 0, 0, 0.5]}}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
                       "min": [0, 0, 0], "max": [1, 1, 1]},
                      {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": len(positions)},
                        {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices)}],
        "buffers": [{"byteLength": len(blob)}]}
    document.update(more)
    return document, blob


def embedded(document, blob):
    uri = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
    document["buffers"][0]["uri"] = uri
    return json.dumps(document, separators=(",", ":"))


def glb(document, blob):
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    blob += b"\0" * (-len(blob) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(blob), b"BIN\0") + blob
    return b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks


def gltfs():
    yield "embedded", embedded(*gltf())
    yield "binary", glb(*gltf())
    document, blob = gltf()
    document["meshes"][0]["primitives"][0]["mode"] = 5
    yield "strip", glb(document, blob)
    document, blob = gltf(extensionsUsed=["EXT_mesh_gpu_instancing"])
    document["nodes"][1]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}
    yield "instances", glb(document, blob)
    document, blob = gltf(extensionsUsed=["KHR_mesh_quantization"],
                          extensionsRequired=["KHR_mesh_quantization"])
    document["accessors"][0].update(componentType=5122, normalized=True, count=4)
    document["accessors"][0].pop("min"), document["accessors"][0].pop("max")
    document["bufferViews"][0]["byteStride"] = 8
    yield "quantised", glb(document, blob)
    document, blob = gltf()
    document["accessors"][0]["sparse"] = {
        "count": 1, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}
    yield "sparse", glb(document, blob)
    document, blob = gltf(extensionsUsed=["EXT_meshopt_compression"])
    document["bufferViews"][1]["extensions"] = {"EXT_meshopt_compression": {
        "buffer": 0, "byteOffset": 48, "byteLength": 24, "byteStride": 2, "count": 12,
        "mode": "TRIANGLES"}}
    yield "meshopt", glb(document, blob)
    document, blob = gltf(extensionsUsed=["KHR_draco_mesh_compression"])
    document["meshes"][0]["primitives"][0]["extensions"] = {"KHR_draco_mesh_compression": {
        "bufferView": 1, "attributes": {"POSITION": 0}}}
    yield "draco", glb(document, blob)


def main(folder):
    for name, seeds in (("ply", plys), ("obj", objs), ("stl", stls), ("off", offs), ("gltf", gltfs)):
        target = pathlib.Path(folder) / name
        target.mkdir(parents=True, exist_ok=True)
        for seed, data in seeds():
            (target / seed).write_bytes(data.encode() if isinstance(data, str) else data)


if __name__ == "__main__":
    main(sys.argv[1])
