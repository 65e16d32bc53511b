"""Reading event files that don't tell it themselves: order, units, streams, zero, invalid events. Each file has a form that
other tools write."""

import struct

import numpy as np
import pytest
import tides

RANDOM = np.random.default_rng(7)
N = 500
T = 1000 + np.cumsum(RANDOM.integers(0, 30, N))  # [us]
X, Y, P = RANDOM.integers(0, 346, N), RANDOM.integers(0, 260, N), RANDOM.integers(0, 2, N)
TRUTH = tides.make_events(1000 * T, X, Y, P)


def put(path, columns, head="", separator=",", end="\n"):
    rows = (separator.join(map(str, row)) + end for row in zip(*columns))
    path.write_bytes((head + "".join(rows)).encode())
    return path


def same(events):
    return all(np.array_equal(events[name], TRUTH[name]) for name in ("t", "x", "y", "p"))


SECONDS = [f"{t / 1e6:.6f}" for t in T]
TEXTS = {
    "seconds with commas": dict(columns=(SECONDS, X, Y, P)),
    "t x y p": dict(columns=(T, X, Y, P)),
    "x y p t": dict(columns=(X, Y, P, T)),
    "x y t p, -1 and 1": dict(columns=(X, Y, T, 2 * P - 1)),
    "an index": dict(columns=(range(N), T, X, Y, P)),
    "an index with a header": dict(columns=(range(N), T, X, Y, P), head=",t,x,y,p\n"),
    "microseconds with blanks": dict(columns=(T, X, Y, P), separator=" "),
    "nanoseconds of 1970": dict(columns=(10**18 + 1000 * T, X, Y, P), separator=" "),
    "v2e": dict(columns=(SECONDS, X, Y, P), separator=" ", head="#!events.txt\n# format: time [s], x, y, polarity (0=off)\n"),
    "quotes, capitals, CR": dict(columns=(1000 * T, X, Y, P), head='"Timestamp [ns]","X","Y","Polarity"\r', end="\r"),
    "a header in a comment": dict(columns=(T, X, Y, P), head="#timestamp[us] x y polarity\n", separator=" "),
    "BOM, semicolons, ts": dict(columns=(T, X, Y, P), head="\ufeffts;x;y;pol\r\n", separator=";", end="\r\n"),
    "y before x": dict(columns=(T, Y, X, P), head="timestamp_us,y,x,polarity\n"),
    "seconds named t": dict(columns=(SECONDS, X, Y, P), head="t,x,y,p\n"),
    "exponents": dict(columns=[[f"{v:.18e}" for v in column] for column in (T, X, Y, P)], separator=" "),
    "tabs": dict(columns=(SECONDS, X, Y, P), separator="\t"),
}


@pytest.mark.parametrize("name", TEXTS)
def test_text(tmp_path, name):
    file = put(tmp_path / "events.txt", **TEXTS[name])
    events = tides.read_events(file)
    if "1970" in name:
        events["t"] -= 10**18
    assert same(events)


REFUSED = {
    "that doesn't ascend": (dict(columns=(RANDOM.permutation(10**6)[:N], X, Y, P)), "ascends.*--columns"),
    "decimals that are no seconds": (dict(columns=(T + 0.5, X, Y, P)), "seconds.*events a second.*--unit"),
    "a header without p": (dict(columns=(T, X, Y, P), head="t,x,y,what\n"), "names no column p.*--columns"),
    "two t": (dict(columns=(T, T, X, Y, P), head="t,t,x,y,p\n"), "more than one column t"),
    "no polarity": (dict(columns=(T, X, Y, X)), "--columns"),
    "six columns": (dict(columns=(T, X, Y, P, X, Y)), "event file|columns"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_text_refused(tmp_path, name):
    recipe, pattern = REFUSED[name]
    with pytest.raises(tides.errors.TidesError, match=pattern):
        tides.read_events(put(tmp_path / "events.csv", **recipe))


def test_said(tmp_path):
    """Where nothing in the file decides, somebody does; what they say has to be of use."""
    file = put(tmp_path / "a.csv", (T + 0.5, X, Y, P))
    events = tides.read_events(file, unit="us")
    assert np.array_equal(events["t"], 1000 * T + 500)
    file = put(tmp_path / "b.csv", (Y, X, P, X, T, X))
    assert same(tides.read_events(file, columns="y,x,p,-,t,-", unit="us"))
    with pytest.raises(tides.errors.BadArgument, match="6 columns.*of 4"):
        tides.read_events(file, columns="t,x,y,p")
    with pytest.raises(tides.errors.BadArgument, match="fortnights"):
        tides.read_events(file, columns="y,x,p,-,t,-", unit="fortnights")
    tides.write_events(tmp_path / "c.raw", TRUTH, 346, 260)
    with pytest.raises(tides.errors.BadArgument, match="is evt3.*of no use"):
        tides.read_events(tmp_path / "c.raw", columns="t,x,y,p")
    with tides.EventReader(put(tmp_path / "d.csv", (X, Y, T, P))) as reader:
        assert "x y t p" in reader.facts.read_as


def test_archive_refused(tmp_path):
    """An archive's arrays have names, so that its error doesn't name --columns, which is refused there."""
    np.savez(tmp_path / "a.npz", t=T, x=X, y=Y, what=P)
    with pytest.raises(tides.errors.BadFile, match="names no column p: write them by these names") as refused:
        tides.read_events(tmp_path / "a.npz")
    assert "--columns" not in str(refused.value)
    with pytest.raises(tides.errors.BadArgument, match="leave --columns"):
        tides.read_events(tmp_path / "a.npz", columns="t,x,y,p")


def test_invalid(tmp_path):
    columns = [list(map(str, column)) for column in (SECONDS, X, Y, P)]
    columns[0][7], columns[1][20], columns[3][30] = "nan", "400", "4294967295"
    file = put(tmp_path / "a.txt", columns, separator=" ", head="346 260\n")
    with pytest.raises(tides.errors.BadFile, match='"nan".*--drop-invalid'):
        tides.read_events(file)
    kept = np.delete(TRUTH, [7, 20, 30])
    with tides.EventReader(file, drop_invalid=True) as reader:
        assert np.array_equal(reader.read(N)["t"], kept["t"]) and reader.facts.dropped == 3
    report = tides.convert_events(file, tmp_path / "a.h5", drop_invalid=True)
    assert (report.read, report.written, report.dropped) == (N, N - 3, 3)
    assert tides.events_summary(file, drop_invalid=True).count == N - 3
    plain = put(tmp_path / "b.txt", (SECONDS, X, Y, P), separator=" ")  # the sensor's size is the caller's
    report = tides.convert_events(plain, tmp_path / "b.h5", width=300, height=260, drop_invalid=True)
    assert report.dropped == np.count_nonzero(X >= 300) > 0 and report.written == N - report.dropped


# -- AEDAT 4 ---------------------------------------------------------------------------------------------------------------
def flat(identifier, fields):
    """A flatbuffer of one table: fields are packed scalars, None, or bytes of a vector (count, data)."""
    inline, tail = bytearray(4), bytearray()
    offsets, vectors = [], []
    for field in fields:
        if field is None:
            offsets.append(0)
            continue
        vector = isinstance(field, tuple)
        size = 4 if vector else len(field)
        inline += bytes(-len(inline) % size)
        offsets.append(len(inline))
        if vector:
            vectors.append((len(inline), field))
        inline += bytes(4) if vector else field
    table = 8 + 4 + 2 * len(offsets)
    table += -table % 8
    inline[:4] = struct.pack("<i", table - 8)
    end = table + len(inline)
    for place, (count, data) in vectors:
        start = end + len(tail)
        pad = -(start + 4) % 8
        tail += bytes(pad) + struct.pack("<I", count) + data
        struct.pack_into("<I", inline, place, start + pad - (table + place))
    virtual = struct.pack("<HH", 4 + 2 * len(offsets), len(inline)) + struct.pack(f"<{len(offsets)}H", *offsets)
    body = struct.pack("<I", table) + identifier + virtual
    return body + bytes(table - len(body)) + bytes(inline) + bytes(tail)


def packet(number, payload):
    payload = struct.pack("<I", len(payload)) + payload
    return struct.pack("<iI", number, len(payload)) + payload


def frame(time, pixels, kind=0, at=(0, 0)):
    """The fields of a frame of 4 ms of exposure about `time` [us]; pixels (height x width [x channels]) uint8."""
    times = [struct.pack("<q", time + step) for step in (0, -3000, 3000, -2000, 2000)]
    sizes = [struct.pack("<h", number) for number in (pixels.shape[1], pixels.shape[0], *at)]
    return [*times, struct.pack("<b", kind), *sizes, (pixels.size, pixels.tobytes())]


def aedat4(path, streams):
    """streams: (type, name, events [us], a frame's time, or a list of frames' fields)."""
    xml = "<dv><node name=\"outInfo\">"
    packets = b""
    for number, (kind, name, what) in enumerate(streams):
        xml += (
            f'<node name="{number}"><attr key="typeIdentifier" type="string">{kind}</attr><node name="info"><attr key="sizeX">346'
            f'</attr><attr key="sizeY">260</attr><attr key="source">{name}</attr></node></node>'
        )
        if kind == "EVTS":
            rows = b"".join(struct.pack("<qhhB3x", *row) for row in what)
            payload = flat(b"EVTS", [(len(what), rows)])
            packets += packet(number, payload)
            continue
        for fields in what if isinstance(what, list) else [[struct.pack("<q", what)]]:
            packets += packet(number, flat(b"FRME", fields))
    head = flat(b"IOHE", [struct.pack("<i", 0), struct.pack("<q", -1), (len(xml), xml.encode())])
    path.write_bytes(b"#!AER-DAT4.0\r\n" + struct.pack("<I", len(head)) + head + packets)
    return path


def test_streams_of_a_container(tmp_path):
    """Several streams are listed, and one is chosen: by number, or by its camera."""
    ours = list(zip(T, X, Y, P))
    file = aedat4(tmp_path / "a.aedat4", [("EVTS", "left", ours), ("EVTS", "right", ours[:100])])
    with pytest.raises(tides.errors.TidesError, match=r"2 streams of events, 0 \(left\), 1 \(right\): --stream"):
        tides.read_events(file)
    assert same(tides.read_events(file, stream="0")) and same(tides.read_events(file, stream="left"))
    assert len(tides.read_events(file, stream="right")) == 100
    with pytest.raises(tides.errors.TidesError, match="middle"):
        tides.read_events(file, stream="middle")
    assert same(tides.read_events(aedat4(tmp_path / "b.aedat4", [("EVTS", "one", ours)])))


# -- the zero --------------------------------------------------------------------------------------------------------------
def test_zero(tmp_path):
    """One zero for a recording: its first frame, its start, or its first event; and an offset."""
    ours = list(zip(T, X, Y, P))
    file = aedat4(tmp_path / "a.aedat4", [("EVTS", "davis", ours), ("FRME", "davis", int(T[0]) - 3650)])
    events = tides.read_events(file, rebase=1)
    assert events["t"][0] == 3_650_000 and np.array_equal(np.diff(events["t"]), np.diff(TRUTH["t"]))
    assert tides.read_events(file, rebase=1, offset_ns=-650_000)["t"][0] == 3_000_000
    report = tides.convert_events(file, tmp_path / "a.h5", rebase=1)
    assert report.first_ns == 3_650_000 and report.zero == tides.api.TIDES_ZERO_FRAME
    assert report.zero_ns == 1000 * (int(T[0]) - 3650)
    with tides.EventWriter(tmp_path / "b.h5", 346, 260, start_ns=900_000, stop_ns=10**9) as writer:
        writer.append(tides.events._in_order(TRUTH))
        writer.finish(10**9)
    assert tides.read_events(tmp_path / "b.h5", rebase=1)["t"][0] == TRUTH["t"][0] - 900_000
    with tides.EventReader(tmp_path / "b.h5", rebase=1) as reader:
        assert reader.facts.start_ns == 0 and reader.facts.zero == tides.api.TIDES_ZERO_START
    assert tides.read_events(put(tmp_path / "c.csv", (T, X, Y, P)), rebase=1)["t"][0] == 0


def test_stretch(tmp_path):
    """What misses the recording names its span."""
    epoch = TRUTH.copy()
    epoch["t"] += 1_589_163_150 * 10**9
    tides.write_events(tmp_path / "a.h5", epoch, 346, 260)
    for kept in (dict(start_ns=0, stop_ns=10**9), dict(start_ns=5 * 10**8), dict(start_ns=2 * 10**18)):
        with pytest.raises(tides.errors.BadArgument, match=r"lasts from 1589163150.001.*rebase"):
            tides.convert_events(tmp_path / "a.h5", tmp_path / "b.h5", **kept)
        assert not (tmp_path / "b.h5").exists()
    cut = tides.convert_events(tmp_path / "a.h5", tmp_path / "b.h5", rebase=1, stop_ns=1_000_000)
    assert 0 < cut.written < N
    tides.check_stretch(0, 10, 5, 20)
    with pytest.raises(tides.errors.BadArgument, match="ends at 0.5 s"):
        tides.check_stretch(10**9, 2 * 10**9, -(2**63), 5 * 10**8)


def test_clocks_of_two():
    late = TRUTH.copy()
    late["t"] += 10**12
    with pytest.raises(tides.errors.BadArgument, match="share no time.*--rebase"):
        tides.metrics.compare(TRUTH, late)


# -- HDF5 ------------------------------------------------------------------------------------------------------------------
h5py = pytest.importorskip("h5py")


def h5(path, **datasets):
    with h5py.File(path, "w") as file:
        for name, values in datasets.items():
            file[name.replace("__", "/")] = values
    return path


VARIANTS = {
    "real seconds": dict(events__t=T / 1e6, events__x=X, events__y=Y, events__p=P),
    "other names": dict(cam__timestamp=T, cam__x=X, cam__y=Y, cam__polarity=P),
    "a unit in the name": dict(events__timestamp_ns=1000 * T, events__xs=X, events__ys=Y, events__on=P),
    "a table x y t p": dict(events=np.column_stack((X, Y, T, P))),
    "a table t x y p": dict(events=np.column_stack((T, X, Y, P)).astype("u4")),
    "a table in seconds": dict(a__events=np.column_stack((T / 1e6, X, Y, 2 * P - 1))),
    "v2e with -1 unsigned": dict(events=np.column_stack((T, X, Y, np.where(P, 1, 2**32 - 1))).astype("u4")),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_hdf5(tmp_path, name):
    assert same(tides.read_events(h5(tmp_path / "a.h5", **VARIANTS[name])))


def test_hdf5_streams(tmp_path):
    """Two cameras: neither is read in silence."""
    for left, right in (("prophesee/left", "prophesee/right"), ("a", "b")):
        columns = {f"{left}/{n}".replace("/", "__"): v for n, v in zip("txyp", (T, X, Y, P))}
        columns |= {f"{right}/{n}".replace("/", "__"): v[:100] for n, v in zip("txyp", (T, X, Y, P))}
        file = h5(tmp_path / "a.h5", **columns)
        with pytest.raises(tides.errors.TidesError, match=f"2 streams of events, /{left}, /{right}: --stream"):
            tides.read_events(file)
        assert same(tides.read_events(file, stream=left))
        assert len(tides.read_events(file, stream=right.split("/")[-1])) == 100
        with pytest.raises(tides.errors.TidesError, match="no stream of events"):
            tides.read_events(file, stream="middle")
    table = np.column_stack((X, Y, T / 1e6, 2 * P - 1))
    file = h5(tmp_path / "b.h5", davis__left__events=table[:50], davis__right__events=table)
    assert same(tides.read_events(file, stream="right"))


def test_hdf5_invalid(tmp_path):
    p = P.copy()
    p[40] = 2**32 - 1  # among zeros: no -1
    file = h5(tmp_path / "a.h5", events=np.column_stack((T, X, Y, p)).astype("u4"))
    with pytest.raises(tides.errors.BadFile, match="4294967295.*--drop-invalid"):
        tides.read_events(file)
    assert np.array_equal(tides.read_events(file, drop_invalid=1), tides.events.as_events(np.delete(TRUTH, 40)))
    file = h5(tmp_path / "b.h5", t_offset=5_000_000, events__t=T, events__x=X, events__y=Y, events__p=P)
    assert tides.read_events(file)["t"][0] == 1000 * (T[0] + 5_000_000)
    assert tides.read_events(file, rebase=1)["t"][0] == 1000 * T[0]  # what DSEC's times count from


# -- numpy -----------------------------------------------------------------------------------------------------------------
def structured(names):
    rows = np.empty(N, [(names[0], "<u2"), (names[1], "<u2"), (names[2], "<i2"), (names[3], "<i8")])
    for name, values in zip(names, (X, Y, P, T)):
        rows[name] = values
    return rows


@pytest.mark.parametrize("names", [("x", "y", "p", "t"), ("xs", "ys", "polarity", "timestamp"), ("X", "Y", "pol", "ts_us")])
def test_npy_structured(tmp_path, names):
    np.save(tmp_path / "a.npy", structured(names))
    assert same(tides.read_events(tmp_path / "a.npy"))


@pytest.mark.parametrize("columns", [(T, X, Y, P), (X, Y, T, 2 * P - 1), (X, Y, P, T), (T / 1e6, X, Y, P)])
def test_npy_table(tmp_path, columns):
    np.save(tmp_path / "a.npy", np.column_stack(columns))
    assert same(tides.read_events(tmp_path / "a.npy"))
    np.savez(tmp_path / "a.npz", events=np.column_stack(columns))
    assert same(tides.read_events(tmp_path / "a.npz"))


def test_npz_units(tmp_path):
    """rpg_vid2e has nanoseconds, most others have microseconds under the same names: what no pixel can do decides."""
    random = np.random.default_rng(3)
    n = 200_000  # of 346 x 260 px in a second: 2.2 a pixel
    t, x, y, p = np.sort(random.integers(0, 10**6, n)), *(random.integers(0, m, n) for m in (346, 260, 2))
    np.savez(tmp_path / "us.npz", x=x, y=y, t=t, p=p)
    np.savez(tmp_path / "ns.npz", x=x, y=y, t=1000 * t, p=p)
    np.savez(tmp_path / "s.npz", x=x, y=y, t=t / 1e6, p=p)
    np.savez(tmp_path / "long.npz", x=x, y=y, timestamp=t, polarity=p)
    for name in ("us", "ns", "s", "long"):
        assert np.array_equal(tides.read_events(tmp_path / f"{name}.npz")["t"], 1000 * t), name
    assert np.array_equal(tides.read_events(tmp_path / "us.npz", unit="ms")["t"], 10**6 * t)
    with tides.EventReader(tmp_path / "us.npz") as reader:
        assert "microseconds" in reader.facts.read_as
    assert np.array_equal(tides.read_events(tmp_path / "long.npz")["x"], x)  # no 1/32 px


# -- frames' lists of times --------------------------------------------------------------------------------------------------
LISTS = {
    "an index before": lambda k, t: f"{k} {t:.6f}",
    "names behind": lambda k, t: f"{t:.6f} frame_{k:05d}.png",
    "names before": lambda k, t: f"frame_{k:05d}.png,{t:.6f}",
    "microseconds": lambda k, t: f"{1e6 * t:.0f}",
    "nanoseconds of 1970": lambda k, t: f"{10**18 + int(round(1e9 * t))}",
    "milliseconds": lambda k, t: f"{1e3 * t:.0f}",
    "a header": lambda k, t: ("" if k else "frame,time [ms]\n") + f"{k},{1e3 * t:.3f}",
    "EuRoC": lambda k, t: ("" if k else "#timestamp [ns],filename\n") + f"{1e9 * t:.0f},{1e9 * t:.0f}.png",
    "start and end": lambda k, t: f"{1e6 * t:.0f}, {1e6 * t + 500:.0f}",
}


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("name", LISTS)
def test_times_of_frames(tmp_path, name, end):
    times = 0.04 * np.arange(1, 9)
    np.save(tmp_path / "frames.npy", np.ones((8, 4, 5)))
    text = end.join(LISTS[name](k, t) for k, t in enumerate(times)).replace("\n", end if end != "\r\n" else "\n") + end
    (tmp_path / "t.txt").write_bytes(text.encode())
    frames = tides.Frames(tmp_path / "frames.npy", timestamps=str(tmp_path / "t.txt"))
    found = np.asarray(frames.times) - (1e9 if "1970" in name else 0)
    assert np.allclose(found, times, atol=1e-6 if "1970" in name else 1e-9)
    moved = tides.Frames(tmp_path / "frames.npy", timestamps=str(tmp_path / "t.txt"), rebase=1, offset_s=-0.5)
    assert np.allclose(moved.times, times - times[0] - 0.5, atol=1e-6)


# -- no output is an input ------------------------------------------------------------------------------------------------
def test_outputs_apart(tmp_path):
    events, scene, camera = tmp_path / "e.h5", tmp_path / "s.ply", tmp_path / "c.json"
    tides.write_events(events, tides.make_events([1, 2], [3, 4], [5, 6], [1, 0]), 8, 8)
    link = tmp_path / "link.h5"
    link.symlink_to(events)
    with tides.EventReader(events):
        for name in (events, link):
            with pytest.raises(ValueError, match="is read, and would be replaced"):
                tides.ArrayWriter(name, (1, 8, 8))
            with pytest.raises(ValueError, match="is read, and would be replaced"):
                tides.EventWriter(name, 8, 8)
    tides.write_events(events, tides.make_events([1], [3], [5], [1]), 8, 8)  # nobody reads it any more
    assert len(tides.read_events(events)) == 1
    made = tides.Scene()
    made.add(tides.Gaussians.from_colours([[0, 0, 1]], 0.1, [[1, 0, 0]]))
    made.save(scene)
    made.save(scene)
    read = tides.Scene(scene)
    with pytest.raises(ValueError, match="s.ply is read, and would be replaced"):
        read.save(scene)
    tides.Camera(tides.Trajectory.static([0, 0, 0]), width=8, height=8, fx=8, fy=8).save(camera)
    with pytest.raises(ValueError, match="c.json is read, and would be replaced"):
        tides.Camera.load(camera).save(camera)


# -- what is taken is said --------------------------------------------------------------------------------------------------
def test_units_of_hdf5(tmp_path):
    h5py = pytest.importorskip("h5py")
    file = tmp_path / "e.h5"
    for group, unit, factor, said in (
        ("events", None, 1, "microseconds"),
        ("events", "ns", 1000, ""),
        ("camera/left", "Nanoseconds", 1000, ""),
        ("camera/left", None, 1, "microseconds"),
        ("prophesee/left", None, 1, ""),
        ("", "us", 1, ""),
    ):
        with h5py.File(file, "w") as f:
            for name, values in zip("txyp", (factor * T, X, Y, P)):
                f[f"{group}/{name}"] = values
            if unit:
                f[f"{group}/t"].attrs["units"] = unit
        with tides.EventReader(file) as reader:
            assert np.array_equal(reader.read(N)["t"], 1000 * T)
            assert (said in reader.facts["read_as"]) if said else not reader.facts["read_as"]
    np.savez(tmp_path / "e.npz", t=1000 * T, x=X, y=Y, p=P)
    with tides.EventReader(tmp_path / "e.npz") as reader:
        assert "nanoseconds, as rpg_vid2e has them" in reader.facts["read_as"]


def test_frames_beside_events(tmp_path):
    """Frames of an AEDAT 4 file: times at mid-exposure on the events' clock, grey and colour, and what isn't whole."""
    rng = np.random.default_rng(7)
    grey = [rng.integers(0, 256, (4, 5), dtype=np.uint8) for _ in range(3)]
    start = 1_589_000_000_000_000
    ours = [(start + 100 * k, k % 5, k % 4, k % 2) for k in range(50)]
    parts = [("EVTS", "davis", ours), ("FRME", "davis", [frame(start + 40_000 * k, one) for k, one in enumerate(grey)])]
    file = aedat4(tmp_path / "a.aedat4", parts)
    with tides.Frames(file, rebase=True) as frames:
        assert (frames.width, frames.height, len(frames)) == (5, 4, 3)
        assert np.allclose(frames.times, [0, 0.04, 0.08], atol=1e-6) and "4 ms" in frames.note
        assert all(np.allclose(frames[k], grey[k] / 255, atol=1e-7) for k in range(3))
    with tides.Frames(file) as frames:
        assert abs(frames.times[0] - start / 1e6) < 1e-6
    assert len(tides.read_events(file)) == 50

    colour = rng.integers(0, 256, (4, 5, 3), dtype=np.uint8)
    both = [frame(start, colour, 16), frame(start + 9, np.dstack([colour, colour[..., :1]]), 24)]
    with tides.Frames(aedat4(tmp_path / "c.aedat4", [parts[0], ("FRME", "davis", both)])) as frames:
        luminance = colour.astype(float) @ [0.0722, 0.7152, 0.2126] / 255  # blue, green, red
        assert np.allclose(frames[0], luminance, atol=1e-6) and np.allclose(frames[1], luminance, atol=1e-6)

    whole = file.read_bytes()
    (tmp_path / "cut.aedat4").write_bytes(whole[:-7])
    refused = {
        "ends within a packet": tmp_path / "cut.aedat4",
        "no stream of frames": aedat4(tmp_path / "no.aedat4", parts[:1]),
        "a part of the others": aedat4(tmp_path / "roi.aedat4", [parts[0], ("FRME", "d", [frame(start, grey[0], at=(1, 0))])]),
        "format 5": aedat4(tmp_path / "format.aedat4", [parts[0], ("FRME", "d", [frame(start, grey[0], 5)])]),
        "several streams": aedat4(tmp_path / "two.aedat4", [*parts, parts[1]]),
    }
    for why, path in refused.items():
        with pytest.raises(tides.errors.TidesError, match=why):
            tides.Frames(path)[0]
