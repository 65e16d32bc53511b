#!/usr/bin/env python3
"""Writes small valid files for the fuzz targets of binary formats into a folder (scripts/fuzz.sh runs this)."""
import base64, gzip, io, json, os, pickle, random, struct, sys, types, zipfile, zlib
from collections import OrderedDict

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


def sog(path, version):
    """meta.json with lossless WebP pictures of one pixel; version 1 has a palette of 64, too."""
    def picture(r, g, b, a, width=1):
        # VP8L, one row of one colour: five prefix codes with one symbol each and no transform.
        bits, count = 0, 0

        def put(value, size):
            nonlocal bits, count
            bits |= value << count
            count += size

        put(0x2F, 8), put(width - 1, 14), put(0, 14), put(1, 1), put(0, 3)  # signature, width - 1, height - 1, alpha, version
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
    if version == 1:
        ends = {"mins": [-1, -1, -1, -1], "maxs": [1, 1, 1, 1]}
        meta = {"means": {"shape": [1, 3], "mins": [0, 0, 0], "maxs": [1, 1, 1], "files": ["l", "u"]},
                "scales": {"mins": [-5, -5, -5], "maxs": [0, 0, 0], "files": ["s"]}, "quats": {"files": ["q"]},
                "sh0": {"files": ["c"], **ends}, "shN": {"shape": [1, 9], "mins": -1, "maxs": 1, "files": ["p", "n"]}}
    with zipfile.ZipFile(path, "w") as out:
        out.writestr(zipfile.ZipInfo("meta.json"), json.dumps(meta))
        for name in "luscqn" if version == 1 else "luscq":
            out.writestr(zipfile.ZipInfo(name), picture(1, 0, 3, 253))
        if version == 1:
            out.writestr(zipfile.ZipInfo("p"), picture(1, 2, 3, 255, 64 * 3))


def gltf(draft):
    """Two splats of degree 1, in a binary file; a draft has them in the text, with colours in COLOR_0. And a .spz."""
    widths = {"POSITION": 3, "KHR_gaussian_splatting:ROTATION": 4, "KHR_gaussian_splatting:SCALE": 3}
    widths.update({"_ROTATION": 4, "_SCALE": 3, "COLOR_0": 4} if draft else {"KHR_gaussian_splatting:OPACITY": 1})
    for l in range(0 if draft else 2):
        widths.update({"KHR_gaussian_splatting:SH_DEGREE_%d_COEF_%d" % (l, n): 3 for n in range(2 * l + 1)})
    data, views, accessors = b"", [], []
    for i, width in enumerate(widths.values()):
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": 8 * width})
        accessors.append({"bufferView": i, "componentType": 5126, "count": 2, "type": ("", "SCALAR", "", "VEC3", "VEC4")[width]})
        data += struct.pack("<%df" % (2 * width), *[0.5 + 0.01 * k for k in range(2 * width)])
    primitive = {"attributes": {name: i for i, name in enumerate(widths)}, "mode": 0,
                 "extensions": {"KHR_gaussian_splatting": {"kernel": "ellipse", "colorSpace": "srgb_rec709_display"}}}
    packed = gzip.compress(spz(2, 0), mtime=0)
    views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
    data += packed + b"\0" * (-len(data + packed) % 4)
    inner = {"KHR_gaussian_splatting_compression_spz_2": {"bufferView": len(views) - 1}}
    other = {"attributes": {}, "extensions": {"KHR_gaussian_splatting": {"extensions": inner}}}
    tree = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "bufferViews": views, "accessors": accessors,
            "nodes": [{"children": [1], "matrix": [0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1]},
                      {"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0.6, 0.8], "scale": [1, 2, 3]}],
            "meshes": [{"primitives": [primitive, other]}], "buffers": [{"byteLength": len(data)}]}
    if draft:
        tree["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
        return json.dumps(tree).encode()
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def colmap():
    camera = struct.pack("<Q2I2Q4d", 1, 1, 1, 640, 480, 500, 500, 320, 240)
    image = struct.pack("<QI7dI", 1, 1, 1, 0, 0, 0, 1, 2, 3, 1) + b"a\0" + struct.pack("<Q2dq", 1, 5, 6, -1)
    write("fuzz_colmap", "cameras_text", b"0# comment\n1 OPENCV 640 480 500 500 320 240 0.1 0 0 0\n")
    write("fuzz_colmap", "cameras_fov", b"0" b"1 FOV 640 480 500 500 320 240 0.9\n")
    write("fuzz_colmap", "cameras_binary", b"1" + camera)
    write("fuzz_colmap", "images_text", b"2# comment\n1 1 0 0 0 1 2 3 1 a.png\n1 2 3\n2 0 1 0 0 1 2 3 1 b.png\n\n")
    write("fuzz_colmap", "images_binary", b"3" + image)


# -- folders of trained models: files as fuzz_method.c numbers them ----------------------------------------------------

FILES = ["cfg_args", "points", "deformation", "decoder", "deform", "chkpnt", "params", "ckpt", "time0", "time1"]


def names_of_torch():
    """Modules that pickle can name things by."""
    torch, utils = types.ModuleType("torch"), types.ModuleType("torch._utils")
    torch.FloatStorage = type("FloatStorage", (), {"__module__": "torch"})

    def rebuild(*arguments):
        raise NotImplementedError
    rebuild.__module__, rebuild.__name__, rebuild.__qualname__ = "torch._utils", "_rebuild_tensor_v2", "_rebuild_tensor_v2"
    utils._rebuild_tensor_v2 = rebuild
    sys.modules["torch"], sys.modules["torch._utils"] = torch, utils
    return torch.FloatStorage, rebuild


FLOATS, REBUILD = names_of_torch()


class Storage:
    def __init__(self, key, values):
        self.key, self.values = key, values


class Tensor:
    """Small numbers that differ, of a shape."""
    count = 0

    def __init__(self, *shape, scale=0.1):
        Tensor.count += 1
        size = 1
        for extent in shape:
            size *= extent
        self.shape, self.storage = shape, Storage(str(Tensor.count), [scale * ((7 * i) % 11 - 5) + 0.01 for i in range(size)])

    def __reduce__(self):
        strides, step = [], 1
        for extent in reversed(self.shape):
            strides.insert(0, step)
            step *= extent
        return REBUILD, (self.storage, 0, self.shape, tuple(strides), False, OrderedDict())


def torch_file(value):
    """What torch.save writes."""
    storages, out, archive = [], io.BytesIO(), io.BytesIO()

    class Pickler(pickle.Pickler):
        def persistent_id(self, thing):
            if not isinstance(thing, Storage):
                return None
            storages.append(thing)
            return "storage", FLOATS, thing.key, "cpu", len(thing.values)
    Pickler(out, 2).dump(value)
    with zipfile.ZipFile(archive, "w") as to:
        to.writestr(zipfile.ZipInfo("model/data.pkl"), out.getvalue())
        for s in storages:
            to.writestr(zipfile.ZipInfo("model/data/" + s.key), struct.pack("<%df" % len(s.values), *s.values))
    return archive.getvalue()


def ply(names, rows=2):
    head = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % rows
    head += "".join("property float %s\n" % n for n in names) + "end_header\n"
    return head.encode() + struct.pack("<%df" % (rows * len(names)), *(0.1 * (i % 13) - 0.5 for i in range(rows * len(names))))


def numbered(name, count):
    return ["%s_%d" % (name, i) for i in range(count)]


def npz(arrays):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as to:
        for name, shape in arrays.items():
            size = 1
            for extent in shape:
                size *= extent
            head = ("{'descr': '<f4', 'fortran_order': False, 'shape': %s, }" % (shape,)).ljust(117) + "\n"
            data = struct.pack("<%df" % size, *(0.1 * (i % 7) - 0.2 for i in range(size)))
            to.writestr(zipfile.ZipInfo(name + ".npy"), b"\x93NUMPY\1\0\x76\0" + head.encode() + data)
    return out.getvalue()


def layer(state, name, rows, columns):
    state[name + ".weight"], state[name + ".bias"] = Tensor(rows, columns), Tensor(rows)


def hexplane():
    state, p = OrderedDict(), "deformation_net."
    state[p + "grid.aabb"] = Tensor(2, 3)
    state[p + "grid.aabb"].storage.values = [1.6, 1.6, 1.6, -1.6, -1.6, -1.6]
    for plane in range(6):
        state[p + "grid.grids.0.%d" % plane] = Tensor(1, 2, 3, 2)
    for plane in (0, 1, 3):
        state[p + "grid.grids.0.%d" % plane] = Tensor(1, 2, 2, 2)
    layer(state, p + "feature_out.0", 4, 2)
    for head, width in (("pos_deform", 3), ("scales_deform", 3), ("rotations_deform", 4)):
        layer(state, p + head + ".1", 4, 4), layer(state, p + head + ".3", width, 4)
    return state


def warp():
    state = OrderedDict()
    layer(state, "linear.0", 4, 63 + 5), layer(state, "linear.1", 4, 4)
    for head, width in (("gaussian_warp", 3), ("gaussian_rotation", 4), ("gaussian_scaling", 3)):
        layer(state, head, width, 4)
    return state


def models():
    plain = ["x", "y", "z", "nx", "ny", "nz"] + numbered("f_dc", 3) + ["opacity"] + numbered("scale", 3) + numbered("rot", 4)
    stg = plain + ["trbf_center", "trbf_scale"] + numbered("motion", 9) + numbered("omega", 4)
    full = [n for n in stg if not n.startswith("f_dc")] + numbered("f_dc", 6) + numbered("f_t", 3)
    capture = [7, Tensor(2, 3), Tensor(2, 1, 3), Tensor(2, 15, 3), Tensor(2, 3), Tensor(2, 4), Tensor(2, 1)] + [None] * 6
    capture += [Tensor(2, 1), Tensor(2, 1), Tensor(2, 4), True, None, 0]
    splats = {"means": (2, 3), "scales": (2, 3), "quats": (2, 4), "opacities": (2,), "sh0": (2, 1, 3), "shN": (2, 0, 3),
              "times": (2, 1), "durations": (2, 1), "velocities": (2, 3)}
    options = b"Namespace(no_dx=False, no_ds=False, no_dr=False, no_do=True, no_dshs=True, rgbfunction='sandwich')"
    yield "inria", {"points": ply(plain)}
    yield "stg_lite", {"points": ply(stg)}
    yield "stg_full", {"cfg_args": options, "points": ply(full),
                       "decoder": torch_file(OrderedDict([("mlp1.weight", Tensor(6, 12, 1, 1)), ("mlp2.weight", Tensor(3, 6, 1, 1))]))}
    yield "fourdgs", {"cfg_args": options, "points": ply(plain), "deformation": torch_file(hexplane())}
    yield "deformable", {"points": ply(plain), "deform": torch_file(warp())}
    yield "fudan4d", {"chkpnt": torch_file((tuple(capture), 7))}
    yield "dyn3dgs", {"params": npz({"means3D": (3, 2, 3), "unnorm_rotations": (3, 2, 4), "rgb_colors": (3, 2, 3),
                                     "logit_opacities": (2, 1), "log_scales": (2, 3)})}
    yield "freetime", {"ckpt": torch_file({"step": 7, "splats": OrderedDict((k, Tensor(*v)) for k, v in splats.items())})}
    yield "frames", {"time0": ply(plain), "time1": ply(plain)}


def row(files, held):
    """A row of files as fuzz.h reads it."""
    return b"".join(bytes([files.index(k)]) + struct.pack("<I", len(v))[:3] + v for k, v in held.items())


for name, held in models():
    write("fuzz_method", name, row(FILES, held))


# -- pictures, frame sequences, noise histograms -----------------------------------------------------------------------

def png(width, height, depth, colour, interlaced=0):
    """`colour`: 0 grey, 2 RGB, 3 palette, 4 grey with alpha, 6 RGB with alpha."""
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
    head = struct.pack(">IIBBBBB", width, height, depth, colour, 0, 0, interlaced)
    lines = b"".join(b"\0" + bytes((7 * i + y) % 4 for i in range((width * channels * depth + 7) // 8)) for y in range(height))
    palette = chunk(b"PLTE", bytes(range(12))) if colour == 3 else b""
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + palette + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")


def exr(channels, width, height, compression, half):
    """Scan lines; compression 0 none, 2 ZIPS (a line), 3 ZIP (16 lines)."""
    def attribute(name, kind, data):
        return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<I", len(data)) + data
    listed = b"".join(c.encode() + b"\0" + struct.pack("<IB3xII", 1 if half else 2, 0, 1, 1) for c in channels) + b"\0"
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    head = struct.pack("<II", 20000630, 2) + attribute("channels", "chlist", listed)
    head += attribute("compression", "compression", bytes([compression])) + attribute("dataWindow", "box2i", box)
    head += attribute("displayWindow", "box2i", box) + attribute("lineOrder", "lineOrder", b"\0")
    head += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    head += attribute("screenWindowCenter", "v2f", bytes(8)) + attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    lines = 16 if compression == 3 else 1
    blocks = []
    for y in range(0, height, lines):
        count = len(channels) * width * min(lines, height - y)
        data = struct.pack("<%d%s" % (count, "e" if half else "f"), *(0.25 * (i % 5) for i in range(count)))
        if compression:
            mixed = bytearray(data[0::2] + data[1::2])
            for i in range(len(mixed) - 1, 0, -1):
                mixed[i] = (mixed[i] - mixed[i - 1] + 128) & 255
            packed = zlib.compress(bytes(mixed), 9)
            data = packed if len(packed) < len(data) else data
        blocks.append(struct.pack("<iI", y, len(data)) + data)
    at, table = len(head) + 8 * len(blocks), b""
    for block in blocks:
        table += struct.pack("<Q", at)
        at += len(block)
    return head + table + b"".join(blocks)


def npy_file(dtype, shape, data):
    kind = dtype if dtype.startswith("[") else "'%s'" % dtype
    head = ("{'descr': %s, 'fortran_order': False, 'shape': %s, }" % (kind, shape)).ljust(117) + "\n"
    return b"\x93NUMPY\1\0\x76\0" + head.encode() + data


FRAMES = ["0.png", "1.png", "0.exr", "own", "dsec", "npy", "npz", "times", "y4m"]
for depth, colour, interlaced in ((8, 0, 0), (16, 0, 0), (8, 2, 1), (16, 6, 0), (2, 3, 0), (1, 0, 1), (8, 4, 0)):
    write("fuzz_png", "%d_%d" % (depth, colour), png(5, 3, depth, colour, interlaced))
for compression in (0, 2, 3):
    write("fuzz_exr", "float%d" % compression, exr(["Y"], 6, 18, compression, False))
    write("fuzz_exr", "half%d" % compression, exr(["B", "G", "R"], 40, 17, compression, True))
array = npy_file("<f4", (2, 1, 3), struct.pack("<6f", *range(6)))
for name, data in (("flow", array), ("known", npy_file("<f4", (1, 2, 3), struct.pack("<6f", 1, 2, 1, 3, 4, 0))),
                   ("instance", npy_file("<i4", (2, 2), struct.pack("<4i", *range(4))))):
    write("fuzz_truth", name, b"\0" + data)
for name, kind, data in (("dsec", 1, png(3, 2, 16, 2)), ("depth", 1, png(3, 2, 16, 0)), ("mask", 1, png(3, 2, 8, 0)),
                         ("disparity", 2, png(3, 2, 16, 0)), ("exr", 3, exr(["depth"], 3, 2, 0, False))):
    write("fuzz_truth", name, bytes([kind]) + data)
pictures = {"0.png": png(3, 2, 8, 0), "1.png": png(3, 2, 8, 2)}
write("fuzz_frames", "seconds", bytes([0, 0]) + row(FRAMES, dict(pictures, own=b"# s\n0.0\n0.5 name\n")))
write("fuzz_frames", "dsec", bytes([0, 3]) + row(FRAMES, dict(pictures, dsec=b"49599300523\n49599350523\n")))
write("fuzz_frames", "given", bytes([0, 32 | 4 * 2]) + row(FRAMES, dict(pictures, times=b"a.png, 1\na.png, 2\n")))
write("fuzz_frames", "exr", bytes([0, 64]) + row(FRAMES, {"0.exr": exr(["Y"], 3, 2, 0, False)}))
write("fuzz_frames", "npy", bytes([1, 64]) + row(FRAMES, {"npy": array}))
write("fuzz_frames", "npz", bytes([2, 1]) + row(FRAMES, {"npz": npz({"Y": (2, 1, 3), "t": (2,)})}))
video = b"YUV4MPEG2 W3 H2 F30000:1001 Ip C420jpeg\n" + 2 * (b"FRAME\n" + bytes(range(16, 26)))
write("fuzz_frames", "y4m", bytes([3, 1]) + row(FRAMES, {"y4m": video}))
write("fuzz_frames", "y4m_grey", bytes([3, 64]) + row(FRAMES, {"y4m": b"YUV4MPEG2 W3 H2 F5:1 Cmono XCOLORRANGE=FULL\nFRAME I\n012345"}))
pairs = npy_file("[('a', '<f4'), ('b', '<f4')]", (1, 1, 72), bytes(8 * 72))
write("fuzz_iebcs_noise", "pairs", pairs)
write("fuzz_frames", "pairs", bytes([1, 64]) + row(FRAMES, {"npy": pairs}))
write("fuzz_iebcs_noise", "table", npy_file("|u1", (1, 2, 72), bytes(i % 72 // 60 for i in range(144))))
write("fuzz_iebcs_noise", "real", npy_file("<f8", (1, 1, 72), struct.pack("<72d", *([0] * 60 + [1] * 12))))


# -- HDF5 files as hdf5_items.h makes them; a chunk of Prophesee's codec; manifests --------------------------------------

NAMES = ("events/p events/t events/x events/y events/t_ns events/height events/width events/ps events/ts events/xs events/ys p t x "
         "y events t_offset ms_to_idx CD/events prophesee/left/p prophesee/left/t prophesee/left/x prophesee/left/y "
         "prophesee/left/calib/resolution davis/left/events Y frames images timestamps @width @height @sensor_resolution @format "
         "@version @count @stop_ns @geometry rectify_map").split()
TYPES = "u1 i1 u2 i2 u4 i4 u8 >i8 f4 f8 bool text record".split()


def item(name, kind, shape, storage, data):
    extents = list(shape) + [1] * (3 - len(shape))
    return bytes([NAMES.index(name), TYPES.index(kind), len(shape)] + extents + [storage, len(data)]) + data


def events_of(prefix, names, types, storage):
    values = {"p": b"\1\0", "t": b"\5\0\0\0", "x": b"\1\0\2\0", "y": b"\3\0"}
    return b"".join(item(prefix + n, k, (5,), storage, values[n[0]]) for n, k in zip(names, types))


ECF = struct.pack("<IQ", 2 << 2 | 2, 5) + bytes([0x02]) + struct.pack("<3I", 0x00100300, 0x0010, 0)
size_of = item("@width", "i4", (), 0, b"\x05\0\0\0") + item("@height", "i4", (), 0, b"\x05\0\0\0")
seconds = struct.pack("<d", 0.5)
write("fuzz_hdf5", "dsec", events_of("events/", "ptxy", ["u1", "u4", "u2", "u2"], 3) + item("t_offset", ">i8", (), 0, bytes(8)))
write("fuzz_hdf5", "tides", events_of("events/", ["p", "t", "x", "y", "t_ns"], ["i1", "u4", "u2", "u2", "u8"], 2) + size_of +
      item("@format", "text", (), 0, b"tides-events") + item("@version", "i4", (), 0, b"\1\0\0\0") +
      item("@count", "u8", (), 0, b"\5" + bytes(7)) + item("@stop_ns", "u8", (), 0, b"\5" + bytes(7)))
write("fuzz_hdf5", "eds", events_of("", "ptxy", ["u1", "u4", "u2", "u2"], 1))
write("fuzz_hdf5", "timostoff", events_of("events/", ["ps", "xs", "ys"], ["bool", "i2", "i2"], 0) +
      item("events/ts", "f8", (5,), 0, seconds) + item("@sensor_resolution", "i4", (2,), 0, b"\x05\0\0\0"))
write("fuzz_hdf5", "v2e", item("events", "u4", (3, 4), 0, struct.pack("<4I", 7, 1, 2, 1)))
write("fuzz_hdf5", "mvsec", item("davis/left/events", "f8", (3, 4), 2, struct.pack("<4d", 1, 2, 0.5, 1)))
write("fuzz_hdf5", "m3ed", events_of("prophesee/left/", "ptxy", ["i1", "u8", "u2", "u2"], 1))
write("fuzz_hdf5", "rvt", events_of("events/", ["p", "t", "x", "y", "height", "width"][:4], ["u1", "u4", "u2", "u2"], 0) +
      item("events/height", "i4", (), 0, b"\x05\0\0\0") + item("events/width", "i4", (), 0, b"\x05\0\0\0"))
write("fuzz_hdf5", "ecf", item("CD/events", "record", (2,), 4, ECF) + item("@geometry", "text", (), 0, b"9x9"))
write("fuzz_hdf5", "frames", item("Y", "f4", (2, 2, 3), 0, struct.pack("<f", 0.5)) + item("t", "f8", (2,), 0, bytes(8) + seconds))
write("fuzz_hdf5", "images", item("images", "u1", (2, 2, 3), 2, b"\x10\x20") + item("timestamps", "i4", (2,), 0, b"\1\0\0\0\2\0\0\0"))


def columns(names, x):
    """An .npz of two events, at (1, 1) and (x, 2)."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as to:
        for name, dtype, values in zip(names, "qHHB", ((5, 6), (1, x), (1, 2), (1, 0))):
            kind = "<" + {"q": "i8", "H": "u2", "B": "u1"}[dtype]
            to.writestr(zipfile.ZipInfo(name + ".npy"), npy_file(kind, (2,), struct.pack("<2" + dtype, *values)))
    return out.getvalue()


FOLDER = ["events/0", "events/1", "images", "aligned/0", "aligned/1", "corrected", "0", "1", "h5", "left", "map", "right"]
picture = png(970, 625, 1, 0)[:33]
bs = ["timestamp", "x", "y", "polarity"]
dsec = events_of("events/", "ptxy", ["u1", "u4", "u2", "u2"], 3) + item("t_offset", ">i8", (), 0, bytes(8))
rectify = item("rectify_map", "f4", (9, 8, 2), 0, bytes(4))
for name, start, held in (
        ("bs_ergb", (0, 0), {"events/0": columns(bs, 65535), "events/1": columns(bs, 31039), "images": picture}),
        ("hs_ergb", (0, 0), {"aligned/0": columns("txyp", 9000), "aligned/1": columns("txyp", 3), "corrected": picture}),
        ("hs_near", (3, 1), {"aligned/0": columns("txyp", 3), "corrected": picture}),
        ("vid2e", (0, 0), {"0": columns("txyp", 3), "1": columns("txyp", 4)}),
        ("dsec", (0, 0), {"left": dsec, "map": rectify}),
        ("dsec_two", (0, 3), {"left": dsec, "right": dsec}),
        ("dsec_left", (2, 0), {"left": dsec, "map": rectify}),
        ("eds", (0, 0), {"h5": events_of("", "ptxy", ["u1", "u4", "u2", "u2"], 1)})):
    write("fuzz_event_folder", name, bytes(start) + row(FOLDER, held))
write("fuzz_ecf", "all", ECF)
write("fuzz_ecf", "rows", struct.pack("<IQ", 2 << 2, 5) + bytes([0x02]) + struct.pack("<HHB", 3 << 5 | 2, 1 << 5 | 16, 0x82))
write("fuzz_ecf", "x", struct.pack("<IQ", 1 << 2 | 1, 5) + bytes([0x31]) + struct.pack("<H3H", 3 << 5 | 1, 16, 0, 0))
# Formats of events that are read only: two events each.
def evt21(extra, words):
    head = b"%% evt 2.1\n%% format EVT21%s;height=7;width=9\n%% geometry 9x7\n%% end\n" % extra
    return head + struct.pack("<%dI" % len(words), *words)


write("fuzz_events", "evt21", evt21(b"", [0, 8 << 28 | 1, 5, 1 << 28 | 5 << 22 | 2 << 11 | 3, 1, 6 << 22]))
write("fuzz_events", "evt21_swapped", evt21(b";endianness=legacy", [8 << 28 | 1, 0, 6 << 22 | 4, 3]))
words4 = [0xB << 28, 0xE << 28 | 1, 0xA << 28 | 5 << 22 | 3 << 11 | 2, 0xFFFFFFFF, 0xD << 28 | 6 << 22 | 4 << 11 | 3, 5]
write("fuzz_events", "evt4", b"% evt 4.0\n% format EVT4;height=7;width=9\n% geometry 9x7\n% end\n" + struct.pack("<6I", *words4))
write("fuzz_events", "aedat2", b"#!AER-DAT2.0\r\n# DAVIS240\r\n" + struct.pack(">4I", 3 << 22 | 2 << 12 | 1 << 11, 5, 4 << 22 | 7 << 12, 6))
write("fuzz_events", "csv_ns", b"t_ns,x@9,y@7,p\n1000,1,2,1\n2000,3,4,-1\n")
write("fuzz_events", "ergb", columns(["timestamp", "x", "y", "polarity"], 3))
for short in range(4): # fuzz_events opens what has no mark as the format that the size leaves by four
    write("fuzz_events", "nmnist%d" % short, bytes([1, 2, 128, 0, 5, 3, 4, 0, 0, 6]) + bytes(5 * short))
write("fuzz_batch", "grid", b'{"base": "run.json", "set": {"a": 1}, "grid": {"sensor.threshold_on": [0.1, 0.2], "seed": ["1", "2"]}}')
write("fuzz_batch", "runs", b'{"runs": [{"name": "a", "file": "a.json", "set": {"b": null}}, {"name": "b", "file": "b.json"}]}')

for version in (1, 2, 3):
    write("fuzz_spz", "plain%d" % version, spz(version, version))
    write("fuzz_spz", "gzip%d" % version, gzip.compress(spz(version, 1), mtime=0))
write("fuzz_spz", "v4", spz4())
for mode in range(3):
    write("fuzz_ksplat", str(mode), ksplat(mode))
write("fuzz_splat", "two", struct.pack("<6f", 1, 2, 3, 1, 1, 1) + bytes(range(8)) + struct.pack("<6f", *range(1, 7)) + bytes(8))
splats = [{"type": "notes", "size": 3}, {"type": "splat", "size": 65536, "texwidth": 4096, "texheight": 1, "cameras": []}]
head = json.dumps(splats).encode()
row = struct.pack("<3f", 1, 2, 3) + struct.pack("<7e2x4B", 1, 0, 0, 0, 0.1, 0.2, 0.3, 9, 99, 255, 128) + struct.pack("<9e2x6e", *range(9), 0, 0, 0, 1, 0.5, 0.1)
write("fuzz_splatv", "two", struct.pack("<II", 0x674B, len(head)) + head + b"abc" + 2 * row + bytes(65536 - 128))
write("fuzz_ply", "packed", packed_ply())
os.makedirs(os.path.join(folder, "fuzz_sog"), exist_ok=True)
sog(os.path.join(folder, "fuzz_sog", "seed_one"), 2)
sog(os.path.join(folder, "fuzz_sog", "seed_version1"), 1)
write("fuzz_gltf", "binary", gltf(False))
write("fuzz_gltf", "draft", gltf(True))
write("fuzz_sog_lod", "two", b'{"version": 1, "environment": "env/meta.json", "filenames": ["0_0/meta.json", "1_0/meta.json"], "tree": '
      b'{"children": [{"lods": {"0": {"file": 0, "offset": 0, "count": 3}, "1": {"file": 1, "offset": 0, "count": 1}}}]}}')
colmap()
npy = "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 17), }".ljust(117) + "\n"
pose = struct.pack("<17d", 0, 1, 0, 0, 480, 1, 0, 0, 0, 640, 0, 0, -1, 0, 500, 1, 9)
write("fuzz_path", "llff", b"\x93NUMPY\1\0\x76\0" + npy.encode() + pose)
write("fuzz_path", "euroc", b"#q_RS_w\n" + b"".join(b"%d,1,2,3,1,0,0,0,0,0,0,0,0,0,0,0,0\n" % (10**9 * i) for i in range(3)))
write("fuzz_path", "kitti", b"1 0 0 0 0 1 0 0 0 0 1 0\n0 0 1 1 -1 0 0 2 0 -1 0 3\n")
write("fuzz_path", "nerfies", b'{"orientation": [[1,0,0],[0,1,0],[0,0,1]], "position": [0,0,0], "focal_length": 5, '
      b'"principal_point": [3,2], "image_size": [6,4]}')

# Worlds by chance, for targets that make some of their input: formats in turn, and what is long enough to fill them.
chance = random.Random(16)
for k in range(18):
    gaps = [0, 4, 10, 20, 31] if k % 2 else [0]
    events = b"".join(chance.randbytes(2) + bytes([chance.choice(gaps)]) + chance.randbytes(5) for _ in range(120))
    write("fuzz_back_events", str(k), bytes([k, chance.randrange(196)]) + events)
for k in range(10):
    sizes = bytes([k % 5, k % 5, 3 + k, 20 + k, 0, 20 * k, 0, 80])
    write("fuzz_back_scenes", str(k), sizes + chance.randbytes(1500))
for k in range(12):
    write("fuzz_runs", str(k), bytes([11 * k]) + chance.randbytes(400))
