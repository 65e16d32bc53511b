"""Every format that tides writes, read by the clients that people have: what is installed is tried, the rest is skipped.

    pip install faery event-stream aedat dv-processing evlib expelliarmus h5py
    TIDES=build/tides TIDES_TEST_EVENTS=events.h5 python -m pytest tests/python/test_event_clients.py

Defects of the clients that are known (versions of 2025) are asserted, so that a mended client is noticed.
"""

import os
import subprocess

import pytest

np = pytest.importorskip("numpy")

ENDINGS = ("csv", "raw", "evt2.raw", "dat", "es", "aedat4", "npy", "npz", "txt", "h5")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """The run's events, floored to microseconds, in every format."""
    source, tides = os.environ.get("TIDES_TEST_EVENTS"), os.environ.get("TIDES")
    if not source or not tides:
        pytest.skip("TIDES_TEST_EVENTS names no event file, or TIDES no tool")
    folder = tmp_path_factory.mktemp("clients")
    floored, ordered = folder / "floored.csv", folder / "ordered.csv"
    subprocess.run([tides, "convert", "-q", source, floored], check=True)
    subprocess.run([tides, "convert", "-q", floored, ordered], check=True)
    for ending in ENDINGS:
        subprocess.run([tides, "convert", "-q", ordered, folder / f"events.{ending}"], check=True)
    return folder


@pytest.fixture(scope="module")
def truth(files):
    return np.loadtxt(files / "events.csv", delimiter=",", skiprows=1, dtype=np.int64).T


def check(truth, *columns):
    for name, wanted, got in zip("txyp", truth, columns):
        assert np.array_equal(wanted, np.asarray(got).astype(np.int64)), name


def test_numpy(files, truth):
    a = np.load(files / "events.npy")
    check(truth, a["t"], a["x"], a["y"], a["p"])
    z = np.load(files / "events.npz")
    check(truth, z["t"] // 1000, z["x"], z["y"], z["p"] > 0)


@pytest.mark.parametrize("ending", ["raw", "evt2.raw", "dat", "es", "aedat4", "csv"])
def test_faery(files, truth, ending):
    faery = pytest.importorskip("faery")
    a = np.concatenate(list(faery.events_stream_from_file(str(files / f"events.{ending}"))))
    check(truth, a["t"], a["x"], a["y"], a["on"])


def test_event_stream(files, truth):
    event_stream = pytest.importorskip("event_stream")
    decoder = event_stream.Decoder(str(files / "events.es"))
    a = np.concatenate(list(decoder))
    check(truth, a["t"], a["x"], decoder.height - 1 - a["y"].astype(int), a["on"])  # it leaves y as it is stored


def test_aedat(files, truth):
    aedat = pytest.importorskip("aedat")
    a = np.concatenate([p["events"] for p in aedat.Decoder(str(files / "events.aedat4")) if "events" in p])
    check(truth, a["t"], a["x"], a["y"], a["on"])


def test_dv_processing(files, truth):
    dv = pytest.importorskip("dv_processing")
    reader = dv.io.MonoCameraRecording(str(files / "events.aedat4"))
    batches = []
    while reader.isRunning():
        batch = reader.getNextEventBatch()
        if batch is None:
            break
        batches.append(batch.numpy())
    a = np.concatenate(batches)
    check(truth, a["timestamp"], a["x"], a["y"], a["polarity"])


@pytest.mark.parametrize("encoding, ending", [("evt2", "evt2.raw"), ("dat", "dat"), ("evt3", "raw")])
def test_expelliarmus(files, truth, encoding, ending):
    expelliarmus = pytest.importorskip("expelliarmus")
    a = expelliarmus.Wizard(encoding=encoding).read(str(files / f"events.{ending}"))
    if encoding == "evt3":  # it adds 4096 us where the time's low part falls, and again where its high part rises
        check(truth[1:], a["x"], a["y"], a["p"])
        assert not np.array_equal(truth[0], a["t"])
    else:
        check(truth, a["t"], a["x"], a["y"], a["p"])


@pytest.mark.parametrize("ending", ["raw", "evt2.raw", "h5", "aedat4", "txt"])
def test_evlib(files, truth, ending):
    evlib = pytest.importorskip("evlib")
    frame = evlib.load_events(str(files / f"events.{ending}"), sort=False).collect()
    t = frame["t"].dt.total_microseconds().to_numpy()
    check(truth[1:], frame["x"].to_numpy(), frame["y"].to_numpy(), frame["polarity"].to_numpy() > 0)
    assert np.abs(t - truth[0]).max() <= (1 if ending == "txt" else 0)  # it cuts decimal seconds off
