"""Trajectories, cameras, scenes, motions."""

import gc
import json
import pickle

import numpy as np
import pytest
import tides
from conftest import make_cloud


def same(a, b):
    return all(np.array_equal(getattr(a, name), getattr(b, name)) for name in vars(a))


def test_trajectory():
    times = np.linspace(0, 1, 5)
    positions = np.stack([times, times**2, 0 * times], 1)
    path = tides.Trajectory(times, positions, [[1, 0, 0, 0]] * 5)
    assert len(path) == 5 and path.range == (0.0, 1.0) and not path.is_static
    pose = path.at(0.25)
    assert np.allclose(pose.position, positions[1]) and np.allclose(pose.rotation, np.eye(3))
    later = path.at(0.25 + 1e-6)
    assert np.allclose((later.position - pose.position) / 1e-6, pose.position_dot, atol=1e-4)
    assert np.array_equal(path.samples["position"], positions)
    with pytest.raises(tides.errors.OutOfRange):
        path.at(1.5)
    with pytest.raises(ValueError, match="positions"):
        tides.Trajectory(times, positions[:, :2], [[1, 0, 0, 0]] * 5)


def test_trajectory_with_rates():
    path = tides.Trajectory([0, 1], [[0, 0, 0], [1, 0, 0]], [[1, 0, 0, 0]] * 2, [[0, 2, 0]] * 2, np.zeros((2, 3)))
    assert np.allclose(path.at(0).position_dot, [0, 2, 0]) and path.samples["has_rates"].all()
    with pytest.raises(ValueError, match="both"):
        tides.Trajectory([0, 1], np.zeros((2, 3)), [[1, 0, 0, 0]] * 2, velocities=np.zeros((2, 3)))


def test_mounted_on_a_body():
    body = tides.Trajectory.orbit(radius=3, angular_speed=2)
    camera = body.mounted([0.1, 0, 0.2], [0, 0, 0, 1])
    b, c = body.at(0.3), camera.at(0.3)
    assert np.allclose(c.position, b.position + b.rotation @ [0.1, 0, 0.2], atol=1e-15)
    assert np.allclose(c.rotation, b.rotation @ np.diag([-1, -1, 1]), atol=1e-15)


def test_generators():
    static = tides.Trajectory.static([1, 2, 3])
    assert static.is_static and static.range == (-np.inf, np.inf) and np.array_equal(static.at(5).position, [1, 2, 3])
    orbit = tides.Trajectory.orbit(target=(1, 0, 0), radius=3, angular_speed=2, stop=2)
    assert np.isclose(np.linalg.norm(orbit.at(0.7).position - [1, 0, 0]), 3, atol=1e-4)
    assert np.isclose(np.linalg.norm(orbit.at(0.7).position_dot), 6, atol=1e-3)
    dolly = tides.Trajectory.dolly((0, 0, -3), (1, 0, -3), (0, 0, 0))
    assert np.allclose(dolly.at(1).position, [1, 0, -3])
    shaken = [tides.Trajectory.handheld((0, 0, -3), (0, 0, 0), seed=seed).at(0.5).position for seed in (1, 1, 2)]
    assert np.array_equal(shaken[0], shaken[1]) and not np.array_equal(shaken[0], shaken[2])


def test_camera_file(tmp_path, camera):
    camera.save(tmp_path / "path.json")
    loaded = tides.Camera.load(tmp_path / "path.json")
    assert loaded.format == "tides" and loaded.intrinsics == camera.intrinsics and not loaded.distorted
    assert np.allclose(loaded.trajectory.at(0.05).position, camera.trajectory.at(0.05).position)
    assert "Camera(" in repr(loaded)
    moved = tides.Camera.load(tmp_path / "path.json", lens={"width": 100}, start=-1.0)
    assert moved.intrinsics.width == 100 and moved.trajectory.range[0] == 1.0
    assert tides.Trajectory.load("tests/install/path.txt").range == (0.0, 0.06)
    assert tides.PathOptions().duration == 1.0


def test_camera_file_without_times(tmp_path):
    order = [1, 10, 2, 3, 4, 5, 6, 7, 8, 9]
    poses = [{"file_path": f"{k}.png", "transform_matrix": np.eye(4) + 0.1 * k * np.eye(1, 16, 3).reshape(4, 4)} for k in order]
    text = {"fl_x": 30, "w": 32, "h": 24, "frames": [dict(pose, transform_matrix=pose["transform_matrix"].tolist()) for pose in poses]}
    (tmp_path / "transforms.json").write_text(json.dumps(text))
    with pytest.warns(UserWarning, match="transforms.json: .*names|spread evenly over 1 s"):
        camera = tides.Camera.load(tmp_path / "transforms.json")
    assert [line.split(":")[0] for line in camera.notes] == ["has no times", "has no times"]
    assert np.allclose(np.diff([camera.trajectory.at(t).position[0] for t in np.linspace(0, 1, 10)]), 0.1)
    with pytest.warns(UserWarning, match="camera.duration_s"), tides.Session(
        "tests/install/run.json", {"camera.file": str(tmp_path / "transforms.json")}, device="reference"
    ) as session:
        assert sum("has no times" in note for note in session.notes) == 2
    (tmp_path / "us.txt").write_text("0 0 0 0 0 0 0 1\n5 1 0 0 0 0 0 1\n10 2 0 0 0 0 0 1\n")
    with pytest.raises(tides.errors.BadFile, match="camera.time_unit"):
        tides.Camera.load(tmp_path / "us.txt")
    assert np.allclose(tides.Camera.load(tmp_path / "us.txt", time_unit="us").trajectory.range, (0, 1e-5))


def test_lens(cloud, tmp_path):
    assert tides.lens_names() == ["none", "radtan", "equidistant"]
    lens = tides.Lens(model="equidistant", k1=-0.03)
    bent = tides.Intrinsics.from_fov(32, 24, 1.2).copy(lens=lens)
    assert bent.lens == lens and bent.lens.model == "equidistant" and tides.Intrinsics().lens.model == "none"
    with tides.Scene() as scene:
        scene.add(cloud)
        path = tides.Trajectory.static([0, 0, -3])
        seen = []
        for one in (bent, bent.copy(lens=tides.Lens())):
            with tides.Renderer(scene, tides.Camera(path, one)) as renderer:
                seen.append(renderer.frame(0.0, ["L"])["L"])
        assert not np.array_equal(*seen)
        own = bent.copy(lens=tides.Lens()).rectify_map()
        assert np.allclose(own[3, 5], (5, 3), atol=1e-5) and own.shape == (24, 32, 2)
        bent.save_rectify_map(tmp_path / "map.npy", rotation=np.eye(3))
        assert np.array_equal(np.load(tmp_path / "map.npy"), bent.rectify_map()) and not np.allclose(own, bent.rectify_map())
        with pytest.raises(tides.errors.TidesError, match="folds over"):
            tides.Renderer(scene, tides.Camera(path, bent.copy(lens=tides.Lens(model="radtan", k1=-3.0))))


def test_scene_keeps_what_it_is_given(cloud, tmp_path):
    path = tides.Trajectory.dolly((0, 0, 0), (1, 0, 0), (0, 0, 5))
    with tides.Scene() as scene:
        assert scene.add(cloud, name="first") == 0 and scene.add(cloud, path, scale=2.0, name="second") == 1
        assert len(scene) == 2 and scene.count == 2 * len(cloud) and scene.sh_degree == 0
        first, second = scene[0], scene[1]
        lower, upper = scene.bounds
        assert (lower <= cloud.mean.min(0)).all() and (upper >= cloud.mean.max(0)).all()
        scene.save(tmp_path / "scene.h5")
        assert "2 objects" in repr(scene)
        with pytest.raises(IndexError):
            scene[2]
    gc.collect()
    assert same(first.gaussians, cloud) and first.trajectory is None and first.motion is None
    assert second.scale == 2 and second.name == "second"
    assert np.allclose(second.trajectory.at(0.3).position, path.at(0.3).position)  # a copy: the scene is gone
    again = tides.Scene(tmp_path / "scene.h5")
    assert [one.name for one in again] == ["first", "second"] and same(again[1].gaussians, cloud)
    assert tides.Scene.is_file(tmp_path / "scene.h5") and not tides.Scene.is_file(__file__)
    assert repr(scene) == "Scene(closed)"


def test_tags_of_a_scene(cloud, tmp_path):
    assert cloud.trained == "unknown"
    tagged = tides.Gaussians(cloud.mean, cloud.log_scale, cloud.quaternion, cloud.opacity_logit, cloud.sh, "antialiased")
    scene = tides.Scene()
    scene.add(tagged)
    scene.up = (0, 0, 1)
    assert scene.trained == scene[0].gaussians.trained == pickle.loads(pickle.dumps(scene)).trained == "antialiased"
    for name in ("a.ply", "a.h5"):
        scene.save(tmp_path / name)
        assert tides.Scene(tmp_path / name).trained == "antialiased"
    with pytest.warns(UserWarning, match="a.glb: has no place for the scene's trained, up"):
        scene.save(tmp_path / "a.glb")
    assert tides.Scene(tmp_path / "a.glb").trained == "unknown"
    scene.add(tides.Gaussians(cloud.mean, cloud.log_scale, cloud.quaternion, cloud.opacity_logit, cloud.sh, "plain"))
    assert scene.trained == "mixed"
    with pytest.raises(ValueError, match="trained: 'antialias' is none of .*did you mean 'antialiased'"):
        tides.Gaussians(cloud.mean, cloud.log_scale, cloud.quaternion, cloud.opacity_logit, cloud.sh, "antialias")
    arrays = cloud.mean, cloud.log_scale, cloud.quaternion, cloud.opacity_logit, cloud.sh
    coded = tides.Scene()
    assert cloud.transfer == scene.transfer == "linear"
    coded.add(tides.Gaussians(*arrays, transfer="gamma", gamma=1.8))
    for name in ("b.ply", "b.h5"):
        coded.save(tmp_path / name)
        again = tides.Scene(tmp_path / name)
        assert (again.transfer, again[0].gaussians.gamma) == ("gamma", 1.8) == (pickle.loads(pickle.dumps(again)).transfer, 1.8)
    coded.add(cloud)
    with pytest.raises(ValueError, match="image.transfer"):
        coded.transfer
    with pytest.raises(ValueError, match="transfer: 'sgrb' is none of .*did you mean 'srgb'"):
        tides.Gaussians(*arrays, transfer="sgrb")
    assert tides.ImageParams().transfer == "file" and tides.ImageParams(transfer="srgb").transfer == "srgb"
    assert tides.ImageParams().antialias == "file" and tides.ImageParams(antialias=True).antialias == "true"


def test_broken_gaussians_and_parts(cloud, tmp_path):
    scene = tides.Scene()
    scene.add(cloud, name="first")
    scene.add(cloud, name="second")
    scene.save(tmp_path / "two.h5")
    assert [len(tides.Scene(tmp_path / "two.h5", part=part)) for part in (None, "second", 0)] == [2, 1, 1]
    with pytest.raises(tides.errors.BadArgument, match="scene.part"):
        tides.Scene(tmp_path / "two.h5", part="third")
    one = tides.Scene()
    one.add(cloud)
    one.save(tmp_path / "a.ply")
    data = bytearray((tmp_path / "a.ply").read_bytes())
    start = data.index(b"end_header\n") + len(b"end_header\n")
    data[start : start + 4] = np.float32("nan").tobytes()
    (tmp_path / "a.ply").write_bytes(data)
    with pytest.raises(tides.errors.BadFile, match="scene.invalid = drop"):
        tides.Scene(tmp_path / "a.ply")
    with pytest.warns(UserWarning, match="1 of .* left out"):
        whole = tides.Scene(tmp_path / "a.ply", invalid="drop")
    assert whole.dropped == 1 and whole.count == len(cloud) - 1 and len(whole.notes) == 1


def test_foreign_files_are_named(tmp_path):
    (tmp_path / "a.mp4").write_bytes(b"\0\0\0\x20ftypisom" + bytes(100))
    with pytest.raises(tides.errors.BadFile, match="an MP4 video.*ffmpeg"):
        tides.files.check_kind(tmp_path / "a.mp4")
    assert {row.key for row in tides.parameters() if row.path} >= {"scene.file", "sensor.preset", "scene.objects"}


def test_means_far_from_the_origin(cloud, tmp_path):
    """Doubles go in and come back as they are, by arrays, by files and as keyframes; what floats hold comes back as floats."""
    far = np.array([4194304.0, -1048576.0, 65536.0])
    mean = far + np.asarray(cloud.mean, np.float64)
    wide = tides.Gaussians(mean, cloud.log_scale, cloud.quaternion, cloud.opacity_logit, cloud.sh)
    assert wide.mean.dtype == np.float64 and np.array_equal(wide.mean, mean)
    assert cloud.mean.dtype == np.float32
    scene = tides.Scene()
    scene.add(wide)
    assert np.array_equal(scene[0].gaussians.mean, mean)
    for name in ("far.h5", "far.ply"):
        scene.save(tmp_path / name)
        assert np.array_equal(tides.Scene(tmp_path / name)[0].gaussians.mean, mean)
    moving = tides.Scene()
    keys = tides.Motion.keyframes([0, 1], np.stack([mean, mean + 0.25]), [cloud.quaternion] * 2)
    moving.add(wide, motion=keys)
    (lower, upper), (later, above) = moving.bounds_at(0), moving.bounds_at(1)
    assert np.allclose(lower, mean.min(0), atol=1e-6) and np.allclose(later - lower, 0.25, atol=1e-6)
    assert np.allclose(upper, mean.max(0), atol=1e-6) and np.allclose(above - upper, 0.25, atol=1e-6)


def test_gaussians_are_checked(cloud):
    with pytest.raises(ValueError, match="quaternion"):
        tides.Gaussians(cloud.mean, cloud.log_scale, cloud.quaternion[:, :3], cloud.opacity_logit, cloud.sh)
    with pytest.raises(ValueError, match="coefficients"):
        tides.Gaussians(cloud.mean, cloud.log_scale, cloud.quaternion, cloud.opacity_logit, np.zeros((len(cloud), 5, 3)))
    bad = make_cloud()
    bad.mean[3, 1] = np.nan
    with pytest.raises(tides.errors.BadArgument, match="3"):
        tides.Scene().add(bad)


def test_scene_is_locked_while_used(scene, camera, cloud):
    renderer = tides.Renderer(scene, camera)
    for change in (lambda: scene.add(cloud), scene.close, lambda: scene.set_duration(1), renderer.device.close):
        with pytest.raises(ValueError, match="Renderer uses it"):
            change()
    renderer.close()
    assert scene.add(cloud) == 1


def sliding(cloud):
    """Each model's way of moving everything along x: one scene unit per unit of its own clock."""
    n = len(cloud)
    coefficients = np.zeros((n, 9))
    coefficients[:, 0] = 1
    frames = np.linspace(0, 1, 5)
    means = cloud.mean[None] + frames[:, None, None] * np.array([1, 0, 0])

    def move(time, side, index, theta):
        assert side in (-1, 0, 1) and theta.sh is None
        theta.mean[:, 0] += time
        theta.mean_dot[:, 0] = 1

    return {
        "polynomial": tides.Motion.polynomial(np.zeros(n), np.full(n, 20.0), coefficients, np.zeros((n, 4))),
        "keyframes": tides.Motion.keyframes(frames, means, np.broadcast_to(cloud.quaternion, (5, n, 4))),
        "callback": tides.Motion.callback(move, n),
    }


@pytest.mark.parametrize("model", ["polynomial", "keyframes", "callback"])
def test_motion(model, camera):
    """All gaussians slide: the image is that of a camera which slides the other way, with the same L_dot."""
    cloud = make_cloud(60)
    motion = sliding(cloud)[model]
    assert motion.model == model and motion.range == (0.0, 1.0) and motion.moving(cloud) == len(cloud)
    assert motion.knots >= 0
    moving = tides.Scene()
    moving.add(cloud, motion=motion, duration_s=2.0)
    assert motion.closed and moving[0].motion == model and moving[0].moving == len(cloud)
    assert moving[0].motion_range == (0.0, 1.0) and moving[0].duration_s == 2.0
    del motion
    gc.collect()
    still = tides.Camera(tides.Trajectory.static((0, 0, -5)), camera.intrinsics)
    frame = tides.Renderer(moving, still).frame(0.8)
    slid = tides.Camera(tides.Trajectory([0, 2], [[0, 0, -5], [-1, 0, -5]], [[1, 0, 0, 0]] * 2), camera.intrinsics)
    resting = tides.Scene()
    resting.add(cloud)
    wanted = tides.Renderer(resting, slid).frame(0.8)
    assert np.abs(wanted["L_dot"]).max() > 0.1
    for name in ("L", "L_dot"):
        assert np.allclose(frame[name], wanted[name], atol=2e-4), name
    assert moving.set_duration(4.0) == 1 and moving[0].duration_s == 4.0


def test_rotor_motion(camera):
    cloud = make_cloud(40)
    n = len(cloud)
    turned = np.tile([1.0, 0, 0, 0], (n, 1))
    motion = tides.Motion.rotor(np.full(n, 0.5), np.zeros(n), turned, np.zeros((n, 1, 1, 3)))
    scene = tides.Scene()
    scene.add(cloud, motion=motion)
    assert scene[0].motion == "rotor" and scene[0].knots >= 0
    still = tides.Camera(tides.Trajectory.static((0, 0, -5)), camera.intrinsics)
    assert np.isfinite(tides.Renderer(scene, still).frame(0.3)["L"]).all()


def test_callback_exception_comes_out(cloud, camera):
    class Mine(Exception):
        pass

    def fail(time, side, index, theta):
        raise Mine("from the function")

    scene = tides.Scene()
    scene.add(cloud, motion=tides.Motion.callback(fail, len(cloud)))
    still = tides.Camera(tides.Trajectory.static((0, 0, -5)), camera.intrinsics)
    with pytest.raises(Mine, match="from the function"):
        tides.Renderer(scene, still).frame(0.3)


def test_callback_of_colours(camera):
    cloud = make_cloud(30)

    def brighten(time, side, index, theta):
        theta.sh[:] += time
        theta.sh_dot[:] = 1

    scene = tides.Scene()
    scene.add(cloud, motion=tides.Motion.callback(brighten, len(cloud), sh_degree=0))
    still = tides.Camera(tides.Trajectory.static((0, 0, -5)), camera.intrinsics)
    frame = tides.Renderer(scene, still).frame(0.5)
    assert frame["L_dot"].max() > 0.1 and frame["L_dot"].min() > -1e-6


def test_motion_of_another_size_is_refused(cloud):
    with pytest.raises(tides.TidesError):
        tides.Scene().add(cloud, motion=tides.Motion.callback(print, 3))
    with pytest.raises(ValueError, match="mean_coefficient"):
        tides.Motion.polynomial(np.zeros(3), np.zeros(3), np.zeros((3, 8)), np.zeros((3, 4)))


def test_range_and_bounds(cloud):
    scene = tides.Scene()
    scene.add(cloud)
    assert scene.range == (-np.inf, np.inf)
    scene.add(cloud, tides.Trajectory([0, 2], [[0, 0, 0], [4, 0, 0]], [[1, 0, 0, 0]] * 2))
    assert scene.range == (0.0, 2.0)
    middle, pose = np.median(cloud.mean, 0), scene.orbit(up=[0, 0, 1]).at(3.0)
    ahead = (middle - pose.position) / np.linalg.norm(middle - pose.position)
    assert np.allclose(pose.rotation[:, 2], ahead, atol=0.2) and pose.position[2] > middle[2]
    with pytest.raises(tides.errors.BadArgument, match="holds nothing"):
        tides.Scene().orbit()
    lower, upper = scene.bounds_at(1.0)
    assert np.allclose(upper - [2, 0, 0], cloud.mean.max(0), atol=1e-5) and np.allclose(lower, cloud.mean.min(0))
    with pytest.raises(tides.errors.OutOfRange):
        scene.bounds_at(3.0)


def test_generate():
    kinds = {row.name: row for row in tides.generators()}
    assert kinds["fan"].sentence and kinds["fan"].duration_s > 0
    world = tides.generate("fan", width=64, height=48, seed=3)
    assert world.camera.intrinsics.width == 64 and world.scene.count > 100 and len(world.background) == 3
    assert world.duration_s == kinds["fan"].duration_s and world.camera.trajectory.range[1] >= world.duration_s
    assert same(world.scene[0].gaussians, tides.generate("fan", width=64, height=48, seed=3).scene[0].gaussians)
    with pytest.raises(tides.errors.BadArgument, match="fan"):
        tides.generate("fam")
    assert tides.GenerateOptions().width == 346


def test_files_apart(tmp_path):
    """What is written is no input, and is called as what it is."""
    (tmp_path / "a.json").write_text("{}")
    tides.files.check_apart([tmp_path / "a.json"], [tmp_path / "b.h5", tmp_path / "c.h5"])
    with pytest.raises(ValueError, match="a.json"):
        tides.files.check_apart([tmp_path / "a.json"], [tmp_path / "." / "a.json"])
    tides.files.check_named(tmp_path / "a.json", ".json")
    with pytest.raises(ValueError, match="a.h5"):
        tides.files.check_named(tmp_path / "a.h5", ".json")
    run = tides.Run("tests/install/run.json")
    run.check_apart([tmp_path / "events.h5"])
    with pytest.raises(ValueError, match="scene.ply"):
        run.check_apart(["tests/install/scene.ply"])


def test_scene_of_c(tmp_path):
    """C programs add files without options; Scene.add_file reads with some."""
    made = tides.Scene()
    tides._call.call("tides_scene_add_file", made._pointer, b"tests/install/scene.ply", None, 1.0)
    assert len(made) == 1


def test_gaussians_at_a_time():
    rng = np.random.default_rng(5)
    n = 700  # more than one of C's portions
    own = tides.Gaussians(*(rng.normal(size=shape) for shape in ((n, 3), (n, 3), (n, 4), (n,), (n, 4, 3))), transfer="srgb")
    scene = tides.Scene()
    scene.add(own, tides.Trajectory.orbit(radius=4, angular_speed=1, stop=2), 3.0)
    still = scene.gaussians_at(0, 1.0)  # its own coordinates: neither turned nor scaled
    for name in ("mean", "log_scale", "quaternion", "opacity_logit", "sh"):
        assert np.array_equal(getattr(still, name), getattr(own, name)), name
    assert still.transfer == "srgb"

    coefficient, centre = rng.normal(size=(n, 9)), np.full(n, 0.5)
    motion = tides.Motion.polynomial(centre, np.zeros(n), coefficient, np.zeros((n, 4)))
    scene.add(own, motion=motion, duration_s=2.0)
    got, dt = scene.gaussians_at(1, 1.5), 0.75 - 0.5  # 1.5 s of 2 are 0.75 of its own clock
    powers = np.array([dt, dt**2, dt**3])
    assert np.allclose(got.mean, own.mean + np.einsum("p,npi->ni", powers, coefficient.reshape(n, 3, 3)), atol=1e-5)
    opacity = np.exp(-(dt**2)) / (1 + np.exp(-own.opacity_logit))
    assert np.allclose(1 / (1 + np.exp(-got.opacity_logit)), opacity, atol=1e-6)
    assert np.allclose(got.log_scale, own.log_scale, atol=1e-5) and np.array_equal(got.sh, own.sh)
    a, b = (one / np.linalg.norm(one, axis=1, keepdims=True) for one in (got.quaternion, own.quaternion))
    assert np.allclose(np.abs((a * b).sum(1)), 1, atol=1e-6)

    keys = rng.normal(size=(3, n, 4, 3))
    scene.add(own, motion=tides.Motion.keyframes([0, 1, 2], np.stack([own.mean] * 3), np.stack([own.quaternion] * 3), sh=keys))
    assert np.allclose(scene.gaussians_at(2, 1.0).sh, keys[1], atol=1e-6)
    with pytest.raises(tides.errors.OutOfRange):
        scene.gaussians_at(1, 2.5)
    with pytest.raises(tides.errors.BadArgument):
        scene.gaussians_at(3, 0.0)
