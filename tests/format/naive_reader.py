#!/usr/bin/env python3
"""An independent reader of Pagoda databases, written from ooc/FORMAT.md alone, in plain Python.

    naive_reader.py NAME.pagoda     prints what it found as JSON; exit 1 if anything is broken

It decodes every page of the codecs raw and meshopt, verifies every checksum and everything else
that FORMAT.md promises, and recomputes the order-free sum of the leaf triangles. Draco geometry
needs the Draco library: there it checks what stands around it. What is broken costs what duty 5 of
FORMAT.md says, and is listed.
"""

import json
import math
import struct
import sys

from naive_page import NONE, Broken, Geometry, Mesh, need, page_sections, triangle_item, unpack
from xxh3 import xxh3_128_medium, xxh3_64

CODECS = ("raw", "meshopt", "draco")
HEADER_BYTES = 256


class Header:
    """The first or the last 256 bytes of a file."""

    def __init__(self, data, file_bytes):
        need(len(data) == HEADER_BYTES and data[:6] == b"PAGODA", "no Pagoda header")
        version, size, features = unpack("HII", data, 6)
        need(xxh3_64(data[:248]) == unpack("Q", data, 248)[0], "header: checksum")
        need(version == 1 and size == HEADER_BYTES and features == 0, "version or features unknown")
        self.origin = unpack("3d", data, 16)
        (self.exponent, self.bits, self.codec, self.levels, self.budget,
         reserved) = unpack("i5I", data, 40)
        (self.nodes, self.leaves, self.triangles, low, high, self.objects, self.materials,
         self.file_bytes, self.pages_end) = unpack("9Q", data, 64)
        self.sum = low | high << 64
        self.index, self.object_table, self.material_table, self.metadata = (
            unpack("3Q", data, at) for at in (136, 160, 184, 208))
        need(all(map(math.isfinite, self.origin)), "header: origin")
        need(-1000 <= self.exponent <= 900 and 1 <= self.bits <= 30, "header: lattice")
        need(self.codec < 3 and 1 <= self.levels <= 21 and self.nodes >= 1, "header: counts")
        need(self.objects <= NONE and self.materials <= NONE, "header: objects or materials")
        need(self.file_bytes == file_bytes, "header: bytes of the file")
        need(reserved == 0 and not any(data[232:248]), "header: reserved bytes")

    def place(self, point):
        """A lattice point in model units."""
        return [self.origin[axis] + math.ldexp(point[axis], self.exponent) for axis in range(3)]


class Node:
    """One record of 96 bytes and, once read, its mesh."""

    def __init__(self, data, at):
        self.id, *box = unpack("Q6i", data, at)
        self.least, self.greatest = tuple(box[:3]), tuple(box[3:])
        (self.error, self.page_at, self.checksum, self.below, self.page_bytes, self.triangles,
         self.opaque, self.vertices, self.block, self.first, self.children, self.flags,
         reserved) = unpack("d3Q6I2HI", data, at + 32)
        self.path, self.slot = self.id >> 4, self.id & 15
        self.level = (self.path.bit_length() - 1) // 3 + (self.slot > 0)
        self.leaf = self.children == 0
        self.mesh, self.child_nodes = None, []
        need(reserved == 0 and self.children < 1 << 12, "node record: reserved bits")
        need(self.opaque <= self.triangles, "node record: opaque triangles")
        need(math.isfinite(self.error) and self.error >= 0, "node record: error")
        need(not self.leaf or (self.below, self.block, self.first) == (self.triangles, 0, 0),
             "node record: leaf")

    def child_ids(self):
        for octant in range(8):
            if self.children >> octant & 1:
                yield (self.path << 3 | octant) << 4
        for slot in range(1, 1 + (self.children >> 8)):
            yield self.path << 4 | slot


def order_free_sum(triangles):
    total = 0
    for triangle in triangles:
        total += xxh3_128_medium(triangle_item(*triangle))
    return total & ((1 << 128) - 1)


class Database:
    """Everything a file holds. `problems` lists what is broken; empty for a whole file."""

    def __init__(self, data):
        self.data, self.problems = data, []
        self.sum = None  # of the leaf triangles as decoded; only when nothing is broken
        self.header = self._read_header()
        self.objects, self.materials, self.nodes = [], [], []
        self.object_blocks = self.index_blocks = 0
        self.metadata = self._try("metadata", self._read_metadata) or {}
        self.materials = self._try("materials", self._read_materials) or []
        object_begin = self.header.index[0] + self.header.index[1]
        self._try("object table", self._read_objects, object_begin)
        self._try("index", self._read_index)
        for node in self.nodes:
            self._try("node %#x" % node.id, self._read_page, node)
        self._try("whole", self._check_whole)

    def _try(self, place, function, *arguments):
        try:
            return function(*arguments)
        except Broken as error:
            self.problems.append("%s: %s" % (place, error))
            return None

    def _read_header(self):
        size = len(self.data)
        headers = [self._try(place, Header, part, size) for place, part in
                   (("header", self.data[:HEADER_BYTES]), ("footer", self.data[-HEADER_BYTES:]))]
        if headers == [None, None]:
            raise Broken("; ".join(self.problems))
        if None not in headers and self.data[:HEADER_BYTES] != self.data[-HEADER_BYTES:]:
            self.problems.append("footer: differs from the header")
        header = headers[0] or headers[1]
        parts = (header.index, header.object_table, header.material_table, header.metadata)
        for at, length, _ in parts:
            need(HEADER_BYTES <= at and at + length <= size - HEADER_BYTES, "header: parts")
        ends = [at + length for at, length, _ in parts]
        need(ends[1:] == [parts[2][0], parts[3][0], size - HEADER_BYTES], "header: gaps")
        return header

    def _part(self, where):
        at, size, checksum = where
        part = self.data[at:at + size]
        need(len(part) == size and xxh3_64(part) == checksum, "checksum")
        return part

    def _blocks(self, directory, begin):
        """(offset, bytes, checksum), records of every block; they tile begin .. directory."""
        part = self._part(directory)
        need(len(part) % 24 == 0, "directory: bytes")
        result = []
        for at in range(0, len(part), 24):
            offset, size, records, checksum = unpack("QIIQ", part, at)
            need(offset == begin, "directory: gaps")
            begin += size
            result.append(((offset, size, checksum), records))
        need(begin == directory[0], "directory: gaps")
        return result

    def _read_metadata(self):
        try:
            result = json.loads(self._part(self.header.metadata).decode("utf-8"))
        except ValueError as error:
            raise Broken("not JSON: %s" % error) from error
        need(isinstance(result, dict), "not a JSON object")
        return result

    def _read_materials(self):
        part, count = self._part(self.header.material_table), self.header.materials
        need(16 * count <= len(part), "more materials than bytes")
        names = part[16 * count:]
        result = []
        for i in range(count):
            colour, flags, at, size = unpack("4I", part, 16 * i)
            need(at + size <= len(names), "a name outside the names")
            result.append({"name": names[at:at + size].decode("utf-8", "replace"),
                           "colour": "#" + struct.pack("<I", colour).hex(),
                           "translucent": bool(flags & 1)})
        return result

    def _read_objects(self, begin):
        blocks = self._blocks(self.header.object_table, begin)
        need(sum(records for _, records in blocks) == self.header.objects, "number of objects")
        self.object_blocks = len(blocks)
        for number, (where, records) in enumerate(blocks):
            need(records == 4096 or (number == len(blocks) - 1 and 0 < records < 4096),
                 "objects of a block")
            found = self._try("object block %d" % number, self._read_object_block, where, records)
            self.objects.extend(found or [None] * records)

    def _read_object_block(self, where, records):
        part, result = self._part(where), []
        need(48 * records <= len(part), "more objects than bytes")
        names, sources = part[48 * records:], self.metadata.get("sources")
        need(sources is None or isinstance(sources, list), "sources that are no list")
        for i in range(records):
            parent, source, *box, triangles, at, size = unpack("2I6iQ2I", part, 48 * i)
            need(parent == NONE or parent < len(self.objects) + i, "a parent that comes later")
            need(sources is None or source < len(sources), "a source that the metadata do not have")
            need(size <= 65535 and at + size <= len(names), "a name outside the names")
            result.append({"name": names[at:at + size].decode("utf-8", "replace"),
                           "parent": parent, "source": source, "triangles": triangles,
                           "least": tuple(box[:3]), "greatest": tuple(box[3:])})
        return result

    def _read_index(self):
        blocks = self._blocks(self.header.index, self.header.pages_end)
        need(sum(records for _, records in blocks) == self.header.nodes, "number of nodes")
        self.index_blocks = len(blocks)
        loaded, owner = {}, {}

        def record(block, at, parent_block):
            need(block < len(blocks) and at < blocks[block][1], "a record outside the index")
            need(owner.setdefault(block, parent_block) == parent_block or block == parent_block,
                 "a block referred to by two blocks")
            if block not in loaded:
                where, records = blocks[block]
                need(1 <= records <= 512 and where[1] == 96 * records, "index block: records")
                loaded[block] = self._part(where)
            return Node(loaded[block], 96 * at)

        root = record(0, 0, 0)
        need(root.id == 16, "the root's id")
        waiting = [(root, 0, 0)]
        while waiting:
            node, block, at = waiting.pop()
            self.nodes.append(node)
            found = self._try("children of node %#x" % node.id, self._read_children, node,
                              (block, at), record)
            waiting.extend(found or [])
        if not self.problems:
            need(len(self.nodes) == self.header.nodes, "records that no node refers to")

    def _read_children(self, node, place, record):
        ids = list(node.child_ids())
        need(not ids or (node.block, node.first) > place, "children that do not come later")
        result = []
        for i, expected in enumerate(ids):
            child = record(node.block, node.first + i, place[0])
            need(child.id == expected, "a child of another place")
            need(child.error <= node.error, "a child's error above its parent's")
            result.append((child, node.block, node.first + i))
        children = [child for child, _, _ in result]
        need(node.leaf or sum(child.below for child in children) == node.below, "triangles below")
        for child in children:
            need(inside(child.least, node) and inside(child.greatest, node), "a child's box")
            need(child.level < self.header.levels, "a child below the last level")
        node.child_nodes = children
        return result

    def _read_page(self, node):
        need(node.page_bytes <= 1 << 30 and node.page_at >= HEADER_BYTES
             and node.page_at + node.page_bytes <= self.header.pages_end, "page outside the pages")
        sections = page_sections(self._part((node.page_at, node.page_bytes, node.checksum)))
        meshes = [Mesh(part, codec) for tag, codec, part in sections if tag == b"MESH"]
        need(len(meshes) == 1, "not one MESH")
        mesh = meshes[0]
        zippers = [part for tag, codec, part in sections if tag == b"ZIPR"]
        need(bool(zippers) == bool(node.flags & 8), "flag of zippers")
        for tag, codec, part in sections:
            if tag == b"ZIPR":
                need(codec in (0, 1) and unpack("Q", part)[0] != node.id, "ZIPR: head")
                geometry = Geometry(part[8:], codec)
                need(not geometry.has_colours and not geometry.has_normals, "ZIPR: attributes")
        self._check_mesh(node, mesh)
        node.mesh = mesh

    def _check_mesh(self, node, mesh):
        geometry = mesh.geometry
        need((geometry.triangles, geometry.vertices, mesh.part_start[8]) ==
             (node.triangles, node.vertices, node.opaque), "counts of record and page differ")
        need((geometry.has_colours, geometry.has_normals, node.opaque < node.triangles) ==
             (bool(node.flags & 1), bool(node.flags & 2), bool(node.flags & 4)),
             "flags of record and page differ")
        if geometry.decoded:
            self._check_points(node, mesh)
        at = 0
        for count, thing, material in mesh.runs:
            need(thing < self.header.objects and material < self.header.materials,
                 "a run's object or material")
            if self.materials:
                need(self.materials[material]["translucent"] == (at >= node.opaque),
                     "a run in the wrong half")
            at += count

    def _check_points(self, node, mesh):
        top, geometry = 1 << self.header.bits, mesh.geometry
        for point in geometry.points:
            need(min(point) >= 0 and max(point) <= top, "a point outside the lattice")
            need(inside(point, node), "a point outside the box")
        for triangle in mesh.triangles():
            a, b, c = (geometry.points[vertex] for vertex in triangle[:3])
            need(a != b and b != c and c != a, "a triangle of two equal corners")
            need(not node.leaf or has_area(a, b, c), "a leaf triangle without area")

    def _check_whole(self):
        """What can only be said when nothing is broken."""
        if self.problems:
            return
        header, end = self.header, HEADER_BYTES
        for node in sorted(self.nodes, key=lambda each: each.page_at):
            need(node.page_at == end, "gaps between pages")
            end += node.page_bytes
        need(end == header.pages_end, "gap behind the pages")
        leaves = self.leaves()
        need(len(leaves) == header.leaves, "number of leaves")
        need(sum(node.triangles for node in leaves) == header.triangles == self.nodes[0].below,
             "triangles")
        need(max(node.level for node in self.nodes) + 1 == header.levels, "levels")
        if not self.decoded():
            return
        for node in self.nodes:
            corners = list(node.mesh.geometry.points)
            for child in node.child_nodes:
                corners += [child.least, child.greatest]
            need(box_of(corners) == (node.least, node.greatest), "node %#x: its box" % node.id)
        self.sum = order_free_sum(self.leaf_triangles())
        need(self.sum == header.sum, "order-free sum of the triangles")
        self._check_objects()

    def _check_objects(self):
        found = {}
        for a, b, c, thing, _ in self.leaf_triangles():
            found.setdefault(thing, []).extend((a, b, c))
        for number, record in enumerate(self.objects):
            corners = found.get(number, [])
            need(record["triangles"] * 3 == len(corners), "object %d: its triangles" % number)
            need(not corners or box_of(corners) == (record["least"], record["greatest"]),
                 "object %d: its box" % number)

    def decoded(self):
        """Whether the geometry of every page is known (there is none of Draco)."""
        return all(node.mesh is not None and node.mesh.geometry.decoded for node in self.nodes)

    def leaves(self):
        return [node for node in self.nodes if node.leaf]

    def leaf_triangles(self):
        """(point, point, point, object, material) of every leaf triangle, in lattice points."""
        for node in self.leaves():
            if node.mesh is not None and node.mesh.geometry.decoded:
                points = node.mesh.geometry.points
                for a, b, c, thing, material in node.mesh.triangles():
                    yield points[a], points[b], points[c], thing, material

    def summary(self):
        header, levels = self.header, [0] * self.header.levels
        for node in self.nodes:
            levels[node.level] += node.triangles
        root = self.nodes[0] if self.nodes else None
        return {
            "codec": CODECS[header.codec], "nodes": len(self.nodes), "leaves": len(self.leaves()),
            "levels": header.levels, "triangles": sum(node.triangles for node in self.leaves()),
            "triangles_per_level": levels,
            "box": [header.place(root.least), header.place(root.greatest)] if root else None,
            "materials": self.materials, "objects": len(self.objects),
            "page_codecs": sorted({CODECS[node.mesh.codec] for node in self.nodes if node.mesh}),
            "geometry": "decoded" if self.decoded() else "needs the Draco library or is broken",
            "order_free_sum": None if self.sum is None else "%032x" % self.sum,
            "problems": self.problems,
        }


def inside(point, node):
    return all(l <= v <= g for l, v, g in zip(node.least, point, node.greatest))


def has_area(a, b, c):
    u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
    return any(u[i] * v[j] != u[j] * v[i] for i, j in ((0, 1), (1, 2), (2, 0)))


def box_of(points):
    return tuple(map(min, zip(*points))), tuple(map(max, zip(*points)))


def read(path):
    with open(path, "rb") as file:
        return Database(file.read())


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    try:
        summary = read(sys.argv[1]).summary()
    except Broken as error:
        sys.exit("%s: refused: %s" % (sys.argv[1], error))
    print(json.dumps(summary, indent=2, ensure_ascii=False))
    sys.exit(1 if summary["problems"] else 0)


if __name__ == "__main__":
    main()
