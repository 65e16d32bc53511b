"""ROS bags read by tides.bag, that the rosbags package wrote: ROS 1's and ROS 2's, their frames, exposures, poses and lens; and
packets of EVT 3.0."""

import numpy as np
import pytest
import readers
import tides

readers.import_client("rosbags.highlevel")
from rosbags import rosbag1, rosbag2  # noqa: E402
from rosbags.typesys import Stores, get_types_from_msg, get_typestore  # noqa: E402
from tides import bag as bags  # noqa: E402

WIDTH, HEIGHT, SECOND = 40, 30, 10**9
ZERO = 1_500_000_000 * SECOND + 123_456_789  # of an ordinary ROS clock
SIZE = "std_msgs/Header header\nuint32 height\nuint32 width\n"
EVENTS = ("uint16 x\nuint16 y\n{time} ts\nbool polarity\n", SIZE + "dvs_msgs/Event[] events\n")
PACKET = SIZE + "uint64 seq\nuint64 time_base\nstring encoding\nbool is_bigendian\nuint8[] events\n"


class Store:
    """Messages of one version of ROS."""

    def __init__(self, version):
        self.version = version
        self.types = get_typestore(Stores.ROS1_NOETIC if version == 1 else Stores.ROS2_HUMBLE)
        time = "time" if version == 1 else "builtin_interfaces/Time"
        self.types.register(get_types_from_msg(EVENTS[0].format(time=time), "dvs_msgs/msg/Event"))
        self.types.register(get_types_from_msg(EVENTS[1], "dvs_msgs/msg/EventArray"))
        self.types.register(get_types_from_msg(PACKET, "event_camera_msgs/msg/EventPacket"))

    def make(self, name, *values, **named):
        return self.types.types[name](*values, **named)

    def stamp(self, ns):
        return self.make("builtin_interfaces/msg/Time", ns // SECOND, ns % SECOND)

    def header(self, ns):
        seq = {"seq": 0} if self.version == 1 else {}
        return self.make("std_msgs/msg/Header", stamp=self.stamp(ns), frame_id="cam", **seq)

    def image(self, ns, values, encoding):
        values = np.ascontiguousarray(values)
        step = values.strides[0]
        return self.make(
            "sensor_msgs/msg/Image", self.header(ns), values.shape[0], values.shape[1], encoding, 0, step, values.view(np.uint8).ravel()
        )

    def lens(self, ns):
        kind, names = "sensor_msgs/msg/CameraInfo", "DKRP" if self.version == 1 else "dkrp"
        region = self.make("sensor_msgs/msg/RegionOfInterest", 0, 0, 0, 0, False)
        k = np.array([50, 0, 19.5, 0, 51, 14.5, 0, 0, 1.0])
        values = dict(zip(names, (np.array([-0.1, 0.02, 0.001, -0.002, 0.0]), k, np.eye(3).ravel(), np.zeros(12))))
        named = {"header": self.header(ns), "height": HEIGHT, "width": WIDTH, "distortion_model": "plumb_bob"}
        return self.make(kind, **named, **values, binning_x=0, binning_y=0, roi=region)

    def pose(self, ns, at):
        point, turn = self.make("geometry_msgs/msg/Point", *at), self.make("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.6, 0.8)
        return self.make("geometry_msgs/msg/PoseStamped", self.header(ns), self.make("geometry_msgs/msg/Pose", point, turn))

    def array(self, events):
        rows = [
            self.make("dvs_msgs/msg/Event", int(x), int(y), self.stamp(int(t)), bool(p > 0))
            for t, x, y, p in zip(events["t"], events["x"], events["y"], events["p"])
        ]
        return self.make("dvs_msgs/msg/EventArray", self.header(int(events["t"][-1])), HEIGHT, WIDTH, rows)


def make_events(count=3000):
    """Over 0.3 s, in order of time alone: ties stand in any order, as a camera's rows do."""
    rng = np.random.default_rng(5)
    t = ZERO + np.sort(rng.integers(0, 300_000, count)) * 1000
    return tides.make_events(t, rng.integers(0, WIDTH, count), rng.integers(0, HEIGHT, count), rng.choice([-1, 1], count))


def wanted(events):
    events = events[np.lexsort((events["p"], events["x"], events["y"], events["t"]))].copy()
    events["t"] -= ZERO // SECOND * SECOND
    return events


FRAMES = [(np.arange(WIDTH * HEIGHT).reshape(HEIGHT, WIDTH) * (k + 1) % 251).astype(np.uint8) for k in range(7)]


def messages(store, events):
    """(topic, type, ns, message), as rpg_dvs_ros sends them, and a picture that is no light."""
    out = []
    for part in np.array_split(events, 9):
        out.append(("/dvs/events", int(part["t"][-1]), store.array(part)))
    for k, frame in enumerate(FRAMES):
        ns = ZERO + k * 50_000_000
        out.append(("/dvs/image_raw", ns, store.image(ns, frame, "mono8")))
        out.append(("/dvs/exposure", ns, store.make("std_msgs/msg/Int32", 4000 + k)))
        out.append(("/dvs/depth", ns, store.image(ns, np.zeros((HEIGHT, WIDTH), "f4"), "32FC1")))
        out.append(("/other/image_raw", ns, store.image(ns, frame, "mono8")))
        out.append(("/dvs/pose", ns, store.pose(ns, (0.1 * k, 1.0, -2.0))))
        out.append(("/dvs/camera_info", ns, store.lens(ns)))
    return sorted(out, key=lambda one: one[1])


def write(path, kind, store, made):
    if kind == "bag":
        writer = rosbag1.Writer(path)
        writer.set_compression(rosbag1.Writer.CompressionFormat.LZ4)
    else:
        storage = rosbag2.StoragePlugin.SQLITE3 if kind == "db3" else rosbag2.StoragePlugin.MCAP
        writer = rosbag2.Writer(path, version=9, storage_plugin=storage)
    with writer:
        connections = {}
        for topic, ns, message in made:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, message.__msgtype__, typestore=store.types)
            code = store.types.serialize_ros1 if kind == "bag" else store.types.serialize_cdr
            writer.write(connections[topic], ns, code(message, message.__msgtype__))


@pytest.mark.parametrize("kind", ["bag", "db3", "mcap"])
def test_whole_recording(tmp_path, kind):
    store, events = Store(1 if kind == "bag" else 2), make_events()
    path, folder = tmp_path / f"recording.{kind}", tmp_path / "folder"
    write(path, kind, store, messages(store, events))
    done = bags.convert(path, folder)
    assert (done.events, done.frames, done.poses) == (len(events), len(FRAMES), len(FRAMES))
    assert done.topics["frames"] == "/dvs/image_raw" and done.zero_ns == ZERO // SECOND * SECOND
    assert np.array_equal(tides.read_events(folder / "events.h5"), wanted(events))
    assert (folder / "clock.txt").read_text() == f"{done.zero_ns}\n"
    times = [line.split() for line in (folder / "images.txt").read_text().splitlines()]
    assert [one[0] for one in times] == [f"0.{123_456_789 + k * 50_000_000:09d}" for k in range(7)]
    exposures = [line.split()[1] for line in (folder / "exposure.txt").read_text().splitlines()]
    assert exposures == [f"{1e-6 * (4000 + k):.6f}" for k in range(7)]
    poses = np.loadtxt(folder / "groundtruth.txt")
    assert np.allclose(poses[:, 1], 0.1 * np.arange(7)) and np.array_equal(poses[:, 4:], np.tile([0, 0, 0.6, 0.8], (7, 1)))
    assert np.array_equal(np.loadtxt(folder / "calib.txt"), [50, 51, 19.5, 14.5, -0.1, 0.02, 0.001, -0.002, 0])
    frames = tides.Frames(folder / "images")
    assert len(frames) == 7 and np.allclose(frames[3], FRAMES[3] / 255) and abs(frames.times[3] - 0.273456789) < 1e-8


@pytest.mark.parametrize("encoding", ["mono16", "rgb8", "bgr8", "bgra8", "16UC1", "8UC1"])
def test_encodings(tmp_path, encoding):
    store, rng = Store(1), np.random.default_rng(1)
    kind, planes = bags._ENCODINGS[encoding]
    values = rng.integers(0, 256 ** int(kind[1]), (HEIGHT, WIDTH, planes)).astype(kind)
    made = [("/dvs/events", ZERO, store.array(make_events(10)))]
    made.append(("/dvs/image_raw", ZERO, store.image(ZERO, values if planes > 1 else values[:, :, 0], encoding)))
    write(tmp_path / "a.bag", "bag", store, made)
    bags.convert(tmp_path / "a.bag", tmp_path / "a")
    frame = tides.Frames(tmp_path / "a" / "images", frames_per_second=1)[0]
    light = values[:, :, [2, 1, 0]] if encoding.startswith("bgr") else values[:, :, :3]
    weights = [0.2126, 0.7152, 0.0722] if planes > 1 else [1]
    assert np.allclose(frame, light @ np.array(weights) / (255 if kind == "u1" else 65535), atol=2e-4)


def test_evt3(tmp_path):
    """Packets go on from one another: the y of one holds in the next, whose vectors TIDES's reader decodes."""
    store, events = Store(2), wanted(make_events())
    tides.write_events(tmp_path / "e.raw", events, WIDTH, HEIGHT)
    data = (tmp_path / "e.raw").read_bytes()
    words = np.frombuffer(data[data.index(b"% end\n") + 6 :], np.uint8)
    made = []
    for number, part in enumerate(np.array_split(words.reshape(-1, 2), 5)):
        ns = ZERO + number * 1000  # when packets came says nothing: the first one's stamp is the first event's
        packet = store.make("event_camera_msgs/msg/EventPacket", store.header(ns), HEIGHT, WIDTH, number, 0, "evt3", False, part.ravel())
        made.append(("/cam/events", ns, packet))
    write(tmp_path / "p.mcap", "mcap", store, made)
    assert bags.convert(tmp_path / "p.mcap", tmp_path / "p").events == len(events)
    got = tides.read_events(tmp_path / "p" / "events.h5")
    first = ZERO - ZERO // SECOND * SECOND
    assert got["t"][0] == first and np.array_equal(got["t"] - first, events["t"] // 1000 * 1000 - events["t"][0] // 1000 * 1000)
    assert np.array_equal(got["x"], events["x"]) and np.array_equal(got["y"], events["y"]) and np.array_equal(got["p"], events["p"])


def test_lens_of_another_camera(tmp_path, capsys):
    """The only CameraInfo is another camera's: its lens is taken where it is named, and else a line tells of it."""
    store, events = Store(1), make_events(20)
    write(tmp_path / "a.bag", "bag", store, [("/dvs/events", ZERO, store.array(events)), ("/rgb/camera_info", ZERO, store.lens(ZERO))])
    assert bags.main([str(tmp_path / "a.bag"), str(tmp_path / "without"), "-q"]) == 0
    assert "/rgb/camera_info isn't beside /dvs/events" in capsys.readouterr().err
    assert not (tmp_path / "without" / "calib.txt").exists()
    done = bags.convert(tmp_path / "a.bag", tmp_path / "with", lens="/rgb/camera_info")
    assert done.notes == [] and (tmp_path / "with" / "calib.txt").exists()


def test_chunks(tmp_path, monkeypatch):
    """Events in many chunks, with messages a little out of order, come out as in one."""
    monkeypatch.setattr(bags, "_CHUNK", 300)
    store, events = Store(1), make_events()
    order = np.argsort(events["t"] + np.random.default_rng(2).integers(0, 4_000_000, len(events)), kind="stable")
    made = [("/dvs/events", ZERO + k, store.array(part)) for k, part in enumerate(np.array_split(events[order], 40))]
    write(tmp_path / "a.bag", "bag", store, made)
    bags.convert(tmp_path / "a.bag", tmp_path / "a")
    assert np.array_equal(tides.read_events(tmp_path / "a" / "events.h5"), wanted(events))


def refuses(capsys, words, *given):
    assert bags.main([str(one) for one in given]) == 1
    assert words in capsys.readouterr().err


def test_wrong_input(tmp_path, capsys):
    store, events = Store(1), make_events(50)
    frame = ("/dvs/image_raw", ZERO, store.image(ZERO, FRAMES[0], "mono8"))
    two = [("/a/events", ZERO, store.array(events)), ("/b/events", ZERO, store.array(events)), frame]
    write(tmp_path / "two.bag", "bag", store, two)
    write(tmp_path / "none.bag", "bag", store, [frame])
    refuses(capsys, "events: the bag has /a/events, /b/events: name one", tmp_path / "two.bag", tmp_path / "out")
    refuses(capsys, "no topic of it has events", tmp_path / "none.bag", tmp_path / "out")
    refuses(capsys, "no such bag", tmp_path / "absent.bag", tmp_path / "out")
    refuses(capsys, "is no such topic", tmp_path / "two.bag", tmp_path / "out", "--events", "/c/events")
    times = [(f"/{name}/exposure", ZERO, store.make("std_msgs/msg/Int32", 4000)) for name in "ab"]
    write(tmp_path / "times.bag", "bag", store, [("/c/events", ZERO, store.array(events)), frame, *times])
    refuses(capsys, "name one of them (--exposure)", tmp_path / "times.bag", tmp_path / "out")
    (tmp_path / "cut.bag").write_bytes((tmp_path / "two.bag").read_bytes()[:3000])
    refuses(capsys, "cut.bag", tmp_path / "cut.bag", tmp_path / "out")
    write(tmp_path / "short", "mcap", Store(2), [("/a/events", ZERO, Store(2).array(events))])
    (chunk,) = (tmp_path / "short").glob("*.mcap")
    chunk.write_bytes(chunk.read_bytes().replace((50).to_bytes(4, "little"), (51).to_bytes(4, "little")))
    refuses(capsys, "/a/events: a message can't be read", tmp_path / "short", tmp_path / "out")
    packet = store.make("event_camera_msgs/msg/EventPacket", store.header(ZERO), HEIGHT, WIDTH, 0, 0, "mono", False, np.zeros(8, np.uint8))
    write(tmp_path / "mono.bag", "bag", store, [("/cam/events", ZERO, packet)])
    refuses(capsys, "encoding 'mono': evt3 is read", tmp_path / "mono.bag", tmp_path / "out")
    assert bags.convert(tmp_path / "times.bag", tmp_path / "times", exposure="/b/exposure").topics["exposure"] == "/b/exposure"
    assert not (tmp_path / "out").exists() and not (tmp_path / "out.part").exists()
    assert bags.main([str(tmp_path / "two.bag"), str(tmp_path / "out"), "--events", "/b/events", "-q"]) == 0
    refuses(capsys, "is there already", tmp_path / "two.bag", tmp_path / "out", "--events", "/b/events")
