"""Pickle: objects that know their file or values can be sent to another process; others raise, with what to send instead."""

import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
import tides

RUN = "tests/install/run.json"
POSE = ("rotation", "position", "rotation_dot", "position_dot")


def crossed(value):
    return pickle.loads(pickle.dumps(value))


def paths():
    random = np.random.default_rng(3)
    times, places, turns = np.arange(9) / 8, random.normal(size=(9, 3)), random.normal(size=(9, 4))
    hand = tides.Trajectory.handheld((0, 0, -3), (0, 0, 0), seed=4)
    yield tides.Trajectory(times, places, turns)
    yield tides.Trajectory(times, places, turns, places[::-1], random.normal(size=(9, 3)))
    yield from (tides.Trajectory.static((0, 1, 2)), tides.Trajectory.orbit(), hand)
    yield hand.mounted((1, 2, 3), (0.5, 0.5, 0.5, -0.5))


@pytest.mark.parametrize("path", paths())
def test_trajectories(path):
    other = crossed(path)
    assert other.range == path.range and other.is_static == path.is_static and len(other) == len(path)
    for time in (0.0, 0.123, 0.9):
        assert all(np.array_equal(getattr(path.at(time), one), getattr(other.at(time), one)) for one in POSE)


def test_values():
    stepping = tides.Stepping(mode="fixed", step_s=0.02)
    stepping.risk.w_b = 0.5
    frames = tides.FramesOptions(timestamps="times.txt")
    assert crossed(stepping) == stepping and crossed(frames) == frames and crossed(frames).timestamps == "times.txt"
    lens = tides.Lens(model="radtan", k1=-0.1)
    camera = tides.Camera(tides.Trajectory.orbit(), width=64, height=48, fx=60, fy=60, cx=32, cy=24, lens=lens)
    assert crossed(camera).intrinsics == camera.intrinsics and crossed(camera).intrinsics.lens.k1 == -0.1


def test_runs(tmp_path):
    run = tides.Run(RUN, {"sensor.threshold_on": 0.3}).vary({"stepping.model": "linear"})
    assert crossed(run).json == run.json and crossed(crossed(run)).gives("stepping.model")
    assert not crossed(run).gives("sensor.threshold_off")
    parsed = tides.Run(text=run.json, directory="tests/install")
    data, home = pickle.dumps([run, parsed]), os.getcwd()
    os.chdir(tmp_path)  # what is pickled doesn't hang on the working directory
    try:
        for other in pickle.loads(data):
            assert other.json == run.json and other.open()[0].count == 20
    finally:
        os.chdir(home)


def test_scenes(tmp_path, cloud):
    first = tides.Scene()
    first.add(cloud, name="cloud")
    first.save(tmp_path / "cloud.h5")
    far = tides.Gaussians(cloud.mean + 1e7, cloud.log_scale, cloud.quaternion, cloud.opacity_logit, cloud.sh)
    scene = tides.Scene(tmp_path / "cloud.h5", tides.Trajectory.orbit(), 2.0)
    scene.add(far, tides.Trajectory.static((1, 2, 3)).mounted((1, 0, 0)), 0.5)
    data = pickle.dumps(scene)
    assert len(data) < len(pickle.dumps(first)) + len(pickle.dumps(far))  # of a file the name alone
    other = pickle.loads(data)
    assert len(other) == 2 and other.count == scene.count
    for one, two in zip(scene, other):
        assert (one.name, one.source, one.scale) == (two.name, two.source, two.scale)
        assert all(np.array_equal(a, b) for a, b in zip(vars(one.gaussians).values(), vars(two.gaussians).values()))
        assert np.array_equal(one.trajectory.samples, two.trajectory.samples)
    opened, _ = tides.Run(RUN).open()
    assert np.array_equal(crossed(opened)[0].gaussians.mean, opened[0].gaussians.mean)


def test_up_goes_with_a_scene(tmp_path, cloud):
    scene = tides.Scene()
    scene.add(cloud)
    assert scene.up is None and crossed(scene).up is None and scene.orbit().at(0).rotation[:, 1] @ (0, 1, 0) > 0.5  # y down
    scene.up = (0, 1, 0)
    assert scene.up == crossed(scene).up == (0, 1, 0) and scene.orbit().at(0).rotation[:, 1] @ (0, 1, 0) < -0.5
    scene.save(tmp_path / "up.ply")
    assert tides.Scene(tmp_path / "up.ply").up == (0, 1, 0)
    with pytest.raises(ValueError, match="up: shape"):
        scene.up = (1, 2)
    scene.up = None
    assert scene.up is None
    opened, _ = tides.Run(tmp_path / "up.ply").open()
    assert opened.up == crossed(opened).up == (0, 1, 0)


def test_moving_scenes(tmp_path, cloud):
    random = np.random.default_rng(7)
    scene, n = tides.Scene(), len(cloud)
    motion = tides.Motion.polynomial(np.zeros(n), np.full(n, 20.0), random.normal(size=(n, 9)), np.zeros((n, 4)))
    scene.add(cloud, motion=motion, duration_s=2)
    with pytest.raises(TypeError, match="object 0 .* moves by .*save it as .h5"):
        pickle.dumps(scene)
    scene.save(tmp_path / "moving.h5")
    again = tides.Scene(tmp_path / "moving.h5")
    again.set_duration(3)
    assert crossed(again)[0].motion == scene[0].motion and crossed(again).range == again.range


def test_what_is_open_says_what_to_send(scene, camera, tmp_path):
    for one in (tides.Device("reference"), tides.Simulation(scene, camera), tides.Renderer(scene, camera)):
        with pytest.raises(TypeError, match=f"a {type(one).__name__} can't be pickled.*Run, Scene, Camera"):
            pickle.dumps(one)
    closed = tides.Scene()
    closed.close()
    with pytest.raises(ValueError, match="closed"):
        pickle.dumps(closed)


def test_another_process_has_the_same_events(scene, camera, tmp_path):
    stepping, sensor = tides.Stepping(step_s=0.01), tides.Sensor(threshold_on=0.3)
    (tmp_path / "world").write_bytes(pickle.dumps((scene, camera, sensor, stepping)))
    program = (
        "import pickle, sys, numpy, tides\n"
        "scene, camera, sensor, stepping = pickle.load(open(sys.argv[1], 'rb'))\n"
        "events = tides.Simulation(scene, camera, sensor=sensor, stepping=stepping, device='reference').run()\n"
        "open(sys.argv[2], 'wb').write(events.tobytes())\n"
    )
    subprocess.run([sys.executable, "-c", program, tmp_path / "world", tmp_path / "events"], check=True)
    events = tides.Simulation(scene, camera, sensor=sensor, stepping=stepping).run()
    assert len(events) > 500 and events.tobytes() == (tmp_path / "events").read_bytes()
