"""Streams for the tests of clients, and files made of them, each made once."""

import os

import numpy as np
import pytest
import random_events
import tides
import worlds

COUNT = 1_000_000
LARGE, SMALL = (1280, 720), (640, 480)

# Longest silence [us] of a stream that is still within a format, and the largest sensor.
FORMATS = {
    "h5": ("hdf5", 2**30, 65536),  # DSEC's 32 bits of time
    "ecf.h5": ("ecf", 2**31, 2048),  # an index entry every 2 ms
    "aedat4": ("aedat4", 2**35, 32768),
    "es": ("es", 2**31, 65535),  # a byte every 127 us
    "raw": ("evt3", 2**35, 2048),
    "evt2.raw": ("evt2", 2**35, 2048),
    "evt21.raw": ("evt21", 2**35, 2048),
    "evt4.raw": ("evt4", 2**35, 2048),
    "dat": ("dat", 2**31, 16384),  # half a turn of its clock
    "csv": ("csv", 2**35, 65536),
    "ns.csv": ("csv-ns", 2**35, 65536),
    "openeb.csv": ("csv-openeb", 2**35, 65536),
    "npy": ("npy", 2**35, 32768),
    "npz": ("npz", 2**35, 8192),  # what is larger is taken for HS-ERGB's
    "txt": ("ecd", 2**35, 65536),
    "e2vid.txt": ("e2vid", 2**35, 65536),
}


def run_events():
    """Of a small run, floored to microseconds."""
    path = os.environ.get("TIDES_TEST_EVENTS")
    if not path:
        pytest.skip("TIDES_TEST_EVENTS names no event file")
    events = tides.read_events(path)
    facts = tides.events_summary(path)
    return random_events.in_order(events["t"] // 1000, events["x"], events["y"], events["p"] > 0), (facts.width, facts.height)


def make(stream):
    """A stream by name, and the size of its sensor; "silence:N" has none longer than N us."""
    kind, _, longest = stream.partition(":")
    if kind == "run":
        return run_events()
    if kind == "silence":
        seed = int(longest).bit_length()
        print(f"{stream}: seed {seed}")
        return random_events.make_stream(seed, COUNT, *LARGE, int(longest)), LARGE
    if kind == "small":
        print(f"{stream}: seed 1")
        return random_events.make_stream(1, COUNT, *SMALL, 2**30), SMALL
    few = {"none": random_events.make_none(), "one": random_events.make_one(*SMALL)}
    few["corners"] = random_events.make_corners(*SMALL)
    few["late"] = random_events.make_corners(*SMALL, start=2**35 + 5)
    return few[kind], SMALL


def records(events):
    return tides.make_events(events["t"] * 1000, events["x"], events["y"], 2 * events["p"] - 1)


class Files:
    def __init__(self, folder):
        self.folder, self.streams = folder, {}

    def stream(self, name):
        if name not in self.streams:
            self.streams[name] = make(name)
        return self.streams[name]

    def file(self, name, ending):
        """The path, the events, the sensor's size."""
        events, size = self.stream(name)
        path = self.folder / f"{name.replace(':', '-')}.{ending}"
        if not path.exists():
            tides.write_events(path, records(events), *size, format=FORMATS[ending][0])
        return str(path), events, size


@pytest.fixture(scope="session")
def files(tmp_path_factory):
    return Files(tmp_path_factory.mktemp("clients"))


@pytest.fixture(scope="session")
def of(tmp_path_factory):
    """Small datasets by name (worlds.py)."""
    folder, made = tmp_path_factory.mktemp("worlds"), {}
    worlds.save_run(folder)

    def get(name):
        if name not in made:
            made[name] = worlds.make(folder, name)
        return made[name]

    return get


def columns(array):
    return [np.asarray(array[name], np.int64) for name in random_events.COLUMNS]
