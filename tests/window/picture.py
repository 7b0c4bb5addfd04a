"""Pictures as tests need them: PNG (8-bit RGB, as Pagoda writes it), PFM depths, silhouettes. Python
standard library."""
import array
import struct
import zlib
from pathlib import Path


def read_png(path):
    """(width, height, rows): each row the bytes of its RGB pixels."""
    data = Path(path).read_bytes()
    at, packed, width, height = 8, b"", 0, 0
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            if (depth, colour) != (8, 2):
                raise ValueError(f"{path}: not 8-bit RGB")
        elif kind == b"IDAT":
            packed += body
        at += 12 + length
    raw, rows = zlib.decompress(packed), []
    before = bytearray(3 * width)
    for y in range(height):
        begin = y * (3 * width + 1)
        row = unfiltered(raw[begin], bytearray(raw[begin + 1:begin + 1 + 3 * width]), before)
        rows.append(bytes(row))
        before = row
    return width, height, rows


def unfiltered(kind, row, above):
    """PNG specification, section 9."""
    for i, value in enumerate(row):
        left = row[i - 3] if i >= 3 else 0
        up = above[i]
        if kind == 1:
            value += left
        elif kind == 2:
            value += up
        elif kind == 3:
            value += (left + up) // 2
        elif kind == 4:
            corner = above[i - 3] if i >= 3 else 0
            guess = left + up - corner
            by_left, by_up, by_corner = abs(guess - left), abs(guess - up), abs(guess - corner)
            value += left if by_left <= by_up and by_left <= by_corner else \
                up if by_up <= by_corner else corner
        row[i] = value & 255
    return row


def silhouette_of_png(path):
    """Where the picture is not its background, which has one colour a row: that of the first pixel,
    so the model must not reach the left border. A list of booleans from the top left."""
    width, _, rows = read_png(path)
    return [row[3 * x:3 * x + 3] != row[:3] for row in rows for x in range(width)]


def silhouette_of_depth(path, width, height):
    """Where `render --depth` wrote a finite depth."""
    values = array.array("f", Path(path).read_bytes()[-4 * width * height:])
    return [values[(height - 1 - y) * width + x] < float("inf")
            for y in range(height) for x in range(width)]


def intersection_over_union(a, b):
    both = sum(p and q for p, q in zip(a, b))
    return both / max(1, sum(p or q for p, q in zip(a, b)))
