"""Frames and the simulators that work on them."""

import json
import zipfile

import numpy as np
import pytest
import tides
from conftest import SIZE


def ramp(frames=11, stop=0.1):
    """Luminance that rises by a factor of e over the sequence, faster on the right."""
    times = np.linspace(0, stop, frames)
    slope = np.tile(np.linspace(0.5, 1.5, SIZE[0]), (SIZE[1], 1))
    return np.exp(times[:, None, None] / stop * slope) * 0.1, times


def params(**fields):
    made = tides.BaselineParams(method="esim", **fields)
    made.esim.contrast_threshold_pos = made.esim.contrast_threshold_neg = 0.2
    made.esim.contrast_threshold_sigma_pos = made.esim.contrast_threshold_sigma_neg = 0
    return made


def test_frames(tmp_path):
    luminance, times = ramp()
    frames = tides.Frames.of(luminance, times)
    for stored in (np.round(255 * luminance).astype(np.uint8), 255.5 * luminance / luminance.max()):
        with pytest.raises(ValueError, match="full_scale"):
            tides.Frames.of(stored, times)
        assert np.array_equal(tides.Frames.of(stored, times, full_scale=255)[3], stored[3] / 255)
    assert len(frames) == 11 and (frames.width, frames.height) == SIZE and np.array_equal(frames.times, times)
    assert np.array_equal(frames[3], luminance[3])
    np.savez(tmp_path / "a.npz", Y=luminance, t=times)
    assert np.array_equal(tides.Frames(tmp_path / "a.npz")[10], luminance[10])
    (tmp_path / "t.txt").write_text("\n".join(str(1000 * time) for time in times))
    np.save(tmp_path / "b.npy", luminance)
    timed = tides.Frames(tmp_path / "b.npy", timestamps=str(tmp_path / "t.txt"), unit="ms")
    assert np.allclose(timed.times, times)
    with pytest.raises(IndexError):
        frames[11]
    options = tides.FramesOptions(timestamps="a file", transfer="srgb")
    assert options.timestamps == "a file" and options.copy(rebase=1).timestamps == "a file"



@pytest.mark.parametrize("save", (np.savez, np.savez_compressed))
def test_frames_of_zip64(tmp_path, monkeypatch, save):
    """As an archive of more than 4 GiB is written: Python puts sizes into ZIP64's fields above this limit."""
    monkeypatch.setattr(zipfile, "ZIP64_LIMIT", 16)
    monkeypatch.setattr(zipfile, "ZIP_FILECOUNT_LIMIT", 1)
    luminance = np.random.default_rng(64).uniform(0, 1, (3, 4, 5))
    save(tmp_path / "wide.npz", Y=luminance, t=np.arange(3.0))
    bytes_of_file = (tmp_path / "wide.npz").read_bytes()
    member = bytes_of_file.index(b"PK\1\2")
    assert b"PK\6\6" in bytes_of_file and bytes_of_file[member + 20 : member + 28] == b"\xff" * 8
    frames = tides.Frames(tmp_path / "wide.npz")
    assert len(frames) == 3 and np.array_equal(frames[2], luminance[2])


def test_baseline():
    luminance, times = ramp()
    baseline = tides.Baseline(params(), *SIZE)
    parts = [baseline.push(time, plane) for time, plane in zip(times, luminance)]
    pushed = np.concatenate([*parts, baseline.finish()])
    again = tides.Baseline(params(), *SIZE)
    events = again.run(tides.Frames.of(luminance, times))
    assert np.array_equal(pushed, events) and (events["p"] == 1).all() and len(events) > 1000
    assert again.stats.events == len(events)
    assert (events["x"] >= SIZE[0] // 2).sum() > (events["x"] < SIZE[0] // 2).sum()


def test_baseline_of_a_renderer(scene, camera):
    events = tides.Baseline(params(), *SIZE).run(tides.Renderer(scene, camera), 0.0, 0.1, frames_per_second=200)
    assert len(events) > 100


def test_esim_and_ldati():
    made = params()
    made.esim.adaptive_sampling_lambda, made.esim.minimum_framerate = 0.5, 30
    assert tides.esim_next_time(made, 1.0, 100.0) == pytest.approx(1.005)
    voxels = np.zeros((2, 10, 4, 5))
    voxels[0, 3, 1, 2] = 2
    events = tides.ldati(voxels, 0.0, 0.1, seed=1)
    assert set(events["x"]) == {2} and set(events["y"]) == {1} and set(events["p"]) == {1}


def test_ldati_of_exact_voxels(tmp_path):
    """Voxels that share an event between the planes on both sides of it give its time back, to the microsecond."""
    rng, fps, count = np.random.default_rng(5), 100.0, 3
    wanted, voxels = [], np.zeros((count, 2, 10, 4, 5))
    for k in range(count):
        for y in range(4):
            for x in range(5):
                bin, part, polarity = rng.integers(9), rng.uniform(0.01, 0.99), rng.integers(2)
                voxels[k, polarity, bin, y, x], voxels[k, polarity, bin + 1, y, x] = 1 - part, part
                wanted.append(((k + (bin + part) / 9) / fps, y, x, -1 if polarity else 1))
    np.save(tmp_path / "voxels.npy", voxels.astype(np.float64))
    run = tides.Run(text={"method": "ldati", "frames": {"file": "voxels.npy"}, "ldati": {"fps": fps}}, directory=tmp_path)
    events = run.simulate()
    assert len(events) == len(wanted)
    for event, (time, y, x, p) in zip(events, sorted(wanted)):
        assert (event["x"], event["y"], event["p"]) == (x, y, p) and -1.5 <= 1e-3 * event["t"] - 1e6 * time <= 0.1
    with run.open_frames() as frames:
        assert frames.planes == 20 and np.array_equal(frames[1].reshape(2, 10, 4, 5), voxels[1])
    params = tides.BaselineParams(method="ldati")
    params.ldati.fps = fps
    baseline = tides.Baseline(params, 5, 4)
    assert len(baseline.push(0.0, voxels[0])) + len(baseline.finish()) == 20


@pytest.mark.parametrize("key", ["readout.enabled", "sensor.labels"])
def test_what_frames_cannot_have_is_refused(key):
    with pytest.raises(tides.errors.Unsupported, match=f'{key} is true: .* a scene and method "tides"'):
        tides.Run("tests/install/run.json", {"method": "esim", key: True}).simulate()


def test_psf(scene, camera):
    renderer = tides.Renderer(scene, camera)
    sharp = renderer.frame(0.05, ["L"])["L"]
    renderer.set_psf(2.0)
    blurred = renderer.frame(0.05, ["L"])["L"]
    assert np.abs(np.diff(blurred)).sum() < np.abs(np.diff(sharp)).sum()
    with pytest.raises(ValueError, match="domain"):
        renderer.set_psf(2.0, "both")


def test_the_renderer_of_a_run_leaves_the_optics_out():
    run = tides.Run("tests/install/run.json", {"frontend.psf_sigma_px": 1.5})
    sharp = tides.Run("tests/install/run.json").renderer("reference").frame(0.01, ["L"])["L"]
    with run.renderer("reference") as renderer:
        assert np.array_equal(renderer.frame(0.01, ["L"])["L"], sharp)
        renderer.set_psf(1.5)
        assert not np.array_equal(renderer.frame(0.01, ["L"])["L"], sharp)


def test_hot_pixels_fire_on():
    deaf = {"sensor.threshold_on": 50, "sensor.threshold_off": 50}
    hot = {"frontend.hot_pixel_fraction": 0.2, "frontend.hot_pixel_rate_hz": 2000}
    events = tides.Run("tests/install/run.json", {**deaf, **hot}).simulate("reference")
    assert len(events) > 100 and (events["p"] == 1).all()


def test_an_image_tells_its_progress_and_stops(scene, camera):
    renderer, told = tides.Renderer(scene, camera, device="reference"), []
    whole = renderer.frame(0.02, progress=lambda *step: told.append(step))
    assert told and all(0 <= fraction <= 1 and stage == "rendering" for fraction, stage in told)
    for render in (renderer.frame, renderer.truth, renderer.expose):
        with pytest.raises(tides.errors.Cancelled):
            render(0.02, progress=lambda fraction, stage: True)
    assert np.array_equal(renderer.frame(0.02)["L"], whole["L"])


def test_run_of_frames(tmp_path):
    luminance, times = ramp()
    np.savez(tmp_path / "a.npz", Y=luminance, t=times)
    text = {"frames": {"file": "a.npz"}, "method": "esim", "time": {"start": 0, "stop": 0.1}}
    run = tides.Run(text=json.dumps(text), directory=tmp_path)
    assert run.baseline.method == "esim" and len(run.open_frames()) == 11
    events = tides.Baseline(run.baseline, *SIZE).run(run.open_frames(), run.start, run.stop)
    assert np.array_equal(run.simulate(), events)
    with pytest.raises(tides.errors.Unsupported, match="esim"):
        run.simulation()


def test_run_of_a_baseline_on_a_scene():
    run = tides.Run("tests/install/run.json", {"method": "esim", "esim.contrast_threshold_pos": 0.2})
    events = run.simulate("reference")
    by_hand = tides.Baseline(run.baseline, 64, 48).run(run.renderer("reference"), 0.0, run.stop, run.frames_per_second)
    assert len(events) > 10 and np.array_equal(events, by_hand)
    with pytest.raises(tides.errors.Unsupported):
        run.simulation("reference")


def test_frames_say_how_they_were_taken(tmp_path):
    """Whole floats up to 255 are taken for eight bits, and that is said; those up to 1 are silent."""
    np.save(tmp_path / "bytes.npy", np.arange(3 * 6 * 8, dtype=np.float32).reshape(3, 6, 8) + 50)
    assert "255" in tides.Frames(tmp_path / "bytes.npy", frames_per_second=10).note
    np.save(tmp_path / "ones.npy", np.linspace(0, 1, 3 * 6 * 8, dtype=np.float32).reshape(3, 6, 8))
    assert tides.Frames(tmp_path / "ones.npy", frames_per_second=10).note == ""


def test_tides_on_arrays():
    """TIDES's own pixels on frames from memory: straight lines in log luminance, each crossing of which is an event."""
    times, light = np.arange(5) * 1e-3, np.linspace(0.1, 1, 5)
    params = tides.BaselineParams(method="tides", log_eps=0.001)
    frames = tides.Frames.of(light[:, None, None] * np.ones((1, 3, 4)), times)
    events = tides.Baseline(params, 4, 3).run(frames)
    levels = np.log(0.101) + 0.2 * np.arange(1, 12)
    wanted = 1e9 * np.interp(levels, np.log(light + 0.001), times)
    one = events[(events["x"] == 2) & (events["y"] == 1)]
    assert len(events) == 12 * 11 and (one["p"] == 1).all() and np.allclose(one["t"], wanted, atol=2)
