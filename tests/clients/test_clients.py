"""Every format that tides writes, read by other people's clients, event for event. Their known defects are asserted, so that
the test notices when one is mended. Versions: requirements.txt. scripts/client_tests.sh runs this."""

from pathlib import Path

import numpy as np
import pytest
import readers
import tides
from conftest import FORMATS, LARGE, records
from random_events import COLUMNS, make_corners, make_stream

EXAMPLES = Path(__file__).resolve().parents[2] / "python_ctypes" / "examples"

evt2, evt3, dat = (readers.expelliarmus(encoding) for encoding in ("evt2", "evt3", "dat"))

# Who reads what, and the longest silence [us] that it reads too.
CLIENTS = [
    (readers.h5py, "h5", 2**30),
    (readers.evlib, "h5", 2**30),
    (readers.faery, "raw", 2**35),
    (readers.evlib, "raw", 2**35),
    (readers.faery, "evt2.raw", 2**35),
    (readers.evlib, "evt2.raw", 2**31),
    (evt2, "evt2.raw", 2**31),
    (readers.evlib, "evt21.raw", 2**31),
    (readers.faery, "dat", 2**31),
    (dat, "dat", 2**31),
    (readers.faery, "es", 2**31),
    (readers.event_stream, "es", 2**31),
    (readers.faery, "aedat4", 2**35),
    (readers.aedat, "aedat4", 2**35),
    (readers.dv_processing, "aedat4", 2**35),
    (readers.tonic, "aedat4", 2**35),
    (readers.faery, "csv", 2**35),
    (readers.numpy, "npy", 2**35),
    (readers.numpy, "npz", 2**35),
    (readers.text, "txt", 2**30),
    (readers.text, "e2vid.txt", 2**30),
    (readers.csv, "openeb.csv", 2**30),
]
NAMES = [f"{reader.__name__}-{ending}" for reader, ending, _ in CLIENTS]
every_client = pytest.mark.parametrize("reader, ending, longest", CLIENTS, ids=NAMES)

# evlib 0.13.2 looks for columns in a table that has none, expelliarmus 1.1.12 gives None, tonic 1.7.0 joins an empty list.
FAILS_ON_NONE = {"evlib-h5", "expelliarmus-evt2-evt2.raw", "expelliarmus-dat-dat", "tonic-aedat4"}


def check(events, got, names=COLUMNS):
    for name, column in zip(COLUMNS, got):
        if name in names:
            column = np.asarray(column).astype(np.int64)
            assert len(column) == len(events[name]), name
            wrong = np.flatnonzero(column != events[name])
            assert len(wrong) == 0, f"{name} of event {wrong[0]}: {column[wrong[0]]}, not {events[name][wrong[0]]}"


# -- what is read exactly -------------------------------------------------------------------------------------------------
@every_client
def test_a_million_events(files, reader, ending, longest):
    path, events, size = files.file(f"silence:{longest}", ending)
    check(events, reader(path, size))


@every_client
@pytest.mark.parametrize("stream", ["one", "corners", "run"])
def test_few_events(files, stream, reader, ending, longest):
    path, events, size = files.file(stream, ending)
    check(events, reader(path, size))


@pytest.mark.filterwarnings("ignore:loadtxt")
@every_client
def test_no_events(files, reader, ending, longest):
    path, events, size = files.file("none", ending)
    if f"{reader.__name__}-{ending}" in FAILS_ON_NONE:
        with pytest.raises(Exception, match="not found|zero-dimensional|at least one array"):
            reader(path, size)
    else:
        check(events, reader(path, size))


LATE = [row[:2] for row in CLIENTS if row[2] == 2**35]


@pytest.mark.parametrize("reader, ending", LATE, ids=[f"{reader.__name__}-{ending}" for reader, ending in LATE])
def test_a_late_beginning(files, reader, ending):
    path, events, size = files.file("late", ending)
    check(events, reader(path, size))


# The largest sensor [px] of clients that hold less than the format: faery and evlib count in 16 bits, evlib in signed ones.
HOLDS_LESS = {"faery-aedat4": 32767, "faery-csv": 65535, "evlib-h5": 32768}
WITH_A_HEADER = [row for row in CLIENTS if row[0] not in (readers.text, readers.csv)]


@pytest.mark.parametrize("reader, ending, longest", WITH_A_HEADER, ids=[f"{r.__name__}-{e}" for r, e, _ in WITH_A_HEADER])
def test_corners_of_the_largest_sensor(tmp_path, reader, ending, longest):
    format, _, most = FORMATS[ending]
    path, client = str(tmp_path / f"corners.{ending}"), f"{reader.__name__}-{ending}"
    for size in {most, HOLDS_LESS.get(client, most)}:
        events = make_corners(size, size)
        tides.write_events(path, records(events), size, size, format=format)
        if size > HOLDS_LESS.get(client, size):
            with pytest.raises((AssertionError, OverflowError, RuntimeError), match="smaller than|not 65535|out of range"):
                check(events, reader(path, (size, size)))
        else:
            check(events, reader(path, (size, size)))
    with pytest.raises(tides.errors.TidesError):
        tides.write_events(path, records(events), most + 1, most, format=format)


# -- known defects --------------------------------------------------------------------------------------------------------
def test_expelliarmus_counts_evt3_time_twice(files):
    """1.1.12: where the low part falls it adds 4096 us, and again where the high part rises."""
    path, events, size = files.file(f"silence:{2**30}", "raw")
    got = evt3(path, size)
    check(events, got, "xyp")
    wrong = np.asarray(got[0]).astype(np.int64) - events["t"]
    assert wrong.any() and (wrong % 4096 == 0).all()


def test_turns_of_evt2(files):
    """Beyond 2^34 us expelliarmus 1.1.12 begins anew, and evlib 0.13.2 adds a turn with every TIME_HIGH."""
    path, events, size = files.file(f"silence:{2**35}", "evt2.raw")
    t, *rest = evt2(path, size)
    check(events, (np.asarray(t), *rest), "xyp")
    assert np.array_equal(t, events["t"] % 2**34) and events["t"][-1] > 2**34
    t, *rest = readers.evlib(path, size)
    check(events, (t, *rest), "xyp")
    turns, rest = np.divmod(t - events["t"], 2**34)
    assert not rest.any() and turns.max() > 1000


def test_evlib_refuses_large_aedat4(files):
    """0.13.2: coordinates above 1024 are out of its bounds; below, it reads AEDAT4 exactly."""
    path, events, size = files.file("small", "aedat4")
    check(events, readers.evlib(path, size))
    path, events, size = files.file(f"silence:{2**35}", "aedat4")
    with pytest.raises(OSError, match="max_x=1024"):
        readers.evlib(path, size)


def test_evlib_cuts_decimal_seconds_off(files):
    """0.13.2: 0.004095 becomes 4094 us."""
    path, events, size = files.file(f"silence:{2**35}", "txt")
    got = readers.evlib(path, size)
    check(events, got, "xyp")
    assert set(np.unique(got[0] - events["t"])) == {-1, 0}


def test_evlib_decodes_ecf_by_luck(files):
    """0.13.2: its decoder of Prophesee's codec reads some chunks and refuses others, Prophesee's own too."""
    read = 0
    for stream in ("one", "corners", "late", "small", f"silence:{2**31}"):
        path, events, size = files.file(stream, "ecf.h5")
        try:
            got = readers.evlib(path, size)
        except OSError as reason:
            assert "Native ECF decode failed" in str(reason)
        else:
            check(events, got)
            read += 1
    assert 0 < read < 5


def test_faery_ignores_the_size_in_csv(tmp_path):
    """0.7.1: it writes x@WIDTH and y@HEIGHT into a CSV's header, and doesn't read them."""
    faery = readers.import_client("faery")
    path = tmp_path / "large.csv"
    path.write_text("t,x@2000,y@1500,on\n1,1999,1499,1\n")
    with pytest.raises(RuntimeError, match="smaller than width=1280"):
        list(faery.events_stream_from_file(str(path)))


# -- what is done with them -----------------------------------------------------------------------------------------------
def test_tonic_takes_our_arrays(files):
    """Its frames are our event frames; signs survive (its ToVoxelGrid loses those of boolean polarities)."""
    transforms = readers.import_client("tonic").transforms
    path, events, (width, height) = files.file("run", "npy")
    array, ours = np.load(path), records(events)
    assert array.dtype == tides.TONIC and np.array_equal(array, tides.to_tonic(ours))
    frames = transforms.ToFrame(sensor_size=(width, height, 2), event_count=len(array))(array)
    assert frames.shape[0] == 1 and np.array_equal(frames[0], tides.event_frame(ours, width, height))
    grid = transforms.ToVoxelGrid(sensor_size=(width, height, 2), n_time_bins=5)(array)
    assert grid.min() < 0 < grid.max()


def test_training_set_with_tonic(tmp_path, monkeypatch):
    """The example's dataset hands tonic's transforms the very events of the files; PyTorch isn't needed for that."""
    transforms = readers.import_client("tonic").transforms
    monkeypatch.syspath_prepend(EXAMPLES)
    import training_set

    size = (training_set.WIDTH, training_set.HEIGHT)
    to_grid = transforms.ToVoxelGrid(sensor_size=(*size, 2), n_time_bins=training_set.BINS)
    wanted = []
    for seed in (1, 2):
        events = make_stream(seed, 5000, *size, 2**12)
        tides.write_events(tmp_path / f"{seed}.h5", records(events), *size)
        (tmp_path / f"{seed}.json").write_text(f'{{"speed": {seed}}}')
        rows = zip(*(events[name] for name in "xytp"))
        wanted.append(np.array(list(rows), [("x", "<i2"), ("y", "<i2"), ("t", "<i8"), ("p", "i1")]))
    dataset = training_set.Recordings(tmp_path, transform=to_grid)
    assert [speed for _, speed in (dataset[0], dataset[1])] == [1, 2] and len(dataset) == 2
    assert all(np.array_equal(dataset[k][0], to_grid(wanted[k])) and dataset[k][0].any() for k in (0, 1))


def test_largest_streams_use_what_they_should(files):
    """The streams are what they are meant to be: silences over each limit, bursts, corners, repeats."""
    events, (width, height) = files.stream(f"silence:{2**35}")
    gaps = np.diff(events["t"])
    assert {2**12, 2**24 + 1, 2**31 - 1, 2**32 + 1, 2**34 + 1} <= set(gaps[gaps > 4000])
    assert (gaps == 0).sum() > 10000 and (width, height) == LARGE
    assert all((events[name] == most).sum() > 1000 for name, most in (("x", width - 1), ("y", height - 1), ("x", 0)))
    same = np.all([np.diff(events[name]) == 0 for name in "txy"], axis=0)
    assert same.sum() > 100
