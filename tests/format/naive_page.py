"""Pages, decoded as ooc/FORMAT.md tells it ("Pages"); meshopt streams in naive_meshopt.py."""

import math
import struct

from naive_meshopt import BadStream, decode_indices, decode_vertices, read_varint, unzigzag32

NONE = 0xFFFFFFFF


class Broken(Exception):
    """The file says otherwise than ooc/FORMAT.md."""


def need(condition, what):
    if not condition:
        raise Broken(what)


def unpack(layout, data, at=0):
    try:
        return struct.unpack_from("<" + layout, data, at)
    except struct.error as error:
        raise Broken("ends early") from error


class Geometry:
    """Vertices and triangles of a section. Of codec 2 only the head is known (not `decoded`)."""

    def __init__(self, data, codec):
        self.vertices, self.triangles, flags, *origin = unpack("3I3i", data)
        need(max(self.vertices, self.triangles) <= 1 << 26 and flags < 16, "geometry: head")
        self.has_colours, self.has_normals = bool(flags & 1), bool(flags & 2)
        self.wide, self.wide_indices = bool(flags & 4), bool(flags & 8)
        self.points, self.colours, self.normals, self.indices = [], [], [], []
        self.decoded = codec != 2
        if codec == 0:
            positions = self._raw(data)
        elif codec == 1:
            positions = self._meshopt(data)
        else:
            need(codec == 2, "geometry: codec")
            need(data[24:33] == b"DRACO\2\2\1\1", "geometry: no Draco 2.2 edgebreaker mesh")
            need(self.triangles <= 8 * len(data), "geometry: triangles that nothing backs")
            return
        self.points = [(x + origin[0], y + origin[1], z + origin[2]) for x, y, z in
                       zip(positions[0::3], positions[1::3], positions[2::3])]
        need(all(index < self.vertices for index in self.indices), "geometry: an index too large")

    def _raw(self, data):
        n, at = self.vertices, 24
        layouts = ["%d%s" % (3 * n, "I" if self.wide else "H"), "%dI" % n * self.has_colours,
                   "%db" % (2 * n) * self.has_normals,
                   "%d%s" % (3 * self.triangles, "I" if self.wide_indices else "H")]
        sizes = [struct.calcsize("<" + layout) for layout in layouts]
        need(len(data) == at + sum(sizes), "raw geometry: bytes")
        parts = []
        for layout, size in zip(layouts, sizes):
            parts.append(unpack(layout, data, at))
            at += size
        positions, self.colours, normals, self.indices = parts
        self.normals = list(zip(normals[0::2], normals[1::2]))
        return positions

    def _meshopt(self, data):
        vertex_bytes, index_bytes = unpack("2I", data, 24)
        need(len(data) == 32 + vertex_bytes + index_bytes, "meshopt geometry: bytes")
        position = "3I" if self.wide else "3H"
        layout = position + "2b" * self.has_normals
        layout += "x" * (-struct.calcsize("<" + layout) % 4) + "I" * self.has_colours
        stride = struct.calcsize("<" + layout)
        need(self.vertices * stride <= 64 * vertex_bytes, "geometry: vertices that nothing backs")
        try:
            records = decode_vertices(data[32:32 + vertex_bytes], self.vertices, stride)
            self.indices = decode_indices(data[32 + vertex_bytes:], self.triangles)
        except BadStream as error:
            raise Broken("meshopt geometry: %s" % error) from error
        columns = list(struct.iter_unpack("<" + layout, records))
        if self.has_normals:
            self.normals = [record[3:5] for record in columns]
        if self.has_colours:
            self.colours = [record[-1] for record in columns]
        return [value for record in columns for value in record[:3]]

    def normal(self, vertex):
        """A unit vector, or none where the triangle is to be shaded flat."""
        u, v = self.normals[vertex] if self.has_normals else (0, -128)
        if v == -128:
            return None
        return unfold(u / 127, v / 127)


def unfold(x, y):
    """The unit vector of a place on the octahedron's square."""
    z = 1 - abs(x) - abs(y)
    if z < 0:  # (an integer zero has no sign: it counts as positive)
        x, y = math.copysign(1 - abs(y), x), math.copysign(1 - abs(x), y)
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


class Mesh:
    """A decoded `MESH` section."""

    def __init__(self, data, codec):
        self.codec = codec
        self.colour, runs, *self.part_start = unpack("2I17I", data)
        need(codec in (0, 1, 2), "MESH: codec")
        need(runs * (12 if codec == 0 else 3) <= len(data) - 76, "MESH: runs that nothing backs")
        self.runs, at = self._read_runs(data, runs)
        self.geometry = geometry = Geometry(data[at:], codec)
        starts = self.part_start
        need((starts[0], starts[16]) == (0, geometry.triangles), "MESH: parts' sum")
        need(all(a <= b for a, b in zip(starts, starts[1:])), "MESH: parts are not in order")
        begin = 0
        inner = {start for start in starts if 0 < start < geometry.triangles}
        for count, _, _ in self.runs:
            need(count > 0 and not any(start in inner for start in range(begin + 1, begin + count)),
                 "MESH: a run is empty or reaches into the next part")
            begin += count
        need(begin == geometry.triangles, "MESH: runs do not sum to the mesh")

    def _read_runs(self, data, count):
        at, result = 76, []
        if self.codec == 0:
            return [unpack("3I", data, at + 12 * i) for i in range(count)], at + 12 * count
        thing = material = 0
        for _ in range(count):
            values = []
            for _ in range(3):
                try:
                    value, at = read_varint(data, at, len(data))
                except BadStream as error:
                    raise Broken("MESH: %s" % error) from error
                values.append(value)
            thing = (thing + unzigzag32(values[1])) & NONE
            material = (material + unzigzag32(values[2])) & NONE
            result.append((values[0], thing, material))
        return result, at

    def colour_of(self, vertex):
        return self.geometry.colours[vertex] if self.geometry.has_colours else self.colour

    def triangles(self):
        """(vertex, vertex, vertex, object, material) for every triangle."""
        indices, at = self.geometry.indices, 0
        for count, thing, material in self.runs:
            for i in range(3 * at, 3 * (at + count), 3):
                yield indices[i], indices[i + 1], indices[i + 2], thing, material
            at += count


def triangle_item(a, b, c, thing, material):
    """The 44 bytes of which the order-free sum is made; a, b, c are lattice points."""
    least = min(a, b, c)
    if b == least and a != least:
        a, b, c = b, c, a
    elif c == least and a != least:
        a, b, c = c, a, b
    return struct.pack("<9i2I", *a, *b, *c, thing, material)


def page_sections(page):
    """(tag, codec, bytes) of every section."""
    count, = unpack("I", page)
    need(1 <= count <= 4096 and 4 + 16 * count <= len(page), "page: sections")
    result, end = [], 4 + 16 * count
    for i in range(count):
        tag, codec, begin, size = unpack("4s3I", page, 4 + 16 * i)
        need(begin == end and size <= len(page) - begin, "page: gaps between sections")
        end = begin + size
        result.append((tag, codec, page[begin:end]))
    need(end == len(page), "page: bytes behind the last section")
    return result
