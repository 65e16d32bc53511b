"""Datasets: the content of each layout's files, read as by their users, equals the renderer's."""

import json
import struct

import numpy as np
import pytest
import tides
from read_png import decode_flow, read_png

BASELINE, METRES = 0.2, 0.5
LAYOUTS = ("ecd", "dsec", "mvsec", "evimo", "blinkflow", "tum", "ros2", "kubric")


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    """A cloud that turns before a stereo rig, its dataset in every layout, and what a renderer says at its times."""
    folder = tmp_path_factory.mktemp("dataset")
    random = np.random.default_rng(3)
    cloud = tides.Gaussians.from_colours(
        random.uniform(-1, 1, (120, 3)), random.uniform(0.1, 0.25, (120, 3)), random.uniform(0, 1, (120, 3))
    )
    scene = tides.Scene()
    scene.add(cloud, name="cloud")
    scene.save(folder / "cloud.h5")
    path = tides.Trajectory.orbit(radius=4, angular_speed=1, start=1, stop=1.21)
    tides.Camera(path, tides.Intrinsics.from_fov(40, 28, 0.8)).save(folder / "path.json")
    right = np.eye(4)
    right[0, 3] = BASELINE
    run = {
        "scene": {"file": "cloud.h5", "metres_per_unit": METRES},
        "camera": {"file": "path.json"},
        "time": {"start": 1, "stop": 1.21},
        "stepping": {"step_s": 0.01},
        "imu": {"down": [0, 1, 0], "rate_hz": 100},
        "rig": {"cameras": [{"name": "one"}, {"name": "two", "T_B_C": right.tolist()}]},
    }
    (folder / "run.json").write_text(json.dumps(run))
    with tides.Session(folder / "run.json", device="reference-f32") as session:
        report = session.dataset(folder / "all", LAYOUTS)
        with session.vary({"rig.camera": "two"}) as other:
            events = [session.simulate(), other.simulate()]
        with session.renderer() as renderer:
            times = [1.0, 1.1, 1.2]
            truth = [renderer.truth(t) for t in times]
            moves = [renderer.displacement(a, b) for a, b in ((1.0, 1.1), (1.1, 1.2), (1.1, 1.0), (1.2, 1.1))]
            frame = renderer.frame(1.05, ["Y"])["Y"]
        poses = session.camera.trajectory
        intrinsics = session.intrinsics
        imu = poses.imu(tides.Imu(rate_hz=100, down=(0, 1, 0), metres_per_unit=METRES), 1.0, 1.21)
        yield {**locals(), "all": folder / "all"}


def test_what_is_made(world):
    assert world["report"].cameras == 2 and world["report"].events == sum(len(one) for one in world["events"]) > 1000
    assert (world["report"].pictures, world["report"].truths, world["report"].poses) == (5, 3, 43)
    assert [one.name for one in tides.dataset_layouts()] == list(LAYOUTS)
    assert (world["all"] / "contact.png").exists() and not list(world["folder"].glob("*.part"))
    assert not np.array_equal(world["events"][0], world["events"][1])


def same_events(got, wanted):
    """Columns t [ns], x, y, ON."""
    t, x, y, p = got
    assert np.array_equal(t, wanted["t"]) and np.array_equal(x, wanted["x"]) and np.array_equal(y, wanted["y"])
    assert np.array_equal(p > 0, wanted["p"] > 0)


def test_ecd(world):
    root = world["all"] / "ecd" / "one"
    rows = [line.split() for line in (root / "events.txt").read_text().splitlines()]
    columns = [np.array([int(row[0].replace(".", "")) for row in rows])]
    columns += [np.array([int(row[i]) for row in rows]) for i in (1, 2, 3)]
    same_events(columns, world["events"][0])
    k = np.loadtxt(root / "calib.txt")
    lens = world["intrinsics"]
    assert np.array_equal(k, [lens.fx, lens.fy, lens.cx - 0.5, lens.cy - 0.5, 0, 0, 0, 0, 0])
    poses = np.loadtxt(root / "groundtruth.txt")
    assert np.allclose(poses[:, 0], 1 + np.arange(43) / 200, atol=1e-9)
    for row in poses[::9]:
        pose = world["poses"].at(row[0])
        x, y, z, w = row[4:]
        third = [2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)]
        assert np.allclose(row[1:4], METRES * pose.position, atol=1e-15)
        assert np.allclose(third, pose.rotation[:, 2], atol=1e-14)
    (t, name), *_ = [line.split() for line in (root / "images.txt").read_text().splitlines()][1:]
    grey, y = read_png(root / name) / 255.0, np.clip(world["frame"], 0, 1)
    wanted = np.where(y <= 0.0031308, 12.92 * y, 1.055 * y ** (1 / 2.4) - 0.055)
    imu, reference = np.loadtxt(root / "imu.txt"), world["imu"]
    assert np.allclose(imu[:, 0], 1 + np.arange(22) / 100, atol=1e-9)
    assert np.array_equal(imu[:, 1:4], reference["specific_force"]) and np.array_equal(imu[:, 4:], reference["angular_rate"])
    assert t == "1.050000" and np.abs(grey - wanted).max() < 0.51 / 255
    depth = tides.image.read_exr(root / "depthmaps/frame_00000001.exr")
    assert np.array_equal(depth["Z"], (METRES * world["truth"][1]["depth_median"]).astype(np.float32))


def test_dsec(world):
    h5py = pytest.importorskip("h5py")
    root = world["all"] / "dsec"
    for side, events in zip(("left", "right"), world["events"]):
        with h5py.File(root / "events" / side / "events.h5") as file:
            t, us = file["events/t"][:].astype(np.int64), file["ms_to_idx"][:]
            assert np.array_equal(t + file["t_offset"][()], events["t"] // 1000)
            window = slice(us[1050], us[1100])  # DSEC's own: whole milliseconds from t_offset on
            assert np.array_equal(t[window], t[(t >= 1050000) & (t < 1100000)]) and len(t[window])
            same_events([events["t"], *(file["events"][name][:] for name in "xyp")], events)
        with h5py.File(root / "events" / side / "rectify_map.h5") as file:
            ways = file["rectify_map"][:]
        assert ways.shape == (28, 40, 2) and ways.dtype == np.float32
        assert np.array_equal(ways[7, 11], [11, 7])
        assert len(list((root / "images" / side / "rectified").glob("*.png"))) == 5
    times = np.loadtxt(root / "flow/forward_timestamps.txt", delimiter=",", dtype=np.int64)
    assert times.tolist() == [[1000000, 1100000], [1100000, 1200000]]
    times = np.loadtxt(root / "flow/backward_timestamps.txt", delimiter=",", dtype=np.int64)
    assert times.tolist() == [[1100000, 1000000], [1200000, 1100000]]
    files = ("forward/000000", "forward/000002", "backward/000002", "backward/000004")
    for name, move in zip(files, world["moves"]):
        flow, known = decode_flow(root / f"flow/{name}.png")
        wanted = np.stack([move["u"], move["v"]], -1)
        assert known.any() and np.array_equal(known, np.isfinite(wanted).all(-1))
        assert np.abs(flow - wanted)[known].max() <= 0.5 / 128
        planes = tides.image.read_truth(root / f"flow/{name}.png")
        read = np.stack([planes["displacement_u"], planes["displacement_v"]], -1)
        assert np.array_equal(read, np.where(known[..., None], flow, np.nan), equal_nan=True)
    disparity, depth = read_png(root / "disparity/event/000002.png") / 256, world["truth"][1]["depth_median"]
    assert np.array_equal(disparity > 0, depth > 0)
    assert np.abs(disparity[depth > 0] - world["intrinsics"].fx * BASELINE / depth[depth > 0]).max() <= 0.5 / 256
    read = tides.image.read_truth(root / "disparity/event/000002.png")["disparity"]
    assert np.array_equal(np.nan_to_num(read), disparity)
    text = (root / "calibration/cam_to_cam.yaml").read_text()
    q = [float(one) for one in text.split("cams_03:")[1].split("- [")[4].split("]")[0].split(",")]
    assert np.isclose(1 / q[2], BASELINE * METRES) and "T_32:" in text and "camRect0:" in text


def test_mvsec(world):
    h5py = pytest.importorskip("h5py")
    root = world["all"] / "mvsec"
    with h5py.File(root / "all_data.hdf5") as data, h5py.File(root / "all_gt.hdf5") as truth:
        for side, events in zip(("left", "right"), world["events"]):
            own = data["davis"][side]
            x, y, t, p = own["events"][:].T
            same_events([np.round(1e9 * t).astype(np.int64), x, y, p], events)
            assert set(np.unique(p)) == {-1, 1} and own["image_raw"].shape == (5, 28, 40)
            for time, index in zip(own["image_raw_ts"], own["image_raw_event_inds"]):
                assert index == max(np.sum(events["t"] <= round(1e9 * time)) - 1, 0)
        own = truth["davis/left"]
        for i, wanted in enumerate(world["truth"]):
            depth = np.where(wanted["depth_median"] > 0, METRES * wanted["depth_median"], np.nan).astype(np.float32)
            assert np.array_equal(own["depth_image_raw"][i], depth, equal_nan=True)
        assert np.array_equal(data["davis/left/imu"][:, :3], world["imu"]["specific_force"])
        assert np.array_equal(data["davis/left/imu_ts"], world["imu"]["time"])
        assert np.array_equal(own["depth_image_raw_ts"], [1.0, 1.1, 1.2])
        pose = world["poses"].at(own["pose_ts"][7])
        assert np.allclose(own["pose"][7][:3, :3], pose.rotation, atol=1e-15)
        assert np.allclose(own["pose"][7][:3, 3], METRES * pose.position, atol=1e-15)
        flow = np.load(root / "all_gt_flow_dist.npz")
        for i in range(2):
            assert np.array_equal(own["flow_dist"][i][0], np.nan_to_num(world["moves"][i]["u"]))
            assert np.array_equal(flow["y_flow_dist"][i], np.nan_to_num(world["moves"][i]["v"]))
        assert np.array_equal(flow["x_flow_dist"], own["flow_dist"][:, 0])
        assert np.array_equal(flow["timestamps"], own["flow_dist_ts"][:])


def test_evimo(world):
    root = world["all"] / "evimo" / "two"
    t, xy, p = (np.load(root / f"dataset_events_{name}.npy") for name in ("t", "xy", "p"))
    same_events([np.round(1e9 * t).astype(np.int64), *xy.T, p], world["events"][1])
    root = world["all"] / "evimo" / "one"
    depth, mask, flow = (np.load(root / f"dataset_{name}.npz") for name in ("depth", "mask", "flow"))
    wanted = world["truth"][2]
    assert np.array_equal(depth["depth_0000000002"], np.round(1000 * METRES * wanted["depth_median"]))
    assert np.array_equal(mask["mask_0000000002"], 1000 * (wanted["instance"] + 1))
    assert np.array_equal(flow["flow_0000000001"][..., 0], world["moves"][1]["u"].astype(np.float32), equal_nan=True)
    assert np.array_equal(flow["t"], [1.0, 1.1]) and np.array_equal(flow["t_end"], [1.1, 1.2])
    info, lens = np.load(root / "dataset_info.npz"), world["intrinsics"]
    assert np.array_equal(info["K"], [[lens.fx, 0, lens.cx - 0.5], [0, lens.fy, lens.cy - 0.5], [0, 0, 1]])
    assert np.load(root / "dataset_classical.npz")["classical_0000000002"].shape == (28, 40, 3)


def test_blinkflow_and_tum(world):
    flow = np.load(world["all"] / "blinkflow/one/forward_flow/000000.npy")
    u = world["moves"][0]["u"]
    assert flow.shape == (28, 40, 3) and flow.dtype == np.float32 and np.array_equal(flow[..., 2] == 1, np.isfinite(u))
    assert np.array_equal(flow[..., 0], np.nan_to_num(u).astype(np.float32))
    read = tides.image.read_truth(world["all"] / "blinkflow/one/forward_flow/000000.npy")
    assert np.array_equal(read["displacement_u"], u.astype(np.float32), equal_nan=True)
    t, *rest = (tides.read_events(world["all"] / "blinkflow/two/events_left/events.h5")[name] for name in ("t", "x", "y", "p"))
    config = dict(line.split(": ") for line in (world["all"] / "blinkflow/two/config.yaml").read_text().splitlines())
    assert {key: float(value) for key, value in config.items()} == {"fps": 10, "duration": 0.2, "start": 1}
    same_events([t + 10**9, *rest], world["events"][1])  # from the first ground truth on
    root = world["all"] / "tum/one"
    rows = [line.split() for line in (root / "depth.txt").read_text().splitlines()[1:]]
    assert [row[0] for row in rows] == ["1.000000", "1.100000", "1.200000"]
    depth = read_png(root / rows[1][1])
    assert np.array_equal(depth, np.round(5000 * METRES * world["truth"][1]["depth_median"]))
    read = tides.image.read_truth(root / rows[1][1])["depth"]
    assert np.array_equal(np.nan_to_num(read), (depth / np.float32(5000)).astype(np.float32))


def test_ros2(world):
    """What is at the ends of the file, and that the index leads to messages; tests/clients reads it with ROS's own readers."""
    data = (world["all"] / "ros2/all.mcap").read_bytes()
    magic = b"\x89MCAP0\r\n"
    assert data[:8] == magic == data[-8:] and data[-37] == 2
    at, channels, messages = struct.unpack("<Q", data[-28:-20])[0], {}, 0
    while data[at] != 2:
        kind, size = data[at], struct.unpack("<Q", data[at + 1 : at + 9])[0]
        body = data[at + 9 : at + 9 + size]
        if kind == 4:
            channels[body[0]] = body[8 : 8 + body[4]].decode()
        if kind == 11:
            messages = struct.unpack("<Q", body[:8])[0]
        if kind == 8:
            start = struct.unpack("<Q", body[16:24])[0]
            assert data[start] == 6
        at += 9 + size
    kinds = ("events", "imu", "image_raw", "camera_info", "pose", "depth", "optic_flow")
    assert set(channels.values()) == {f"/{side}/{kind}" for side in ("one", "two") for kind in kinds}
    text = (world["all"] / "ros2/metadata.yaml").read_text()
    assert f"message_count: {messages}" in text and "storage_identifier: mcap" in text


def test_wrong_input_is_named(world):
    run, folder = world["folder"] / "run.json", world["folder"]
    turned = [[0, 0, 1, BASELINE], [0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 0, 1]]
    cases = (
        ({"scene.metres_per_unit": None}, "ecd", "scene.metres_per_unit"),
        ({}, "kitti", "none of ecd"),
        ({}, "ecd,ecd", "twice"),
        ({"dataset.truth_hz": 15}, "dsec", "whole multiple"),
        ({"rig.cameras": [{"name": "a"}, {"name": "b", "T_B_C": turned}]}, "dsec", "rectified"),
        ({"rig.cameras": [{"name": "a", "kind": "frame"}]}, "dsec", "event"),
        ({"rig.cameras": [{"name": "a", "kind": "event"}]}, "mvsec", "both"),
    )
    for settings, layout, words in cases:
        with tides.Session(run, settings, device="reference-f32") as session:
            with pytest.raises(tides.errors.BadConfig, match=words):
                session.dataset(folder / "no", layout)
    with tides.Session(run, device="reference-f32") as session:
        with pytest.raises(tides.errors.WriteFailed, match="is there already"):
            session.dataset(world["all"], "ecd")
        with pytest.raises(ValueError, match="dataset.layout"):
            session.dataset(folder / "no")
        with pytest.raises(tides.errors.Cancelled):
            session.dataset(folder / "again", "ecd", progress=lambda fraction, stage: stage == "pictures")
        assert not (folder / "again").exists() and list((folder / "again.part" / ".events").glob("*.h5"))
        session.dataset(folder / "again", "ecd")  # goes on from there
    assert list((folder / "again").rglob("events.txt")) and not (folder / "again.part").exists()


def test_lenses_are_written(world):
    run, folder = world["folder"] / "run.json", world["folder"]
    radtan = {"camera.lens": "radtan", "camera.k1": -0.1, "camera.k2": 0.02, "camera.p1": 0.003, "camera.p2": -0.004}
    settings = {**radtan, "dataset.truth_hz": 20, "dataset.picture_hz": 20, "time.stop": 1.06}
    with tides.Session(run, settings, device="reference-f32") as session:
        session.dataset(folder / "bent", ["ecd", "mvsec", "evimo", "ros2"])
    assert np.loadtxt(folder / "bent/ecd/one/calib.txt")[4:].tolist() == [-0.1, 0.02, 0.003, -0.004, 0]
    assert np.load(folder / "bent/evimo/one/dataset_info.npz")["D"].tolist() == [-0.1, 0.02, 0.003, -0.004, 0]
    chain = (folder / "bent/mvsec/camchain.yaml").read_text()
    numbers = [float(one) for one in chain.split("distortion_coeffs: [")[1].split("]")[0].split(",")]
    assert "distortion_model: radtan" in chain and numbers == [-0.1, 0.02, 0.003, -0.004]
    rig = {"rig.file": str(folder / "bent/mvsec/camchain.yaml"), "rig.cameras": []}
    with tides.Session(run, {**rig, "rig.camera": "cam1"}, device="reference-f32") as session:  # as it was
        lens, own = session.intrinsics, world["intrinsics"]
        assert [lens.fx, lens.cx, lens.width, lens.lens.k1, lens.lens.p2] == [own.fx, own.cx, own.width, -0.1, -0.004]
        with tides.Session(run, {"rig.camera": "two"}, device="reference-f32") as other:
            here, there = (one.camera.trajectory.at(1.1).position for one in (session, other))
        assert np.allclose(here, there, atol=1e-12)
    with tides.Session(run, {"camera.lens": "equidistant", "camera.k1": 0.01}, device="reference-f32") as session:
        with pytest.raises(tides.errors.BadConfig, match="ecd: one has a lens.*radtan"):
            session.dataset(folder / "no", "ecd")


def test_pictures_are_exposed(world):
    """Where asked for: DSEC's pictures are the renderer's exposures, with their starts and ends; the first has room."""
    run = world["folder"] / "run.json"
    settings = {"exposure.exposure_s": 0.02, "exposure.transfer": "srgb", "dataset.truth_hz": 20, "dataset.layout": "dsec"}
    with tides.Session(run, settings, device="reference-f32") as session:
        session.dataset(world["folder"] / "exposed")
        how = tides.Exposure(exposure_s=0.02, transfer="srgb", colour=1)
        with session.renderer() as renderer:
            light, _ = renderer.expose(1.06, how)
            sharp, _ = renderer.expose(1.06, tides.Exposure(exposure_s=0, transfer="srgb", colour=1))
    root = world["folder"] / "exposed"
    times = np.loadtxt(root / "images/left/exposure_timestamps.txt", delimiter=",", dtype=np.int64)
    assert times[:2].tolist() == [[1000000, 1020000], [1050000, 1070000]]
    assert np.loadtxt(root / "images/timestamps.txt", dtype=np.int64)[1] == 1060000
    codes = how.values(light, 1)
    got = read_png(root / "images/left/rectified/000001.png")
    assert np.array_equal(got, codes) and not np.array_equal(how.values(sharp, 1), codes)
