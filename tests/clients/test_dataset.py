"""Datasets, read by other people's clients: evlib for ECD's text and DSEC's HDF5; the mcap and rosbags packages for bags."""

import json

import numpy as np
import pytest
import readers
import tides

METRES = 0.5
RIGHT = [[1, 0, 0, 0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dataset")
    random = np.random.default_rng(3)
    cloud = tides.Gaussians.from_colours(
        random.uniform(-1, 1, (120, 3)), random.uniform(0.1, 0.25, (120, 3)), random.uniform(0, 1, (120, 3))
    )
    scene = tides.Scene()
    scene.add(cloud, name="cloud")
    scene.save(folder / "cloud.h5")
    path = tides.Trajectory.orbit(radius=4, angular_speed=1, start=16.7, stop=16.9)  # EVT 3.0's clock turns at 16.777216 s
    tides.Camera(path, tides.Intrinsics.from_fov(40, 28, 0.8)).save(folder / "path.json")
    run = {
        "scene": {"file": "cloud.h5", "metres_per_unit": METRES},
        "camera": {"file": "path.json"},
        "time": {"start": 16.7, "stop": 16.9},
        "stepping": {"step_s": 0.01},
        "imu": {"down": [0, 1, 0]},
        "rig": {"cameras": [{"name": "left"}, {"name": "right", "kind": "event", "T_B_C": RIGHT}]},
    }
    (folder / "run.json").write_text(json.dumps(run))
    with tides.Session(folder / "run.json", device="reference-f32") as session:
        report = session.dataset(folder / "all", ["ecd", "dsec", "ros2"])
        with session.vary({"rig.camera": "right"}) as other:
            events = {"left": session.simulate(), "right": other.simulate()}
        with session.renderer() as renderer:
            t = session.values.start + 0.05
            frame = renderer.frame(t, ["R", "G", "B"])
            truth = renderer.truth(session.values.start + 0.1)
        yield {"all": folder / "all", "report": report, "events": events, "frame": frame, "truth": truth, "session": session}


def check(got, events):
    t, x, y, p = (np.asarray(one).astype(np.int64) for one in got)
    assert np.array_equal(t, events["t"] // 1000) and np.array_equal(x, events["x"])
    assert np.array_equal(y, events["y"]) and np.array_equal(p > 0, events["p"] > 0)


@pytest.mark.parametrize("side", ["left", "right"])
def test_evlib(world, side):
    check(readers.evlib(str(world["all"] / f"ecd/{side}/events.txt"), (40, 28)), world["events"][side])
    check(readers.evlib(str(world["all"] / f"dsec/events/{side}/events.h5"), (40, 28)), world["events"][side])


def decode_evt3(packets):
    """Of one topic: words as Prophesee documents them, each packet on its own; turns of the clock by the packets' stamps."""
    columns = []
    for stamp, data in packets:
        words, high, low, y = np.frombuffer(data, "<u2"), None, None, None
        for word in words.tolist():
            kind, value = word >> 12, word & 0xFFF
            if kind == 8:
                high, low = value, 0
            elif kind == 6:
                low = value
            elif kind == 0:
                y = value
            else:
                assert kind == 2 and None not in (high, low, y)
                t = stamp + ((high << 12 | low) - stamp) % 2**24
                columns.append((t, value & 0x7FF, y, value >> 11))
    return np.array(columns).T


def test_mcap(world):
    pytest.importorskip("mcap_ros2")
    from mcap_ros2.reader import read_ros2_messages

    messages = {}
    last = 0
    for one in read_ros2_messages(str(world["all"] / "ros2/all.mcap")):
        messages.setdefault(one.channel.topic, []).append(one.ros_msg)
        assert one.log_time_ns >= last  # merged by the index
        last = one.log_time_ns
    for side in ("left", "right"):
        packets = messages[f"/{side}/events"]
        assert [one.seq for one in packets] == list(range(len(packets)))
        assert {(one.encoding, one.width, one.height) for one in packets} == {("evt3", 40, 28)}
        stamps = [(1000000 * one.header.stamp.sec + one.header.stamp.nanosec // 1000, bytes(one.events)) for one in packets]
        check(decode_evt3(stamps), world["events"][side])
    assert "/right/image_raw" not in messages and len(messages["/right/camera_info"]) == world["report"].truths
    image, info = messages["/left/image_raw"][1], messages["/left/camera_info"][1]
    assert (image.encoding, image.step, len(messages["/left/image_raw"])) == ("rgb8", 120, world["report"].pictures)
    light = np.clip(np.stack([world["frame"][name] for name in "RGB"], -1), 0, 1)
    wanted = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)
    got = np.frombuffer(bytes(image.data), np.uint8).reshape(28, 40, 3) / 255.0
    assert np.abs(got - wanted).max() < 0.51 / 255
    lens = world["session"].intrinsics
    assert list(info.k) == [lens.fx, 0, lens.cx - 0.5, 0, lens.fy, lens.cy - 0.5, 0, 0, 1]
    depth, flow = (np.frombuffer(bytes(messages[f"/left/{name}"][1].data), "<f4") for name in ("depth", "optic_flow"))
    wanted = world["truth"]["depth_median"].ravel()
    assert np.array_equal(depth, np.where(wanted > 0, METRES * wanted, np.nan).astype(np.float32), equal_nan=True)
    assert np.array_equal(flow[1::2], world["truth"]["flow_v"].ravel().astype(np.float32))
    imu = messages["/left/imu"][5]
    wanted = world["session"].camera.trajectory.imu(tides.Imu(down=(0, 1, 0), metres_per_unit=METRES), 16.7, 16.75)[5]
    force = imu.linear_acceleration
    assert np.allclose([force.x, force.y, force.z], wanted["specific_force"], rtol=1e-12)
    assert imu.orientation_covariance[0] == -1
    for one in messages["/left/pose"][::7]:
        t = one.header.stamp.sec + 1e-9 * one.header.stamp.nanosec
        place = one.pose.position
        assert np.allclose([place.x, place.y, place.z], METRES * world["session"].camera.trajectory.at(t).position, atol=1e-8)


def test_rosbags(world):
    highlevel = pytest.importorskip("rosbags.highlevel")
    count, kinds = {}, set()
    with highlevel.AnyReader([world["all"] / "ros2"]) as bag:
        for connection, _, data in bag.messages():
            message = bag.deserialize(data, connection.msgtype)
            count[connection.topic] = count.get(connection.topic, 0) + 1
            kinds.add(type(message).__name__.split("__")[-1])
            if connection.topic == "/left/camera_info":
                assert message.distortion_model == "plumb_bob" and message.p.shape == (12,)
        assert bag.message_count == sum(count.values())
    assert count["/left/pose"] == world["report"].poses and count["/left/image_raw"] == world["report"].pictures
    assert kinds == {"EventPacket", "Image", "CameraInfo", "PoseStamped", "Imu"}
