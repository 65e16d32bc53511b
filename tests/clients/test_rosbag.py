"""ROS 1 bags by tides.rosbag, read by the rosbags package: events to the nanosecond, all topics of a dataset's ROS 2 bag."""

import numpy as np
import pytest
import readers
import tides
import worlds
from conftest import records

highlevel = readers.import_client("rosbags.highlevel")
import tides.rosbag  # noqa: E402


def read(path):
    """Messages of each topic, deserialised, with the times that they were sent at; and the types' sums."""
    topics = {}
    with highlevel.AnyReader([path]) as bag:
        for connection, ns, data in bag.messages():
            topics.setdefault(connection.topic, []).append((ns, bag.deserialize(data, connection.msgtype)))
        return topics, {one.topic: one.digest for one in bag.connections}


def nanoseconds(stamp):
    return 10**9 * stamp.sec + stamp.nanosec


def events_of(messages):
    rows = [(nanoseconds(e.ts), e.x, e.y, e.polarity) for _, message in messages for e in message.events]
    return np.array(rows, np.int64).reshape(-1, 4).T


@pytest.mark.parametrize("stream", ["one", "corners", "run", "none"])
def test_event_files(files, tmp_path, stream):
    path, events, (width, height) = files.file(stream, "h5")
    count = tides.rosbag.write_rosbag(tmp_path / "events.bag", path)
    wanted = records(events)
    if stream == "none":
        assert count == 0 and (tmp_path / "events.bag").exists()
        return
    topics, digests = read(tmp_path / "events.bag")
    messages = topics["/dvs/events"]
    assert digests["/dvs/events"] == "5e8beee5a6c107e504c2e78903c224b8" and len(messages) == count
    t, x, y, p = events_of(messages)
    assert np.array_equal(t, wanted["t"]) and np.array_equal(x, wanted["x"]) and np.array_equal(y, wanted["y"])
    assert np.array_equal(p, wanted["p"] > 0)
    for number, (ns, message) in enumerate(messages):
        assert (message.height, message.width, message.header.seq) == (height, width, number)
        assert ns == nanoseconds(message.header.stamp) == nanoseconds(message.events[-1].ts)
        assert ns - nanoseconds(message.events[0].ts) < 10**7


@pytest.mark.parametrize("name", worlds.WORLDS)
def test_datasets(of, tmp_path, name):
    world = of(name)
    source = world.folder / name / "ros2"
    count = tides.rosbag.write_rosbag(tmp_path / "all.bag", source, {"/right/imu": None, "/left/pose": "/pose"})
    (ours, _), (theirs, digests) = read(source), read(tmp_path / "all.bag")
    ours["/pose"] = ours.pop("/left/pose")
    ours.pop("/right/imu", None)
    assert set(ours) == set(theirs) and count == sum(len(one) for one in theirs.values())
    assert digests["/left/image_raw"] == "060021388200f6f0f447d0fcd9c64743"
    for side in world.sides:
        t, x, y, p = events_of(theirs.pop(f"/{side}/events", []))
        wanted = world.events[side]
        assert np.array_equal(t, wanted["t"] // 1000 * 1000) and np.array_equal(x, wanted["x"])
        assert np.array_equal(y, wanted["y"]) and np.array_equal(p, wanted["p"] > 0)
    for topic, messages in theirs.items():
        assert len(messages) == len(ours[topic])
        for (ns, got), (wanted_ns, wanted) in zip(messages, ours[topic]):
            assert ns == wanted_ns == nanoseconds(got.header.stamp) and got.header.frame_id == wanted.header.frame_id
            for name in ("data", "encoding", "step", "k", "K", "linear_acceleration", "pose"):
                if hasattr(got, name):
                    one, two = getattr(got, name), getattr(wanted, name.lower())
                    assert np.array_equal(one, two) if hasattr(one, "shape") else repr(one) == repr(two)


def test_wrong_input(tmp_path):
    tides.write_events(tmp_path / "early.h5", tides.make_events([-5], [1], [1], [1]), 4, 3)
    with pytest.raises(ValueError, match="ROS's clock has no"):
        tides.rosbag.write_rosbag(tmp_path / "early.bag", tmp_path / "early.h5")
    assert not list(tmp_path.glob("*.bag*"))
