"""Event arrays and files, metrics, representations, readout, pictures."""

import struct

import numpy as np
import pytest
import tides
from conftest import SIZE


def some_events(n=2000, seed=3, stop_ns=50_000_000):
    print("seed", seed)
    random = np.random.default_rng(seed)
    t = np.sort(random.integers(0, stop_ns, n))
    events = tides.make_events(t, random.integers(0, SIZE[0], n), random.integers(0, SIZE[1], n), random.integers(0, 2, n))
    return events[np.lexsort((events["p"], events["x"], events["y"], events["t"]))]


# -- arrays ---------------------------------------------------------------------------------------------------------------
def test_record():
    event = tides.make_events([1234567], [3], [5], [0])
    assert event.tobytes() == struct.pack("<qHHbBBB", 1234567, 3, 5, -1, 0, 0, 0)
    assert tides.as_events(event) is event
    assert tides.CAUSES["signal"] == 0 and tides.EVENT.itemsize == 16


def test_other_arrays():
    kind = np.dtype([("x", "i2"), ("y", "i2"), ("t", "i8"), ("p", "?")])
    made = tides.as_events(np.array([(1, 2, 3, True), (4, 5, 6, False)], kind))
    assert made["p"].tolist() == [1, -1] and made["t"].tolist() == [3, 6]
    tonic = tides.to_tonic(tides.make_events([1999, 2000], [1, 2], [3, 4], [1, -1]))
    assert tonic.dtype == tides.TONIC and tonic["t"].tolist() == [1, 2] and tonic["p"].tolist() == [1, 0]
    with pytest.raises(ValueError, match="fields"):
        tides.as_events(np.zeros(3))
    with pytest.raises(ValueError, match="nanoseconds"):
        tides.make_events([0.5], [1], [1], [1])
    with pytest.raises(ValueError, match="x: values outside"):
        tides.make_events([1], [70000], [1], [1])
    with pytest.raises(ValueError, match="four times"):
        tides.make_events([1, 2], [1], [1], [1])
    strided = some_events()[::2]
    assert np.array_equal(tides.as_events(strided), strided) and tides.as_events(strided).flags.c_contiguous


# -- files ----------------------------------------------------------------------------------------------------------------
def test_formats():
    formats = {row.name: row for row in tides.event_formats()}
    assert formats["evt3"].tick_ns == 1000 and formats["evt3"].writes and formats["evt3"].reads
    assert any(not row.writes for row in formats.values())


@pytest.mark.parametrize("name", [row.name for row in tides.event_formats() if row.writes])
def test_every_format_goes_round(name, tmp_path):
    events = some_events()
    tick = next(row.tick_ns for row in tides.event_formats() if row.name == name)
    events["t"] = events["t"] // tick * tick
    events = events[np.lexsort((events["p"], events["x"], events["y"], events["t"]))]
    try:
        tides.write_events(tmp_path / "file", events, *SIZE, format=name)
    except tides.errors.Unsupported as reason:
        pytest.skip(str(reason))  # a plugin of HDF5 that isn't installed
    with tides.EventReader(tmp_path / "file", packet=300) as reader:
        packets = list(reader)
    read = np.concatenate(packets)
    assert max(len(packet) for packet in packets) <= 300
    assert np.array_equal(read["t"] - read["t"][0], events["t"] - events["t"][0])
    assert all(np.array_equal(read[field], events[field]) for field in "xyp")


def test_reader_and_summary(tmp_path):
    events = some_events()
    tides.write_events(tmp_path / "a.h5", events, *SIZE, stop_ns=60_000_000)
    with tides.EventReader(tmp_path / "a.h5") as reader:
        assert (reader.facts.width, reader.facts.height, reader.facts["count"]) == (*SIZE, len(events))
        assert len(reader.read(10)) == 10
    summary = tides.events_summary(tmp_path / "a.h5")
    assert summary["count"] == len(events) and summary.count_on == (events["p"] == 1).sum() and summary.disorder == 0
    assert summary.first_ns == events["t"][0] and summary.last_ns == events["t"][-1]
    assert np.array_equal(tides.read_events(tmp_path / "a.h5", 100, 50), events[100:150])
    assert np.array_equal(tides.read_events(tmp_path / "a.h5", 1900), events[1900:])
    assert len(tides.read_events(tmp_path / "a.h5", 5000)) == 0
    tides.write_events(tmp_path / "a.csv", events, *SIZE)
    assert len(tides.read_events(tmp_path / "a.csv")) == len(events)
    with pytest.raises(tides.errors.BadFile):
        tides.EventReader(__file__)


def test_writer(tmp_path):
    events = some_events()
    with tides.EventWriter(tmp_path / "a.h5", *SIZE, run="{}", seed="1") as writer:
        writer.append(events[:1000])
        writer.flush()
        assert writer.count == 1000
        with pytest.raises(tides.errors.BadArgument):
            writer.append(events[:10])  # before what is there
        writer.append(events[1000:])
    assert writer.closed and np.array_equal(tides.read_events(tmp_path / "a.h5"), events)
    with pytest.raises(ZeroDivisionError):
        with tides.EventWriter(tmp_path / "b.h5", *SIZE) as writer:
            writer.append(events[:1500])
            raise ZeroDivisionError
    assert not (tmp_path / "b.h5").exists() and len(tides.read_events(tmp_path / "b.h5.part")) == 1500
    with tides.EventWriter(tmp_path / "b.h5", *SIZE, resume=1200) as writer:
        writer.append(events[1200:])
    assert np.array_equal(tides.read_events(tmp_path / "b.h5"), events)
    for ending in ("h5", "npy", "csv", "raw"):  # what was read in a foreign file's order is put in order, as convert does
        tides.write_events(tmp_path / f"turned.{ending}", events[::-1], *SIZE)
        tides.write_events(tmp_path / f"straight.{ending}", events, *SIZE)
        turned, straight = (tides.read_events(tmp_path / f"{name}.{ending}") for name in ("turned", "straight"))
        assert np.array_equal(turned, straight)
    with pytest.raises(ValueError, match="events"):
        tides.write_events(tmp_path / "unsorted.h5", [1, 2], *SIZE)
    assert not list(tmp_path.glob("unsorted*"))  # nor a .part
    twice = tides.make_events([10, 20], [1, 1], [1, 1], [1, 1])
    assert tides.write_events(tmp_path / "c.csv", twice, *SIZE) == 1


def test_convert(tmp_path):
    events = some_events()
    tides.write_events(tmp_path / "a.h5", events, *SIZE)
    seen = []
    report = tides.convert_events(
        tmp_path / "a.h5", tmp_path / "b", format="npy", start_ns=10_000_000, progress=lambda *step: seen.append(step)
    )
    kept = events[events["t"] >= 10_000_000]
    assert report.read >= report.written == len(kept) and report["to"] == "npy" and seen
    assert np.load(tmp_path / "b")["t"].tolist() == (kept["t"] // 1000).tolist()
    cut = tides.convert_events(tmp_path / "a.h5", tmp_path / "c.h5", x=8, y=8, cut_width=16, cut_height=16, rebase=1)
    assert (cut.width, cut.height) == (16, 16) and 0 < cut.written < len(events)
    with pytest.raises(TypeError, match="cut_width"):
        tides.convert_events(tmp_path / "a.h5", tmp_path / "c.h5", cut_widht=3)
    with pytest.raises(tides.errors.Cancelled):
        tides.convert_events(tmp_path / "a.h5", tmp_path / "d.h5", progress=lambda *step: True)


# -- measures -------------------------------------------------------------------------------------------------------------
def test_match():
    events = some_events()
    late = events.copy()
    late["t"] += 2000
    report = tides.metrics.match(events, late)
    assert report.matched == len(events) and report.dt_median_us == 2 and report.mismatch_percent == 0
    assert tides.metrics.match(events, events[:0]).missing == len(events)


def test_compare():
    events = some_events()
    seen = []
    same = tides.metrics.compare(events, events, width=SIZE[0], height=SIZE[1], progress=lambda *step: seen.append(step))
    assert same.count_ratio == 1 and same.chamfer_px == 0 and same.victor_purpura == 0 and seen
    assert same.reference.events == len(events) and len(same.reference.intervals) == 3
    half = tides.metrics.compare(events, events[::2], wanted=["counts", "match"])
    assert half.count_ratio == pytest.approx(0.5, abs=0.01) and np.isnan(half.chamfer_px)
    with pytest.raises(ValueError, match="chamfer"):
        tides.metrics.compare(events, events, wanted=["chamfr"])
    with pytest.raises(tides.errors.BadArgument):
        tides.metrics.compare(events[::-1], events)


def test_representations():
    events = some_events()
    grid = tides.voxel_grid(events, *SIZE, style="dsec", normalise="none")
    assert grid.shape == (15, *SIZE[::-1]) and np.isclose(grid.sum(), events["p"].astype(int).sum())
    assert tides.voxel_grid(events, *SIZE).shape[0] == 5
    frame = tides.event_frame(events, *SIZE)
    wanted = np.zeros((2, *SIZE[::-1]))
    np.add.at(wanted, ((events["p"] > 0).astype(int), events["y"], events["x"]), 1)
    assert np.array_equal(frame, wanted)
    surface = tides.time_surface(events, *SIZE, time_ns=25_000_000, decay_s=0.01)
    assert surface.shape == frame.shape and 0 < surface.max() <= 1
    assert tides.VoxelOptions.of("dsec").bins == 15
    with pytest.raises(tides.errors.BadArgument):
        tides.event_frame(events, 4, 4)


def test_readout():
    events = some_events(stop_ns=500_000)
    free = tides.Arbiter(tides.Readout(tick_s=0.0, eta=0.0, gamma_sigma_s=0.0), *SIZE)
    parts = [free.push(events[:700]), free.push(events[700:]), free.finish()]
    assert np.array_equal(np.concatenate([part[0] for part in parts]), events)
    busy = tides.Arbiter(tides.Readout(kind="bottleneck", tick_s=1e-6, k0=1, eta=0.5, jitter_law="delay"), *SIZE, seed=5)
    assert busy.tiles == (3, 3)
    busy.set_activity(np.full((3, 3), 0.5))
    (out, fired), (rest, late) = busy.push(events), busy.finish()
    left, when = np.concatenate([out, rest]), np.concatenate([fired, late])
    assert (left["t"] >= when).all() and (left["t"] > when).any() and (np.diff(left["t"]) >= 0).all()
    stats = busy.stats
    assert stats["in"] == len(events) and stats.out == len(left) and stats.dropped == len(events) - len(left) > 0
    early = tides.Arbiter(tides.Readout(tick_s=0.0, eta=0.0, sigma0_s=1e-5), *SIZE, start=int(events["t"][0]))
    (out, fired), (rest, late) = early.push(events), early.finish()
    left, when = np.concatenate([out, rest]), np.concatenate([fired, late])
    assert len(left) == len(events) and (left["t"] < when).any() and left["t"].min() >= events["t"][0]
    with pytest.raises(ValueError, match="psi"):
        busy.set_activity(np.zeros(3))


def test_exr(tmp_path):
    planes = {"L_dot": np.random.default_rng(2).normal(size=(5, 7)).astype(np.float32), "Y": np.ones((5, 7), np.float32)}
    for compression in ("none", "zips", "zip"):
        tides.image.write_exr(tmp_path / "a.exr", planes, compression, {"made by": "a test"})
        read = tides.image.read_exr(tmp_path / "a.exr")
        assert set(read) == set(planes) and all(np.array_equal(read[name], planes[name]) for name in planes)
    with pytest.raises(ValueError, match="shape"):
        tides.image.write_exr(tmp_path / "a.exr", {"a": np.ones((2, 3)), "b": np.ones((3, 2))})


def test_pictures(tmp_path):
    ramp = np.tile(np.linspace(-1, 1, SIZE[0]), (SIZE[1], 1))
    grey = tides.image.picture_grey(ramp)
    assert grey.shape == (*SIZE[::-1], 3) and grey[0, 0].tolist() == [0, 0, 0] and grey[0, -1].tolist() == [255] * 3
    signed = tides.image.picture_signed(ramp, 1.0)
    assert signed[0, 0, 2] > signed[0, 0, 0] and signed[0, -1, 0] > signed[0, -1, 2]
    assert tides.image.picture_rgb(ramp, ramp * 0, ramp * 0)[0, -1].tolist() == [255, 0, 0]
    flat = np.ones((64, 96))
    assert tides.image.picture_flow(ramp, ramp * 0)[0, [0, -1]].tolist() == [[0, 255, 255], [255, 0, 0]]
    for draw in (lambda key: tides.image.picture_flow(flat, flat, key=key), lambda key: tides.image.picture_depth(flat, key=key)):
        changed = (draw(True) != draw(False)).any(axis=2)
        assert changed[48:, 32:].any() and not changed[:48].any()
    assert tides.image.picture_depth(ramp)[0, 0].tolist() == [0, 0, 0] and tides.image.picture_depth(ramp)[0, -1, 0] < 60
    assert tides.image.picture_labels(ramp * 0 - 1).max() == 0
    on = tides.make_events([1], [4], [6], [1])
    shown = tides.image.picture_events(on, *SIZE, base=ramp * 0)
    assert shown[6, 4, 0] > shown[6, 4, 2] and len(set(shown[0, 0])) == 1
    with pytest.raises(ValueError, match="outside"):
        tides.image.picture_events(on, 4, 4)
    before = grey.copy()
    tides.image.picture_text(grey, 1, 1, "t", colour=(255, 0, 0))
    assert (grey != before).any()
    tides.image.write_png(tmp_path / "a.png", grey)
    assert (tmp_path / "a.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n"
    with pytest.raises(ValueError, match="uint8"):
        tides.image.write_png(tmp_path / "a.png", ramp)


def test_animation(tmp_path):
    picture = np.zeros((*SIZE[::-1], 3), np.uint8)
    with tides.image.Animation(tmp_path / "a.y4m", *SIZE, pictures_per_second=10) as animation:
        for level in (0, 100, 200):
            animation.append(picture + np.uint8(level))
    made = (tmp_path / "a.y4m").read_bytes()
    assert made.startswith(b"YUV4MPEG2") and made.count(b"FRAME") == 3
    with open(tmp_path / "stream.y4m", "wb") as pipe:
        with tides.image.Animation(pipe.fileno(), *SIZE, pictures_per_second=10) as animation:
            for level in (0, 100, 200):
                animation.append(picture + np.uint8(level))
    assert (tmp_path / "stream.y4m").read_bytes() == made
    with pytest.raises(ValueError, match="rgb"):
        with tides.image.Animation(tmp_path / "b.png", *SIZE) as animation:
            animation.append(picture[1:])
    assert not (tmp_path / "b.png").exists()


def test_array_writer(tmp_path):
    events = some_events()
    grids = [tides.voxel_grid(part, *SIZE) for part in (events[:1000], events[1000:])]
    for ending in ("npy", "npz"):
        with tides.ArrayWriter(tmp_path / f"a.{ending}", grids[0].shape, name="voxels") as writer:
            for index, grid in enumerate(grids):
                writer.append(grid, 25_000_000 * index, 25_000_000 * (index + 1), 1000)
        read = np.load(tmp_path / f"a.{ending}")
        assert np.array_equal(read if ending == "npy" else read["voxels"], np.array(grids, np.float32))
    with tides.ArrayWriter(tmp_path / "a.exr", (2, *SIZE[::-1]), plane_names=["OFF", "ON"]) as writer:
        writer.append(tides.event_frame(events, *SIZE), 0, 50_000_000, len(events))
    assert np.array_equal(tides.image.read_exr(tmp_path / "a.exr")["ON"], tides.event_frame(events, *SIZE)[1])
    with pytest.raises(ValueError, match="plane_names"):
        tides.ArrayWriter(tmp_path / "b.exr", (2, *SIZE[::-1]), plane_names=["one"])
    with pytest.raises(ValueError, match="values"):
        with tides.ArrayWriter(tmp_path / "c.npy", grids[0].shape) as writer:
            writer.append(grids[0][1:], 0, 1, 0)
    assert not (tmp_path / "c.npy").exists()


def test_causes_are_kept(tmp_path):
    events = some_events()
    events["cause"][::3] = tides.CAUSES["shot"]
    tides.write_events(tmp_path / "a.h5", events, *SIZE)
    assert np.array_equal(tides.read_events(tmp_path / "a.h5"), events)
    assert np.array_equal(tides.read_events(tmp_path / "a.h5", 500, 100), events[500:600])


def test_labels_are_kept(tmp_path):
    events = some_events()
    events["frontend"] = np.linspace(-2, 2, len(events))
    fired = events["t"] - np.arange(len(events))
    assert tides.EVENT["frontend"] == np.float16
    assert [tides.lib.tides_event_frontend(tides.events._records(events[i:])) for i in range(99)] == events["frontend"][:99].tolist()
    with tides.EventWriter(tmp_path / "a.h5", *SIZE, labels=True) as writer:
        writer.append(events[:900], fired[:900])
        writer.flush()
        writer.append(events[900:], fired[900:])
        with pytest.raises(ValueError, match="fired"):
            writer.append(events[-1:], [1, 2])
    read, when = tides.read_labelled(tmp_path / "a.h5")
    assert np.array_equal(read, events) and np.array_equal(when, fired)
    assert tides.events_summary(tmp_path / "a.h5").labels == sum(tides.LABELS.values())
    with tides.EventReader(tmp_path / "a.h5") as reader:
        assert reader.facts.labels == sum(tides.LABELS.values())
    tides.write_events(tmp_path / "b.h5", events, *SIZE)
    assert np.array_equal(tides.read_labelled(tmp_path / "b.h5")[1], events["t"])
    with pytest.raises(tides.errors.Unsupported, match="no place for labels"):
        tides.EventWriter(tmp_path / "a.raw", *SIZE, labels=True)


def test_the_table_of_metrics():
    rows = {row.name: row for row in tides.metrics.table()}
    assert rows["chamfer_px"].family == "chamfer" and rows["chamfer_px"].unit == "px" and rows["chamfer_px"].better == "lower"
    assert rows["count_ratio"].better == "one" and rows["same_ts"].of_stream and not rows["matched"].of_stream


def test_filters(tmp_path):
    """Arrays and files go through the same filters; what a camera drops is told by filter."""
    events = some_events(4000)
    assert np.array_equal(tides.filter(events), events)
    one = tides.Filter(tides.Filters(trail="trail", trail_s=0.001), *SIZE)
    parts = np.concatenate([one(events[:1500]), one(events[1500:])])
    passed = tides.filter(events, trail="trail", trail_s=0.001, size=SIZE)
    assert 0 < len(passed) < len(events) and np.array_equal(parts, passed)
    assert one.stats["in"] == len(events) and one.stats.dropped.trail == len(events) - len(passed)
    tides.write_events(tmp_path / "all.h5", events, *SIZE)
    filters = tides.Filters(trail="trail", trail_s=0.001)
    assert filters.any and not tides.Filters().any
    report = tides.convert_events(tmp_path / "all.h5", tmp_path / "passed.h5", filters=filters)
    assert report.written == len(passed) and report.filtered[3] == len(events) - len(passed)
    assert np.array_equal(tides.read_events(tmp_path / "passed.h5"), passed)
    with pytest.raises(ValueError, match="trail"):
        tides.filter(events, trail="stc")
    with pytest.raises(tides.TidesError, match="afk_start"):
        tides.filter(events, afk="band_stop", afk_start=3)


def test_blemishes_of_a_recording():
    rng = np.random.default_rng(3)
    t = np.sort(rng.integers(0, 200_000_000, 8000))
    burst = np.sort(rng.integers(100_000_000, 101_000_000, 2000))
    times = np.concatenate([t, burst])
    x, y = rng.integers(0, 40, len(times)), rng.integers(0, 30, len(times))
    x[:1000:2], y[:1000:2] = 20, 15  # a hot pixel
    order = np.argsort(times, kind="stable")
    events = tides.make_events(times[order], x[order], y[order], np.where(np.arange(len(times)) % 2, 1, -1))
    found = tides.metrics.Blemishes(events, 40, 30)
    assert found.bursts.shape == (1, 2) and found.bursts[0, 0] <= 100_000_000 and found.bursts[0, 1] >= 101_000_000
    assert found.hot.tolist() == [[20, 15]] and 480 < found.hot_events < 530 and found.burst_events >= 2000
    kept = found.leave_out(events)
    assert len(kept) == len(events) - found.hot_events - found.burst_events
    assert not ((kept["x"] == 20) & (kept["y"] == 15)).any() and len(events) == len(times)
    assert len(found.leave_out(kept)) == len(kept)
    none = tides.metrics.Blemishes(events[:0], 40, 30)
    assert none.bursts.shape == (0, 2) and len(none.leave_out(events)) == len(events)
    with pytest.raises(ValueError):
        tides.metrics.Blemishes(events[::-1], 40, 30)
