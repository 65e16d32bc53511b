"""Sessions: a run file with all its inputs open."""

import gc
import multiprocessing

import numpy as np
import pytest
import tides

RUN = "tests/install/run.json"


def test_a_session_runs_whatever_the_file_says(tmp_path):
    run = tides.Run(RUN)
    whole = run.simulate("reference")
    with tides.Session(RUN, device="reference") as session:
        assert not session.sees_frames and session.frames is None and session.device.facts.kind == "reference"
        assert session.scene.count > 0 and session.camera.intrinsics == session.intrinsics
        assert session.values.stop == run.stop and session.values.path.duration == 1.0
        assert np.array_equal(session.simulate(), whole) and len(whole) > 100
        packets = []
        stats = session.run(lambda events: packets.append(events.copy()))
        assert np.array_equal(np.concatenate(packets), whole) and stats.events == len(whole)
        assert session.write(tmp_path / "a.h5").events == len(whole)
        assert np.array_equal(tides.read_events(tmp_path / "a.h5"), whole)
        with pytest.raises(tides.errors.Cancelled):
            session.run(lambda events: len(events) > 0)
        with session.simulation() as simulation:
            assert np.array_equal(simulation.run(), whole)
            with pytest.raises(ValueError, match="Simulation uses it"):
                session.close()
        with session.renderer() as renderer:
            assert np.isfinite(renderer.frame(session.values.start)["L"]).all()
        scene = session.scene
    assert session.closed and scene.closed


def test_events_get_their_truth(tmp_path):
    h5py = pytest.importorskip("h5py")
    columns = ("flow_u", "flow_v", "depth", "alpha", "instance")
    plain, told = tmp_path / "plain.h5", tmp_path / "told.h5"
    with tides.Session(RUN, device="reference-f32") as session:
        session.write(plain)
        events = tides.read_events(plain)
        with session.vary({"sensor.truth": True}) as other:
            other.write(told)
        with session.renderer() as renderer:
            truth = renderer.event_truth(events)
            frame = renderer.truth(1e-9 * events["t"][5])
        assert np.array_equal(tides.read_events(told), events) and truth["alpha"].max() > 0.5
        x, y = events["x"][5], events["y"][5]
        assert all(truth[name][5] == frame[name][y, x] for name in columns)
        session.add_truth(plain)
        session.add_truth(plain)  # replaced
        session.write_maps(plain.with_name("maps.h5"))
        assert plain.with_name("maps.h5").stat().st_size > 0
        for file in (plain, told):
            with h5py.File(file) as read:
                for name in columns:
                    assert np.array_equal(read["events"][name][:], truth[name].astype(read["events"][name].dtype))
        assert np.array_equal(tides.read_events(plain), events)
        some = {"sensor.truth_columns": "depth,instance", "sensor.truth_metres": True}
        with session.vary({**some, "scene.metres_per_unit": 0.5}) as other:
            other.add_truth(plain)
        with h5py.File(plain) as read, h5py.File(told) as before:
            assert not {"flow_u", "flow_v", "alpha"} & set(read["events"])
            assert np.allclose(read["events/depth"][:], 0.5 * truth["depth"], rtol=1e-6)
            units = [file["events/depth"].attrs["unit"] for file in (read, before)]
            assert [unit.decode() if isinstance(unit, bytes) else unit for unit in units] == ["m", "scene units"]
        for wrong, what in ((some, "scene.metres_per_unit"), ({"sensor.truth_columns": "depth,speed"}, "'speed' is none of")):
            with session.vary({**wrong, "sensor.truth": True}) as other:
                with pytest.raises(tides.errors.BadConfig, match=what):
                    other.write(tmp_path / "no.h5")
        assert not (tmp_path / "no.h5").exists()
        (tmp_path / "junk.h5").write_bytes(b"junk")
        with pytest.raises(tides.errors.Unsupported, match="isn't an HDF5 event file"):
            session.add_truth(tmp_path / "junk.h5")
        assert (tmp_path / "junk.h5").read_bytes() == b"junk" and not list(tmp_path.glob("*.part"))
        with session.vary({"sensor.truth": True}) as other:
            with pytest.raises(tides.errors.Unsupported, match="only HDF5 has columns"):
                other.write(tmp_path / "a.raw")
        assert not (tmp_path / "a.raw").exists()


def test_cameras_of_a_rig():
    right = np.eye(4)
    right[0, 3] = 0.1
    cameras = [{"name": "left"}, {"name": "right", "kind": "event", "T_B_C": right.tolist(), "camera": {"width": 20}}]
    with tides.Session(RUN, {"rig.cameras": cameras}, device="reference") as session:
        rig = tides.Run(RUN, {"rig.cameras": cameras}).rig
        assert [one.name for one in rig] == ["left", "right"] and [one.kind for one in rig] == ["both", "event"]
        assert np.array_equal(rig[1].T_B_C, right) and tides.Run(RUN).rig == []
        with session.vary({"rig.camera": "right"}) as other:
            a, b = session.camera.trajectory.at(0.01), other.camera.trajectory.at(0.01)
            assert other.camera.intrinsics.width == 20
            assert np.allclose(b.position, a.position + a.rotation @ right[:3, 3], atol=1e-15)


def _forked(connection, device):
    """In a child of a fork: what it is told, on a new device and on the parent's."""
    told = []
    for spec in (device, "cpu", "reference"):
        try:
            told.append(len(tides.Run(RUN).simulate(spec)))
        except tides.errors.NoDevice as error:
            told.append(str(error))
    connection.send(told)


def test_forks_are_told_and_spawn_works():
    if not tides.devices():
        pytest.skip("this machine has no OpenCL device")
    with tides.Device(0) as device:
        whole = len(tides.Run(RUN).simulate(device))
        ours, theirs = multiprocessing.Pipe()
        child = multiprocessing.get_context("fork").Process(target=_forked, args=(theirs, device))
        child.start()
        assert ours.poll(300), "the child hangs"
        own, new, reference = ours.recv()
        child.join(60)
        assert child.exitcode == 0
        assert 'multiprocessing_context="spawn"' in own and own == new and reference > 100
        assert len(tides.Run(RUN).simulate(device)) == whole


def test_presets_and_what_they_did_not_set():
    text = {"scene": {"file": "a.ply"}, "camera": {"file": "p"}, "sensor": {"preset": "gen4", "threshold_on": 0.5}}
    run = tides.Run(text=text)
    assert run.notes == ["run: preset gen4: given otherwise, and so not set by it: sensor.threshold_on"]
    varied = run.vary({"sensor.preset": "gen4"})
    assert run.sensor.threshold_on == 0.5 and varied.sensor.threshold_on == 0.223 and varied.notes == []


def test_variations_share_what_is_open(tmp_path):
    session = tides.Run(RUN).session("reference")
    low = session.vary({"sensor.threshold_on": 0.1, "sensor.threshold_off": 0.1})
    assert low.device is session.device and low.values.sensor.threshold_on == 0.1
    assert len(low.simulate()) > len(session.simulate())
    alone = tides.Run(RUN, {"sensor.threshold_on": 0.1, "sensor.threshold_off": 0.1})
    assert np.array_equal(alone.simulate("reference"), low.simulate())
    again = tides.Run(RUN).vary({"seed": "5", "sensor.threshold_on": 0.1, "sensor.threshold_off": 0.1})
    assert np.array_equal(again.simulate("reference"), low.simulate())
    with pytest.raises(tides.errors.BadConfig, match="camera.width is another one"):
        session.vary({"camera.width": 9})
    with pytest.raises(ValueError, match="a Session uses it"):
        session.close()
    low.close()
    session.close()


def test_frames_have_no_simulation(tmp_path):
    frames = np.random.default_rng(1).uniform(0, 1, (5, 6, 8))
    np.save(tmp_path / "frames.npy", frames)
    text = {"frames": {"file": "frames.npy", "frames_per_second": 100}, "method": "v2e"}
    session = tides.Session(tides.Run(text=text, directory=tmp_path))
    assert session.sees_frames and session.scene is None and session.device is None and session.frames.width == 8
    events = session.simulate()
    stats = session.write(tmp_path / "v2e.csv", format="csv")
    assert stats.events == len(events) > 0
    for refused in (session.simulation, session.renderer, lambda: session.write(tmp_path / "a.h5", resume=True)):
        with pytest.raises(tides.errors.Unsupported):
            refused()
    with pytest.raises(tides.errors.Unsupported, match="readout.enabled"):
        session.vary({"readout.enabled": True}).simulate()
    with pytest.raises(ValueError, match="HDF5"):
        session.write(tmp_path / "v2e.csv", resume=True)
    del session
    gc.collect()


def test_inputs_and_their_fingerprints(tmp_path):
    run = tides.Run(RUN)
    inputs = run.inputs()
    assert [one.key for one in inputs] == ["scene.file", "camera.file"] and not inputs[0].folder
    prints = tides.Fingerprints(but=tmp_path / "out")
    first = run.fingerprint(prints=prints)
    assert first == run.fingerprint() and first.files == 2 and first.bytes >= first.largest > 0
    assert run.fingerprint("gpu").hash != first.hash != run.vary({"seed": "3"}).fingerprint().hash
    assert prints.of(inputs[0].path).bytes + prints.of(inputs[1].path).bytes == first.bytes
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a").write_text("x")
    whole = tides.Fingerprints().of(tmp_path)
    (tmp_path / "sub" / "a").write_text("xy")
    assert tides.Fingerprints().of(tmp_path).hash != whole.hash and whole.files == 1
    with pytest.raises(FileNotFoundError):
        prints.of(tmp_path / "gone")


def test_exact_streams_and_ideal_pixels(tmp_path, scene, camera):
    run = tides.Run(RUN, {"time.stop": 0.01, "sensor.threshold_on": 0.15, "sensor.preset": "davis346"})
    settings = tides.ideal_settings(run, "v2e")
    assert settings["method"] == "v2e" and settings["v2e.pos_thres"] == "0.15" and settings["v2e.sigma_thres"] == "0"
    own = tides.ideal_settings(run.vary({"v2e.pos_thres": 0.3}), "v2e", pixel=False)
    assert own == {"method": "v2e"} and "v2e.neg_thres" in tides.ideal_settings(run, "v2e", pixel=False)
    with pytest.raises(ValueError, match="dvs-voltmeter"):
        tides.ideal_settings(run, "ldati")
    sensor = tides.ideal_settings(run, "dvs-voltmeter", pixel=False, sensor=True)
    assert sensor["voltmeter.k3"] == "0" and float(sensor["voltmeter.k2"]) > 0
    ideal = run.ideal()
    assert ideal.sensor.threshold_on == 0.15 and ideal.sensor.threshold_sigma == 0 and not ideal.gives("seed")
    with run.session("reference") as session:
        exact = session.exact(in_double=1, long_renders=50)
        assert exact.moved.mismatch_percent < 5 and exact.steps_per_s > 1000 and len(exact.events) == exact["count"] > 10
        match = tides.metrics.match(exact.events, ideal.simulate("reference"))
        assert match.mismatch_percent < 1
    assert tides.image_is_continuous(tides.ImageParams()) and not tides.image_is_continuous(tides.ImageParams(rules="inria"))
    image = tides.ImageParams(rules="inria")
    rough = tides.exact_stream(scene, camera, 0, 0.01, image=image, first_rate=1000, last_rate=2000, progress=lambda f, s: 0)
    assert rough.tolerance == 0 and rough.steps_per_s == 2000 and np.all(np.diff(rough.events["t"]) >= 0)
    with pytest.raises(ValueError, match="nothing fires"):
        tides.exact_stream(scene, camera, 0, 0.001, tides.Sensor(threshold_on=50, threshold_off=50), long_renders=1)


def test_tables_by_name():
    stats = tides.api.tides_stats(events=7, unit=1)
    values = tides.stat_values(stats)
    assert values["events"] == 7 and values["settings.unit"] == 1 and len(values) == len(tides.statistics())
    formats = {one.endings: one for one in tides.scene_formats()}
    assert formats[".ply"].writes and not formats[".sog"].writes and ".glb .gltf" in formats
    assert tides.preset("davis346")["about"] and "sensor" in tides.preset("davis346")
    with pytest.raises(tides.TidesError, match="is no preset"):
        tides.preset("davis")


def test_the_table_of_statistics():
    rows = {row.name: row for row in tides.statistics()}
    assert rows["events"].type == "count" and rows["time_s.build"].unit == "s" and rows["tiles"].type == "whole"
    assert rows["events_on"].offset == tides.api.tides_stats.events_on.offset


def test_texts_hash_as_published():
    # FNV-1a's own test vectors (64 bits): of no bytes, "a", "foobar"
    assert tides.fingerprint_text() == tides.fingerprint_text("") == 0xCBF29CE484222325
    assert tides.fingerprint_text("a") == 0xAF63DC4C8601EC8C
    assert tides.fingerprint_text("foobar") == tides.fingerprint_text("foo", "", "bar") == 0x85944171F73967E8


def test_a_session_without_events_says_why(tmp_path):
    (tmp_path / "still.txt").write_text("0 0 0 -4 0 0 0 1\n")
    still = tides.Run(RUN, {"camera.file": str(tmp_path / "still.txt"), "time.stop": 0.02}).session("reference")
    with pytest.warns(UserWarning, match="no events: the image stays the same"):
        assert len(still.simulate()) == 0
    high = tides.Run(RUN, {"sensor.threshold_on": 9, "sensor.threshold_off": 9, "time.stop": 0.02}).session("reference")
    with pytest.warns(UserWarning, match="no pixel's L changes by more than .* of the threshold of 9"):
        high.write(tmp_path / "a.h5")
