"""XXH3 with seed 0, 64 and 128 bits, from the public specification (xxhash.com, xxhash_spec.md).

Plain Python for the independent reader of this folder: a few MB/s, no library of ours or of others.
"""

import struct

M32 = (1 << 32) - 1
M64 = (1 << 64) - 1
P32 = (None, 0x9E3779B1, 0x85EBCA77, 0xC2B2AE3D)
P64 = (None, 0x9E3779B185EBCA87, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9, 0x85EBCA77C2B2AE63,
       0x27D4EB2F165667C5)
MX1 = 0x165667919E3779F9
MX2 = 0x9FB21C651E98DF25
SECRET = bytes.fromhex(
    "b8fe6c3923a44bbe7c01812cf721ad1cded46de9839097db7240a4a4b7b3671f"
    "cb79e64eccc0e578825ad07dccff7221b8084674f743248ee03590e6813a264c"
    "3c2852bb91c300cb88d0658b1b532ea371644897a20df94e3819ef46a9deacd8"
    "a8fa763fe39c343ff9dcbbc7c70b4f1d8a51e04bcdb45931c89f7ec9d9787364"
    "eac5ac8334d3ebc3c581a0fffa1363eb170ddd51b7f0da49d316552629d4689e"
    "2b16be587d47a1fc8ff8b8d17ad031ce45cb3a8f95160428afd7fbcabb4b407e")
EIGHT = struct.Struct("<8Q")
TWO = struct.Struct("<2Q")


def _words(at, count, size="Q"):
    return struct.unpack_from("<%d%s" % (count, size), SECRET, at)


def _avalanche(x):
    x ^= x >> 37
    x = x * MX1 & M64
    return x ^ (x >> 32)


def _avalanche_xxh64(x):
    x ^= x >> 33
    x = x * P64[2] & M64
    x ^= x >> 29
    x = x * P64[3] & M64
    return x ^ (x >> 32)


def _fold(a, b):
    product = a * b
    return (product ^ (product >> 64)) & M64


def _rotate(x, by):
    return (x << by | x >> (64 - by)) & M64


def _swap(x):
    return int.from_bytes(x.to_bytes(8, "little"), "big")


# The pairs of secret words for every 16 bytes of a medium input, by offset into the secret.
_PAIRS = [TWO.unpack_from(SECRET, at) for at in range(len(SECRET) - 15)]


def _mix(data, at, secret_at):
    low, high = TWO.unpack_from(data, at)
    key_low, key_high = _PAIRS[secret_at]
    product = (low ^ key_low) * (high ^ key_high)
    return (product ^ (product >> 64)) & M64


def _small(data):
    n = len(data)
    if n == 0:
        a, b = _words(56, 2)
        return _avalanche_xxh64(a ^ b)
    if n <= 3:
        a, b = _words(0, 2, "I")
        value = data[n - 1] | n << 8 | data[0] << 16 | data[n >> 1] << 24
        return _avalanche_xxh64(a ^ b ^ value)
    if n <= 8:
        a, b = _words(8, 2)
        first = int.from_bytes(data[:4], "little")
        last = int.from_bytes(data[n - 4:], "little")
        value = a ^ b ^ (last | first << 32)
        value ^= _rotate(value, 49) ^ _rotate(value, 24)
        value = value * MX2 & M64
        value ^= (value >> 35) + n
        value = value * MX2 & M64
        return value ^ (value >> 28)
    a, b, c, d = _words(24, 4)
    low = a ^ b ^ int.from_bytes(data[:8], "little")
    high = c ^ d ^ int.from_bytes(data[n - 8:], "little")
    return _avalanche((n + _swap(low) + high + _fold(low, high)) & M64)


def _medium(data):
    n = len(data)
    acc = n * P64[1]
    if n <= 128:
        for i in range((n - 1) >> 5, -1, -1):
            acc += _mix(data, i * 16, i * 32) + _mix(data, n - i * 16 - 16, i * 32 + 16)
        return _avalanche(acc & M64)
    for i in range(8):
        acc += _mix(data, i * 16, i * 16)
    acc = _avalanche(acc & M64)
    for i in range(8, n >> 4):
        acc += _mix(data, i * 16, (i - 8) * 16 + 3)
    return _avalanche((acc + _mix(data, n - 16, 119)) & M64)


_STRIPE_SECRETS = [EIGHT.unpack_from(SECRET, 8 * i) for i in range(16)]
_SCRAMBLE_SECRET = EIGHT.unpack_from(SECRET, 128)
_LAST_SECRET = EIGHT.unpack_from(SECRET, 121)


def _accumulate(acc, stripe, secret):
    """Sums are left to grow: they are cut to 64 bits where a block ends."""
    for i in range(8):
        word = stripe[i]
        value = word ^ secret[i]
        acc[i ^ 1] += word
        acc[i] += (value & M32) * (value >> 32)


def _large(data):
    n = len(data)
    acc = [P32[3], P64[1], P64[2], P64[3], P64[4], P32[2], P64[5], P32[1]]
    at = 0
    while n - at > 1024:
        for i in range(16):
            _accumulate(acc, EIGHT.unpack_from(data, at + 64 * i), _STRIPE_SECRETS[i])
        for i in range(8):
            x = acc[i] & M64
            acc[i] = (x ^ (x >> 47) ^ _SCRAMBLE_SECRET[i]) * P32[1] & M64
        at += 1024
    for i in range((n - at - 1) // 64):
        _accumulate(acc, EIGHT.unpack_from(data, at + 64 * i), _STRIPE_SECRETS[i])
    _accumulate(acc, EIGHT.unpack_from(data, n - 64), _LAST_SECRET)
    key = EIGHT.unpack_from(SECRET, 11)
    result = n * P64[1]
    for i in range(0, 8, 2):
        result += _fold((acc[i] & M64) ^ key[i], (acc[i + 1] & M64) ^ key[i + 1])
    return _avalanche(result & M64)


def xxh3_64(data):
    """XXH3_64bits of a bytes-like object."""
    if len(data) <= 16:
        return _small(bytes(data))
    return _medium(data) if len(data) <= 240 else _large(data)


def xxh3_128_medium(data):
    """XXH3_128bits (low + (high << 64)) of 17 .. 128 bytes; the format asks for 44 only."""
    n = len(data)
    if not 17 <= n <= 128:
        raise ValueError("this XXH3_128bits holds for 17 .. 128 bytes")
    low, high = n * P64[1], 0
    for i in range((n - 1) >> 5, -1, -1):
        begin, end = i * 16, n - i * 16 - 16
        low += _mix(data, begin, i * 32)
        high += _mix(data, end, i * 32 + 16)
        low = (low & M64) ^ (sum(TWO.unpack_from(data, end)) & M64)
        high = (high & M64) ^ (sum(TWO.unpack_from(data, begin)) & M64)
    first = _avalanche((low + high) & M64)
    second = _avalanche((low * P64[1] + high * P64[4] + n * P64[2]) & M64)
    return first | (-second & M64) << 64
