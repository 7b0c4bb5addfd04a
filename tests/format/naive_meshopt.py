"""The vertex and the index stream of codec 1, decoded as ooc/FORMAT.md tells it."""

import itertools

TAIL_OF_VERTICES = 32
TAIL_OF_INDICES = 16


class BadStream(Exception):
    """A stream that is not what ooc/FORMAT.md says."""


def unzigzag32(v):
    return ((v >> 1) ^ -(v & 1)) & 0xFFFFFFFF


def read_varint(data, at, end):
    """Returns the value and where the next one begins."""
    value = 0
    for i in range(5):
        if at >= end:
            raise BadStream("a varint runs out of its bytes")
        byte = data[at]
        at += 1
        value |= (byte & 127) << (7 * i)
        if byte < 128:
            if value >= 1 << 32:
                raise BadStream("a varint above 2^32 - 1")
            return value, at
    raise BadStream("a varint of more than 5 bytes")


def _unzigzag8(v):
    return ~(v >> 1) & 255 if v & 1 else v >> 1


_DIFFERENCE = [_unzigzag8(v) for v in range(256)]


def _read_group(data, at, packing):
    """Sixteen values of one packing; returns them and where the next group begins."""
    if packing == 0:
        return bytes(16), at
    if packing == 3:
        return data[at:at + 16], at + 16
    bits = 2 if packing == 1 else 4
    whole = (1 << bits) - 1
    extra = at + 2 * bits
    values = []
    for byte in data[at:extra]:
        for shift in range(8 - bits, -1, -bits):
            value = byte >> shift & whole
            if value == whole:
                value = data[extra]
                extra += 1
            values.append(value)
    return values, extra


def decode_vertices(data, count, stride):
    """Returns `count` records of `stride` bytes, as one bytearray."""
    if count == 0:
        if data:
            raise BadStream("a vertex stream of no vertices has bytes")
        return bytearray()
    if len(data) < 1 + TAIL_OF_VERTICES or data[0] != 0xA0:
        raise BadStream("no head of a vertex stream")
    end = len(data) - TAIL_OF_VERTICES
    if any(data[end:len(data) - stride]):
        raise BadStream("bytes before the base record that are not zero")
    before = list(data[len(data) - stride:])
    result = bytearray(count * stride)
    most = min((8192 // stride) & ~15, 256)
    at, first = 1, 0
    try:
        while first < count:
            here = min(most, count - first)
            for k in range(stride):
                groups = (here + 15) // 16
                packings = data[at:at + (groups + 3) // 4]
                at += len(packings)
                differences = []
                for g in range(groups):
                    values, at = _read_group(data, at, packings[g // 4] >> 2 * (g % 4) & 3)
                    differences.extend(_DIFFERENCE[v] for v in values)
                sums = itertools.accumulate(differences[:here], initial=before[k])
                column = bytes(v & 255 for v in sums)
                begin = first * stride + k
                result[begin:begin + here * stride:stride] = column[1:]
                before[k] = column[-1]
            first += here
    except (IndexError, ValueError) as error:
        raise BadStream("the vertex stream ends early") from error
    if at != end:
        raise BadStream("the vertex stream is not used up exactly")
    return result


def decode_indices(data, triangles):
    """Returns 3 * triangles indices. They are not held against the number of vertices."""
    if triangles == 0:
        if data:
            raise BadStream("an index stream of no triangles has bytes")
        return []
    if len(data) < 1 + triangles + TAIL_OF_INDICES or data[0] != 0xE1:
        raise BadStream("no head of an index stream")
    end = len(data) - TAIL_OF_INDICES
    aux = data[end:]
    reader = _Indices(data, 1 + triangles, end)
    result = []
    for code in data[1:1 + triangles]:
        high, low = code >> 4, code & 15
        result.extend(reader.edge(high, low) if high < 15 else reader.corners(low, aux))
    if reader.at != end:
        raise BadStream("the index stream is not used up exactly")
    return result


class _Indices:
    """The state of an index stream: `next`, `last` and the two memories, newest first."""

    def __init__(self, data, at, end):
        self.data, self.at, self.end = data, at, end
        self.next = self.last = 0
        self.edges = [(0xFFFFFFFF, 0xFFFFFFFF)] * 16
        self.vertices = [0xFFFFFFFF] * 16

    def _push(self, memory, value):
        memory.insert(0, value)
        memory.pop()

    def _new(self):
        self.next += 1
        return self.next - 1

    def _far(self):
        value, self.at = read_varint(self.data, self.at, self.end)
        self.last = (self.last + unzigzag32(value)) & 0xFFFFFFFF
        return self.last

    def edge(self, x, y):
        a, b = self.edges[x]
        if 1 <= y <= 12:
            c = self.vertices[y]
        else:
            if y == 0:
                c = self._new()
            elif y == 15:
                c = self._far()
            else:
                c = self.last = (self.last + (-1 if y == 13 else 1)) & 0xFFFFFFFF
            self._push(self.vertices, c)
        self._push(self.edges, (c, b))
        self._push(self.edges, (a, c))
        return a, b, c

    def corners(self, y, aux):
        if y < 14:
            code = aux[y]
        else:
            if self.at >= self.end:
                raise BadStream("the index stream ends early")
            code = self.data[self.at]
            self.at += 1
            if code == 0:
                self.next = 0
        z, w = code >> 4, code & 15
        if y < 14 and 15 in (z, w):
            raise BadStream("a far index where none may be")
        a = self._far() if y == 15 else self._new()
        b, c = (self._corner(part, list(self.vertices)) for part in (z, w))
        for pair in ((b, a), (c, b), (a, c)):
            self._push(self.edges, pair)
        self._push(self.vertices, a)
        for part, index in ((z, b), (w, c)):
            if part in (0, 15):
                self._push(self.vertices, index)
        return a, b, c

    def _corner(self, part, vertices):
        if part == 0:
            return self._new()
        return self._far() if part == 15 else vertices[part - 1]
