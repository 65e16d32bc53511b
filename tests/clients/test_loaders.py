"""Each layout, read as its published code reads it: with a rig, a lens, one camera, one pixel, without an event, at an
absolute time. The content must equal what was written."""

import loaders
import numpy as np
import pytest
import readers
import tides
import worlds
from worlds import METRES

every_world = pytest.mark.parametrize("name", worlds.WORLDS)


def root(world, layout):
    return world.folder / world.name / layout


def check_events(t_us, x, y, p, events):
    for got, wanted in ((t_us, events["t"] // 1000), (x, events["x"]), (y, events["y"]), (np.asarray(p) > 0, events["p"] > 0)):
        assert np.array_equal(np.asarray(got), wanted)


def test_worlds_are_what_they_should(of):
    counts = {name: [len(one) for one in of(name).events.values()] for name in worlds.WORLDS}
    assert counts["none"] == [0] and min(counts["pixel"]) > 0
    assert all(min(counts[name]) > 100 for name in ("rig", "lens", "one", "late"))
    assert of("late").events["left"]["t"].min() > worlds.LATE * 10**9


@every_world
def test_dsec(of, name):
    """Windows of its slicer are the events; flow and disparity are what was rendered, where they aren't rectified."""
    h5py, world = readers.import_client("h5py"), of(name)
    at = root(world, "dsec")
    for side in world.sides:
        events = world.events[side]
        with h5py.File(at / f"events/{side}/events.h5") as file, h5py.File(at / f"events/{side}/rectify_map.h5") as ways:
            slicer, ways = loaders.EventSlicer(file), ways["rectify_map"][()]
            check_events(*(slicer.events[name][()].astype(np.int64) for name in "txyp"), shifted(events, slicer.t_offset))
            for start, end in ((world.us[0], world.us[1]), (world.us[0] + 12345, world.us[1] + 4321)):
                if not len(events):
                    break
                got, us = slicer.get_events(start, end), events["t"] // 1000
                inside = events[(us >= start) & (us < end)]
                check_events(*(got[name] for name in "txyp"), inside)
                rectified = ways[got["y"], got["x"]]
                assert rectified.shape == (len(inside), 2) and np.isfinite(rectified).all()
                if name != "lens":
                    assert np.array_equal(rectified, np.stack([got["x"], got["y"]], -1))
    assert loaders.dsec_timestamps(at / "flow/forward_timestamps.txt").tolist() == [world.us[:2], world.us[1:]]
    assert loaders.dsec_timestamps(at / "flow/backward_timestamps.txt").tolist() == [world.us[1::-1], world.us[:0:-1]]
    for way, first, moves in (("forward", 0, world.forward), ("backward", 2, world.backward)):
        for k, move in enumerate(moves):
            flow, valid = loaders.dsec_flow(at / f"flow/{way}/{first + 2 * k:06d}.png")
            wanted = np.stack([move["u"], move["v"]], -1)
            assert flow.shape == wanted.shape and (name == "lens" or np.array_equal(valid, np.isfinite(wanted).all(-1)))
            assert name == "lens" or np.abs(flow - wanted)[valid].max() <= 0.5 / 128
    if len(world.sides) > 1:
        disparity, depth = loaders.dsec_disparity(at / "disparity/event/000002.png"), world.truth[1]["depth_median"]
        if name != "lens":
            seen = depth > 0
            assert np.array_equal(disparity > 0, seen)
            assert np.abs(disparity[seen] - world.lens.fx * 0.1 / depth[seen]).max() <= 0.5 / 256
        assert disparity.any()
    else:
        assert not (at / "disparity").exists()


def shifted(events, us):
    made = events.copy()
    made["t"] -= 1000 * us
    return made


@every_world
def test_mvsec(of, name):
    h5py, world = readers.import_client("h5py"), of(name)
    at = root(world, "mvsec")
    with h5py.File(at / f"{name}_data.hdf5") as data, h5py.File(at / f"{name}_gt.hdf5") as truth:
        for side in world.sides:
            davis, events = data["davis"][side], world.events[side]
            x, y, t, p = davis["events"][()].T
            assert np.array_equal(t, events["t"] / 1e9)
            check_events(events["t"] // 1000, x, y, p, events)
            times = davis["image_raw_ts"][()]
            assert np.array_equal(times, [(world.us[0] + 25000 * k) / 1e6 for k in range(5)])
            if len(events):
                parts = [loaders.mvsec_between(davis, k) for k in range(4)]
                first, last = np.searchsorted(t, [times[0], times[4]], side="right")
                assert np.array_equal(np.concatenate(parts), davis["events"][max(first - 1, 0) : max(last - 1, 0)])
        left = truth["davis/left"]
        assert np.array_equal(left["depth_image_raw_ts"], world.times)
        for k, wanted in enumerate(world.truth):
            depth = np.where(wanted["depth_median"] > 0, METRES * wanted["depth_median"], np.nan).astype(np.float32)
            assert np.array_equal(left["depth_image_raw"][k], depth, equal_nan=True)
        for t, pose in zip(world.times, world.poses):
            (k,) = np.flatnonzero(left["pose_ts"][()] == t)
            assert np.allclose(left["pose"][k][:3, 3], METRES * pose.position, atol=1e-12)
    for k, move in enumerate(world.forward):
        u, v = loaders.mvsec_flow(at / f"{name}_gt_flow_dist.npz", world.times[k] + 0.01)
        assert np.array_equal(u, np.nan_to_num(move["u"])) and np.array_equal(v, np.nan_to_num(move["v"]))


@every_world
def test_evimo(of, name):
    world = of(name)
    for side in world.sides:
        events, planes, info = loaders.evimo(worlds.camera_folder(world, "evimo", side))
        assert np.array_equal(events[:, 0], world.events[side]["t"] / 1e9)
        check_events(world.events[side]["t"] // 1000, *events[:, 1:].T, world.events[side])
        assert [key for key in planes["classical"] if isinstance(key, int)] == [0, 1, 2] == list(planes["depth"])
        assert planes["classical"]["t"].tolist() == world.times
        assert planes["classical"]["t_between"].tolist() == [(world.us[0] + 25000 * k) / 1e6 for k in (1, 3)]
        assert np.array_equal(info["K"][:2, 2], [world.lens.cx - 0.5, world.lens.cy - 0.5])
    _, planes, info = loaders.evimo(worlds.camera_folder(world, "evimo", "left"))
    for k, wanted in enumerate(world.truth):
        assert np.array_equal(planes["depth"][k], np.round(1000 * METRES * wanted["depth_median"]))
        assert np.array_equal(planes["mask"][k] // 1000, wanted["instance"] + 1)
    for k, move in enumerate(world.forward):
        assert np.array_equal(planes["flow"][k], np.stack([move["u"], move["v"]], -1).astype(np.float32), equal_nan=True)
        assert (planes["flow"]["t"][k], planes["flow"]["t_end"][k]) == (world.times[k], world.times[k + 1])
    meta, metres = info["meta"].item(), worlds.METRES
    assert [frame["id"] for frame in meta["frames"]] == [0, 1, 2] == [key for key in planes["mask"]]
    assert [frame["classical_frame"] for frame in meta["frames"]] == [f"img_{k}.png" for k in range(3)]
    for frame, t, pose in zip(meta["frames"], world.times, world.poses):
        place, turn = frame["cam"]["pos"]["t"], frame["cam"]["pos"]["q"]
        assert frame["ts"] == frame["cam"]["ts"] == t
        assert np.allclose([place[k] for k in "xyz"], metres * pose.position, atol=1e-12)
        w, *v = (turn[k] for k in "wxyz")
        assert np.allclose((2 * w * w - 1) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * np.cross(np.eye(3), v), pose.rotation)
        r, p, y = (frame["cam"]["pos"]["rpy"][k] for k in "rpy")
        assert np.allclose(pose.rotation[:, 0], [np.cos(y) * np.cos(p), np.sin(y) * np.cos(p), -np.sin(p)])
        assert np.allclose(pose.rotation[2, 1:], [np.cos(p) * np.sin(r), np.cos(p) * np.cos(r)])
    assert [one["ts"] for one in meta["full_trajectory"]] == [(world.us[0] + 5000 * k) / 1e6 for k in range(21)]
    (samples,) = meta["imu"].values()
    assert set(samples[0]) == {"ts", "angular_velocity", "linear_acceleration"} and samples[0]["ts"] == world.times[0]
    sizes = {"res_x": world.lens.width, "res_y": world.lens.height, "num_frames": 3, "fx": world.lens.fx, "ros_time_offset": 0}
    assert {key: meta["meta"][key] for key in sizes} == sizes
    lens = world.lens.lens
    assert info["D"][:4].tolist() == [lens.k1, lens.k2, lens.p1, lens.p2] == [meta["meta"][key] for key in ("k1", "k2", "p1", "p2")]
    assert (meta["meta"]["k3"], meta["meta"]["k4"], meta["meta"]["dist_model"]) == (0, 0, "radtan")


@every_world
def test_evimo_flow_by_poses(of, name):
    """What evimo_flow and ETAP make of depth, masks and objects' poses is the displacement that the layout has."""
    world = of(name)
    at = worlds.camera_folder(world, "evimo", "left")
    flows = loaders.evimo(at)[1]["flow"]
    for first in (0, 1):
        for k, mask, moved in loaders.evimo_tracks(at, first):
            if k != first + 1:
                continue
            y, x = np.indices(mask.shape)
            gone = moved - np.stack([x, y], -1)
            known = np.isfinite(flows[first]).all(-1)
            assert known.any() and np.array_equal(known & (mask > 0), known) and np.isfinite(gone[known]).all()
            if name == "moving":
                assert set(np.unique(mask[known])) == {1000, 2000}
            off = np.abs(gone - flows[first]).max(-1)  # at edges a mask's splat isn't always the flow's
            assert all(np.median(off[known & (mask == one)]) < 0.02 for one in np.unique(mask[known]))
            assert np.quantile(off[known], 0.9) < 0.1


@every_world
def test_blinkflow(of, name):
    """A flow is put beside the events of its own time, which its file and config.yaml count from one zero."""
    world = of(name)
    for side in world.sides:
        pairs = loaders.blinkflow(worlds.camera_folder(world, "blinkflow", side))
        assert len(pairs) == len(world.forward)
        for k, (_, got) in enumerate(pairs):
            us = world.events[side]["t"] // 1000
            inside = world.events[side][(us >= world.us[k]) & (us < world.us[k + 1])]
            check_events(got["t"].astype(np.int64) + world.us[0], got["x"], got["y"], got["p"], inside)
    pairs = loaders.blinkflow(worlds.camera_folder(world, "blinkflow", "left"))
    for k, move in enumerate(world.forward):
        flow = pairs[k][0]
        u, v, known = np.moveaxis(flow, -1, 0)
        assert flow.dtype == np.float32 and np.array_equal(known == 1, np.isfinite(move["u"]))
        assert np.array_equal(u, np.nan_to_num(move["u"]).astype(np.float32))
        assert np.array_equal(v, np.nan_to_num(move["v"]).astype(np.float32))


@pytest.mark.parametrize("hz, exposure, start", [(10, 0, 0), (32, 0, 1), (20, 0.007, 1.0000004), (7, 0.002, 1.003)])
def test_blinkflow_is_beside_its_events(tmp_path, hz, exposure, start):
    """Whatever rate, start and exposure: the flow and the events that the loader pairs are of one time."""
    worlds.save_run(tmp_path)
    settings = {"dataset.truth_hz": hz, "dataset.picture_hz": hz, "exposure.exposure_s": exposure, "time.start": start}
    settings |= {"time.stop": start + 0.32, "camera.start_s": 1 - start, "camera.file": "long.json"}
    path = tides.Trajectory.orbit(radius=4, angular_speed=2, start=1, stop=1.5)
    tides.Camera(path, tides.Intrinsics.from_fov(24, 18, 0.6)).save(tmp_path / "long.json")
    with tides.Session(tmp_path / "run.json", settings, device="reference-f32") as session:
        session.dataset(tmp_path / "set", ["blinkflow"])
        events = session.simulate()
        zero = int(np.ceil(round(1e9 * start) / 1000)) + round(5e5 * exposure)
        pairs = loaders.blinkflow(tmp_path / "set")
        assert len(pairs) == int((0.32 - exposure) * hz)
        count = 0
        with session.renderer() as renderer:
            for k, (flow, got) in enumerate(pairs):
                first, last = (zero + round(1e6 * (k + one) / hz) for one in (0, 1))
                inside = events[(events["t"] >= 1000 * first) & (events["t"] < 1000 * last)]
                count += len(inside)
                check_events(got["t"].astype(np.int64), got["x"], got["y"], got["p"], shifted(inside, zero))
                move = renderer.displacement(first / 1e6, last / 1e6)
                assert np.array_equal(flow[..., 0], np.nan_to_num(move["u"]).astype(np.float32))
        assert count > 0.7 * len(events) > 70


@every_world
def test_kubric(of, name):
    world = of(name)
    for side in world.sides:
        at = worlds.camera_folder(world, "kubric", side)
        places, visible, queries = loaders.kubric(at)
        images = sorted((at / "frames").iterdir())
        assert len(images) == len(places) and loaders.png(images[2]).shape == (world.lens.height, world.lens.width, 3)
        assert np.array_equal(np.loadtxt(at / "timestamps.txt"), [(world.us[0] + 25000 * k) / 1e6 for k in range(5)])
        read = tides.read_events(at / "events.h5")
        assert all(np.array_equal(read[column], world.events[side][column]) for column in "txyp")
        if side == "left":
            assert np.array_equal(places, world.tracks["uv"].astype(np.float32))
            assert np.array_equal(visible, world.tracks["visible"] == 1) and visible.any()
            assert (queries[:, 1:] >= 0).all() and (queries[:, 1:] <= [world.lens.width, world.lens.height]).all()


@every_world
def test_tum(of, name):
    """Every depth has its picture and its pose, at the same time."""
    world = of(name)
    at = worlds.camera_folder(world, "tum", "left")
    rgb, depth, poses = (loaders.tum_list(at / f"{kind}.txt") for kind in ("rgb", "depth", "groundtruth"))
    assert loaders.tum_associate(depth, rgb) == loaders.tum_associate(depth, poses) == [(t, t) for t in world.times]
    for k, t in enumerate(world.times):
        values = np.array(readers.import_client("PIL.Image").open(at / depth[t][0]))
        assert np.array_equal(values, np.round(5000 * METRES * world.truth[k]["depth_median"]))
        assert loaders.png(at / rgb[t][0]).shape == (*values.shape, 3)
        assert np.allclose(np.array(poses[t][:3], float), METRES * world.poses[k].position, atol=1e-12)


@every_world
@pytest.mark.filterwarnings("ignore:loadtxt")
def test_ecd(of, name):
    world = of(name)
    for side in world.sides:
        at = worlds.camera_folder(world, "ecd", side)
        events, (t, x, y, p) = world.events[side], loaders.ecd_events(at / "events.txt")
        check_events(events["t"] // 1000, x, y, p, events)
        assert (np.abs(t - events["t"] / 1e9) <= np.spacing(t)).all()  # at 1e9 s 0.12 us: what a double has
    at, lens = worlds.camera_folder(world, "ecd", "left"), world.lens
    bent = [lens.lens.k1, lens.lens.k2, lens.lens.p1, lens.lens.p2, 0]
    assert loaders.calibration(at / "calib.txt").tolist() == [lens.fx, lens.fy, lens.cx - 0.5, lens.cy - 0.5, *bent]
    images = loaders.tum_list(at / "images.txt")
    assert list(images) == [(world.us[0] + 25000 * k) / 1e6 for k in range(5)]
    assert all((at / one[0]).exists() for one in images.values())


@every_world
def test_evlib(of, name):
    """ECD's text and DSEC's HDF5, with whole microseconds from its beginning; it finds no columns in a file of no events."""
    world = of(name)
    for side in world.sides:
        for file in (worlds.camera_folder(world, "ecd", side) / "events.txt", root(world, "dsec") / f"events/{side}/events.h5"):
            if name == "none":
                with pytest.raises(Exception, match="not found|File is empty"):
                    readers.evlib(str(file), None)
                continue
            t, *rest = (np.asarray(column).astype(np.int64) for column in readers.evlib(str(file), None))
            events = world.events[side]
            us = events["t"] // 1000
            if name == "late":  # it ignores t_offset, and has text's seconds as doubles
                assert np.array_equal(t + worlds.LATE * 10**6, us) or np.abs(t - us).max() <= 1
                t = us
            check_events(t, *rest, events)


def test_evlib_knows_no_mvsec(of, tmp_path):
    """0.13.2 looks for /events or /CD in HDF5, and MVSEC's are davis/left/events (n, 4), as its authors document it: a file of
    just that, not written by us, is refused with the same words."""
    h5py, world = readers.import_client("h5py"), of("rig")
    with h5py.File(tmp_path / "plain.hdf5", "w") as file:
        file["davis/left/events"] = np.array([[1.0, 2, 0.5, 1], [3, 4, 0.6, -1]])
    for path in (tmp_path / "plain.hdf5", root(world, "mvsec") / "rig_data.hdf5"):
        with pytest.raises(OSError, match="Unsupported HDF5 format or no event data found"):
            readers.evlib(str(path), None)
