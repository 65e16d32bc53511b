"""Rendering and simulating: arrays, packets, files."""

import json
import os
import subprocess
import sys
import warnings

import numpy as np
import pytest
import tides
from conftest import SIZE, again


def test_frame(scene, camera):
    with tides.Renderer(scene, camera) as renderer:
        frame = renderer.frame(0.05, tides.CHANNELS)
        assert set(frame) == set(tides.CHANNELS) and tides.CHANNELS[:3] == ("Y", "L", "L_dot")
        assert all(plane.shape == SIZE[::-1] and plane.dtype == np.float64 for plane in frame.values())
        assert np.allclose(frame["L"], np.log(frame["Y"] + tides.ImageParams().log_eps))
        h = 1e-5
        before, after = (renderer.frame(0.05 + d, ["L"])["L"] for d in (-h, h))
        assert np.median(np.abs((after - before) / (2 * h) - frame["L_dot"])) < 1e-3 * np.abs(frame["L_dot"]).max()
        assert renderer.stats.gaussians_total == scene.count and renderer.stats.tile_jobs > 0
        other = renderer.frame(0.0, ["Y"], tides.Trajectory.static((0, 0, -4)))
        assert not np.array_equal(other["Y"], frame["Y"])
        with pytest.raises(ValueError, match="did you mean 'L_dot'"):
            renderer.frame(0.05, ["L_dott"])
    with pytest.raises(ValueError, match="closed"):
        renderer.frame(0.05)
    assert tides.lib.tides_channel_name(99) is None


def test_colour_filter(scene, camera):
    cells = tides.colour_filter("grbg", *SIZE[::-1])
    assert cells.shape == SIZE[::-1] and cells[:2, :2].tolist() == [[1, 0], [2, 1]]
    with tides.Renderer(scene, camera, tides.ImageParams(colour_filter="grbg")) as renderer:
        seen = renderer.frame(0.05, ["L", "L_dot"])
    for c in range(3):
        alone = tides.ImageParams(luminance=[float(k == c) for k in range(3)])
        with tides.Renderer(scene, camera, alone) as renderer:
            frame = renderer.frame(0.05, ["L", "L_dot"])
        assert all(np.array_equal(seen[name][cells == c], frame[name][cells == c]) for name in frame)
    with pytest.raises(ValueError, match="did you mean 'rggb'"):
        tides.colour_filter("rgb", 2, 2)
    with pytest.raises(ValueError, match="lets all light through"):
        tides.colour_filter("off", 2, 2)


def test_truth(scene, camera):
    with tides.Renderer(scene, camera) as renderer:
        truth = renderer.truth(0.05)
        assert tuple(truth) == tides.TRUTHS and tides.TRUTHS[:3] == ("flow_u", "flow_v", "depth")
        assert all(plane.shape == SIZE[::-1] and plane.dtype == np.float64 for plane in truth.values())
        seen = truth["alpha"] > 0.5
        assert seen.any() and (truth["depth_median"][seen] > 0).all() and (truth["instance"][seen] >= 0).all()
        assert np.abs(truth["alpha"] - renderer.frame(0.05, ["A"])["A"]).max() < 1e-4
        length = np.sqrt(sum(truth[name] ** 2 for name in ("normal_x", "normal_y", "normal_z")))
        assert np.abs(length[seen] - 1).max() < 1e-5
        with pytest.raises(ValueError, match="did you mean 'depth'"):
            renderer.truth(0.05, ["dept"])
    assert tides.lib.tides_truth_name(99) is None


def test_tracks(scene, camera):
    with tides.Renderer(scene, camera) as renderer:
        way = renderer.displacement(0.04, 0.06)
        seen = np.isfinite(way["u"])
        assert seen.any() and (way["visible"] <= seen).all() and way["u"].shape == SIZE[::-1]
        rows, columns = np.nonzero(seen)
        places = np.stack([columns, rows], axis=1) + 0.5
        points = renderer.pick(0.04, places)
        assert (points["object"] >= 0).all() and (points["gaussian"] < scene.count).all()
        tracks = renderer.follow(0.06, points)
        assert np.abs(tracks["u"] - places[:, 0] - way["u"][seen]).max() < 0.1
        assert np.array_equal(tracks["visible"] > 0, way["visible"][seen])
        with pytest.raises(tides.TidesError, match="outside of the image"):
            renderer.pick(0.04, [[-1, 0]])
        points["gaussian"] = 10**9
        with pytest.raises(tides.TidesError, match="no Gaussian"):
            renderer.follow(0.06, points)


def test_image_rules(scene, camera):
    image = tides.ImageParams(rules="inria", background=(1, 1, 1))
    assert tides.Renderer(scene, camera, image).frame(0, ["Y"])["Y"].max() > 0.99


def test_events(simulation, events):
    assert events.dtype == tides.EVENT and len(events) > 1000
    assert (np.diff(events["t"]) >= 0).all() and set(events["p"]) == {1, -1}
    assert events["x"].max() < SIZE[0] and events["y"].max() < SIZE[1] and (events["cause"] == 0).all()
    stats = simulation.stats
    assert stats.events == len(events) == stats.events_on + stats.events_off and stats.simulated_s == pytest.approx(0.1)
    assert stats.render.tile_jobs > 0
    state = simulation.state
    assert state.signal.shape == SIZE[::-1] and (np.abs(state.signal - state.reference) < 0.2).all()
    assert state.count_on.sum() == (events["p"] == 1).sum() and state.count_off.sum() == (events["p"] == -1).sum()
    with pytest.raises(ValueError, match=r"at its end \(0.1 s\).*make a new one"):
        simulation.run()


def test_what_is_spent_says_so(scene, camera, events, tmp_path):
    ways = {
        "run": lambda one: one.run(),
        "packets": lambda one: list(one),
        "feed": lambda one: one.feed(lambda packet: None),
        "write": lambda one: one.write(tmp_path / "events.h5"),
    }
    for first in ways.values():
        simulation = again(scene, camera)
        first(simulation)
        for second in ways.values():
            with pytest.raises(ValueError, match="has given all its events"):
                second(simulation)
        assert simulation.stats.events == len(events)
    assert np.array_equal(tides.read_events(tmp_path / "events.h5"), events)  # a second write leaves the first
    simulation = again(scene, camera)
    assert np.array_equal(simulation.run(0.1), events) and len(simulation.run()) == 0  # to a time: there may be a rest


def hears_of_nothing(take):
    """That the warning comes once, and names the user's line: here that is one of this file."""
    with pytest.warns(UserWarning, match="nothing of the scene was in view") as heard:
        take()
    assert [one.filename for one in heard] == [__file__]


def test_a_view_of_nothing_says_so(scene, tmp_path):
    """A camera that looks away has no events, and its user hears why; one that stands still before a scene doesn't."""
    lens = tides.Intrinsics.from_fov(*SIZE, 0.8)
    stepping = tides.Stepping(mode="fixed", step_s=0.01)
    away = tides.Camera(tides.Trajectory.static((0, 0, -4), (0, 1, 0, 0)), lens)
    silent, file = lambda packet: None, tmp_path / "no.h5"
    for take in (lambda one: one.run(), list, lambda one: one.feed(silent), lambda one: one.write(file)):
        simulation = tides.Simulation(scene, away, 0, 0.02, stepping=stepping, device="reference")
        hears_of_nothing(lambda: take(simulation))
        assert simulation.stats.events == 0
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        still = tides.Camera(tides.Trajectory.static((0, 0, -4)), lens)
        assert len(tides.Simulation(scene, still, 0, 0.02, stepping=stepping, device="reference").run()) == 0


def test_a_session_of_nothing_says_so(tmp_path):
    away = {"exposure.frames_per_second": 100, "exposure.exposure_s": 0.001, "time.stop": 0.02}
    (tmp_path / "away.txt").write_text("0 0 0 -4 0 1 0 0\n")
    away["camera.file"] = str(tmp_path / "away.txt")
    run = tides.Run("tests/install/run.json", away)
    session = run.session("reference")
    ways = (
        lambda: run.simulate("reference"),
        session.simulate,
        lambda: session.run(lambda packet: None),
        lambda: session.write(tmp_path / "no.h5"),
        lambda: session.write_frames(tmp_path / "frames"),
        lambda: session.dataset(tmp_path / "set", "blinkflow"),
    )
    for way in ways:
        hears_of_nothing(way)


def test_absolute_times(scene, camera, tmp_path):
    """A path at 1.4e9 s: the same events, so much later, in memory, in packets and in files."""
    times = np.arange(9) / 64
    positions = np.stack([0.5 * np.sin(20 * times), 0.2 * times, np.full(9, -4.0)], axis=1)
    runs = []
    for start in (0.0, 1.4e9):
        path = tides.Trajectory(times + start, positions, np.tile((1.0, 0, 0, 0), (9, 1)))
        runs.append(again(scene, tides.Camera(path, camera.intrinsics)))
    early, moved = runs[0].run(), 1_400_000_000 * 10**9
    late = np.concatenate(list(runs[1]))
    assert len(early) > 1000 and np.array_equal(late["t"] - moved, early["t"])
    assert all(np.array_equal(late[name], early[name]) for name in ("x", "y", "p"))
    again(scene, runs[1].camera).write(tmp_path / "late.h5")
    assert np.array_equal(tides.read_events(tmp_path / "late.h5"), late)
    with pytest.raises(tides.errors.Unsupported, match="HDF5"):
        again(scene, runs[1].camera).write(tmp_path / "late.raw")
    assert not list(tmp_path.glob("late.raw*"))
    with tides.EventWriter(tmp_path / "b.h5", *SIZE, start_ns=moved, stop_ns=moved + 10**9) as writer:
        writer.append(late)
    assert np.array_equal(tides.read_events(tmp_path / "b.h5"), late)


def test_packets_are_the_events(scene, camera, events):
    packets = list(again(scene, camera))
    assert len(packets) == 10 and np.array_equal(np.concatenate(packets), events)
    assert np.array_equal(np.concatenate(list(again(scene, camera).packets(0.035))), events)
    begun = again(scene, camera)
    first = begun.run(0.03)
    assert 0 < len(first) < len(events)
    assert np.array_equal(np.concatenate([first, *begun]), events)
    with pytest.raises(ValueError, match="duration_s"):
        next(begun.packets(0.0))


def test_feed_gives_views(scene, camera, events):
    packets = []
    again(scene, camera).feed(lambda packet: packets.append(packet.copy()))
    assert np.array_equal(np.concatenate(packets), events)
    with pytest.raises(tides.errors.Cancelled):
        again(scene, camera).feed(lambda packet: True)
    simulation = again(scene, camera)
    with pytest.raises(ZeroDivisionError):
        simulation.feed(lambda packet: 1 / 0)


@pytest.mark.parametrize("ending", ["h5", "npy", "raw"])
def test_write(scene, camera, events, tmp_path, ending):
    stats = again(scene, camera, run='{"a": 1}', seed="7").write(tmp_path / f"events.{ending}")
    assert stats.events == len(events)
    read = tides.read_events(tmp_path / f"events.{ending}")
    tick = 1 if ending == "h5" else 1000
    assert np.array_equal(read["t"], events["t"] // tick * tick)
    assert all(np.array_equal(read[name], events[name]) for name in "xyp")
    assert os.listdir(tmp_path) == [f"events.{ending}"]


def test_progress(scene, camera, capfd):
    seen = []
    simulation = again(scene, camera, progress=lambda fraction, stage: seen.append(stage))
    simulation.run(progress=lambda fraction, stage: seen.append((fraction, stage)))
    assert seen[-1] == (1.0, "simulating") and len(seen) >= 10
    again(scene, camera).run(progress=True)
    assert "simulating" in capfd.readouterr().err  # tqdm's bar, or a line per tenth


def test_progress_without_tqdm(scene, camera, capfd, monkeypatch):
    for name in ("tqdm", "tqdm.auto"):
        monkeypatch.setitem(sys.modules, name, None)
    again(scene, camera).run(progress=True)
    lines = capfd.readouterr().err.splitlines()
    assert lines[-1] == "tides: simulating 100 %" and len(lines) <= 11


def test_progress_with_tqdm(scene, camera, monkeypatch):
    class Bar:
        made = []

        def __init__(self, **_):
            self.n, self.steps, self.closed = 0.0, [], False
            self.made.append(self)

        def set_description(self, stage, refresh):
            self.steps.append(stage)

        def update(self, more):
            self.n += more

        def close(self):
            self.closed = True

    module = type(sys)("tqdm.auto")
    module.tqdm = Bar
    monkeypatch.setitem(sys.modules, "tqdm", type(sys)("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", module)
    again(scene, camera).run(progress=True)
    (bar,) = Bar.made
    assert bar.closed and bar.n == pytest.approx(1) and set(bar.steps) == {"simulating"}


def test_stopping(scene, camera, events):
    simulation = again(scene, camera)
    with pytest.raises(tides.errors.Cancelled) as raised:
        simulation.run(progress=lambda fraction, stage: fraction > 0.4)
    assert 0 < len(raised.value.events) < len(events)
    assert np.array_equal(np.concatenate([raised.value.events, simulation.run()]), events)
    simulation = again(scene, camera)
    with pytest.raises(ZeroDivisionError):
        simulation.run(progress=lambda fraction, stage: 1 / 0)
    simulation = again(scene, camera)
    simulation.cancel()
    with pytest.raises(tides.errors.Cancelled):
        simulation.run()
    simulation.run()


def test_no_end(scene, camera):
    with pytest.raises(ValueError, match="stands still"):
        tides.Simulation(scene, tides.Camera(tides.Trajectory.static((0, 0, -4)), camera.intrinsics))


def test_save_and_restore(scene, camera, events, tmp_path):
    first = again(scene, camera)
    head = first.run(0.05)
    first.save(tmp_path / "state")
    second = again(scene, camera)
    second.restore(tmp_path / "state")
    assert np.array_equal(np.concatenate([head, second.run()]), events)
    other = tides.Simulation(scene, camera, sensor=tides.Sensor(threshold_on=0.3), stepping=first.stepping)
    with pytest.raises(tides.errors.BadConfig, match="threshold_on"):
        other.restore(tmp_path / "state")


def test_interrupted_file_goes_on(scene, camera, events, tmp_path):
    file = tmp_path / "events.h5"
    with pytest.raises(tides.errors.Cancelled):
        again(scene, camera).write(file, progress=lambda fraction, stage: fraction > 0.6)
    part = tides.read_events(f"{file}.part")
    assert not file.exists() and 0 < len(part) < len(events) and np.array_equal(part, events[: len(part)])
    again(scene, camera).write(file, resume=True, checkpoint_s=1e-9)  # with a checkpoint at every step
    assert np.array_equal(tides.read_events(file), events) and os.listdir(tmp_path) == ["events.h5"]
    with pytest.raises(ValueError, match="HDF5"):
        again(scene, camera).write(tmp_path / "events.raw", resume=True)
    assert tides.can_resume("a.h5") and not tides.can_resume("a.raw")


def test_finished_file_is_extended(scene, camera, events, tmp_path):
    file = tmp_path / "events.h5"
    for stop in (0.043, 0.06):  # within a step, and once more
        again(scene, camera, stop=stop).write(file, resume=file.exists(), keep_checkpoint=True)
        assert sorted(os.listdir(tmp_path)) == ["events.h5", "events.h5.checkpoint"]
    shorter = tides.read_events(file)
    assert 0 < len(shorter) < len(events)
    assert again(scene, camera).write(file, resume=True).events_written == len(events)
    assert np.array_equal(tides.read_events(file), events) and os.listdir(tmp_path) == ["events.h5"]
    with pytest.raises(tides.errors.FileMissing, match="events.h5.checkpoint"):
        again(scene, camera).write(file, resume=True)
    with pytest.raises(ValueError, match="HDF5"):
        again(scene, camera).write(tmp_path / "events.raw", keep_checkpoint=True)


def test_command_line_goes_on(tmp_path):
    """What Python leaves is what `tides simulate --resume` takes."""
    tool = os.environ.get("TIDES")
    if not tool:
        pytest.skip("TIDES names no tool")
    run, file = "tests/install/run.json", tmp_path / "events.h5"
    with pytest.raises(tides.errors.Cancelled):
        with tides.Run(run).simulation("reference") as simulation:
            simulation.write(file, progress=lambda fraction, stage: fraction > 0.4)
    command = [tool, "simulate", run, "-o", file, "--resume", "--device", "reference", "--json"]
    facts = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    whole = tides.Run(run).simulate("reference")
    assert np.array_equal(tides.read_events(file), whole) and facts["events"] == len(whole)


def test_readout(scene, camera, events, tmp_path):
    slow = tides.Readout(enabled=1, kind="bottleneck", tick_s=2e-6, k0=1, eta=0.0, gamma_sigma_s=0.0)
    packets = []
    simulation = again(scene, camera, readout=slow)
    simulation.feed(lambda packet, fired: packets.append((packet.copy(), fired.copy())), fired=True)
    left, fired = (np.concatenate(one) for one in zip(*packets))
    assert np.array_equal(np.sort(fired), events["t"]) and (left["t"] >= fired).all() and (left["t"] > fired).any()
    assert simulation.stats.events_delayed > 0 and simulation.stats.events_written == len(events)
    plain = []
    again(scene, camera).feed(lambda packet, fired: plain.append(np.array_equal(packet["t"], fired)), fired=True)
    assert all(plain)
    file = tmp_path / "events.h5"
    with pytest.raises(tides.errors.Cancelled):
        again(scene, camera, readout=slow).write(file, progress=lambda fraction, stage: fraction > 0.6)
    again(scene, camera, readout=slow).write(file, resume=True)
    assert np.array_equal(tides.read_events(file), left)


def test_labels(scene, camera, tmp_path):
    sensor = tides.Sensor(photoreceptor_cutoff_hz=200, labels=1)
    slow = tides.Readout(enabled=1, kind="bottleneck", tick_s=2e-6, k0=1, eta=0.0, gamma_sigma_s=0.0)
    whole, file = again(scene, camera, sensor=sensor).run(), tmp_path / "events.h5"
    assert (whole["frontend"] != 0).mean() > 0.9
    with pytest.raises(tides.errors.Cancelled):
        again(scene, camera, sensor=sensor, readout=slow).write(file, progress=lambda fraction, stage: fraction > 0.6)
    again(scene, camera, sensor=sensor, readout=slow).write(file, resume=True)
    events, fired = tides.read_labelled(file)
    assert (fired <= events["t"]).all() and (fired < events["t"]).any()
    events["t"] = fired
    assert np.array_equal(events[np.lexsort((events["p"], events["x"], events["y"], events["t"]))], whole)
    with pytest.raises(tides.errors.Unsupported, match="labels"):
        again(scene, camera, sensor=sensor).write(tmp_path / "events.raw")


def test_filters_behind_a_simulation(scene, camera):
    """What a run drops is what the same filters drop of its events."""
    filters = tides.Filters(trail="trail", trail_s=0.05)
    events = again(scene, camera).run()
    kept = again(scene, camera, filters=filters).run()
    assert 0 < len(kept) < len(events) and np.array_equal(kept, tides.filter(events, filters))
