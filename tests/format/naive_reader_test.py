#!/usr/bin/env python3
"""Databases that `pagoda` builds, read by naive_reader.py and held against their inputs.

    naive_reader_test.py PAGODA FOLDER

PAGODA is the program, FOLDER is where models and databases go.
"""

import collections
import json
import math
import os
import random
import re
import subprocess
import sys
import unittest

import naive_inputs
import naive_reader
from naive_page import triangle_item

PAGODA, FOLDER = "", ""
PAGE = os.path.join(os.path.dirname(__file__), "..", "..", "ooc", "FORMAT.md")
NORMAL_DEGREES = 1.0  # two i8 on the octahedron are off by less
FLAT_DEGREES = 5.0    # normals this near to the triangle's may be left out


def path_of(name):
    return os.path.join(FOLDER, name)


def pagoda(*arguments):
    return subprocess.run([PAGODA, *arguments], check=True, stdout=subprocess.PIPE,
                          stderr=subprocess.DEVNULL).stdout


def generate(kind, name, triangles):
    pagoda("generate", kind, "--triangles", str(triangles), "-o", path_of(name), "--force")
    return path_of(name)


def build(model, codec, *options):
    target = "%s.%s.pagoda" % (model, codec)
    pagoda("build", model, "-o", target, "--force", "--codec", codec, *options)
    return target


def rotated(corners, key):
    """The corners with the least one first."""
    at = corners.index(min(corners, key=key))
    return corners[at:] + corners[:at]


def degrees(a, b):
    cosine = sum(x * y for x, y in zip(a, b)) / math.dist(a, (0, 0, 0)) / math.dist(b, (0, 0, 0))
    return math.degrees(math.acos(max(-1, min(1, cosine))))


def cross(a, b, c):
    u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
    return [u[i] * v[j] - u[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]


def stored_triangles(database):
    """44 bytes of a leaf triangle -> list of its corners' (normal, colour), least corner first."""
    result = collections.defaultdict(list)
    for node in database.leaves():
        mesh, points = node.mesh, node.mesh.geometry.points
        for *corners, thing, material in mesh.triangles():
            corners = rotated(corners, lambda vertex: points[vertex])
            item = triangle_item(*(points[vertex] for vertex in corners), thing, material)
            result[item].append([(mesh.geometry.normal(vertex),
                                  mesh.colour_of(vertex).to_bytes(4, "little"))
                                 for vertex in corners])
    return result


class Truth(unittest.TestCase):
    """What the test classes share."""

    def snap(self, header, corner, up):
        """A lattice point within half a step on every axis; `up` decides where two are."""
        steps = [(corner[i] - header.origin[i]) / 2.0 ** header.exponent for i in range(3)]
        return tuple(math.floor(x + 0.5) if up else math.ceil(x - 0.5) for x in steps)

    def assert_holds(self, database, model):
        """Leaf triangles, objects and materials are the input's, one to one."""
        self.assertEqual([], database.problems)
        self.assertTrue(database.decoded())
        self.assertEqual(model.objects, [each["name"] for each in database.objects])
        objects = {name: i for i, name in enumerate(model.objects)}
        self.assertEqual(len(objects), len(model.objects), "names must be unique")
        materials = {each["name"]: i for i, each in enumerate(database.materials)}
        self.assert_materials(database, model)
        stored, total = stored_triangles(database), 0
        for triangle in model.triangles:
            for up in (True, False):
                points = [self.snap(database.header, corner, up) for corner in triangle.corners]
                item = triangle_item(*points, objects[triangle.object],
                                     materials[triangle.material])
                if stored.get(item):
                    break
            self.assertTrue(stored.get(item), "not in the leaves: %s" % (triangle,))
            self.assert_attributes(triangle, points, stored[item].pop(), model)
            total += naive_reader.xxh3_128_medium(item)
        self.assertEqual([], [item for item, rest in stored.items() if rest], "leaves hold more")
        self.assertEqual(database.header.triangles, len(model.triangles))
        self.assertEqual(database.summary()["order_free_sum"], "%032x" % (total % (1 << 128)))

    def assert_materials(self, database, model):
        used = {triangle.material for triangle in model.triangles}
        self.assertEqual({name: "#" + bytes(model.materials[name]).hex() for name in used},
                         {each["name"]: each["colour"] for each in database.materials})
        self.assertEqual({name for name in used if model.materials[name][3] < 255},
                         {each["name"] for each in database.materials if each["translucent"]})

    def assert_attributes(self, triangle, points, stored, model):
        given = rotated(list(range(3)), lambda i: points[i])
        face, material = cross(*points), model.materials[triangle.material]
        for corner, (normal, colour) in zip(given, stored):
            own = triangle.colours[corner] if triangle.colours else (255, 255, 255, 255)
            expected = bytes(round(x * y / 255) for x, y in zip(own, material))
            self.assertEqual(expected, colour)
            if normal and triangle.normals:
                self.assertLess(degrees(normal, triangle.normals[corner]), NORMAL_DEGREES)
            elif triangle.normals:
                self.assertLess(degrees(face, triangle.normals[corner]), FLAT_DEGREES)
            else:
                self.assertIsNone(normal)

    def assert_agrees_with_info(self, path, database):
        info, summary = json.loads(pagoda("info", "--json", path)), database.summary()
        header = database.header
        for key in ("nodes", "leaves", "levels", "triangles", "objects", "codec"):
            self.assertEqual(info[key], summary[key], key)
        self.assertEqual(info["materials"], len(summary["materials"]))
        self.assertEqual([info["box"]["min"], info["box"]["max"]], summary["box"])
        self.assertEqual(info["lattice"], {"origin": list(header.origin), "bits": header.bits,
                                           "step": 2.0 ** header.exponent})
        self.assertEqual((info["bytes"], info["page_bytes"]),
                         (header.file_bytes, header.pages_end - 256))
        self.assertEqual((info["node_triangles"], info["dropped"]), (header.budget, {}))
        root = database.nodes[0]
        self.assertEqual(info["root"], {"triangles": root.triangles, "error": root.error,
                                        "bytes": root.page_bytes})
        self.assertEqual([level["triangles"] for level in info["level_list"]],
                         summary["triangles_per_level"])
        for level in info["level_list"]:
            nodes = [node for node in database.nodes if node.level == level["level"]]
            self.assertEqual((level["nodes"], level["max_error"]),
                             (len(nodes), max(node.error for node in nodes)))


class WhatPagodaBuilds(Truth):
    def test_the_example_of_the_page_reads_as_it_says(self):
        with open(PAGE, encoding="utf-8") as file:
            dump = file.read().split("```dump\n")[1].split("```")[0]
        lines = re.findall(r"^ *\d+: ((?:[0-9a-f]+ )+) ", dump, re.MULTILINE)
        data = bytes.fromhex("".join(lines).replace(" ", ""))
        database = naive_reader.Database(data + data[:256])
        self.assertEqual([], database.problems)
        (triangle,) = database.leaf_triangles()
        self.assertEqual([database.header.place(point) for point in triangle[:3]],
                         [[10, 0, 0], [11, 0, 0], [10, 1, 0.5]])

    def test_a_coloured_surface_is_in_the_leaves_triangle_by_triangle(self):
        path = generate("torus", "torus.ply", 3000)
        model = naive_inputs.read_ply(path)
        self.assertTrue(all(triangle.colours for triangle in model.triangles))
        for codec in ("raw", "meshopt"):
            with self.subTest(codec):
                target = build(path, codec, "--node-triangles", "512")
                database = naive_reader.read(target)
                self.assert_holds(database, model)
                self.assert_agrees_with_info(target, database)
                self.assertGreater(database.header.levels, 2)

    def test_positions_of_32_bits_are_read(self):
        path = generate("torus", "fine.ply", 1000)
        model = naive_inputs.read_ply(path)
        for codec in ("raw", "meshopt"):
            with self.subTest(codec):
                database = naive_reader.read(build(path, codec, "--precision", "0.0000001"))
                self.assertTrue(any(node.mesh.geometry.wide for node in database.nodes))
                self.assert_holds(database, model)

    def test_objects_materials_glass_and_normals_survive(self):
        path = generate("interior", "hall.obj", 36000)
        model = naive_inputs.read_obj(path)
        self.assertTrue(any(triangle.normals for triangle in model.triangles))
        self.assertTrue(any(material[3] < 255 for material in model.materials.values()))
        for codec in ("raw", "meshopt"):
            with self.subTest(codec):
                target = build(path, codec, "--node-triangles", "128")
                database = naive_reader.read(target)
                self.assert_holds(database, model)
                self.assert_agrees_with_info(target, database)
                self.assertGreater(database.index_blocks, 1)
        with self.subTest("draco"):
            self.check_draco(build(path, "draco", "--node-triangles", "128"), database, model)

    def check_draco(self, target, other, model):
        """All but the geometry, which needs the Draco library."""
        database = naive_reader.read(target)
        self.assertEqual([], database.problems)
        self.assertFalse(database.decoded())
        self.assertIn("draco", database.summary()["page_codecs"])
        self.assert_agrees_with_info(target, database)
        self.assert_materials(database, model)
        self.assertEqual(other.objects, database.objects)
        self.assertEqual([(node.id, node.least, node.greatest, node.triangles, node.error)
                          for node in other.nodes],
                         [(node.id, node.least, node.greatest, node.triangles, node.error)
                          for node in database.nodes])
        self.assertEqual(other.header.sum, database.header.sum)
        found = collections.Counter()
        for node in database.leaves():
            for count, thing, material in node.mesh.runs:
                found[database.objects[thing]["name"],
                      database.materials[material]["name"]] += count
        self.assertEqual(found, collections.Counter((triangle.object, triangle.material)
                                                    for triangle in model.triangles))

    def test_thousands_of_objects_keep_their_names(self):
        count, path = 4100, path_of("many.obj")
        with open(path_of("many.mtl"), "w", encoding="utf-8") as file:
            file.write("newmtl p\u00e2te brune\nKd 0.2 0.4 0.6\nd 1\n")
        with open(path, "w", encoding="utf-8") as file:
            file.write("mtllib many.mtl\nusemtl p\u00e2te brune\n")
            for i in range(count):
                file.write("o T\u00fcr %d\n" % i)
                for x, y in ((0, 0), (1, 0), (0, 1)):
                    file.write("v %d %d %d 1 0 1\n" % (2 * (i % 64) + x, 2 * (i // 64) + y, i % 7))
                file.write("f %d %d %d\n" % (3 * i + 1, 3 * i + 2, 3 * i + 3))
        model = naive_inputs.read_obj(path)
        model = model._replace(triangles=[
            triangle._replace(corners=[corner[:3] for corner in triangle.corners],
                              colours=[(255, 0, 255, 255)] * 3) for triangle in model.triangles])
        database = naive_reader.read(build(path, "meshopt"))
        self.assertEqual(database.object_blocks, 2)
        self.assert_holds(database, model)


class BrokenFiles(Truth):
    @classmethod
    def setUpClass(cls):
        path = generate("torus", "small.ply", 400)
        cls.files = []
        for codec in ("raw", "meshopt"):
            with open(build(path, codec, "--node-triangles", "64"), "rb") as file:
                cls.files.append(file.read())

    def flipped(self, data, at, bit):
        return data[:at] + bytes([data[at] ^ 1 << bit]) + data[at + 1:]

    def test_a_flipped_bit_is_found_wherever_it_is(self):
        chance = random.Random(7)
        for data in self.files:
            header = naive_reader.Database(data).header
            parts = [0, 256, header.pages_end, header.index[0], header.object_table[0] - 1,
                     header.object_table[0], header.material_table[0], header.metadata[0],
                     len(data) - 256, len(data) - 1]
            for at in parts + [chance.randrange(len(data)) for _ in range(25)]:
                bit = chance.randrange(8)
                try:
                    problems = naive_reader.Database(self.flipped(data, at, bit)).problems
                except naive_reader.Broken:
                    problems = ["refused"]
                self.assertTrue(problems, "bit %d of byte %d" % (bit, at))

    def test_a_broken_page_costs_that_page_only(self):
        for data in self.files:
            whole = naive_reader.Database(data)
            victim = whole.nodes[len(whole.nodes) // 2]
            found = naive_reader.Database(self.flipped(data, victim.page_at + 40, 3))
            self.assertEqual([victim.id], [node.id for node in found.nodes if node.mesh is None])
            self.assertEqual(len(whole.nodes), len(found.nodes))

    def test_the_footer_stands_in_for_a_broken_header(self):
        for data in self.files:
            found = naive_reader.Database(bytes(256) + data[256:])
            self.assertEqual(["header: no Pagoda header"], found.problems)
            self.assertTrue(found.decoded())
            with self.assertRaises(naive_reader.Broken):
                naive_reader.Database(bytes(256) + data[256:-256] + bytes(256))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    PAGODA, FOLDER = sys.argv[1:3]
    os.makedirs(FOLDER, exist_ok=True)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
