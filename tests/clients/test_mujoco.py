"""MuJoCo's loop: a body's place in the image by MuJoCo's own projection, velocities, events of a replay, and catching a
ball."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest
import tides

mujoco = pytest.importorskip("mujoco", reason="pip install tides[mujoco]")
import tides.mujoco  # noqa: E402
from tides.mujoco import Loop, Poses  # noqa: E402

sys.path.append(str(Path(__file__).parents[2] / "python_ctypes" / "examples"))

#: A stick that tumbles about a point that isn't its middle, seen by a camera on an arm that swings: nothing lies along an axis.
MODEL = """
<mujoco>
  <option timestep="0.001" gravity="0.3 0 -2"/>
  <worldbody>
    <body name="stick" pos="0.2 0.1 1.1" euler="20 40 10"><freejoint/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03" mass="1"/><site name="mark" pos="0 0 0"/>
    </body>
    <body name="arm" pos="0.5 -3 1.4" euler="0 10 5">
      <joint name="swing" axis="0.2 0.1 1"/><joint name="nod" axis="1 0 0" pos="0 0.2 0"/>
      <geom type="box" size="0.1 0.1 0.1" mass="1"/>
      <camera name="eye" pos="0.1 0.3 0.05" euler="85 8 3" fovy="38" resolution="120 90"/>
      <camera name="lens" pos="0.1 0.3 0.05" euler="85 8 3" resolution="120 90" sensorsize="0.0048 0.0036" focal="0.006 0.0062" principal="0.0002 -0.0001"/>
      <camera name="follower" mode="targetbody" target="stick" fovy="38" resolution="120 90"/>
    </body>
  </worldbody>
  <sensor><camprojection site="mark" camera="eye"/></sensor>
</mujoco>
"""
FRAME = ((0.3, -0.2, 0.5), (0.5, 0.5, -0.5, 0.5))  # where the scene's frame lies
UNIT = 0.25  # [m]


@pytest.fixture
def thrown():
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    data.qvel[:] = [0.2, 0.5, 1.0, 3, -2, 4, 0.4, -0.6]
    return model, data


def write_run(folder, poses, camera="eye", step=2e-3, **more):
    """A run of a speckled stick before a wall of Gaussians, in the scene's frame and units."""
    random = np.random.default_rng(6)
    scene = tides.Scene()
    wall = np.stack([random.uniform(-12, 12, 300), random.uniform(-12, 12, 300), random.uniform(-12, 12, 300)], 1)
    scene.add(tides.Gaussians.from_colours(wall, 0.4, random.uniform(0, 1, (300, 3))), name="wall")
    stick = random.normal(size=(40, 3)) * [0.4, 0.1, 0.1] + [0.8, 0, 0]
    scene.add(tides.Gaussians.from_colours(stick, 0.1, random.uniform(0, 1, (40, 3))), name="stick")
    scene.save(folder / "room.h5")
    tides.mujoco.write_camera(folder / "eye.json", poses, camera)
    run = {"scene": {"file": "room.h5", "metres_per_unit": UNIT}, "camera": {"file": "eye.json"}, "stepping": {"step_s": step}, **more}
    (folder / "run.json").write_text(json.dumps(run))
    return folder / "run.json"


# -- conventions ------------------------------------------------------------------------------------------------------------


def by_frustum(model, data, camera, width, height, point):
    """The pixel of a point by the frustum that MuJoCo's renderer has of a camera."""
    scene, view = mujoco.MjvScene(model, 100), mujoco.MjvCamera()
    model.cam_resolution[model.camera(camera).id] = width, height
    view.type, view.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, model.camera(camera).id
    mujoco.mjv_updateScene(model, data, mujoco.MjvOption(), None, view, mujoco.mjtCatBit.mjCAT_ALL, scene)
    one = scene.camera[0]
    eye = (np.array(scene.camera[0].pos) + np.array(scene.camera[1].pos)) / 2  # of the two of a stereo pair
    ahead, up = np.array(one.forward, float), np.array(one.up, float)
    x, y, z = np.cross(ahead, up) @ (point - eye), up @ (point - eye), ahead @ (point - eye)
    half = one.frustum_width or 0.5 * (one.frustum_top - one.frustum_bottom) * width / height
    u = (one.frustum_near * x / z - one.frustum_center) / (2 * half) + 0.5
    v = (one.frustum_top - one.frustum_near * y / z) / (one.frustum_top - one.frustum_bottom)
    return np.array([width * u, height * v])


@pytest.mark.parametrize("camera", ["eye", "lens"])
def test_a_body_is_where_mujoco_projects_it(thrown, tmp_path, camera):
    """At 20 times, by its renderer's frustum and, where no principal point is set, which it ignores, the camprojection sensor;
    against where TIDES shows a Gaussian at the body's origin."""
    model, data = thrown
    poses, times, told, wanted = Poses(model, data, UNIT, FRAME), [], [], []
    for k in range(20):
        mujoco.mj_step(model, data, 5)
        mujoco.mj_forward(model, data)  # sensors of this moment
        poses.update()
        times.append(data.time)
        told.append((poses.camera(camera), poses.body("stick")))
        wanted.append(by_frustum(model, data, camera, 120, 90, data.body("stick").xpos))
        if camera == "eye":
            assert wanted[-1] == pytest.approx(data.sensordata[:2], abs=0.01)
    eye, stick = (tides.Trajectory(times, *(np.array([one[who][k] for one in told]) for k in range(4))) for who in (0, 1))
    scene = tides.Scene()
    scene.add(tides.Gaussians.from_colours(np.zeros((1, 3)), 0.1, np.ones((1, 3))), stick, name="mark")
    lens = tides.mujoco.intrinsics(model, camera)
    renderer = tides.Renderer(scene, tides.Camera(eye, lens), device="reference")
    seen = 0
    for time, pixel in zip(times, wanted):
        point = np.zeros(1, tides.MATERIAL_POINT)
        track = renderer.follow(time, point)[0]
        assert np.array([track["u"], track["v"]]) == pytest.approx(pixel, abs=0.01)
        seen += 0 < pixel[0] < lens.width and 0 < pixel[1] < lens.height
        picture = renderer.frame(time, ["A"])["A"] if seen == 5 else None
        if picture is not None:  # and that is where the image has it: pixel centres at halves
            rows, columns = np.mgrid[: lens.height, : lens.width] + 0.5
            middle = np.array([(picture * columns).sum(), (picture * rows).sum()]) / picture.sum()
            assert middle == pytest.approx(pixel, abs=0.05)
    assert seen >= 10


def test_cameras_look_along_minus_z(tmp_path):
    """The simplest there is: a body straight ahead, one to the right, one above."""
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><camera name="eye" pos="0 0 2" fovy="90" resolution="100 100"/>'
        '<camera name="chip" pos="0 0 2" resolution="80 60" sensorsize="0.004 0.003" focal="0.002 0.002" principal="0.0002 -0.0003"/>'
        '<body name="ahead" pos="0 0 0"/><body name="right" pos="1 0 0"/><body name="above" pos="0 1 0"/></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    poses = Poses(model, data, 1.0)
    position, quaternion = poses.camera("eye")[:2]
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, quaternion)
    sees = [turn.reshape(3, 3).T @ (poses.body(name)[0] - position) for name in ("ahead", "right", "above")]
    assert np.allclose(sees, [[0, 0, 2], [1, 0, 2], [0, -1, 2]], atol=1e-12)  # x right, y down, z forward
    for name in ("eye", "chip"):  # in images of other shapes too
        for size in ((100, 100), (60, 90), (90, 60)):
            lens, point = tides.mujoco.intrinsics(model, name, *size), np.array([0.3, -0.2, 0.1])
            mujoco.mj_forward(model, data)
            seen = lens.fx * 0.3 / 1.9 + lens.cx, lens.fy * 0.2 / 1.9 + lens.cy
            assert by_frustum(model, data, name, *size, point) == pytest.approx(seen, abs=1e-3)
    lens = tides.mujoco.intrinsics(model, "eye", 64, 32)
    assert (lens.width, lens.height, lens.cx, lens.cy) == (64, 32, 32, 16) and lens.fy == lens.fx == pytest.approx(16)


def test_axes_of_others():
    """What each calls forward, right and up, in a camera at rest."""
    for axes, right, down, forward in [
        ("opencv", (1, 0, 0), (0, 1, 0), (0, 0, 1)),
        ("opengl", (1, 0, 0), (0, -1, 0), (0, 0, -1)),
        ("robot", (0, -1, 0), (0, 0, -1), (1, 0, 0)),
    ]:
        turn = np.empty(9)
        mujoco.mju_quat2Mat(turn, tides.camera_quaternion((1, 0, 0, 0), axes))
        assert np.allclose(turn.reshape(3, 3).T, [right, down, forward], atol=1e-15)
        given = np.array([0.5, -0.1, 0.7, 0.2]) / np.linalg.norm([0.5, -0.1, 0.7, 0.2])
        whole, part = np.empty(9), np.empty(9)
        mujoco.mju_quat2Mat(whole, tides.camera_quaternion(given, axes))
        mujoco.mju_quat2Mat(part, given)
        assert np.allclose(whole.reshape(3, 3), part.reshape(3, 3) @ turn.reshape(3, 3))
    with pytest.raises(ValueError, match="none of"):
        tides.camera_quaternion((1, 0, 0, 0), "y-up")


def test_velocities_are_those_of_the_poses(thrown):
    """Of the body's own origin, not of its centre of mass, and of a camera that swings with two joints."""
    model, data = thrown
    poses, h = Poses(model, data, UNIT, FRAME), 1e-6
    mujoco.mj_step(model, data, 30)
    poses.update()
    for read, name in ((poses.body, "stick"), (poses.camera, "eye")):
        position, quaternion, velocity, angular = read(name)
        there = data.qpos.copy()
        ends = []
        for way in (-h, h):
            moved = there.copy()
            mujoco.mj_integratePos(model, moved, data.qvel, way)
            data.qpos[:] = moved
            poses.update()
            ends.append(read(name)[:2])
        data.qpos[:] = there
        poses.update()
        assert velocity == pytest.approx((ends[1][0] - ends[0][0]) / (2 * h), abs=1e-6)
        turns = [np.empty(9) for _ in range(3)]
        for turn, one in zip(turns, (ends[0][1], quaternion, ends[1][1])):
            mujoco.mju_quat2Mat(turn, one)
        a, r, b = (turn.reshape(3, 3) for turn in turns)
        spin = (b - a) / (2 * h) @ r.T
        assert angular == pytest.approx([spin[2, 1], spin[0, 2], spin[1, 0]], abs=1e-6) and np.linalg.norm(velocity) > 0.1


def test_poses_are_of_now_and_leave_the_simulation_alone(thrown):
    """mj_step leaves the poses of the moment before it; and a simulation that is watched goes on as one that isn't."""
    model, data = thrown
    twin, poses = mujoco.MjData(model), Poses(model, data, 1.0)
    twin.qvel[:] = data.qvel
    for _ in range(50):
        mujoco.mj_step(model, data)
        poses.update()
        mujoco.mj_step(model, twin)
    assert np.array_equal(data.qpos, twin.qpos) and np.array_equal(data.qacc_warmstart, twin.qacc_warmstart)
    stale = data.body("stick").xpos.copy()
    mujoco.mj_kinematics(model, twin)
    assert poses.body("stick")[0] == pytest.approx(twin.body("stick").xpos, abs=1e-14)
    assert np.linalg.norm(poses.body("stick")[0] - stale) > 1e-4


# -- the loop ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("camera, every", [("eye", 2), ("eye", 3), ("follower", 2)])
def test_the_loop_gives_what_a_replay_gives(thrown, tmp_path, camera, every):
    """Of the poses and velocities that were told, and by a run that knows the paths as a whole."""
    model, data = thrown
    data.time = 12.5  # its clock may say anything
    run = write_run(tmp_path, Poses(model, data, UNIT, FRAME), camera)
    got, told = [], []
    with Loop(run, model, data, camera, {"stick": "stick"}, {"time.start": 1, "time.stop": 2}, frame=FRAME, keep=True, device="reference-f32") as loop:
        for _ in range(15):
            mujoco.mj_step(model, data, every)
            got.append(loop.step())
            told.append((loop.poses.camera(camera), loop.poses.body("stick")))
        assert loop.live.time == pytest.approx(1 + 15 * every * 1e-3, abs=1e-12) == 1 + data.time - 12.5
        eye, stick, reached, session = loop.live.path(), loop.live.path("stick"), loop.live.reached, loop.live.session
        with pytest.raises(ValueError, match="step it first"):
            loop.step()
        v, scene = session.values, tides.Scene()
        for index, path in enumerate((None, stick)):
            scene.add(session.scene[index].gaussians, path, name=session.scene[index].name)
        again = tides.Simulation(
            scene, tides.Camera(eye, session.intrinsics), v.start, 9, v.sensor, v.stepping, v.image, device="reference-f32"
        )
        events = again.run(reached + 1e-12)
    assert len(events) > 200 and np.array_equal(np.concatenate(got), events)
    assert bool(eye.samples["has_rates"].all()) == (camera == "eye") and stick.samples["has_rates"].all()
    with tides.Live(run, {"time.start": 1, "time.stop": 2}, objects=["stick"], device="reference-f32") as live:
        live.tell(tuple(eye.samples[0][n] for n in ("position", "quaternion", "velocity", "angular_velocity")[: len(told[0][0])]), 1)
        live.tell(tuple(stick.samples[0][n] for n in ("position", "quaternion", "velocity", "angular_velocity")), 1, "stick")
        for k, (pose, body) in enumerate(told):
            dt = eye.samples["time"][k + 1] - live.time
            assert np.array_equal(live.step(pose, dt, {"stick": body}), got[k])


def test_wrong_use_says_so(thrown, tmp_path):
    model, data = thrown
    poses = Poses(model, data, UNIT)
    run = write_run(tmp_path, poses)
    for wrong, words in [
        (dict(camera="eyes"), "no 'eyes'.*'eye', 'lens', 'follower'"),
        (dict(camera="eye", bodies={"stick": "stock"}), "no 'stock'"),
        (dict(camera="eye", bodies={"stock": "stick"}), "0 of the scene's are called 'stock'"),
        (dict(camera="eye", metres_per_unit=1), "is given, and the run's"),
        (dict(camera="eye", set={"scene.metres_per_unit": None}), "scene.metres_per_unit; set it"),
        (dict(camera="eye", frame=((0, 0, 0), (1, 1, 0, 0))), "length 1"),
    ]:
        with pytest.raises(ValueError, match=words):
            Loop(run, model, data, **wrong)
    with pytest.raises(ValueError, match="above 0"):
        Poses(model, data, 0)
    with Loop(run, model, data, "eye", device="reference-f32") as loop:
        mujoco.mj_step(model, data)
        loop.step()
        mujoco.mj_resetData(model, data)
        with pytest.raises(ValueError, match="make another Loop"):
            loop.step()
    plain = mujoco.MjModel.from_xml_string('<mujoco><worldbody><camera name="eye"/></worldbody></mujoco>')
    with pytest.raises(ValueError, match="no resolution"):
        tides.mujoco.intrinsics(plain, "eye")


def test_the_example_catches_the_ball():
    import catch_ball

    rows = catch_ball.catch("reference-f32")
    off = np.linalg.norm(rows[:, 1:3], axis=1)
    assert off[0] > 6 and np.median(off[len(off) // 2 :]) < 3 and off.max() < 15
    assert np.abs(rows[:, 3]).max() > 0.4 and rows[:, 5].sum() > 1000  # the head turned, and by events
