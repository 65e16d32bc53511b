"""Exposed frames and inertial measurements."""

import json

import numpy as np
import pytest
import tides

RUN = "tests/install/run.json"


def test_an_exposed_frame_is_the_mean_of_frames(scene, camera):
    exposure = tides.Exposure(exposure_s=0.02, tolerance=1e-3)
    with tides.Renderer(scene, camera) as renderer:
        light, took = renderer.expose(0.05, exposure)
        mean = np.mean([renderer.frame(0.04 + 0.02 * (k + 0.5) / 64, ["Y"])["Y"] for k in range(64)], axis=0)
        sharp = renderer.frame(0.05, ["Y"])["Y"]
        colour, _ = renderer.expose(0.05, exposure.copy(colour=1))
        rolling, _ = renderer.expose(0.05, exposure.copy(exposure_s=0, shutter="rolling", row_time_s=1e-3))
        row = renderer.frame(0.05 - 17.5e-3, ["Y"])["Y"][0]
    assert np.abs(light - mean).max() <= 1e-3 < np.abs(light - sharp).max() and took.error <= 1e-3
    assert colour.shape == (3, *light.shape) and took.unsettled == 0 and took.renders > 1
    assert np.abs(np.tensordot([0.2126, 0.7152, 0.0722], colour, 1) - light).max() <= 2e-3
    assert np.abs(rolling[0] - row).max() <= 1e-3


def test_values_and_times():
    exposure = tides.Exposure(shutter="rolling", exposure_s=0.01, row_time_s=1e-3, frames_per_second=50, bits=16)
    assert np.allclose(exposure.times(11, 0, 0.1), [0.01, 0.03, 0.05, 0.07, 0.09])
    assert np.allclose(exposure.row(11, 0.01, 0), (0, 0.01)) and np.allclose(exposure.row(11, 0.01, 10), (0.01, 0.02))
    assert exposure.span(11, 0.01) == (exposure.row(11, 0.01, 0)[0], exposure.row(11, 0.01, 10)[1])
    assert exposure.values(np.array([[0, 0.5, 1, 2]])).tolist() == [[0, 32768, 65535, 65535]]
    noisy = exposure.copy(full_well_e=5000, read_noise_e=4, seed=3)
    values = noisy.values(np.full((200, 200), 0.4)) / 65535
    assert abs(values.mean() - 0.4) < 1e-3 and abs(values.std() * 5000 - np.sqrt(2000 + 16)) < 1
    assert (noisy.values(np.full((200, 200), 0.4)) == np.round(values * 65535)).all()
    with pytest.raises(tides.errors.BadArgument, match="full_well_e"):
        tides.Exposure(read_noise_e=1).values(np.zeros((2, 2)))


def test_values_as_pictures(tmp_path):
    values = np.arange(12, dtype=np.uint16).reshape(2, 2, 3) * 5000
    tides.image.write_png_values(tmp_path / "a.png", values, 16)
    with pytest.raises(ValueError, match="255"):
        tides.image.write_png_values(tmp_path / "b.png", values)
    try:
        import cv2
    except ImportError:
        return
    assert (cv2.imread(str(tmp_path / "a.png"), cv2.IMREAD_UNCHANGED)[..., ::-1] == values).all()


def test_frames_of_a_run(tmp_path):
    with tides.Session(RUN, {"exposure.exposure_s": 0.01, "exposure.frames_per_second": 100}) as session:
        taken = session.write_frames(tmp_path / "frames")
        times = session.values.exposure.times(session.intrinsics.height, session.values.start, session.values.stop)
    assert taken.count == len(times) == len(list((tmp_path / "frames").glob("*.png")))
    assert np.allclose(np.loadtxt(tmp_path / "frames/timestamps.txt"), times)
    spans = np.loadtxt(tmp_path / "frames/exposure_timestamps.txt", ndmin=2)
    assert np.allclose(spans.mean(axis=1), times) and np.allclose(np.diff(spans), 0.01)
    with tides.Frames(tmp_path / "frames") as frames:
        assert len(frames) == len(times)


def test_what_an_imu_measures():
    times = np.linspace(0, 2, 41)
    positions = np.stack([np.sin(times), np.cos(times), times], axis=1)
    path = tides.Trajectory(times, positions, [(np.cos(t / 4), 0, 0, np.sin(t / 4)) for t in times])
    imu = tides.Imu(down=(0, 0, -2), metres_per_unit=2, rate_hz=100)
    samples = path.imu(imu, 0.5, 1.5)
    assert len(samples) == 101 and np.allclose(samples["angular_rate"], (0, 0, 0.5), atol=1e-6)
    t = samples["time"]
    a, c, s = -2 * np.stack([np.sin(t), np.cos(t)]), np.cos(t / 2), np.sin(t / 2)
    assert np.allclose(path.acceleration(1.0), [-np.sin(1), -np.cos(1), 0], atol=1e-3)
    force = np.stack([c * a[0] + s * a[1], c * a[1] - s * a[0], np.full(len(t), 9.80665)], axis=1)
    assert np.allclose(samples["specific_force"], force, atol=1e-2)
    noisy = path.imu(imu.copy(gyroscope_noise=1e-3, gyroscope_walk=1e-4, gyroscope_bias=(1, 0, 0)), 0.5, 1.5)
    assert noisy["gyroscope_bias"][0].tolist() == [1, 0, 0] and noisy["gyroscope_bias"][:, 1].std() > 0
    with pytest.raises(tides.errors.BadConfig, match="metres_per_unit"):
        path.imu(tides.Imu(down=(0, 0, -1)), 0, 1)
    with pytest.raises(tides.errors.BadConfig, match="imu.down"):
        path.imu(tides.Imu(metres_per_unit=1), 0, 1)


def test_chosen_points_are_seen(scene, camera):
    with tides.Renderer(scene, camera) as renderer:
        xy, points = renderer.choose(0.02, 40, seed=7)
        again, _ = renderer.choose(0.02, 40, seed=7)
        others, _ = renderer.choose(0.02, 40, seed=7, number=1)
        tracks = renderer.follow(0.02, points)
        empty = tides.Trajectory.static((0, 0, 50))  # looks away
        assert len(renderer.choose(0.02, 5, trajectory=empty)[0]) == 0
    assert len(xy) == 40 and (xy == again).all() and (xy != others).any() and (points["object"] == 0).all()
    assert np.median(np.hypot(tracks["u"] - xy[:, 0], tracks["v"] - xy[:, 1])) < 1e-6 and tracks["visible"].mean() > 0.9


def test_tracks_of_a_run(tmp_path):
    with tides.Session(RUN, {"tracks.count": 20, "tracks.rate_hz": 50}) as session:
        taken = session.write_tracks(tmp_path / "a.npz")
        session.write_tracks(tmp_path / "a.csv")
        span = session.values.stop - session.values.start
        with pytest.raises(tides.errors.Unsupported, match="npz"):
            session.write_tracks(tmp_path / "a.txt")
    made, rows = np.load(tmp_path / "a.npz"), np.loadtxt(tmp_path / "a.csv", delimiter=",", skiprows=1)
    times = round(50 * span) + 1
    assert taken.tracks == 20 and taken.count == times and made["uv"].shape == (times, 20, 2)
    assert made["depth"].shape == made["visible"].shape == (times, 20) and made["query"].shape == (20, 3)
    assert np.allclose(rows[:, 3:5].reshape(times, 20, 2), made["uv"], rtol=1e-8, equal_nan=True)
    early = np.flatnonzero(made["query"][:, 0] == made["t"][0])
    assert len(early) > 0 and np.allclose(made["uv"][0, early], made["query"][early, 1:], atol=0.5)
    assert made["visible"][0, early].mean() > 0.5


def test_tracks_as_annotations(tmp_path):
    """Kubric's: by track, then time; where one is behind the camera it is where it was, and not seen."""
    scene = tides.Scene()
    scene.add(tides.Gaussians.from_colours([[0, 0, 2], [0, 0, 8]], [[0.3] * 3, [3] * 3], [[1, 0, 0], [0, 1, 0]], 0.99))
    scene.save(tmp_path / "two.h5")
    path = tides.Trajectory.dolly((0, 0, 0), (0, 0, 4), (0, 0, 9), stop=0.1)
    tides.Camera(path, tides.Intrinsics.from_fov(16, 12, 0.6)).save(tmp_path / "path.json")
    run = {"scene": {"file": "two.h5"}, "camera": {"file": "path.json"}, "time": {"stop": 0.1}}
    (tmp_path / "run.json").write_text(json.dumps({**run, "tracks": {"count": 40, "rate_hz": 100}}))
    with tides.Session(tmp_path / "run.json", device="reference-f32") as session:
        session.write_tracks(tmp_path / "a.npz")
        session.write_tracks(tmp_path / "annotations.npy")
    made, kubric = np.load(tmp_path / "a.npz"), np.load(tmp_path / "annotations.npy", allow_pickle=True).item()
    places, occluded = kubric["target_points"], kubric["occluded"]
    assert places.dtype == np.float32 and occluded.dtype == bool and places.shape == (*occluded.shape, 2) == (40, 11, 2)
    wanted, known = made["uv"].transpose(1, 0, 2).astype(np.float32), np.isfinite(made["uv"][..., 0]).T
    assert np.array_equal(places[known], wanted[known]) and np.array_equal(occluded, made["visible"].T == 0)
    assert np.isfinite(places).all() and occluded[~known].all() and not known[:, -1].all()
    track = np.flatnonzero(~known[:, -1])[0]
    last = np.flatnonzero(known[track])[-1]
    assert (places[track, last:] == places[track, last]).all()
    assert places.flags.writeable


def test_tracks_are_chosen(tmp_path):
    """On a grid over the first image; as many of a small object as of the large one behind it."""
    random, scene = np.random.default_rng(5), tides.Scene()
    for size, depth, count in ((2.0, 1.0, 400), (0.15, -1.0, 60)):
        places = np.append(random.uniform(-size, size, (count, 2)), np.full((count, 1), depth), axis=1)
        sigma = np.full((count, 3), 1.5 * size / np.sqrt(count))
        scene.add(tides.Gaussians.from_colours(places, sigma, random.uniform(0, 1, (count, 3)), opacity=0.99))
    scene.save(tmp_path / "two.h5")
    times = np.linspace(0, 0.5, 6)
    path = tides.Trajectory(times, [(t - 0.25, 0, -4) for t in times], [(1, 0, 0, 0)] * 6)
    tides.Camera(path, tides.Intrinsics.from_fov(64, 48, 0.7)).save(tmp_path / "path.json")
    run = {"scene": {"file": "two.h5"}, "camera": {"file": "path.json"}, "time": {"stop": 0.5}, "tracks": {"rate_hz": 10}}
    (tmp_path / "run.json").write_text(json.dumps(run))
    made = {}
    for choice in ("random", "grid", "instance"):
        with tides.Session(tmp_path / "run.json", {"tracks.choice": choice, "tracks.count": 48}) as session:
            session.write_tracks(tmp_path / f"{choice}.npz")
        made[choice] = np.load(tmp_path / f"{choice}.npz")
    grid, few = made["grid"], [np.bincount(made[choice]["object"], minlength=2) for choice in ("random", "instance")]
    x, y = np.meshgrid(4 + 8 * np.arange(8), 4 + 8 * np.arange(6))
    places = {(0.0, u, v) for u, v in zip(x.ravel(), y.ravel())}
    assert 20 < len(grid["query"]) <= 48 and {tuple(row) for row in grid["query"].tolist()} <= places
    assert few[0][1] < 10 and abs(few[1][0] - few[1][1]) <= 8 and few[1].sum() > 40
    assert len(set(made["instance"]["query"][:, 0])) == 8


def test_imu_of_a_run(tmp_path):
    known = {"scene.metres_per_unit": 0.5, "imu.down": [0, 1, 0], "imu.rate_hz": 400, "imu.gyroscope_walk": 0.01}
    with tides.Session(RUN) as session, pytest.raises(tides.errors.BadConfig, match="metres_per_unit"):
        session.write_imu(tmp_path / "a.csv")
    with tides.Session(RUN, known) as session:
        taken = session.write_imu(tmp_path / "a.npz")
        session.write_imu(tmp_path / "a.csv")
        session.write_imu(tmp_path / "a.txt")
        session.write_imu(tmp_path / "a.h5")
        with pytest.raises(tides.errors.Unsupported, match="csv"):
            session.write_imu(tmp_path / "a.bag")
    made = np.load(tmp_path / "a.npz")
    euroc, ecd = np.loadtxt(tmp_path / "a.csv", delimiter=","), np.loadtxt(tmp_path / "a.txt")
    assert taken.count == len(made["t"]) == len(euroc) == len(ecd)
    assert np.allclose(euroc[:, 0] * 1e-9, made["t"]) and np.allclose(ecd[:, 0], made["t"])
    assert np.allclose(euroc[:, 1:4], made["angular_rate"]) and np.allclose(euroc[:, 4:], made["specific_force"])
    assert np.allclose(ecd[:, 1:4], made["specific_force"]) and np.allclose(ecd[:, 4:], made["angular_rate"])
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5") as file:
        assert set(file) == set(made.files) and json.loads(file.attrs["run"])["imu"]["rate_hz"] == 400
        assert all(np.array_equal(file[name][:], made[name]) for name in made.files)
        unit = file["specific_force"].attrs["unit"]
        assert (unit.decode() if isinstance(unit, bytes) else unit) == "m/s^2"
    bias = np.loadtxt(tmp_path / "a_bias.csv", delimiter=",")
    assert np.allclose(bias[:, 1:4], made["gyroscope_bias"]) and made["gyroscope_bias"].std() > 0
