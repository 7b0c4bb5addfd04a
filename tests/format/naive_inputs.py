"""Mesh files read as simply as can be: the truth that databases are compared with."""

import collections
import os
import struct

# Corners are (x, y, z) of floats; normals and colours are lists of three or None.
Triangle = collections.namedtuple("Triangle", "corners object material normals colours")
Input = collections.namedtuple("Input", "triangles objects materials")

SIZES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I",
         "float": "f", "double": "d"}


def read_mtl(path):
    """Name -> (red, green, blue, alpha), 0 .. 255."""
    result, name = {}, None
    with open(path, encoding="utf-8") as file:
        for line in file:
            key, _, rest = line.strip().partition(" ")
            if key == "newmtl":
                name = rest
                result[name] = (255, 255, 255, 255)
            elif key == "Kd":
                result[name] = tuple(round(255 * float(x)) for x in rest.split()) + result[name][3:]
            elif key == "d":
                result[name] = result[name][:3] + (round(255 * float(rest)),)
    return result


def read_obj(path):
    """Triangles only, numbers from 1, `f v` or `f v//n` (or with a texture between)."""
    places, normals, triangles, objects, materials = [], [], [], [], {}
    material = ""
    with open(path, encoding="utf-8") as file:
        for line in file:
            key, _, rest = line.strip().partition(" ")
            if key == "v":
                places.append(tuple(float(x) for x in rest.split()))
            elif key == "vn":
                normals.append(tuple(float(x) for x in rest.split()))
            elif key == "mtllib":
                materials = read_mtl(os.path.join(os.path.dirname(path), rest))
            elif key == "o":
                objects.append(rest)
            elif key == "usemtl":
                material = rest
            elif key == "f":
                corners = [corner.split("/") for corner in rest.split()]
                assert len(corners) == 3, line
                own = [normals[int(c[2]) - 1] for c in corners if len(c) == 3 and c[2]]
                triangles.append(Triangle([places[int(c[0]) - 1] for c in corners], objects[-1],
                                          material, own if len(own) == 3 else None, None))
    return Input(triangles, objects, materials)


def read_ply(path):
    """Binary little-endian: vertices x y z, maybe red green blue alpha; then triangles."""
    with open(path, "rb") as file:
        data = file.read()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    counts, layouts, names = [], [], []
    for line in data[:end].decode("ascii").splitlines():
        words = line.split()
        if words[0] == "format":
            assert words[1] == "binary_little_endian", line
        elif words[0] == "element":
            counts.append(int(words[2]))
            layouts.append("<")
            names.append([])
        elif words[:2] == ["property", "list"]:
            layouts[-1] += SIZES[words[2]] + "3" + SIZES[words[3]]
        elif words[0] == "property":
            layouts[-1] += SIZES[words[1]]
            names[-1].append(words[2])
    vertex_bytes = counts[0] * struct.calcsize(layouts[0])
    vertices = list(struct.iter_unpack(layouts[0], data[end:end + vertex_bytes]))
    coloured = names[0][3:7] == ["red", "green", "blue", "alpha"]
    triangles = []
    for corners, *indices in struct.iter_unpack(layouts[1], data[end + vertex_bytes:]):
        assert corners == 3
        own = [vertices[i] for i in indices]
        triangles.append(Triangle([v[:3] for v in own], "", "", None,
                                  [v[3:7] for v in own] if coloured else None))
    return Input(triangles, [""], {"": (255, 255, 255, 255)})
