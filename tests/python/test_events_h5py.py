"""An event file as other people's tools see it: h5py and numpy, nothing of ours.

    TIDES_TEST_EVENTS="events.h5 more.h5" /usr/bin/python3 -m pytest tests/python/test_events_h5py.py
"""

import json
import os

import pytest

h5py = pytest.importorskip("h5py")
np = pytest.importorskip("numpy")

LAYOUT = {
    "events/p": "u1",
    "events/t": "<u4",
    "events/x": "<u2",
    "events/y": "<u2",
    "events/t_ns": "<i8",
    "ms_to_idx": "<u8",
}


@pytest.fixture(scope="module", params=os.environ.get("TIDES_TEST_EVENTS", "").split())
def file(request):
    with h5py.File(request.param, "r") as opened:
        yield opened


@pytest.fixture(scope="module")
def columns(file):
    return {name.split("/")[-1]: file[name][:] for name in LAYOUT}


def test_types_and_storage(file):
    for name, dtype in LAYOUT.items():
        dataset = file[name]
        assert dataset.dtype == np.dtype(dtype), name
        assert dataset.ndim == 1 and dataset.chunks is not None and dataset.maxshape == (None,), name
        assert dataset.compression == "gzip" and dataset.shuffle, name  # filters that every HDF5 has
    assert file["t_offset"].shape == () and file["t_offset"].dtype == np.dtype("<i8")
    offset, stop = int(file["t_offset"][()]), int(file.attrs["stop_ns"])
    assert offset == 0 or offset < 0 or stop // 1000 >= 2**31  # counted from 0 as long as 32 bits will do


def test_attributes(file, columns):
    attributes = file.attrs
    # of fixed length, which h5py gives as bytes: damage to texts of variable length is what HDF5 can't stand
    assert attributes["format"] == b"tides-events" and attributes["version"] == 1
    assert isinstance(attributes["tides_version"], bytes)
    assert attributes["width"] > 0 and attributes["height"] > 0
    assert attributes["count"] == len(columns["t"])
    assert attributes["stop_ns"] >= (columns["t_ns"][-1] if len(columns["t_ns"]) else 0)
    if "run" in attributes:
        assert isinstance(json.loads(attributes["run"]), dict)
    if "seed" in attributes:
        int(attributes["seed"])


def test_size_where_readers_look(file):
    """RVT's preprocessing asks the group of events, and nothing else, how large the sensor is."""
    height, width = (file["events"][name][()].item() for name in ("height", "width"))
    assert (height, width) == (file.attrs["height"], file.attrs["width"])


def test_values(file, columns):
    count = len(columns["t"])
    assert all(len(columns[name]) == count for name in ("p", "x", "y", "t_ns"))
    assert np.isin(columns["p"], (0, 1)).all()
    assert (columns["x"] < file.attrs["width"]).all() and (columns["y"] < file.attrs["height"]).all()
    offset = int(file["t_offset"][()])
    assert (columns["t_ns"] // 1000 >= offset).all()
    assert np.array_equal(columns["t"].astype(np.int64) + offset, columns["t_ns"] // 1000)  # as DSEC's readers add it


def test_sorted(columns):
    order = np.lexsort((columns["p"], columns["x"], columns["y"], columns["t_ns"]))
    keys = np.stack([columns[name].astype(np.int64) for name in ("t_ns", "y", "x", "p")])
    assert np.array_equal(keys, keys[:, order])


def test_index(file, columns):
    index, t = columns["ms_to_idx"], columns["t"].astype(np.int64)
    starts = 1000 * np.arange(len(index), dtype=np.int64)
    assert np.array_equal(index, np.searchsorted(t, starts, side="left"))
    last_us = t[-1] if len(t) else -1
    assert len(index) >= last_us // 1000 + 2  # the millisecond after the last event has an entry
    length_ns = int(file.attrs["stop_ns"]) - 1000 * int(file["t_offset"][()])
    assert len(index) > -(-length_ns // 1_000_000)  # so has the end of the recording


def test_window_by_index(columns):
    """What DSEC's slicer does: from a window of time to rows by way of ms_to_idx."""
    index, t = columns["ms_to_idx"].astype(np.int64), columns["t"].astype(np.int64)
    random = np.random.default_rng(1)
    for _ in range(100):
        first, last = np.sort(random.integers(0, len(index), 2))
        rows = slice(index[first], index[last])
        assert ((t[rows] >= 1000 * first) & (t[rows] < 1000 * last)).all()
        assert ((t >= 1000 * first) & (t < 1000 * last)).sum() == index[last] - index[first]
