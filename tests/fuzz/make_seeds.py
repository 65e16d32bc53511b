#!/usr/bin/env python3
"""Writes small valid files for the fuzz targets of binary formats into a folder (scripts/fuzz.sh runs this)."""
import gzip, json, os, struct, sys, zipfile

folder = sys.argv[1]


def write(target, name, data):
    os.makedirs(os.path.join(folder, target), exist_ok=True)
    with open(os.path.join(folder, target, "seed_" + name), "wb") as out:
        out.write(data)


def spz(version, degree):
    n, rest = 2, 3 * ((degree + 1) ** 2 - 1)
    sizes = [6 if version == 1 else 9, 1, 3, 3, 3 if version < 3 else 4, rest]
    return struct.pack("<IIIBBBB", 0x5053474E, version, n, degree, 12, 0, 0) + bytes(range(1, n * sum(sizes) + 1))


def spz4():
    """Streams as zstd frames of one raw block each."""
    arrays = [bytes(range(1, 2 * size + 1)) for size in (9, 1, 3, 3, 4, 9)]
    frames = [b"\x28\xb5\x2f\xfd\x20" + bytes([len(a)]) + (len(a) << 3 | 1).to_bytes(3, "little") + a for a in arrays]
    table = b"".join(struct.pack("<QQ", len(f), len(a)) for f, a in zip(frames, arrays))
    head = struct.pack("<IIIBBBBI12x", 0x5053474E, 4, 2, 1, 12, 0, 6, 32)
    return head + table + b"".join(frames)


def ksplat(mode):
    head = bytearray(4096)
    struct.pack_into("<BBHIIIIH", head, 0, 0, 1, 0, 1, 1, 3, 3, mode)
    section = bytearray(1024)
    struct.pack_into("<IIIIfHHII", section, 0, 3, 3, 2, 2, 5.0, 12, 0, 1000, 0)
    struct.pack_into("<IIH", section, 32, 1, 1, 1)
    rest = 9 * (4, 2, 1)[mode]
    row = (44 if mode == 0 else 24) + rest
    return bytes(head + section) + struct.pack("<I6f", 1, 0, 0, 0, 1, 1, 1) + bytes(i % 60 for i in range(3 * row))


def packed_ply():
    names = ["min_x", "min_y", "min_z", "max_x", "max_y", "max_z"]
    names += [n.replace("_", "_scale_") for n in names] + ["min_r", "min_g", "min_b", "max_r", "max_g", "max_b"]
    head = "ply\nformat binary_little_endian 1.0\nelement chunk 1\n" + "".join("property float %s\n" % n for n in names)
    head += "element vertex 2\n" + "".join("property uint packed_%s\n" % n for n in ("position", "rotation", "scale", "color"))
    head += "element sh 2\n" + "".join("property uchar f_rest_%d\n" % i for i in range(9)) + "end_header\n"
    return head.encode() + struct.pack("<18f", *range(18)) + bytes(range(2 * 16 + 2 * 9))


def sog(path):
    """meta.json with lossless WebP pictures of one pixel."""
    def picture(r, g, b, a):
        # VP8L, 1x1: five prefix codes with one symbol each and no transform.
        bits, count = 0, 0

        def put(value, width):
            nonlocal bits, count
            bits |= value << count
            count += width

        put(0x2F, 8), put(0, 14), put(0, 14), put(1, 1), put(0, 3)  # signature, width - 1, height - 1, alpha, version
        put(0, 1), put(0, 1), put(0, 1)  # no transform, no colour cache, no meta prefix codes
        for symbol in (g, r, b, a, 0):
            put(1, 1), put(0, 1), put(1, 1), put(symbol, 8)  # simple code, one symbol, of 8 bits
        data = bits.to_bytes((count + 7) // 8, "little")
        data += b"\0" * (len(data) % 2)
        chunk = b"VP8L" + struct.pack("<I", len(data)) + data
        return b"RIFF" + struct.pack("<I", 4 + len(chunk)) + b"WEBP" + chunk

    codes = [i / 64 - 2 for i in range(256)]
    meta = {"version": 2, "count": 1, "means": {"mins": [0, 0, 0], "maxs": [1, 1, 1], "files": ["l", "u"]},
            "scales": {"codebook": codes, "files": ["s"]}, "quats": {"files": ["q"]}, "sh0": {"codebook": codes, "files": ["c"]}}
    with zipfile.ZipFile(path, "w") as out:
        out.writestr(zipfile.ZipInfo("meta.json"), json.dumps(meta))
        for name in "luscq":
            out.writestr(zipfile.ZipInfo(name), picture(1, 2, 3, 253))


def colmap():
    camera = struct.pack("<Q2I2Q4d", 1, 1, 1, 640, 480, 500, 500, 320, 240)
    image = struct.pack("<QI7dI", 1, 1, 1, 0, 0, 0, 1, 2, 3, 1) + b"a\0" + struct.pack("<Q2dq", 1, 5, 6, -1)
    write("fuzz_colmap", "cameras_text", b"0# comment\n1 OPENCV 640 480 500 500 320 240 0.1 0 0 0\n")
    write("fuzz_colmap", "cameras_binary", b"1" + camera)
    write("fuzz_colmap", "images_text", b"2# comment\n1 1 0 0 0 1 2 3 1 a.png\n1 2 3\n2 0 1 0 0 1 2 3 1 b.png\n\n")
    write("fuzz_colmap", "images_binary", b"3" + image)


for version in (1, 2, 3):
    write("fuzz_spz", "plain%d" % version, spz(version, version))
    write("fuzz_spz", "gzip%d" % version, gzip.compress(spz(version, 1), mtime=0))
write("fuzz_spz", "v4", spz4())
for mode in range(3):
    write("fuzz_ksplat", str(mode), ksplat(mode))
write("fuzz_splat", "two", struct.pack("<6f", 1, 2, 3, 1, 1, 1) + bytes(range(8)) + struct.pack("<6f", *range(1, 7)) + bytes(8))
write("fuzz_ply", "packed", packed_ply())
os.makedirs(os.path.join(folder, "fuzz_sog"), exist_ok=True)
sog(os.path.join(folder, "fuzz_sog", "seed_one"))
colmap()
npy = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 17), }".ljust(117) + "\n"
pose = struct.pack("<17d", 0, 1, 0, 0, 480, 1, 0, 0, 0, 640, 0, 0, -1, 0, 500, 1, 9)
write("fuzz_path", "llff", b"\x93NUMPY\1\0\x76\0" + npy.encode() + pose)
write("fuzz_path", "euroc", b"#q_RS_w\n" + b"".join(b"%d,1,2,3,1,0,0,0,0,0,0,0,0,0,0,0,0\n" % (10**9 * i) for i in range(3)))
write("fuzz_path", "kitti", b"1 0 0 0 0 1 0 0 0 0 1 0\n0 0 1 1 -1 0 0 2 0 -1 0 3\n")
write("fuzz_path", "nerfies", b'{"orientation": [[1,0,0],[0,1,0],[0,0,1]], "position": [0,0,0], "focal_length": 5, '
      b'"principal_point": [3,2], "image_size": [6,4]}')
