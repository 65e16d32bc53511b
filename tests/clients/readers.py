"""A reader of event files for each client: a function of path and sensor size that returns columns t [us], x, y, p."""

import numpy as np
import pytest


def import_client(name):
    return pytest.importorskip(name, reason=f"{name} has no wheel for this Python: see requirements.txt")


def join(parts, *names):
    """Of a list of structured arrays; a client gives none where the file holds no events."""
    if not parts:
        return tuple(np.zeros((4, 0), np.int64))
    events = np.concatenate(parts)
    return tuple(events[name] for name in names)


def faery(path, size):
    """It doesn't read a CSV's size, and refuses what lies outside the one it is told."""
    client = import_client("faery")
    return join(list(client.events_stream_from_file(path, dimensions_fallback=size)), "t", "x", "y", "on")


def event_stream(path, size):
    """It leaves y as it is stored: counted from below."""
    t, x, y, p = join(list(import_client("event_stream").Decoder(path)), "t", "x", "y", "on")
    return t, x, size[1] - 1 - y.astype(np.int64), p


def aedat(path, size):
    packets = import_client("aedat").Decoder(path)
    return join([packet["events"] for packet in packets if "events" in packet], "t", "x", "y", "on")


def dv_processing(path, size):
    reader = import_client("dv_processing").io.MonoCameraRecording(path)
    assert reader.getEventResolution() == size
    batches = []
    while reader.isRunning() and (batch := reader.getNextEventBatch()) is not None:
        batches.append(batch.numpy())
    return join(batches, "timestamp", "x", "y", "polarity")


def tonic(path, size):
    return join([import_client("tonic").io.read_aedat4(path)], "t", "x", "y", "p")


def expelliarmus(encoding):
    def read(path, size):
        return join([import_client("expelliarmus").Wizard(encoding=encoding).read(path)], "t", "x", "y", "p")

    read.__name__ = f"expelliarmus-{encoding}"
    return read


def evlib(path, size):
    frame = import_client("evlib").load_events(path, sort=False).collect()
    t, x, y, p = (frame[name] for name in ("t", "x", "y", "polarity"))
    return t.dt.total_microseconds().to_numpy(), x.to_numpy(), y.to_numpy(), p.to_numpy() > 0


def h5py(path, size):
    with import_client("h5py").File(path) as file:
        assert (file.attrs["width"], file.attrs["height"]) == size
        t, x, y, p = (file[f"events/{name}"][:] for name in "txyp")
        return t.astype(np.int64) + int(file["t_offset"][()]), x, y, p


def numpy(path, size):
    events = np.load(path)
    return (events["t"], events["x"], events["y"], events["p"]) if path.endswith(".npy") else from_npz(events)


def from_npz(columns):
    return columns["t"] // 1000, columns["x"], columns["y"], columns["p"] > 0


def text(path, size):
    """Times as numpy reads them: doubles, which carry a microsecond up to 285 years."""
    t, x, y, p = np.loadtxt(path, skiprows=int(path.endswith("e2vid.txt")), ndmin=2).reshape(-1, 4).T
    return np.rint(t * 1e6), x, y, p


def csv(path, size):
    """Prophesee's order of columns."""
    x, y, p, t = np.loadtxt(path, delimiter=",", skiprows=1, dtype=np.int64, ndmin=2).reshape(-1, 4).T
    return t, x, y, p
