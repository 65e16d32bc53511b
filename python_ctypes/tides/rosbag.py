"""ROS 1 bags: recordings and datasets as dvs_msgs/EventArray, and what else a dataset's ROS 2 bag has.

    import tides.rosbag
    tides.rosbag.write_rosbag("events.bag", "events.h5")        # any event file: /dvs/events
    tides.rosbag.write_rosbag("all.bag", "dataset/ros2")        # the folder of `tides dataset --layout ros2`: all its topics

Neither needs ROS; it needs the rosbags package: pip install tides[rosbags].
"""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

try:
    from rosbags.highlevel import AnyReader
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore
except ImportError as missing:
    raise ImportError("tides.rosbag needs the rosbags package: pip install tides[rosbags]") from missing

from .events import EventReader, events_summary
from .files import part_name

_ARRAY = "dvs_msgs/msg/EventArray"
_PACKET = "event_camera_msgs/msg/EventPacket"
_EVENT = np.dtype([("x", "<u2"), ("y", "<u2"), ("s", "<u4"), ("ns", "<u4"), ("p", "?")])  # dvs_msgs/Event as serialised
_SLICE_NS = 10_000_000  # of a message made of an event file: drivers send at 100 Hz
_SECOND = 1_000_000_000


def _typestore() -> Any:
    """ROS 1's types, with those of dvs_msgs."""
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg("uint16 x\nuint16 y\ntime ts\nbool polarity\n", "dvs_msgs/msg/Event"))
    array = "std_msgs/Header header\nuint32 height\nuint32 width\ndvs_msgs/Event[] events\n"
    store.register(get_types_from_msg(array, _ARRAY))
    return store


def _event_array(number: int, ns: int, frame: bytes, height: int, width: int, events: np.ndarray) -> bytes:
    """The serialised message; with objects a million events would take seconds. `events` has columns t [ns], x, y, p."""
    if len(events) and not 0 <= events["t"].min() <= events["t"].max() < 2**32 * _SECOND:
        raise ValueError(f"ROS's clock has no {events['t'][0] / _SECOND:.9g} s: it is from 0 to 2^32 s")
    rows = np.empty(len(events), _EVENT)
    rows["x"], rows["y"], rows["p"] = events["x"], events["y"], events["p"] > 0
    rows["s"], rows["ns"] = np.divmod(events["t"], _SECOND)
    head = struct.pack("<IIII", number, ns // _SECOND, ns % _SECOND, len(frame)) + frame
    return head + struct.pack("<III", height, width, len(rows)) + rows.tobytes()


def _decode_evt3(words: np.ndarray, stamp_us: int) -> np.ndarray:
    """Events and times of EVT 3.0 from TIDES' bags: each packet has its own clock of 24 bits, which starts at the packet's
    stamp."""
    kind, value, here = words >> 12, (words & 0xFFF).astype(np.int64), np.arange(len(words))
    if not np.isin(kind, (0, 2, 6, 8)).all():
        raise ValueError("the bag's events are vectors of EVT 3.0, which only other writers make")
    last = {one: np.maximum.accumulate(np.where(kind == one, here, 0)) for one in (0, 6, 8)}
    single = np.flatnonzero(kind == 2)
    low = np.where(last[6] > last[8], value[last[6]], 0)[single]
    clock = (value[last[8]][single] << 12) + low
    events = np.empty(len(single), [("t", "<i8"), ("x", "<u2"), ("y", "<u2"), ("p", "?")])
    events["t"] = 1000 * (stamp_us + (clock - stamp_us) % 2**24)
    events["x"], events["y"], events["p"] = value[single] & 0x7FF, value[last[0]][single], value[single] >> 11
    return events


_Message = tuple[str, str, int, bytes]  # topic, type, time of sending [ns], content


def _of_events(file: str) -> Iterator[_Message]:
    number = 0
    with EventReader(file) as reader:
        facts = reader.facts if reader.facts.width and reader.facts.height else events_summary(file)
        for packet in reader:
            cuts = 1 + np.flatnonzero(np.diff(packet["t"] // _SLICE_NS))
            for events in np.split(packet, cuts):
                ns = int(events["t"][-1])
                yield "/dvs/events", _ARRAY, ns, _event_array(number, ns, b"dvs", facts.height, facts.width, events)
                number += 1


def _of_bag(folder: str) -> Iterator[_Message]:
    with AnyReader([Path(folder)]) as bag:
        for connection, ns, data in bag.messages():
            if connection.msgtype != _PACKET:
                yield connection.topic, connection.msgtype, ns, bag.typestore.cdr_to_ros1(data, connection.msgtype)
                continue
            packet = bag.deserialize(data, _PACKET)
            events = _decode_evt3(np.frombuffer(packet.events, "<u2"), ns // 1000)
            frame = packet.header.frame_id.encode()
            yield connection.topic, _ARRAY, ns, _event_array(packet.seq, ns, frame, packet.height, packet.width, events)


def _topics_of(topics: Mapping[str, str | Sequence[str] | None], name: str) -> Sequence[str]:
    said = topics.get(name, name)
    return [] if said is None else [said] if isinstance(said, str) else said


def write_rosbag(
    file: str | os.PathLike[str],
    source: str | os.PathLike[str],
    topics: Mapping[str, str | Sequence[str] | None] | None = None,
) -> int:
    """Writes a ROS 1 bag of `source`. An event file of any format becomes /dvs/events, to the nanosecond, with a message every
    10 ms. A ROS 2 bag made by tides keeps topics, times and contents. `topics` renames: {"/left/depth":
    "/davis/left/depth_image_raw"}, to several names for copies, to None to leave one out. Returns the number of
    messages."""
    store, connections, count, part = _typestore(), {}, 0, part_name(file)
    messages = _of_bag if os.path.isdir(source) else _of_events
    Path(part).unlink(missing_ok=True)
    try:
        with Writer(part) as bag:
            for topic, kind, ns, data in messages(os.fspath(source)):
                for name in _topics_of(topics or {}, topic):
                    if name not in connections:
                        connections[name] = bag.add_connection(name, kind, typestore=store)
                    bag.write(connections[name], ns, data)
                    count += 1
        os.replace(part, file)
    finally:
        Path(part).unlink(missing_ok=True)
    return count
