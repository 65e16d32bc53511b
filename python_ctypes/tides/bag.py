"""ROS bags read: events and what lies beside them (frames, poses, lens) as a folder that `tides info`, `tides init` and
`tides calibrate` take. Bags of ROS 1 (.bag) and of ROS 2 (.db3, .mcap, or their folder).

    python -m tides.bag recording.bag recording        # the folder recording/
    tides init recording -o run.json
    tides calibrate recording run.json -o mine.json

The folder has events.h5; images/ and images.txt, a line "time file" for each; exposure.txt with "time exposure" where the bag says
how long frames were exposed; groundtruth.txt, poses as TUM has them; calib.txt, the lens as the Event Camera Dataset has it; and
clock.txt with the ROS time [ns] at which the folder's time is 0, a whole second before the first event.

It needs no ROS, but the rosbags package: pip install tides[rosbags].
"""

from __future__ import annotations

import argparse
import os
import shutil
import struct
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

try:
    from rosbags.highlevel import AnyReader, AnyReaderError
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore
except ImportError as missing:
    raise ImportError("tides.bag needs the rosbags package: pip install tides[rosbags]") from missing

from .errors import TidesError
from .events import EventReader, EventWriter, make_events
from .files import check_apart
from .image import write_png_values

_SECOND = 1_000_000_000
_CHUNK = 1_000_000  # events that are put in order at a time
_TURN_NS = 16_000_000_000  # EVT 3.0 counts 2^24 us: a longer silence between packets loses turns of its clock

_EVENT = np.dtype([("x", "<u2"), ("y", "<u2"), ("s", "<u4"), ("ns", "<u4"), ("p", "?")])  # dvs_msgs/Event in ROS 1's bytes
_ARRAYS = ("dvs_msgs/msg/EventArray", "prophesee_event_msgs/msg/EventArray")  # one layout
_PACKETS = ("event_camera_msgs/msg/EventPacket", "event_array_msgs/msg/EventArray")  # another
_IMAGE = "sensor_msgs/msg/Image"
_POSE, _TRANSFORM, _ODOMETRY = "geometry_msgs/msg/PoseStamped", "geometry_msgs/msg/TransformStamped", "nav_msgs/msg/Odometry"
_KINDS = {
    "events": (*_ARRAYS, *_PACKETS),
    "frames": (_IMAGE,),
    "poses": (_POSE, _TRANSFORM, _ODOMETRY),
    "lens": ("sensor_msgs/msg/CameraInfo",),
    "exposure": ("std_msgs/msg/Int32",),  # [us], as rpg_dvs_ros publishes it beside its frames
}

# Encodings of sensor_msgs/Image that hold light: type and number of planes. Planes b g r are put in the order r g b.
_ENCODINGS = {
    "mono8": ("u1", 1), "8UC1": ("u1", 1), "mono16": ("u2", 1), "16UC1": ("u2", 1),
    "rgb8": ("u1", 3), "bgr8": ("u1", 3), "8UC3": ("u1", 3), "rgba8": ("u1", 4), "bgra8": ("u1", 4),
    "rgb16": ("u2", 3), "bgr16": ("u2", 3),
}  # fmt: skip


@dataclass
class Converted:
    """Contents of a bag: the topic taken for each kind, and counts."""

    folder: str
    zero_ns: int  # ROS time of the folder's time 0
    topics: dict[str, str] = field(default_factory=dict)
    events: int = 0
    frames: int = 0
    poses: int = 0
    notes: list[str] = field(default_factory=list)  # what was left out, and why


# -- topics ----------------------------------------------------------------------------------------------------------------
def _open(files: Sequence[str | os.PathLike[str]]) -> AnyReader:
    """Opens a bag. Types of event messages are added to those that the bag defines, since bags of old rosbag2 define none."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg("uint16 x\nuint16 y\nbuiltin_interfaces/Time ts\nbool polarity\n", "dvs_msgs/msg/Event"))
    array = "std_msgs/Header header\nuint32 height\nuint32 width\ndvs_msgs/Event[] events\n"
    store.register(get_types_from_msg(array, _ARRAYS[0]))
    packet = (
        "std_msgs/Header header\nuint32 height\nuint32 width\nuint64 seq\nuint64 time_base\nstring encoding\n"
        "bool is_bigendian\nuint8[] events\n"
    )
    for name in _PACKETS:
        store.register(get_types_from_msg(packet, name))
    return AnyReader([Path(one) for one in files], default_typestore=store)


def _read(bag: AnyReader, topic: str, decode: Callable[[Any, bytes], Any]) -> Iterator[Any]:
    """Decodes each message of a topic. In a damaged bag rosbags' decoders raise errors of many types; each becomes a
    ValueError that names the topic."""
    try:
        for connection, _, data in bag.messages([one for one in bag.connections if one.topic == topic]):
            yield decode(connection, data)
    except Exception as why:
        raise ValueError(f"{topic}: a message can't be read: {type(why).__name__}: {why}") from why


def _messages(bag: AnyReader, topic: str) -> Iterator[Any]:
    return _read(bag, topic, lambda connection, data: bag.deserialize(data, connection.msgtype))


def _first(bag: AnyReader, topic: str) -> Any:
    """The first message of a topic that has some."""
    for message in _messages(bag, topic):
        return message
    raise ValueError(f"{topic}: its messages aren't in the bag, which says that it has some")


def _candidates(bag: AnyReader, kind: str) -> list[str]:
    found = sorted({one.topic for one in bag.connections if one.msgtype in _KINDS[kind] and one.msgcount})
    if kind == "frames":
        return [one for one in found if _first(bag, one).encoding in _ENCODINGS]
    return [one for one in found if one.endswith("exposure")] if kind == "exposure" else found


def _choose(bag: AnyReader, kind: str, asked: str | None, events: str | None, notes: list[str]) -> str | None:
    """The topic of a kind: the one asked for, the only one, or the only one in the namespace of the events. A lens of another
    namespace is another camera's, and is left out."""
    found = _candidates(bag, kind)
    if asked is not None:
        if asked not in found:
            raise ValueError(f"{kind}: {asked} is no such topic of the bag; it has {', '.join(found) or 'none'}")
        return asked
    if events is not None:
        space = events.rsplit("/", 1)[0] + "/"
        near = [one for one in found if one.startswith(space)]
        if kind == "lens" and found and not near:
            notes.append(f"lens: {', '.join(found)} isn't beside {events}, and is left out: name it if it is that camera's (--lens)")
        found = near if near or kind == "lens" else found
    if len(found) > 1:
        raise ValueError(f"{kind}: the bag has {', '.join(found)}: name one of them (--{kind})")
    return found[0] if found else None


def _stamp(message: Any) -> int:
    return _SECOND * message.header.stamp.sec + message.header.stamp.nanosec


# -- events ----------------------------------------------------------------------------------------------------------------
def _of_array(data: bytes) -> tuple[int, int, np.ndarray]:
    """Height, width and events of an EventArray in ROS 1's bytes."""
    (name,) = struct.unpack_from("<I", data, 12)
    height, width, count = struct.unpack_from("<III", data, 16 + name)
    if len(data) < 28 + name + count * _EVENT.itemsize:
        raise ValueError("a message is shorter than the events that it says it has")
    return height, width, np.frombuffer(data, _EVENT, count, 28 + name)


def _arrays(bag: AnyReader, topic: str) -> Iterator[tuple[int, int, np.ndarray]]:
    """Height, width, and events in ROS time [ns]."""

    def decode(connection: Any, data: bytes) -> tuple[int, int, np.ndarray]:
        return _of_array(bytes(bag.typestore.cdr_to_ros1(data, connection.msgtype) if bag.is2 else data))

    for height, width, rows in _read(bag, topic, decode):
        yield height, width, make_events(rows["s"].astype(np.int64) * _SECOND + rows["ns"], rows["x"], rows["y"], rows["p"])


def _packets(bag: AnyReader, topic: str, folder: str) -> Iterator[tuple[int, int, np.ndarray]]:
    """Height, width, and events in ROS time [ns] of EVT 3.0's packets. The clock of EVT 3.0 runs on from packet to packet, so that
    all are decoded as one .raw file. The first packet's stamp is its first event's ROS time, and gives the offset for all."""
    raw, first, last = os.path.join(folder, "events.raw"), None, 0
    with open(raw, "wb") as file:
        for packet in _messages(bag, topic):
            if packet.encoding != "evt3":
                raise ValueError(f"{topic}: encoding {packet.encoding!r}: evt3 is read")
            if first is None:
                first = packet
                file.write(f"% evt 3.0\n% format EVT3;height={packet.height};width={packet.width}\n".encode())
                file.write(f"% geometry {packet.width}x{packet.height}\n% end\n".encode())
            elif _stamp(packet) - last > _TURN_NS:
                raise ValueError(f"{topic}: {1e-9 * (_stamp(packet) - last):.1f} s between packets: EVT 3.0 turns over in 16 s")
            last = _stamp(packet)
            file.write(bytes(packet.events))
    offset = None
    with EventReader(raw) as reader:
        for events in reader:
            offset = _stamp(first) - int(events["t"][0]) if offset is None else offset
            yield first.height, first.width, make_events(events["t"] + offset, events["x"], events["y"], events["p"])
    os.remove(raw)


class _Sorted:
    """Events put in order of (t, y, x, p) before they are written: messages of drivers are nearly so."""

    def __init__(self, file: str, width: int, height: int, zero_ns: int):
        self._writer, self._zero, self._held, self._count = EventWriter(file, width, height), zero_ns, [], 0

    def add(self, events: np.ndarray) -> None:
        self._held.append(events)
        self._count += len(events)
        if self._count >= _CHUNK:
            self._write(False)

    def _write(self, last: bool) -> None:
        events = np.concatenate(self._held) if self._held else make_events([], [], [], [])
        events = events[np.lexsort((events["p"], events["x"], events["y"], events["t"]))]
        # messages of the next chunk may have events up to 10 ms before this chunk's last
        cut = len(events) if last or not len(events) else int(np.searchsorted(events["t"], events["t"][-1] - _SECOND // 100))
        out = events[:cut].copy()
        out["t"] -= self._zero
        self._writer.append(out)
        self._held, self._count = [events[cut:]], len(events) - cut

    def finish(self) -> int:
        self._write(True)
        count = int(self._writer.count)
        self._writer.finish()
        return count

    def abandon(self) -> None:
        self._writer.close()


def _write_events(bag: AnyReader, topic: str, folder: str, zero_ns: int) -> int:
    packets = any(one.topic == topic and one.msgtype in _PACKETS for one in bag.connections)
    out = None
    try:
        for height, width, events in _packets(bag, topic, folder) if packets else _arrays(bag, topic):
            out = out or _Sorted(os.path.join(folder, "events.h5"), width, height, zero_ns)
            out.add(events)
        return out.finish() if out else 0
    finally:
        if out:
            out.abandon()


# -- what lies beside ------------------------------------------------------------------------------------------------------
def _values(message: Any) -> np.ndarray:
    """The values of an image, (height, width) or (height, width, 3)."""
    kind, planes = _ENCODINGS[message.encoding]
    rows = np.asarray(message.data, np.uint8).reshape(message.height, message.step)
    size = int(kind[1]) * planes * message.width
    values = rows[:, :size].copy().view((">" if message.is_bigendian else "<") + kind).reshape(message.height, message.width, planes)
    if planes == 1:
        return values[:, :, 0].astype(kind)
    turned = message.encoding.startswith("bgr") or message.encoding == "8UC3"  # OpenCV's order
    return values[:, :, [2, 1, 0] if turned else [0, 1, 2]].astype(kind)


def _seconds(ns: int) -> str:
    return f"{'-' if ns < 0 else ''}{abs(ns) // _SECOND}.{abs(ns) % _SECOND:09d}"


def _write_frames(bag: AnyReader, topic: str, folder: str, zero_ns: int) -> list[int]:
    """Writes images/ and images.txt; returns the frames' times [ns]."""
    os.mkdir(os.path.join(folder, "images"))
    times: list[int] = []
    lines = []
    for message in _messages(bag, topic):
        if message.encoding not in _ENCODINGS:
            raise ValueError(f"{topic}: encoding {message.encoding} of frame {len(times)}: its first one had another")
        name, values = f"images/frame_{len(times):08d}.png", _values(message)
        write_png_values(os.path.join(folder, name), values, 8 * values.dtype.itemsize)
        times.append(_stamp(message) - zero_ns)
        lines.append(f"{_seconds(times[-1])} {name}\n")
    Path(folder, "images.txt").write_text("".join(lines), "utf-8")
    return times


def _write_exposures(bag: AnyReader, topic: str, folder: str, times: list[int]) -> None:
    """Writes exposure.txt. Messages of exposures have no stamp: there is one for each frame, in order."""
    exposures = [int(one.data) for one in _messages(bag, topic)]
    if len(exposures) != len(times):
        return
    lines = (f"{_seconds(t)} {1e-6 * us:.6f}\n" for t, us in zip(times, exposures))
    Path(folder, "exposure.txt").write_text("".join(lines), "utf-8")


def _write_poses(bag: AnyReader, topic: str, folder: str, zero_ns: int) -> int:
    lines = []
    for one in _messages(bag, topic):
        moved = getattr(one, "transform", None)
        pose = None if moved else one.pose.pose if hasattr(one.pose, "pose") else one.pose
        at, turn = (moved.translation, moved.rotation) if moved else (pose.position, pose.orientation)
        numbers = (at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w)
        lines.append(_seconds(_stamp(one) - zero_ns) + "".join(f" {float(value):.17g}" for value in numbers) + "\n")
    Path(folder, "groundtruth.txt").write_text("".join(lines), "utf-8")
    return len(lines)


def _write_lens(bag: AnyReader, topic: str, folder: str) -> None:
    """Writes calib.txt: fx fy cx cy k1 k2 p1 p2 k3. A fisheye lens (equidistant) is left out: these coefficients can't describe
    it."""
    info = _first(bag, topic)
    k = [float(one) for one in (info.k if hasattr(info, "k") else info.K)]
    d = [float(one) for one in (info.d if hasattr(info, "d") else info.D)]
    model = info.distortion_model
    if k[0] > 0 and model in ("", "plumb_bob"):
        numbers = [k[0], k[4], k[2], k[5], *(d + [0.0] * 5)[:5]]
        Path(folder, "calib.txt").write_text(" ".join(f"{value:.17g}" for value in numbers) + "\n", "utf-8")


# -- all of it -------------------------------------------------------------------------------------------------------------
def _start(bag: AnyReader, topic: str) -> int:
    message = _first(bag, topic)
    if hasattr(message, "encoding") or not len(message.events):
        return _stamp(message)
    return min(_SECOND * message.events[0].ts.sec + message.events[0].ts.nanosec, _stamp(message))


def _fill(bag: AnyReader, done: Converted, folder: str) -> None:
    topics = done.topics
    done.events = _write_events(bag, topics["events"], folder, done.zero_ns)
    times = _write_frames(bag, topics["frames"], folder, done.zero_ns) if "frames" in topics else []
    done.frames = len(times)
    if times and "exposure" in topics:
        _write_exposures(bag, topics["exposure"], folder, times)
    if "poses" in topics:
        done.poses = _write_poses(bag, topics["poses"], folder, done.zero_ns)
    if "lens" in topics:
        _write_lens(bag, topics["lens"], folder)
    Path(folder, "clock.txt").write_text(f"{done.zero_ns}\n", "utf-8")


def convert(
    bag: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    folder: str | os.PathLike[str],
    events: str | None = None,
    frames: str | None = None,
    poses: str | None = None,
    lens: str | None = None,
    exposure: str | None = None,
) -> Converted:
    """Makes `folder` of a bag, or of several that are one recording. Topics are found by their type. If there are several of one
    type, the one in the events' namespace is taken, unless you name one. A lens of another namespace is left out."""
    files = [bag] if isinstance(bag, (str, os.PathLike)) else list(bag)
    asked = {"frames": frames, "poses": poses, "lens": lens, "exposure": exposure}
    target, part = os.fspath(folder).rstrip("/"), os.fspath(folder).rstrip("/") + ".part"
    check_apart([os.fspath(one) for one in files], [target])
    if os.path.exists(target):
        raise FileExistsError(f"{target}: is there already: name a new folder")
    for one in files:
        if not os.path.exists(one):
            raise FileNotFoundError(f"{os.fspath(one)}: no such bag")
    with _open(files) as reader:
        topic = _choose(reader, "events", events, None, [])
        if topic is None:
            raise ValueError(f"{os.fspath(files[0])}: no topic of it has events ({', '.join((*_ARRAYS, *_PACKETS))})")
        done = Converted(target, _start(reader, topic) // _SECOND * _SECOND, {"events": topic})
        for kind, name in asked.items():
            chosen = _choose(reader, kind, name, topic, done.notes)
            if chosen is not None:
                done.topics[kind] = chosen
        shutil.rmtree(part, ignore_errors=True)
        os.makedirs(part)
        try:
            _fill(reader, done, part)
            os.rename(part, target)
        finally:
            shutil.rmtree(part, ignore_errors=True)
    return done


def main(arguments: list[str] | None = None) -> int:
    """`python -m tides.bag IN.bag FOLDER`: a ROS bag's events, frames, poses and lens as a folder."""
    parser = argparse.ArgumentParser("python -m tides.bag", description=main.__doc__)
    parser.add_argument("bag", nargs="+", metavar="BAG", help=".bag, .db3, .mcap or a folder of ROS 2; several are one recording")
    parser.add_argument("folder", metavar="FOLDER", help="the folder to make")
    for kind in _KINDS:
        parser.add_argument(f"--{kind}", metavar="TOPIC", help=f"the topic of {kind}, where the bag has several")
    parser.add_argument("-q", "--quiet", action="store_true")
    given = parser.parse_args(arguments)
    try:
        done = convert(given.bag, given.folder, given.events, given.frames, given.poses, given.lens, given.exposure)
    except AnyReaderError as why:
        print(f"tides.bag: {', '.join(given.bag)}: {str(why).strip().splitlines()[0]}", file=sys.stderr)
        return 1
    except (TidesError, OSError, ValueError) as why:
        print(f"tides.bag: {str(why).strip().splitlines()[0]}", file=sys.stderr)
        return 1
    for note in done.notes:
        print(f"tides.bag: {note}", file=sys.stderr)
    if not given.quiet:
        counts = (("events", done.events), ("frames", done.frames), ("poses", done.poses))
        said = ", ".join(f"{count} {kind}" for kind, count in counts if count)
        print(f"{done.folder}: {said} of {', '.join(done.topics.values())}; time 0 is {_seconds(done.zero_ns)} s of ROS's clock")
    return 0


if __name__ == "__main__":
    sys.exit(main())
