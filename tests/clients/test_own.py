"""The streams of the client tests, read by tides itself, and the rules of its writers: times rounded down, collapses counted,
little memory."""

import json
import os
import resource
import subprocess

import numpy as np
import pytest
import tides
from conftest import FORMATS, columns, records
from random_events import COLUMNS, make_stream

TIDES = os.environ["TIDES"]
every_format = pytest.mark.parametrize("ending", FORMATS)


def convert(*arguments, **more):
    done = subprocess.run([TIDES, "convert", "--json", *map(str, arguments)], capture_output=True, text=True, **more)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@every_format
@pytest.mark.parametrize("stream", ["longest", "none", "one", "corners", "run"])
def test_round_trip(files, tmp_path, stream, ending):
    """By the Python package, and by `tides convert` to numpy."""
    name, longest, _ = FORMATS[ending]
    path, events, _ = files.file(f"silence:{longest}" if stream == "longest" else stream, ending)
    wanted = [events[column] for column in COLUMNS]
    said = name if os.path.getsize(path) == 0 else None  # by content, but for text without a line
    with tides.EventReader(path, said) as reader:
        read = np.concatenate([*reader, records(files.stream("none")[0])])
    assert all(np.array_equal(*pair) for pair in zip(wanted, (read["t"] // 1000, read["x"], read["y"], read["p"] > 0)))
    assert not (read["t"] % 1000).any()
    report = convert(path, tmp_path / "back.npy", *(["--from", said] if said else []))
    assert (report["events"], report["disorder"]) == (len(wanted[0]), 0)
    assert all(np.array_equal(*pair) for pair in zip(wanted, columns(np.load(tmp_path / "back.npy"))))


@every_format
def test_times_are_floored_and_collapses_counted(tmp_path, ending):
    seed = 7
    print("seed", seed)
    random = np.random.default_rng(seed)
    stream = make_stream(seed, 100_000, 4, 3, 2**12)  # few pixels: many fire twice in a microsecond
    events = records(stream)
    events["t"] += random.integers(0, 1000, len(events))
    events = events[np.lexsort((events["p"], events["x"], events["y"], events["t"]))]
    tides.write_events(tmp_path / "exact.h5", events, 4, 3)
    name = FORMATS[ending][0]
    tick = next(row.tick_ns for row in tides.event_formats() if row.name == name)
    path = tmp_path / f"floored.{ending}"
    report = convert("--to", name, tmp_path / "exact.h5", path)
    ticks = np.stack([events["t"] // 1000, events["x"], events["y"]])
    collapsed = len(events) - np.unique(ticks, axis=1).shape[1]
    assert collapsed > 1000 and report["collapsed"] == (collapsed if tick == 1000 else 0)
    read = tides.read_events(path)
    assert np.array_equal(read["t"], events["t"] // tick * tick) and (np.diff(read["t"]) >= 0).all()
    assert all(np.array_equal(read[name], events[name]) for name in "xyp")


@pytest.fixture(scope="module")
def long_file(tmp_path_factory):
    """Three million events, 48 MB as records, compressed."""
    path, start = tmp_path_factory.mktemp("long") / "long.h5", 0
    with tides.EventWriter(path, 640, 480) as writer:
        for seed in range(3):
            packet = records(make_stream(seed, 1_000_000, 640, 480, 2**12))
            packet["t"] += start
            writer.append(packet)
            start = packet["t"][-1] + 1000
    return path


@every_format
def test_memory_is_bounded(long_file, tmp_path, ending):
    """Of all that is allocated there is less than the events alone would take."""
    if "asan" in os.environ.get("CONFIG", ""):
        pytest.skip("a sanitiser's memory can't be limited")
    limit = 36 << 20
    out = tmp_path / f"long.{ending}"
    report = convert(
        "--to", FORMATS[ending][0], long_file, out, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))
    )
    assert report["events"] == 3_000_000
