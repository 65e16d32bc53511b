"""Reads each dataset as its own published code does: the same files, keys, windows and decodings, with that code's
assertions."""

import math
from pathlib import Path

import numpy as np
import readers


def png(file):
    """16 bits and 8, as PIL and pypng have them: PIL knows no 16-bit RGB."""
    width, height, rows, info = readers.import_client("png").Reader(filename=str(file)).read()
    values = np.vstack([np.asarray(row) for row in rows]).reshape(height, width, info["planes"])
    return values.astype(np.uint16 if info["bitdepth"] == 16 else np.uint8)


# -- DSEC -----------------------------------------------------------------------------------------------------------------
class EventSlicer:
    """DSEC's: windows [us] by its index of whole milliseconds from t_offset on."""

    def __init__(self, file):
        self.events = {name: file[f"events/{name}"] for name in "pxyt"}
        self.ms_to_idx = np.asarray(file["ms_to_idx"], dtype="int64")
        self.t_offset = int(file["t_offset"][()])
        self.t_final = int(self.events["t"][-1]) + self.t_offset if len(self.events["t"]) else self.t_offset

    def get_events(self, start_us, end_us):
        assert start_us < end_us
        start_us, end_us = start_us - self.t_offset, end_us - self.t_offset
        first, last = math.floor(start_us / 1000), math.ceil(end_us / 1000)
        if first >= self.ms_to_idx.size or last >= self.ms_to_idx.size:
            return None
        window = slice(self.ms_to_idx[first], self.ms_to_idx[last])
        t = np.asarray(self.events["t"][window]).astype(np.int64)
        inside = slice(*np.searchsorted(t, [start_us, end_us]))
        return {"t": t[inside] + self.t_offset} | {name: np.asarray(self.events[name][window])[inside] for name in "xyp"}


def dsec_flow(file):
    values = png(file)
    assert values.dtype == np.uint16 and values.ndim == 3 and values.shape[2] == 3
    valid = values[..., 2] == 1
    assert np.all(values[~valid, -1] == 0)
    flow = np.zeros((*valid.shape, 2))
    flow[valid] = (values[valid][:, :2].astype(np.float64) - 2**15) / 128
    return flow, valid


def dsec_disparity(file):
    return np.array(readers.import_client("PIL.Image").open(str(file))).astype("float32") / 256


def dsec_timestamps(file):
    return np.loadtxt(file, dtype="int64", delimiter=",", ndmin=2)


# -- MVSEC ----------------------------------------------------------------------------------------------------------------
def mvsec_between(davis, index):
    """Events between two pictures, which are columns x, y, t, p."""
    indices = davis["image_raw_event_inds"]
    return davis["events"][indices[index] : indices[index + 1]]


def mvsec_flow(file, start):
    """The displacement that begins last before a time."""
    flow = np.load(file)
    index = np.searchsorted(flow["timestamps"], start, side="right") - 1
    return flow["x_flow_dist"][index], flow["y_flow_dist"][index]


# -- EVIMO2 ---------------------------------------------------------------------------------------------------------------
def evimo(folder):
    """Events as one array (t, x, y, p); planes by the number in their names, as its index of frames counts them."""
    t, xy, p = (np.load(folder / f"dataset_events_{name}.npy", mmap_mode="r") for name in ("t", "xy", "p"))
    events = np.hstack([np.atleast_2d(t).T, xy, np.atleast_2d(p).T])
    planes = {}
    for kind in ("depth", "mask", "flow", "classical"):
        with np.load(folder / f"dataset_{kind}.npz") as file:
            planes[kind] = {int(key.split("_")[1]): file[key] for key in file.files if key.startswith(kind)}
            planes[kind] |= {key: file[key] for key in ("t", "t_end", "t_between") if key in file.files}
    return events, planes, np.load(folder / "dataset_info.npz", allow_pickle=True)


def evimo_poses(meta):
    """Of the camera and of each object by its number, times and 4x4 matrices: what every sample has but id, ts and gt_frame."""
    names = [name for name in meta["full_trajectory"][0] if name not in ("id", "ts", "gt_frame")]
    rows = {name: [(one["ts"], matrix(one[name]["pos"])) for one in meta["full_trajectory"]] for name in names}
    return {name if name == "cam" else int(name): tuple(map(np.array, zip(*some))) for name, some in rows.items()}


def matrix(pos):
    w, *v = (pos["q"][k] for k in "wxyz")
    made = np.eye(4)
    made[:3, :3] = (2 * w * w - 1) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * np.cross(np.eye(3), v)
    made[:3, 3] = [pos["t"][k] for k in "xyz"]
    return made


def evimo_project(lens, points):
    """By meta's fx ... p2, as OpenCV's radtan without a third coefficient; points (n, 3) to (n, 2)."""
    x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
    r2 = x * x + y * y
    bent = 1 + lens["k1"] * r2 + lens["k2"] * r2 * r2
    u = x * bent + 2 * lens["p1"] * x * y + lens["p2"] * (r2 + 2 * x * x)
    v = y * bent + 2 * lens["p2"] * x * y + lens["p1"] * (r2 + 2 * y * y)
    return np.stack([lens["fx"] * u + lens["cx"], lens["fy"] * v + lens["cy"]], -1)


def evimo_rays(lens, shape):
    """Where each pixel looks, at a depth of 1: the projection turned around, step by step."""
    pixels = np.stack(np.meshgrid(np.arange(shape[1]), np.arange(shape[0])), -1).reshape(-1, 2).astype(float)
    rays = np.ones((len(pixels), 3))
    for _ in range(50):
        rays[:, :2] += (pixels - evimo_project(lens, rays)) / [lens["fx"], lens["fy"]]
    return rays, pixels


def evimo_tracks(folder, first=1):
    """ETAP's way through a sequence, and evimo_flow's with dframes: points of frame `first` go with the poses of the object that
    its mask names, to each later frame. The depth of a frame is under its place, and under its id less the first's; numbers have
    no gaps. Yields the frame's place, the points' mask and where they come to, NaN where there is no pose."""
    info = np.load(folder / "dataset_info.npz", allow_pickle=True)["meta"].item()
    with np.load(folder / "dataset_depth.npz") as depths, np.load(folder / "dataset_mask.npz") as masks:
        frames, lens, poses = info["frames"], info["meta"], evimo_poses(info)
        numbers = sorted(int(key.split("_")[1]) for key in depths.files)
        assert numbers == list(range(len(frames))) and {lens["dist_model"]} <= {"radtan", "equidistant"}
        depth, mask = (file[f"{kind}_{first:010d}"] for kind, file in (("depth", depths), ("mask", masks)))
        rays, _ = evimo_rays(lens, depth.shape)
        points = rays * depth.reshape(-1, 1) / 1000.0
        for k, frame in enumerate(frames[first + 1 :], first + 1):
            assert f"depth_{frame['id'] - frames[0]['id']:010d}" in depths.files and frame["id"] == k
            moved = np.full((len(points), 2), np.nan)
            for number in poses.keys() - {"cam"}:
                inside = (mask.reshape(-1) == 1000 * number) & (depth.reshape(-1) > 0)
                ways = [poses[number][1][np.flatnonzero(poses[number][0] == one["cam"]["ts"])[0]] for one in (frames[first], frame)]
                way = ways[1] @ np.linalg.inv(ways[0])
                if inside.any():
                    moved[inside] = evimo_project(lens, points[inside] @ way[:3, :3].T + way[:3, 3])
            yield k, mask, moved.reshape(*depth.shape, 2)


# -- BlinkFlow ------------------------------------------------------------------------------------------------------------
def blinkflow(folder):
    """Of each flow the events beside it: fps and duration from config.yaml, else 10 and 1; windows by the index of the events'
    own milliseconds."""
    file = folder / "config.yaml"
    config = dict(line.split(": ") for line in file.read_text().splitlines()) if file.exists() else {}
    fps, duration = float(config.get("fps", 10)), float(config.get("duration", 1.0))
    with readers.import_client("h5py").File(folder / "events_left/events.h5") as file:
        columns, index = {name: file[f"events/{name}"][()] for name in "txyp"}, file["ms_to_idx"][()]
    pairs = []
    for k in range(round(fps * duration)):
        start, end = (round(1e6 * (k + one) / fps) for one in (0, 1))
        assert end // 1000 < len(index)
        first, last = (np.searchsorted(columns["t"], us) for us in (start, end))
        assert index[start // 1000] <= first
        pairs.append((np.load(folder / f"forward_flow/{k:06d}.npy"), {name: columns[name][first:last] for name in "txyp"}))
    assert len(list((folder / "forward_flow").iterdir())) == len(pairs)
    return pairs


# -- Kubric ---------------------------------------------------------------------------------------------------------------
def kubric(folder):
    """As EventKubric's: tracks by frame, and where they are seen; queries are where each is seen first."""
    annotations = np.load(str(folder / "annotations.npy"), allow_pickle=True).item()
    places = np.transpose(annotations["target_points"], (1, 0, 2))
    visible = np.transpose(np.logical_not(annotations["occluded"]), (1, 0))
    first = visible.argmax(axis=0)
    queries = np.stack([[frame, *places[frame, point]] for point, frame in enumerate(first)])
    return places, visible, queries


# -- TUM ------------------------------------------------------------------------------------------------------------------
def tum_list(file):
    lines = Path(file).read_text().replace(",", " ").replace("\t", " ").split("\n")
    rows = [[word for word in line.split(" ") if word] for line in lines if line and line[0] != "#"]
    return {float(row[0]): row[1:] for row in rows}


def tum_associate(first, second, most=0.02):
    """Its associate.py: greedily the nearest pairs of times."""
    near = sorted((abs(a - b), a, b) for a in first for b in second if abs(a - b) < most)
    matches, left, right = [], set(first), set(second)
    for _, a, b in near:
        if a in left and b in right:
            left.remove(a)
            right.remove(b)
            matches.append((a, b))
    return sorted(matches)


# -- ECD ------------------------------------------------------------------------------------------------------------------
def ecd_events(file):
    return np.loadtxt(file, ndmin=2).reshape(-1, 4).T


def calibration(file):
    """fx fy cx cy k1 k2 p1 p2 k3."""
    return np.loadtxt(file)
