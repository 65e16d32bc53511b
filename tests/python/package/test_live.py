"""Live runs: steps give the events of a run that knows the path, and wrong use raises."""

import json
import os
import resource
from pathlib import Path

import numpy as np
import pytest
import tides
from conftest import SIZE, make_cloud

STEP = 2e-3


@pytest.fixture
def room(tmp_path):
    """A run file of a cloud and a ball."""
    scene, ball = tides.Scene(), tides.Scene()
    scene.add(make_cloud(60), name="cloud")
    scene.add(make_cloud(10, seed=2), scale=0.3, name="ball")
    scene.save(tmp_path / "room.h5")
    path = tides.Trajectory.orbit(radius=4, angular_speed=2, start=0, stop=0.1)
    tides.Camera(path, tides.Intrinsics.from_fov(*SIZE, 0.8)).save(tmp_path / "path.json")
    run = {
        "scene": {"file": "room.h5"},
        "camera": {"file": "path.json"},
        "time": {"stop": 0.1},
        "stepping": {"step_s": STEP, "solve": "double", "tolerance": 0.1, "unit": "block"},
    }
    (tmp_path / "room.json").write_text(json.dumps(run))
    return tmp_path / "room.json"


def poses(room):
    return tides.Run(room).open()[1].trajectory


def test_steps_give_what_a_run_gives_that_knows(room):
    path, got = poses(room), []
    with tides.Live(room, objects=["ball"], keep=True, device="reference-f32") as live:
        for k in range(1, 21):
            ball = ((0.02 * k, 0.1, 0), (1, 0, 0, 0))
            pose = path.at(k * STEP)
            if k % 3 == 0:  # in each form
                pose = np.block([[pose.rotation, pose.position[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]])
            got.append(live.step(pose, STEP, objects={"ball": ball}))
            assert live.reached == pytest.approx(k * STEP, abs=1e-15) and live.time == pytest.approx(k * STEP, abs=1e-15)
            assert got[-1]["t"].max() <= 1e9 * live.time and live.stats.events == sum(map(len, got))
        known, moved, session = live.path(), live.path("ball"), live.session
        assert known.is_open and len(known) == len(moved) == 21
        v, scene = session.values, tides.Scene()
        for index, trajectory in enumerate((None, moved)):
            one = session.scene[index]
            scene.add(one.gaussians, trajectory, one.scale, one.name)
        again = tides.Simulation(
            scene, tides.Camera(known, session.intrinsics), v.start, 1.0, v.sensor, v.stepping, v.image, device="reference-f32"
        )
        events = again.run(live.time + 1e-12)
        tides.Camera(known, session.intrinsics).save(room.parent / "told.json")
    assert len(events) > 500 and np.array_equal(np.concatenate(got), events)
    told = tides.Camera.load(room.parent / "told.json").trajectory  # the same path, to the bit, from its file
    assert told.is_open and all(np.array_equal(told.at(t).rotation, known.at(t).rotation) for t in np.linspace(0, 0.04, 50))
    with pytest.raises(tides.errors.OutOfRange, match="camera's path is open"):
        again.run(0.2)


def test_open_paths_are_told_and_pickled(tmp_path):
    import pickle

    path = tides.Trajectory.open([0.0], [(0, 0, 0)], [(1, 0, 0, 0)], [(0, 0, 1)], [(0, 0, 0)])
    assert path.is_open and not path.is_static and path.range == (0, 0) and len(path) == 1
    path.append([1.0, 2.0], [(0, 0, 1), (0, 0, 2)], [(1, 0, 0, 0)] * 2)
    before = path.at(0.7).position
    path.append([3.0], [(5, 0, 0)], [(1, 0, 0, 0)])
    assert np.array_equal(path.at(0.7).position, before) and before == pytest.approx([0, 0, 0.7])
    twin = pickle.loads(pickle.dumps(path))
    assert twin.is_open and np.array_equal(twin.at(2.3).position, path.at(2.3).position)
    for one in (path, twin):
        one.append(np.arange(4.0, 20), np.zeros((16, 3)), [(1, 0, 0, 0)] * 16)
    path.forget(18.9)
    assert len(path) < 10 and np.array_equal(twin.at(18.95).position, path.at(18.95).position)
    with pytest.raises(tides.errors.BadArgument, match="strictly increase"):
        path.append([2.0], [(5, 0, 0)], [(1, 0, 0, 0)])
    with pytest.raises(tides.errors.BadArgument, match="known as a whole"):
        tides.Trajectory.static((0, 0, 0)).append([2.0], [(5, 0, 0)], [(1, 0, 0, 0)])
    with pytest.raises(tides.errors.Unsupported, match="jumps at every sample"):
        path.acceleration(18.9)
    scene = tides.Scene()
    scene.add(make_cloud(3), tides.Trajectory.open([0.0], [(0, 0, 0)], [(1, 0, 0, 0)]))
    scene.append(0, [1.0], [(1, 0, 0)], [(1, 0, 0, 0)])
    assert scene[0].trajectory.range == (0, 1)
    with pytest.raises(tides.errors.Unsupported, match="open"):
        scene.save(tmp_path / "a.h5")


def test_wrong_use_says_so(room):
    still = ((0, 0, -4), (1, 0, 0, 0))
    with tides.Live(room, max_speed=5, device="reference") as live:
        live.tell(still, 0)
        for wrong, words in [
            ((still, 0), "a run goes forward"),
            ((still, -1e-3), "a run goes forward"),
            ((still, np.nan), "above 0 s"),
            (((0, 0), 1e-3), "a pose is"),
            ((((0, 0, np.nan), (1, 0, 0, 0)), 1e-3), "finite numbers"),
            ((np.full((4, 4), np.nan), 1e-3), "rotation"),
            ((2 * np.eye(4), 1e-3), "orthonormal"),
        ]:
            with pytest.raises(ValueError, match=words):
                live.step(*wrong)
        with pytest.raises(TypeError, match="dt"):
            live.step(still)
        with pytest.raises(tides.errors.BadArgument, match="jump.*most_speed"):
            live.step(((0, 3, -4), (1, 0, 0, 0)), 1e-2)
        with pytest.raises(tides.errors.BadArgument, match="quaternion is zero"):
            live.step(((0, 0, -4), (0, 0, 0, 0)), 1e-2)
        with pytest.raises(tides.errors.BadArgument, match="179|turned by"):
            live.step(((0, 0, -4), (0, 0, 1, 0)), 1e-2)
        with pytest.raises(tides.errors.OutOfRange, match="its poses end before"):
            live.step(None, 1e-2)
        with pytest.raises(ValueError, match="'ball' gets no poses"):
            live.step(still, 1e-2, objects={"ball": still})
        assert live.time == 0
        live.step(still, 1e-2)
        with pytest.raises(tides.errors.BadArgument, match="go back"):
            live.run(0)
        session = live.session
        with pytest.raises(ValueError, match="Live uses it"):
            session.close()
    with pytest.raises(ValueError, match="this Live is closed"):
        live.step(still, 1e-2)
    with pytest.raises(ValueError, match="0 of the scene's are called 'bal'; it has 'cloud', 'ball'"):
        tides.Live(session, objects=["bal"])
    with pytest.raises(ValueError, match="on frames"):
        tides.Live(room, {"method": "esim"})
    with tides.Live(session, camera=False, objects="ball", stop=0.02) as live:
        with pytest.raises(ValueError, match="follows the run's path"):
            live.step(still, 1e-2)
        with pytest.raises(ValueError, match="follows the run's path"):
            live.path()
        live.step(None, 1e-2, objects={"ball": ((0.5, 0, 0), (1, 0, 0, 0))})
        with pytest.raises(ValueError, match="follows the run's path"):
            live.tell(still, 0.02)
        with pytest.raises(tides.errors.OutOfRange, match="ends at 0.02"):
            live.step(None, 0.1, objects={"ball": ((0.5, 0, 0), (1, 0, 0, 0))})


def test_a_step_is_told_as_a_whole(room):
    """Refused for one of them, it is refused for all, and taken once more gives what a run gives that was told nothing wrong."""
    here, there, ball = ((0, 0, -4), (1, 0, 0, 0)), ((0.01, 0, -4), (1, 0, 0, 0)), ((0.1, 0, 0), (1, 0, 0, 0))
    with tides.Live(room, objects=["ball"], max_speed=100, keep=True, device="reference-f32") as live:
        with tides.Live(room, objects=["ball"], keep=True, device="reference-f32") as quiet:
            for one in (live, quiet):
                one.tell(here, 0)
                one.tell(ball, 0, "ball")
            for k in range(1, 4):
                far, next_ball = ((9, 9, 9), (1, 0, 0, 0)), ((0.1 + 0.02 * k, 0, 0), (1, 0, 0, 0))
                with pytest.raises(tides.errors.BadArgument, match="object 1: .*jump"):
                    live.step(there, STEP, objects={"ball": far})
                with pytest.raises(tides.errors.OutOfRange, match="ball.*its poses end before"):
                    live.step(there, STEP)
                assert len(live.path()) == len(live.path("ball")) == k and live.time == quiet.time
                moved = {"ball": next_ball}
                assert np.array_equal(live.step(there, STEP, objects=moved), quiet.step(there, STEP, objects=moved))
        assert live.stats.events > 0


def test_nothing_is_lost(room, monkeypatch):
    """A call that is interrupted gave its events to nobody, and one that fails half way too: the next call has them."""
    at = [((0.02 * k, 0, -4), (1, 0, 0, 0)) for k in range(5)]
    with tides.Live(room, device="reference-f32") as live, tides.Live(room, device="reference-f32") as quiet:

        def interrupted(*arguments):  # as where a signal came while C worked
            tides._call.call(*arguments)
            raise KeyboardInterrupt

        for one in (live, quiet):
            one.tell(at[0], 0)
        steps = [quiet.step(pose, STEP) for pose in at[1:]]
        assert all(len(events) for events in steps)
        for k in (1, 2):
            with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
                patch.setattr("tides.live.call", interrupted)
                live.step(at[k], STEP)
            assert live.time == k * STEP
        assert np.array_equal(live.step(at[3], STEP), np.concatenate(steps[:3]))
        live.tell(at[4], 4 * STEP)
        with pytest.raises(tides.errors.BadArgument, match="aren't finite"):
            live.step(((0, 0, -1e300), (1, 0, 0, 0)), 2 * STEP)
        assert live.time == 3 * STEP
        assert np.array_equal(live.run(live.reached), steps[3]) and len(live.run(live.reached)) == 0


@pytest.mark.parametrize("rest, preset", [(1, "ideal"), (50, "ideal"), (200, "ideal"), (47, "dvs128"), (60, "imx636")])
def test_what_rests_first_gives_what_a_run_gives_that_knows(room, rest, preset):
    """The camera, held to 1e-4, and the ball wait for `rest` steps of 1 ms; the paths have forgotten the start by then."""
    held, got = np.random.default_rng(5).uniform(-1e-4, 1e-4, (rest + 7, 3)), {}
    for keep in (True, False):
        settings = {"stepping.step_s": 1e-3, "stepping.solve": "auto", "sensor.preset": preset}
        with tides.Live(room, settings, objects=["ball"], keep=keep, device="reference-f32") as live:
            events = []
            live.tell((held[0] + (0, 0, -4), (1, 0, 0, 0)), 0)
            for k in range(1, rest + 7):
                gone = 0.02 * max(k - rest, 0)
                pose, ball = (held[k] + (gone, 0, -4), (1, 0, 0, 0)), ((0, 2 * gone, 0), (1, 0, 0, 0))
                events.append(live.step(pose, 1e-3, objects={"ball": ball}))
            got[keep] = np.concatenate(events)
            if keep:
                session, v = live.session, live.session.values
                scene, camera = tides.Scene(), tides.Camera(live.path(), session.intrinsics)
                for index, trajectory in enumerate((None, live.path("ball"))):
                    scene.add(session.scene[index].gaussians, trajectory, session.scene[index].scale)
                whole = tides.Simulation(scene, camera, v.start, 9, v.sensor, v.stepping, v.image, device="reference-f32")
                known = whole.run(live.time)
    assert len(known) > 100 and np.array_equal(known, got[True]) and np.array_equal(known, got[False])


def test_the_example_follows_its_ball(monkeypatch, tmp_path):
    """0.4 s of it; `make check-live` takes ten, in which the process doesn't grow."""
    monkeypatch.syspath_prepend("python_ctypes/examples")
    import track_ball

    seconds, pages, step = float(os.environ.get("TIDES_LIVE_SECONDS", 0.4)), [], tides.Live.step

    def watched(live, *pose, **more):
        pages.append(int(Path("/proc/self/statm").read_text().split()[1]))
        return step(live, *pose, **more)

    monkeypatch.setattr(tides.Live, "step", watched)
    rows = track_ball.track(seconds, "reference-f32")
    off = np.linalg.norm(rows[:, 1:3] - rows[:, 3:5], axis=1) * 0.5 * track_ball.WIDTH / np.tan(0.5 * track_ball.VIEW)
    assert len(rows) == len(pages) == round(seconds / track_ball.STEP_S) and rows[:, 5].sum() > 1000
    assert off[0] > 10 and off[60:].max() < 8  # [px]: it begins beside the ball, finds it, and keeps it
    grown = (pages[-1] - pages[min(200, len(pages) // 2)]) * resource.getpagesize()
    print(f"{len(rows)} steps, off by {off[60:].max():.1f} px at most, {grown / 1024:.0f} KiB more at the end than after step 200")
    assert grown < 4 << 20
    picture = track_ball.panel("off [px]", rows[:, 0], [("", off)])
    tides.image.write_png(tmp_path / "a.png", np.ascontiguousarray(picture))


@pytest.mark.parametrize("kind, step", [("requested", 5e-3), ("scanned", 2e-3), (None, 5e-3)])
def test_a_run_may_end_where_it_is(room, kind, step):
    """What its readout still holds comes then: together the events of a run that stops there."""
    slow = {"readout.enabled": True, "readout.kind": kind, "readout.event_s": 1e-4, "readout.row_s": 1e-5} if kind else {}
    settings = {"stepping.step_s": step, **slow}
    path, got = poses(room), []
    with tides.Live(room, settings, keep=True, device="reference-f32") as live:
        for k in range(1, 5):
            got.append(live.step(path.at(k * step), step))
        held = live.finish()
        assert len(live.finish()) == 0 and live.time == live.reached == pytest.approx(4 * step, abs=1e-15)
        with pytest.raises(tides.errors.OutOfRange, match="tides_live_finish"):
            live.step(path.at(5 * step), step)
        tides.Camera(live.path(), live.session.intrinsics).save(room.parent / "told.json")
    known = tides.Session(room, {**settings, "camera.file": "told.json", "time.stop": 4 * step}, "reference-f32").simulate()
    assert np.array_equal(np.concatenate([*got, held]), known) and len(known) > 50
    assert (len(held) > 0) == (kind is not None)
