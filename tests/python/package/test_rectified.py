"""DSEC through lenses, of cameras that aren't parallel: calibration, map, flow, disparity and pictures against closed
forms."""

import json
import re

import numpy as np
import pytest
import tides
from read_png import decode_flow, read_png

METRES, SIZE = 0.5, (48, 36)
LENSES = {
    "left": {"lens": "radtan", "k1": -0.2, "k2": 0.05, "p1": 0.001, "p2": -0.002, "fx": 52.0, "fy": 50.0},
    "right": {"lens": "equidistant", "k1": 0.02, "k2": -0.01, "cx": 25.5, "cy": 17.0},
}
NORMAL, DISTANCE = np.array([-0.2, 0.1, 1.0]) / np.sqrt(1.05), 4.0  # of the plane that is seen: NORMAL . X = DISTANCE


def turn(x, y, z):
    """A rotation of small angles [rad] about each axis in turn, and its quaternion (wxyz)."""
    q = np.array([1.0, 0, 0, 0])
    for axis, angle in enumerate((x, y, z)):
        w, v = np.cos(angle / 2), np.sin(angle / 2) * np.eye(3)[axis]
        q = np.r_[q[0] * w - q[1:] @ v, q[0] * v + w * q[1:] + np.cross(q[1:], v)]
    return rotation_of(q), q


def rotation_of(q):
    w, (x, y, z) = q[0], q[1:]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def pose(position, angles):
    made = np.eye(4)
    made[:3, :3], made[:3, 3] = turn(*angles)[0], position
    return made


MOUNTS = {"left": pose([0, 0, 0], [0.02, 0.1, 0.03]), "right": pose([0.3, 0.02, 0.05], [-0.04, -0.08, 0.01])}


def bend(lens, x, y):
    """Of a ray (x, y, 1), as OpenCV documents both models."""
    r2 = x * x + y * y
    if lens["lens"] == "radtan":
        radial = 1 + lens["k1"] * r2 + lens["k2"] * r2**2
        p1, p2 = lens["p1"], lens["p2"]
        return radial * x + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), radial * y + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    r = np.sqrt(r2)
    theta = np.arctan(r)
    scale = theta * (1 + lens["k1"] * theta**2 + lens["k2"] * theta**4) / np.where(r > 0, r, 1)
    return scale * x, scale * y


def numbers(text, name):
    """A list behind `name:`, or the rows of a matrix."""
    found = re.search(rf"^ +{name}: *((?:\n? *-? *\[[^]]*\])+)", text, re.M).group(1)
    rows = [[float(one) for one in row.split(",")] for row in re.findall(r"\[([^]]*)\]", found)]
    return np.array(rows if len(rows) > 1 else rows[0])


def camera(text, name):
    """fx, fy, cx, cy of a camera."""
    return numbers(text.split(f"  {name}:")[1], "camera_matrix")


def pinhole(fx, fy, cx, cy):
    return tides.Intrinsics(width=SIZE[0], height=SIZE[1], fx=fx, fy=fy, cx=cx, cy=cy)


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    folder = tmp_path_factory.mktemp("rectified")
    scene = tides.Scene()
    axis = np.cross([0, 0, 1], NORMAL)
    plane = np.r_[1 + NORMAL[2], axis] / np.linalg.norm(np.r_[1 + NORMAL[2], axis])
    wall = tides.Gaussians.from_colours([DISTANCE * NORMAL], [[40, 40, 1e-6]], [[0.3, 0.2, 0.1]], 0.999, plane)
    scene.add(wall, name="wall")
    scene.save(folder / "wall.h5")
    times = np.array([0, 0.1, 0.2])
    turns = np.array([turn(0.4 * t, -0.8 * t, 1.2 * t)[1] for t in times])
    path = tides.Trajectory(times, np.outer(times, [4, 2, 1.6]), turns)
    tides.Camera(path, pinhole(50.0, 50.0, 24.0, 18.0)).save(folder / "path.json")
    rig = [{"name": name, "T_B_C": MOUNTS[name].tolist(), "camera": lens} for name, lens in LENSES.items()]
    run = {
        "scene": {"file": "wall.h5", "metres_per_unit": METRES},
        "camera": {"file": "path.json"},
        "time": {"start": 0, "stop": 0.2},
        "stepping": {"step_s": 0.1},
        "rig": {"cameras": rig},
    }
    (folder / "run.json").write_text(json.dumps(run))
    with tides.Session(folder / "run.json", device="reference-f32") as session:
        session.dataset(folder / "dsec", "dsec")
        text = (folder / "dsec/calibration/cam_to_cam.yaml").read_text()
        yield {"folder": folder, "root": folder / "dsec", "session": session, "text": text, "path": path}


def ways_of(world, side):
    h5py = pytest.importorskip("h5py")
    with h5py.File(world["root"] / f"events/{side}/rectify_map.h5") as file:
        return file["rectify_map"][:].astype(np.float64)


@pytest.mark.parametrize("side, number", [("left", 0), ("right", 3)])
def test_map(world, side, number):
    """What a raw pixel shows is there in the rectified view: its ray, bent by the lens that the file has, is the pixel."""
    text, lens = world["text"], LENSES[side]
    fx, fy, cx, cy = camera(text, f"camRect{number}")
    ways, rotation = ways_of(world, side), numbers(text, f"R_rect{number}")
    assert ways.shape == (*SIZE[::-1], 2)
    rays = np.stack([(ways[..., 0] - cx) / fx, (ways[..., 1] - cy) / fy, np.ones(SIZE[::-1])], -1) @ rotation
    x, y = bend(lens, rays[..., 0] / rays[..., 2], rays[..., 1] / rays[..., 2])
    fx, fy, cx, cy = camera(text, f"cam{number}")
    assert np.allclose([cx, cy], [lens.get("cx", 24) - 0.5, lens.get("cy", 18) - 0.5])
    rows, columns = np.mgrid[: SIZE[1], : SIZE[0]]
    assert np.abs(fx * x + cx - columns).max() < 1e-4 and np.abs(fy * y + cy - rows).max() < 1e-4
    assert np.abs(ways - np.stack([columns, rows], -1)).max() > 1
    raw = text.split(f"  cam{number}:")[1]
    assert f"distortion_model: {lens['lens']}" in raw.split("camRect")[0]
    named = ("k1", "k2", "p1", "p2") if lens["lens"] == "radtan" else ("k1", "k2", "k3", "k4")
    assert numbers(raw, "distortion_coeffs").tolist() == [lens.get(name, 0) for name in named]


def test_pair(world):
    """One intrinsics, one way to look, and the baseline along x."""
    text = world["text"]
    assert camera(text, "camRect0").tolist() == camera(text, "camRect3").tolist()
    between = numbers(text, "T_10") @ np.eye(4), numbers(text, "T_21"), numbers(text, "T_32")
    left_to_right = between[2] @ between[1] @ between[0]
    one, two = numbers(text, "R_rect0"), numbers(text, "R_rect3")
    assert np.allclose(two @ left_to_right[:3, :3] @ one.T, np.eye(3), atol=1e-12)
    apart = METRES * np.linalg.norm(MOUNTS["right"][:3, 3] - MOUNTS["left"][:3, 3])
    assert np.allclose(two @ left_to_right[:3, 3], [-apart, 0, 0], atol=1e-12)
    fx, _, cx, cy = camera(text, "camRect0")
    q = numbers(text, "cams_03")
    assert np.allclose(q, [[1, 0, 0, -cx], [0, 1, 0, -cy], [0, 0, 0, fx], [0, 0, 1 / apart, 0]])
    assert np.array_equal(q, numbers(text, "cams_12")) and np.array_equal(one, numbers(text, "R_rect1"))


def place_of(world, t):
    """The left rectified view at a time: rotation to the world, and position."""
    body = world["path"].at(t)
    left = MOUNTS["left"]
    rotation = body.rotation @ left[:3, :3] @ numbers(world["text"], "R_rect0").T
    return rotation, body.position + body.rotation @ left[:3, 3]


def on_the_plane(world, t):
    """What each pixel of the left rectified view shows [scene units], and its depth."""
    fx, fy, cx, cy = camera(world["text"], "camRect0")
    rows, columns = np.mgrid[: SIZE[1], : SIZE[0]]
    rotation, position = place_of(world, t)
    rays = np.stack([(columns - cx) / fx, (rows - cy) / fy, np.ones(SIZE[::-1])], -1) @ rotation.T
    depth = (DISTANCE - NORMAL @ position) / (rays @ NORMAL)
    return position + depth[..., None] * rays, depth


def seen_at(world, points, t):
    fx, fy, cx, cy = camera(world["text"], "camRect0")
    rotation, position = place_of(world, t)
    x, y, z = np.moveaxis((points - position) @ rotation, -1, 0)
    return np.stack([fx * x / z + cx, fy * y / z + cy], -1)


def test_flow_and_disparity(world):
    here = np.stack(np.meshgrid(np.arange(SIZE[0]), np.arange(SIZE[1])), -1)
    for name, start, stop in (("forward/000000", 0, 0.1), ("forward/000002", 0.1, 0.2), ("backward/000002", 0.1, 0)):
        points, depth = on_the_plane(world, start)
        flow, known = decode_flow(world["root"] / f"flow/{name}.png")
        wanted = seen_at(world, points, stop) - here
        assert known.all() and np.abs(wanted).max() > 2
        assert np.abs(flow - wanted).max() < 0.5 / 128 + 1e-4
    points, depth = on_the_plane(world, 0.1)
    fx, apart = camera(world["text"], "camRect0")[0], 1 / numbers(world["text"], "cams_03")[3, 2]
    disparity = read_png(world["root"] / "disparity/event/000002.png") / 256
    assert np.abs(disparity - fx * apart / (METRES * depth)).max() < 0.5 / 256 + 1e-4


def test_pictures_are_what_the_views_see(world):
    """And other layouts' beside them are raw."""
    fx, fy, cx, cy = camera(world["text"], "camRect2")
    rotation = MOUNTS["right"][:3, :3] @ numbers(world["text"], "R_rect2").T
    body, session = world["path"], world["session"]
    w = np.sqrt(1 + np.trace(rotation)) / 2
    skew = (rotation - rotation.T) / (4 * w)
    q = [w, skew[2, 1], skew[0, 2], skew[1, 0]]
    view = tides.Camera(body.mounted(MOUNTS["right"][:3, 3], q), pinhole(fx, fy, cx + 0.5, cy + 0.5))
    with tides.Renderer(session.scene, view, session.values.image, device="reference-f32") as renderer:
        frame = renderer.frame(0.1, ["R", "G", "B"])
    light = np.clip(np.stack([frame[name] for name in "RGB"], -1), 0, 1)
    wanted = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    got = read_png(world["root"] / "images/right/rectified/000002.png") / 255
    assert np.abs(got - wanted).max() < 0.51 / 255


def test_wrong_rigs_are_named(world):
    folder = world["folder"]
    ahead = pose([0, 0, 0.3], [0, 0, 0])
    cases = (
        ({"name": "b", "T_B_C": ahead.tolist()}, "can't be rectified"),
        ({"name": "b", "T_B_C": pose([-0.3, 0, 0], [0, 0, 0]).tolist()}, "to the right"),
        ({"name": "b", "T_B_C": pose([0.3, 0, 0], [0, 0, 0]).tolist(), "camera": {"width": 47}}, "of one size"),
    )
    for second, words in cases:
        with tides.Session(folder / "run.json", {"rig.cameras": [{"name": "a"}, second]}, device="reference-f32") as session:
            with pytest.raises(tides.errors.BadConfig, match=words):
                session.dataset(folder / "no", "dsec")
    rolling = {"exposure.exposure_s": 0.01, "exposure.shutter": "rolling"}
    with tides.Session(folder / "run.json", rolling, device="reference-f32") as session:
        with pytest.raises(tides.errors.BadConfig, match="rolling shutter"):
            session.dataset(folder / "no", "dsec")


def test_four_cameras_are_two_pairs(world):
    """As DSEC has it: events from 0 and 3, pictures from 1 and 2; each pair is rectified by itself."""
    places = {"a": [0, 0, 0], "b": [0.05, 0, 0], "c": [0.45, 0.03, 0], "d": [0.6, 0, 0.02]}
    kinds = ("event", "frame", "frame", "event")
    rig = [
        {"name": name, "kind": kind, "T_B_C": pose(place, [0.01 * k, -0.02 * k, 0.03]).tolist(), "camera": LENSES["left"]}
        for k, (kind, (name, place)) in enumerate(zip(kinds, places.items()))
    ]
    settings = {"rig.cameras": rig, "time.stop": 0.1}
    with tides.Session(world["folder"] / "run.json", settings, device="reference-f32") as session:
        session.dataset(world["folder"] / "four", "dsec")
    root = world["folder"] / "four"
    text = (root / "calibration/cam_to_cam.yaml").read_text()
    steps = [numbers(text, name) for name in ("T_10", "T_21", "T_32")]
    turns = [numbers(text, f"R_rect{k}") for k in range(4)]
    for one, two, way, q in ((0, 3, steps[2] @ steps[1] @ steps[0], "cams_03"), (1, 2, steps[1], "cams_12")):
        assert np.allclose(turns[two] @ way[:3, :3] @ turns[one].T, np.eye(3), atol=1e-12)
        assert np.allclose(turns[two] @ way[:3, 3], [-1 / numbers(text, q)[3, 2], 0, 0], atol=1e-12)
        assert camera(text, f"camRect{one}").tolist() == camera(text, f"camRect{two}").tolist()
    assert not np.allclose(turns[0], turns[1], atol=1e-3)
    assert {len(list((root / f"images/{side}/rectified").iterdir())) for side in ("left", "right")} == {3}
    assert len(list((root / "disparity/event").iterdir())) == 2 and (root / "events/right/rectify_map.h5").exists()
