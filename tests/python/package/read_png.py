"""PNG files as arrays, by the specification: tests of datasets mustn't depend on the library's own reader."""

import struct
import zlib

import numpy as np


def read_png(file):
    """8 or 16 bits, grey or RGB, as an array; every filter of the PNG specification."""
    data, at, packed = file.read_bytes(), 8, b""
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack(">IIBB", data[at + 8 : at + 18])
        packed += data[at + 8 : at + 8 + length] if kind == b"IDAT" else b""
        at += 12 + length
    channels, wide = (3 if colour == 2 else 1), bits // 8
    step, raw = channels * wide, zlib.decompress(packed)
    rows, before = [], bytearray(width * step)
    for y in range(height):
        kind, row = raw[y * (width * step + 1)], bytearray(raw[y * (width * step + 1) + 1 : (y + 1) * (width * step + 1)])
        for i, value in enumerate(row):
            a, b, c = (row[i - step] if i >= step else 0), before[i], (before[i - step] if i >= step else 0)
            paeth = min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]
            row[i] = (value + (0, a, b, (a + b) // 2, paeth)[kind]) & 255
        rows.append(bytes(row))
        before = row
    image = np.frombuffer(b"".join(rows), f">u{wide}").reshape(height, width, channels)
    return image if channels == 3 else image[..., 0]


def decode_flow(file):
    """As DSEC's site has it."""
    image = read_png(file)
    flow, known = (image[..., :2].astype(np.float64) - 2**15) / 128, image[..., 2]
    assert known.max() <= 1
    return flow, known == 1
