"""ROS 2's topics without ROS: bytes as rosbags makes them from the published definitions. A second process receives a run on
the loopback interface alone, and flies one."""

import json
import subprocess
import sys
import time
import warnings

import numpy as np
import pytest
import tides

pytest.importorskip("cyclonedds", reason="pip install tides[ros2]")
typesys = pytest.importorskip("rosbags.typesys")
import tides.ros2  # noqa: E402
from tides import ros2_messages as messages  # noqa: E402
from tides.rosbag import _decode_evt3  # noqa: E402

DOMAIN = 77
PACKET = (
    "std_msgs/Header header\nuint32 height\nuint32 width\nuint64 seq\nuint64 time_base\nstring encoding\nbool is_bigendian\n"
    "uint8[] events\n"
)


@pytest.fixture(scope="module")
def store():
    made = typesys.get_typestore(typesys.Stores.ROS2_JAZZY)
    made.register(typesys.get_types_from_msg(PACKET, "event_camera_msgs/msg/EventPacket"))
    return made


def some(kind, random):
    """A message of random values, by the annotations of its class."""

    def value(one):
        text = str(one)
        if isinstance(one, type) and issubclass(one, messages.IdlStruct):
            return some(one, random)
        if one is str:
            return "".join(chr(c) for c in random.integers(97, 123, random.integers(0, 9)))
        if one is bool:
            return bool(random.integers(2))
        if "sequence" in text and "uint8" in text:
            return random.bytes(random.integers(0, 30))
        if "sequence" in text:
            return [float(n) for n in random.normal(size=random.integers(0, 7))]
        if "array" in text:
            return [float(n) for n in random.normal(size=12 if "12" in text else 9)]
        if "float64" in text:
            return float(random.normal())
        return int(random.integers(0, 200 if "uint8" in text else 2**31))

    return kind(*(value(one) for one in kind.__annotations__.values()))


def plain(one):
    """A message of either package as dicts, lists and numbers."""
    if isinstance(one, (bytes, bytearray)):
        return list(one)
    if isinstance(one, (np.ndarray, list, tuple)):
        return [plain(part) for part in one]
    if hasattr(one, "__dataclass_fields__"):
        return {name: plain(getattr(one, name)) for name in one.__dataclass_fields__ if not name.startswith("_")}
    return one.item() if isinstance(one, np.generic) else one


KINDS = {
    "event_camera_msgs/msg/EventPacket": messages.EventPacket, "sensor_msgs/msg/Image": messages.Image,
    "sensor_msgs/msg/CameraInfo": messages.CameraInfo, "sensor_msgs/msg/Imu": messages.Imu, "rosgraph_msgs/msg/Clock": messages.Clock,
    "geometry_msgs/msg/PoseStamped": messages.PoseStamped, "geometry_msgs/msg/TwistStamped": messages.TwistStamped,
}  # fmt: skip


@pytest.mark.parametrize("name", KINDS)
def test_bytes_are_those_of_rosbags(store, name):
    """Both ways; strings and sequences of all lengths, so that every padding occurs."""
    random, kind = np.random.default_rng(len(name)), KINDS[name]
    package, _, short = name.split("/")
    assert kind.__idl_typename__.replace(".", "::") == f"{package}::msg::dds_::{short}_"
    for _ in range(60):
        message = some(kind, random)
        ours = message.serialize(use_version_2=False)
        theirs = store.deserialize_cdr(ours, name)
        made = plain(message)
        got = plain(theirs)
        got.pop("__msgtype__", None)

        def same(a, b):
            if isinstance(a, dict):
                return all(same(a[key], b[key]) for key in a)
            if isinstance(a, list):
                return len(a) == len(b) and all(map(same, a, b))
            return a == b

        assert same(made, got)
        wanted = bytes(store.serialize_cdr(theirs, name))
        assert ours == wanted[: len(ours)] and len(wanted) - len(ours) in range(4) and not any(wanted[len(ours) :])
        assert plain(kind.deserialize(wanted)) == made


def decoded(words):
    """EVT 3 word by word, as a driver's decoder goes: columns t [us] within 2^24, x, y, p."""
    high = low = y = 0
    rows = []
    for word in np.frombuffer(words, "<u2").tolist():
        kind, value = word >> 12, word & 0xFFF
        if kind == 8:
            high = value
        elif kind == 6:
            low = value
        elif kind == 0:
            y = value & 0x7FF
        elif kind == 2:
            rows.append(((high << 12) + low, value & 0x7FF, y, value >> 11))
        else:
            raise AssertionError(hex(word))
    return np.array(rows, np.int64).reshape(-1, 4)


def test_latency_and_rate(tmp_path):
    """The rows that `tides bench live` puts in its table: sorted latencies of all packets that came, at each rate."""
    command = [sys.executable, "-m", "tides.ros2_bench", "--packets", "20", "--json", str(tmp_path / "rows.json")]
    subprocess.run(command, check=True, timeout=240)
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert [row["rate"] for row in rows] == [1e5, 1e6, 5e6]
    for row in rows:
        assert row["packets"] == 20 and row["events"] == pytest.approx(20e-3 * row["rate"]) and row["seconds"] >= 19e-3
        assert row["lost"] == 0 and len(row["ms"]) == 20 and row["ms"] == sorted(row["ms"])
        assert 0 < row["ms"][0] < 5000 and row["first_ms"] in row["ms"] and 2 < row["bytes_per_event"] < 12


@pytest.mark.parametrize("n, span", [(0, 1), (1, 1), (2000, 10), (2000, 10**6), (2000, 10**8), (300, 10**9)])
def test_evt3(n, span):
    random = np.random.default_rng(n + span)
    t = np.sort(random.integers(0, span * 1000, n)) + 1_700_000_000 * 10**9
    x, y, p = random.integers(0, 2048, n), random.integers(0, 2048, n), random.choice([-1, 1], n)
    words = messages.evt3(t, x.astype("u2"), y.astype("u2"), p.astype("i1"))
    rows = decoded(words)
    assert np.array_equal(rows[:, 0], t // 1000 % 2**24) and np.array_equal(rows[:, 1:3], np.stack([x, y], 1))
    assert np.array_equal(rows[:, 3], p > 0)
    if n and span < 10**7:  # TIDES' own reader of bags, which unfolds the clock
        events = _decode_evt3(np.frombuffer(words, "<u2"), int(t[0]) // 1000)
        assert np.array_equal(events["t"], t // 1000 * 1000) and np.array_equal(events["x"], x)
    with pytest.raises(ValueError, match="11 bits"):
        messages.evt3(np.zeros(1, int), np.array([2048]), np.array([0]), np.array([1]))


def test_lenses(store):
    lens = tides.Intrinsics(width=64, height=48, fx=50, fy=51, cx=32, cy=24.5)
    for bent, model, numbers in [
        (tides.Lens(), "plumb_bob", []),
        (tides.Lens(model="radtan", k1=1, k2=2, k3=3, p1=4, p2=5), "plumb_bob", [1, 2, 4, 5, 3]),
        (tides.Lens(model="equidistant", k1=1, k2=2, k3=3, k4=4), "equidistant", [1, 2, 3, 4]),
    ]:
        info = messages.camera_info(messages.header(5, "a"), lens.copy(lens=bent))
        assert (info.distortion_model, list(info.d)) == (model, numbers)
        assert info.k == [50, 0, 31.5, 0, 51, 24, 0, 0, 1] and info.p[:4] == [50, 0, 31.5, 0]
    for wrong in (-1, 2**31 * 10**9):
        with pytest.raises(ValueError, match="ROS' clock"):
            messages.stamp(wrong)


# -- a second process ---------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def room(tmp_path_factory):
    folder, random = tmp_path_factory.mktemp("room"), np.random.default_rng(8)
    scene = tides.Scene()
    scene.add(tides.Gaussians.from_colours(random.normal(size=(200, 3)), 0.1, random.uniform(0, 1, (200, 3))), name="cloud")
    scene.save(folder / "room.h5")
    path = tides.Trajectory.orbit(radius=4, angular_speed=2, start=0, stop=0.3)
    tides.Camera(path, tides.Intrinsics.from_fov(64, 48, 0.8)).save(folder / "path.json")
    run = {
        "scene": {"file": "room.h5", "metres_per_unit": 0.5}, "camera": {"file": "path.json"}, "time": {"start": 0.02, "stop": 0.22},
        "stepping": {"step_s": 0.01}, "imu": {"down": [0, 1, 0]},
    }  # fmt: skip
    (folder / "run.json").write_text(json.dumps(run))
    return folder / "run.json"


#: Hears all topics of a run, and prints what it heard as JSON when nothing came for a while.
LISTENER = """
import json, sys, time
import tides.ros2
from tides import ros2_messages as messages
bus = tides.ros2.Bus(int(sys.argv[1]), loopback=True)
kinds = {"events": messages.EventPacket, "image_raw": messages.Image, "camera_info": messages.CameraInfo, "imu": messages.Imu}
readers = {name: bus.reader("event_camera/" + name, kind, 2000) for name, kind in kinds.items()}
readers["clock"] = bus.reader("clock", messages.Clock, 2000)
heard, last = {name: [] for name in readers}, time.monotonic() + 60
while time.monotonic() < last:
    for name, reader in readers.items():
        for message in reader.take(100):
            if hasattr(message, "serialize"):  # else it says that its writer has gone
                heard[name].append(message.serialize(use_version_2=False).hex())
                last = time.monotonic() + 3
    time.sleep(0.002)
print(json.dumps(heard))
"""


def nanoseconds(stamp):
    return stamp.sec * 10**9 + stamp.nanosec


def unfolded(packets):
    """Columns t [ns], x, y, p of packets in their order."""
    rows = [_decode_evt3(np.frombuffer(bytes(one.events), "<u2"), nanoseconds(one.header.stamp) // 1000) for one in packets]
    return np.concatenate(rows)


def test_a_second_process_hears_the_run(room, store):
    listener = subprocess.Popen([sys.executable, "-c", LISTENER, str(DOMAIN)], stdout=subprocess.PIPE, text=True)
    command = [sys.executable, "-m", "tides.ros2", str(room), "--loopback", "--domain", str(DOMAIN), "--images", "50", "--wait", "30"]
    try:
        done = subprocess.run([*command, "--speed", "0.5", "--period", "0.02"], capture_output=True, text=True, timeout=120)
        heard, _ = listener.communicate(timeout=120)
    finally:
        listener.kill()
    assert done.returncode == 0, done.stderr
    heard = json.loads(heard)
    types = {"events": "event_camera_msgs/msg/EventPacket", "image_raw": "sensor_msgs/msg/Image", "imu": "sensor_msgs/msg/Imu",
             "camera_info": "sensor_msgs/msg/CameraInfo", "clock": "rosgraph_msgs/msg/Clock"}  # fmt: skip
    got = {name: [store.deserialize_cdr(bytes.fromhex(one), types[name]) for one in rows] for name, rows in heard.items()}
    session = tides.Session(room)
    wanted, events = session.simulate(), unfolded(got["events"])
    assert len(wanted) > 500 and done.stdout == f"{len(wanted)} events\n"
    assert np.array_equal(events["t"], wanted["t"] // 1000 * 1000) and np.array_equal(events["p"], wanted["p"] > 0)
    assert np.array_equal(events["x"], wanted["x"]) and np.array_equal(events["y"], wanted["y"])
    assert [one.seq for one in got["events"]] == list(range(len(got["events"])))
    assert [nanoseconds(one.clock) for one in got["clock"]] == [20_000_000 * k for k in range(2, 12)]
    renderer = session.renderer()
    assert len(got["image_raw"]) == len(got["camera_info"]) == 11
    for image, info in zip(got["image_raw"], got["camera_info"]):
        frame = renderer.frame(nanoseconds(image.header.stamp) / 1e9, "RGB")
        assert (image.width, image.height, image.step, image.encoding) == (64, 48, 192, "rgb8")
        assert np.array_equal(np.reshape(image.data, (48, 64, 3)), tides.image.picture_rgb(frame["R"], frame["G"], frame["B"]))
        assert image.header.stamp == info.header.stamp and info.k[2] == 31.5 and image.header.frame_id == "event_camera"
    samples = session.camera.trajectory.imu(session.values.imu.copy(metres_per_unit=0.5), 0.02, 0.22)
    assert len(got["imu"]) == len(samples) > 30
    for message, sample in zip(got["imu"], samples):
        assert nanoseconds(message.header.stamp) == round(1e9 * sample["time"]) and message.orientation_covariance[0] == -1
        w, a = message.angular_velocity, message.linear_acceleration
        assert [w.x, w.y, w.z] == list(sample["angular_rate"]) and [a.x, a.y, a.z] == list(sample["specific_force"])


@pytest.mark.parametrize("twists, axes", [(True, "opencv"), (False, "robot")])
def test_a_second_process_flies_the_camera(room, twists, axes):
    """Its stamps are another clock's; a twist may come after its pose; the events are those of a Live that is told the same."""
    bus, began = tides.ros2.Bus(DOMAIN + 1, loopback=True), 1_700_000_000 * 10**9 + 123
    pose_writer = bus.writer("event_camera/pose", messages.PoseStamped)
    twist_writer = bus.writer("event_camera/twist", messages.TwistStamped)
    reader = bus.reader("event_camera/events", messages.EventPacket, 2000)
    command = [sys.executable, "-m", "tides.ros2", str(room), "--poses", "--axes", axes, "--loopback", "--domain", str(DOMAIN + 1),
               "--silence", "5", *(["--twists"] if twists else [])]  # fmt: skip
    flown = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    try:
        assert flown.stdout.readline() == "waiting for poses\n"
        until = time.monotonic() + 30
        while not (pose_writer.get_matched_subscriptions() and reader.get_matched_publications()):
            assert time.monotonic() < until
            time.sleep(0.01)
        while twists and not twist_writer.get_matched_subscriptions():
            assert time.monotonic() < until
            time.sleep(0.01)
        # A frame that looks along its x is told by another quaternion: the axes' turn is a third of one, so twice it is its inverse.
        quaternion = tides.camera_quaternion(tides.camera_quaternion((1, 0, 0, 0), axes), axes)
        told = [((0.03 * k, 0.01 * k * k, -4), quaternion, (3, 2.0 * k, 0), (0, 0.1, 0)) for k in range(12)]
        for k, (p, q, v, w) in enumerate(told):
            header = messages.header(began + 10_000_000 * k, "world")
            twist = messages.TwistStamped(header, messages.Twist(messages.Vector3(*map(float, v)), messages.Vector3(*map(float, w))))
            turned = messages.Quaternion(float(q[1]), float(q[2]), float(q[3]), float(q[0]))
            if twists and k % 2:
                twist_writer.write(twist)
            pose_writer.write(messages.PoseStamped(header, messages.Pose(messages.Point(*map(float, p)), turned)))
            if twists and not k % 2:
                twist_writer.write(twist)
            time.sleep(0.05)
        said, errors = flown.communicate(timeout=60)
    finally:
        flown.kill()
        flown.wait()
    assert flown.returncode == 0 and errors == "", errors
    packets = reader.take(2000)
    wanted = []
    with tides.Live(room) as live:
        for k, (p, q, v, w) in enumerate(told):
            pose = (p, tides.camera_quaternion(q, axes), v, w)[: 4 if twists else 2]
            ahead = 0.02 + k * 0.01 - live.time
            wanted.append(live.step(pose, ahead)) if k else live.tell(pose, live.time)
    wanted, events = np.concatenate(wanted), unfolded(packets)
    assert len(wanted) > 100 and said == f"{len(wanted)} events\n"
    assert np.array_equal(events["t"], (wanted["t"] + began - 20_000_000) // 1000 * 1000)
    assert all(np.array_equal(events[name], wanted[name]) for name in "xy") and np.array_equal(events["p"], wanted["p"] > 0)


def test_poses_that_cant_be_are_left_out(room):
    """NaN, no rotation, the past, another clock's future, half a turn: each is said, and the events are those of the other poses."""
    bus = tides.ros2.Bus(DOMAIN + 2, loopback=True)
    node = tides.ros2.Node(tides.Session(room), bus, clock=False)
    follower, writer = tides.ros2.Follower(node), bus.writer("event_camera/pose", messages.PoseStamped)
    began, count, nan = 1_700_000_000 * 10**9, 0, float("nan")
    good = (0.0, 0.0, 0.0, 1.0)
    cases = [
        (0, (nan, 0.0, -4.0), good, "finite"), (1, (0.0, 0.0, -4.0), (0.0,) * 4, "rotation"),
        (-1_700_000_000_000, (0.3, 0.0, -4.0), good, None),  # a clock that isn't set yet
        (2, (0.0, 0.0, -4.0), good, "another clock: the run begins at 1.7e+09 s"),
        (3, (0.03, 0.0, -4.0), (0.0, nan, 0.0, 1.0), "finite"), (12, (0.03, 0.0, -4.0), good, None), (7, (0.1, 0.0, -4.0), good, "past it"),
        (10**9, (0.2, 0.0, -4.0), good, "at most 60 s"), (15, (0.2, 0.0, -4.0), (0.0, 1.0, 0.0, 0.0), "turn"),
        (22, (0.06, 0.0, -4.0), good, None),
    ]  # fmt: skip
    for ms, place, turned, words in cases:
        pose = messages.Pose(messages.Point(*place), messages.Quaternion(*turned))
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            writer.write(messages.PoseStamped(messages.header(began + 1_000_000 * ms, "world"), pose))
            for _ in range(10):
                count += follower.spin(0.1)
        texts = [str(one.message) for one in said]
        assert len(texts) == (1 if words else 0) and all(words in one and ("left out" in one) != ("begins" in one) for one in texts), texts
    with tides.Live(room) as live:
        live.tell(((0, 0, -4), (1, 0, 0, 0)), live.time)
        wanted = sum(len(live.step(((x, 0, -4), (1, 0, 0, 0)), 0.01)) for x in (0.03, 0.06))
    assert count == wanted > 20
    with pytest.raises(OSError, match="can't be joined"):
        tides.ros2.Bus(DOMAIN + 2, loopback=True)
    follower.close()


def test_wrong_use_says_so(room, tmp_path):
    for arguments, words in [
        ([room, "--period", "0"], "--period 0"), ([room, "--speed", "-1"], "--speed -1"), ([room, "--images", "nan"], "--images nan"),
        ([room, "--poses", "--gap", "0"], "--gap 0"), ([room, "--name", "a b"], "topics begin with"),
        ([tmp_path / "none.json"], "none.json"), ([room, "--set", "x"], "KEY=VALUE"), ([room, "--domain", "300"], "0 to 232"),
        ([room, "--poses", "--axes", "up"], "none of"), ([room, "--set", "time.start=-1"], "-1"),
    ]:  # fmt: skip
        command = [sys.executable, "-m", "tides.ros2", *map(str, arguments), "--loopback"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60)
        assert done.returncode == 1 and words in done.stderr and "Traceback" not in done.stderr, done.stderr
    program = "import sys; sys.modules['cyclonedds.core'] = None\nimport tides.ros2"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert "pip install tides[ros2]" in done.stderr
