"""A run on ROS 2's topics, without ROS: events, pictures, lens, IMU and clock go out, and poses and twists come in.

    python -m tides.ros2 run.json                       # the run's own path, in real time
    python -m tides.ros2 run.json --poses --twists      # the camera is where event_camera/pose says

On the wire it is what a ROS 2 node with rmw_cyclonedds sends: topics rt/..., types pkg::msg::dds_::Name_, XCDR1, reliable, volatile, the
last 10 kept. It needs the cyclonedds package: pip install tides[ros2]. `Node` is the same in a program of your own; ros2_bench.py beside
it measures latency and rate.
"""

from __future__ import annotations

import argparse
import math
import os
import re
import sys
import tempfile
import time
from typing import Any, Iterable

import numpy as np

try:
    from cyclonedds.core import DDSException, InstanceState, Policy, Qos, ReadCondition, SampleState, ViewState, WaitSet
    from cyclonedds.domain import Domain, DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.sub import DataReader
    from cyclonedds.topic import Topic
    from cyclonedds.util import duration
except ImportError as missing:
    raise ImportError("tides.ros2 needs the cyclonedds package: pip install tides[ros2]") from missing

from . import ros2_messages as messages
from ._warn import warn
from .errors import BadArgument, OutOfRange, TidesError
from .events import EVENT
from .image import picture_rgb
from .live import Live, camera_quaternion
from .session import Session
from .trajectory import Trajectory

_SECOND = 1_000_000_000
DEPTH = 10  # messages that a queue keeps; ROS' default
PERIOD_S = 0.01  # of packets, along the run's own path
GAP_S = 60.0  # longest time between two poses: clocks that disagree would otherwise begin a run of years
POSE, TWIST = "geometry_msgs::msg::dds_::PoseStamped_", "geometry_msgs::msg::dds_::TwistStamped_"

#: Cyclone's settings for runs that only this machine receives.
LOOPBACK = """<CycloneDDS><Domain><General><Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces>
<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>30
</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>"""


def qos(depth: int = DEPTH) -> Any:
    """ROS 2's default quality of service: reliable, volatile, the last `depth` messages; XCDR1."""
    return Qos(
        Policy.Reliability.Reliable(duration(milliseconds=100)),
        Policy.Durability.Volatile,
        Policy.History.KeepLast(depth),
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
    )


def _domain_of(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise ValueError(f"ROS_DOMAIN_ID={text}: a number from 0 to 232 is needed") from None


class Bus:
    """A participant in a ROS domain (None: ROS_DOMAIN_ID, else 0). `loopback`: only on this machine (None: as
    ROS_LOCALHOST_ONLY or ROS_AUTOMATIC_DISCOVERY_RANGE says)."""

    def __init__(self, domain: int | None = None, loopback: bool | None = None):
        number = _domain_of(os.environ.get("ROS_DOMAIN_ID") or "0") if domain is None else domain
        if not 0 <= number <= 232:
            raise ValueError(f"domain: {number}, where ROS has 0 to 232")
        if loopback is None:
            reach = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "")
            loopback = os.environ.get("ROS_LOCALHOST_ONLY") == "1" or reach.upper() == "LOCALHOST"
        try:
            self._domain = Domain(number, LOOPBACK) if loopback else None
            self.participant = DomainParticipant(number)
        except DDSException as error:
            raise OSError(f"domain {number} can't be joined: {error}; a process joins one once, and 30 do so over the loopback") from None

    def writer(self, topic: str, kind: Any, depth: int = DEPTH) -> Any:
        return DataWriter(self.participant, Topic(self.participant, f"rt/{topic}", kind, qos=qos(depth)), qos=qos(depth))

    def reader(self, topic: str, kind: Any, depth: int = DEPTH) -> Any:
        return DataReader(self.participant, Topic(self.participant, f"rt/{topic}", kind, qos=qos(depth)), qos=qos(depth))


class Node:
    """Publishes a run's messages below `name`: events, image_raw with camera_info, imu; and /clock. `step` takes events and
    the run's time. `shift_ns` is added to the run's time for ROS' clock. `frame`: the frame_id of all messages. `image_hz`
    0: no pictures."""

    def __init__(
        self,
        session: Session,
        bus: Bus,
        name: str = "event_camera",
        frame: str = "event_camera",
        image_hz: float = 0.0,
        clock: bool = True,
        shift_ns: int = 0,
    ):
        self.session, self.bus, self.name, self.frame, self.shift_ns = session, bus, name.strip("/"), frame, shift_ns
        self._events = bus.writer(f"{self.name}/events", messages.EventPacket)
        self._image = bus.writer(f"{self.name}/image_raw", messages.Image) if image_hz else None
        self._info = bus.writer(f"{self.name}/camera_info", messages.CameraInfo)
        self._imu = bus.writer(f"{self.name}/imu", messages.Imu)
        self._clock = bus.writer("clock", messages.Clock) if clock else None
        self._renderer = session.renderer() if image_hz else None
        self._sequence, self._picture_s, self._next_s = 0, 1 / image_hz if image_hz else 0.0, session.values.start

    def header(self, ns: int) -> Any:
        """The header of a message at the run's time `ns`."""
        return messages.header(ns + self.shift_ns, self.frame)

    def events(self, events: np.ndarray, ns: int) -> None:
        """Publishes one packet of the events up to `ns`; none if there were no events."""
        if self._clock:
            self._clock.write(messages.Clock(messages.stamp(ns + self.shift_ns)))
        if not len(events):
            return
        lens, shifted = self.session.intrinsics, events["t"] + self.shift_ns
        packet = messages.EventPacket(
            self.header(int(events["t"][0])), lens.height, lens.width, self._sequence, 0, "evt3", False,
            messages.evt3(shifted, events["x"], events["y"], events["p"]),
        )  # fmt: skip
        self._sequence += 1
        self._events.write(packet)

    def pictures(self, until: float, path: Trajectory) -> None:
        """Publishes the pictures that are due up to `until` [s], along `path`, each with the lens."""
        while self._renderer and self._next_s <= until + 1e-9:
            frame = self._renderer.frame(self._next_s, "RGB", path)
            rgb = picture_rgb(frame["R"], frame["G"], frame["B"])
            header = self.header(round(_SECOND * self._next_s))
            height, width = rgb.shape[:2]
            self._image.write(messages.Image(header, height, width, "rgb8", 0, 3 * width, rgb.tobytes()))
            self._info.write(messages.camera_info(header, self.session.intrinsics))
            self._next_s += self._picture_s

    def imu(self, time: float, rate: Any, force: Any) -> None:
        """Publishes angular rate (3) [rad/s] and specific force (3) [m/s^2] at `time` [s]."""
        self._imu.write(messages.imu(self.header(round(_SECOND * time)), rate, force))


def play(node: Node, speed: float = 1.0, period_s: float = PERIOD_S) -> int:
    """Publishes the session's run along its own path: a packet each `period_s`, at `speed` times real time (0: as fast as
    possible). Returns the number of events."""
    session = node.session
    start, stop, path = session.values.start, session.values.stop, session.camera.trajectory
    inertial = _inertial(session)
    begun, count = time.monotonic(), 0
    simulation = session.simulation()
    for index, packet in enumerate(simulation.packets(period_s)):
        until = min(stop, start + (index + 1) * period_s)
        if speed:
            time.sleep(max(0.0, begun + (until - start) / speed - time.monotonic()))
        while inertial and inertial[-1][0] <= until:
            node.imu(*inertial.pop())
        node.pictures(until, path)
        node.events(packet, round(_SECOND * until))
        count += len(packet)
    simulation.close()
    return count


def _inertial(session: Session) -> list[tuple[float, Any, Any]]:
    """The run's measurements by `tides imu`, the last sample first; none if the path has no acceleration, or the scene no
    unit."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            session.write_imu(os.path.join(folder, "imu.npz"))
        except TidesError as error:
            warn(f"no IMU: {error}")
            return []
        with np.load(os.path.join(folder, "imu.npz")) as made:
            return list(zip(made["t"].tolist(), made["angular_rate"], made["specific_force"]))[::-1]


class Follower:
    """A live run whose camera has the poses of PoseStamped messages. With `twists` its velocities are those of the TwistStamped of the
    same stamp, in world axes. `axes`: the axes of the poses, a key of CAMERA_AXES. The run begins at the first pose, whose stamp
    becomes time.start; stamps of events are of the same clock. An invalid pose, or one more than `gap_s` after the pose before, is
    left out with a warning. If the second pose is that far from the first, their clocks differ: the run begins anew there."""

    def __init__(self, node: Node, twists: bool = False, axes: str = "opencv", gap_s: float = GAP_S, **how: Any):
        camera_quaternion((1, 0, 0, 0), axes)  # raises for an unknown name
        self.node, self.axes, self.gap_s, self._twisted = node, axes, gap_s, twists
        self.live, self._how = Live(node.session, **how), how
        self._poses = node.bus.reader(f"{node.name}/pose", messages.PoseStamped)
        self._twists = node.bus.reader(f"{node.name}/twist", messages.TwistStamped) if twists else None
        self._waiting: tuple[dict[int, Any], dict[int, Any]] = ({}, {})
        self._first: int | None = None
        self._wait = WaitSet(node.bus.participant)
        mask = SampleState.NotRead | ViewState.Any | InstanceState.Alive
        for reader in filter(None, (self._poses, self._twists)):
            self._wait.attach(ReadCondition(reader, mask))

    def spin(self, timeout_s: float) -> int:
        """Waits at most `timeout_s` for messages, and steps to each complete pose. Returns the number of events."""
        self._wait.wait(duration(seconds=timeout_s))
        poses, twists = self._waiting
        for reader, kept in ((self._poses, poses), (self._twists, twists)):
            for message in reader.take(DEPTH) if reader else ():
                if type(message).__name__ != "InvalidSample":
                    kept[messages.nanoseconds(message.header.stamp)] = message
        count = 0
        for ns in sorted(poses):
            if self._twisted and ns not in twists:
                if not any(later > ns for later in twists):
                    break  # its twist hasn't arrived
                warn(f"pose at {ns / _SECOND:.9g} s: no twist has its stamp; it is left out")
                del poses[ns]
                continue
            count += self._step(ns, poses.pop(ns), twists.pop(ns, None))
        for ns in [one for one in twists if self._first is not None and one < self._reached()]:
            del twists[ns]
        return count

    def _reached(self) -> int:
        return round(_SECOND * self.live.time) + self.node.shift_ns

    def _step(self, ns: int, pose: Any, twist: Any) -> int:
        p, q = pose.pose.position, pose.pose.orientation
        told: tuple[Any, ...] = ((p.x, p.y, p.z), camera_quaternion((q.w, q.x, q.y, q.z), self.axes))
        if twist:
            v, w = twist.twist.linear, twist.twist.angular
            told = (*told, (v.x, v.y, v.z), (w.x, w.y, w.z))
        try:
            events = self._tell(ns, told)
        except OutOfRange:  # the scene's motion ends, and so does the run
            raise
        except (BadArgument, ValueError) as error:  # NaN, no rotation, half a turn, a jump: the run is unchanged
            warn(f"pose at {ns / _SECOND:.9g} s is left out: {error}")
            events = None
        if events is None:
            return 0
        self.node.pictures(self.live.time, Trajectory.static(told[0], told[1]))
        self.node.events(events, round(_SECOND * self.live.time))
        return len(events)

    def _tell(self, ns: int, told: tuple[Any, ...]) -> np.ndarray | None:
        """Moves to a pose and returns the events up to it; None for the first pose, at which the run begins."""
        if self._first is None:
            self.live.tell(told, self.live.time)
            self._first, self.node.shift_ns = ns, ns - round(_SECOND * self.live.time)
            return None
        start = self.node.session.values.start
        ahead = start + (ns - self._first) / _SECOND - self.live.time
        if self.live.time == start and abs(ahead) > self.gap_s:
            warn(f"the first pose, at {self._first / _SECOND:.9g} s, is of another clock: the run begins at {ns / _SECOND:.9g} s")
            self.live.close()
            self.live, self._first = Live(self.node.session, **self._how), None
            return self._tell(ns, told)
        if ahead <= 0:
            raise ValueError("the run is past it")
        if ahead > self.gap_s:
            raise ValueError(f"it is {ahead:.3g} s after the one before, and at most {self.gap_s:g} s are run (--gap)")
        return self.live.step(told, ahead)

    def close(self) -> None:
        self.live.close()


# -- the command ----------------------------------------------------------------------------------------------------------


def options() -> argparse.ArgumentParser:
    made = argparse.ArgumentParser("python -m tides.ros2", description="A run on ROS 2's topics, without ROS.")
    made.add_argument("run", help="run file")
    made.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="override a key of the run file; may be repeated")
    made.add_argument("--name", default="event_camera", help="what topics begin with (event_camera)")
    made.add_argument("--frame", default="event_camera", help="frame_id of all messages (event_camera)")
    made.add_argument("--images", type=float, default=0, metavar="HZ", help="pictures a second of the run's time (0: none)")
    made.add_argument("--speed", type=float, default=1, help="of time, along the run's path; 0: as fast as it goes (1)")
    made.add_argument("--period", type=float, default=PERIOD_S, metavar="S", help="of packets, along the run's path [s] (0.01)")
    made.add_argument("--poses", action="store_true", help="the camera is where NAME/pose says (PoseStamped)")
    made.add_argument("--twists", action="store_true", help="and as fast as NAME/twist says (TwistStamped of the same stamp)")
    made.add_argument("--axes", default="opencv", help="of the poses' frame: opencv, opengl or robot (opencv)")
    made.add_argument("--gap", type=float, default=GAP_S, metavar="S", help=f"with --poses: leave later ones out ({GAP_S:g})")
    made.add_argument("--silence", type=float, metavar="S", help="with --poses: end where none comes for so long (never)")
    made.add_argument("--no-clock", action="store_true", help="no /clock; with --poses there is none anyway")
    made.add_argument("--domain", type=int, help="ROS domain (ROS_DOMAIN_ID, else 0)")
    made.add_argument("--loopback", action="store_true", default=None, help="this machine alone (as ROS_LOCALHOST_ONLY says)")
    made.add_argument("--device", metavar="SPEC", help="auto, cpu, gpu, reference, an index or a name (else TIDES_DEVICE)")
    made.add_argument("--wait", type=float, default=0, metavar="S", help="for a subscriber of the events, so long at most (0)")
    return made


def follow(follower: Follower, silence_s: float | None) -> int:
    """Follows poses until none came for `silence_s`."""
    count, heard = 0, time.monotonic()
    while silence_s is None or time.monotonic() - heard < silence_s:
        before = follower.live.time, follower._first
        count += follower.spin(0.1)
        if (follower.live.time, follower._first) != before:
            heard = time.monotonic()
    return count


def check(given: argparse.Namespace) -> None:
    """Raises ValueError for an option out of range."""
    for name, value, fine in [
        ("speed", given.speed, given.speed >= 0), ("images", given.images, given.images >= 0), ("period", given.period, given.period > 0),
        ("gap", given.gap, given.gap > 0), ("silence", given.silence or 0.0, given.silence is None or given.silence > 0),
    ]:  # fmt: skip
        if not (fine and math.isfinite(value)):
            raise ValueError(f"--{name} {value:g}: a number {'of at least' if name in ('speed', 'images') else 'above'} 0 is needed")
    if not re.fullmatch(r"/?[A-Za-z_]\w*(/[A-Za-z_]\w*)*", given.name, re.ASCII):
        raise ValueError(f"--name {given.name!r}: ROS' topics begin with letters, digits and _, with / between")


def run(given: argparse.Namespace) -> int:
    check(given)
    settings: dict[str, str] = {}
    for one in given.set:
        key, equals, value = one.partition("=")
        if not equals:
            raise ValueError(f"--set {one}: KEY=VALUE is needed")
        settings[key] = value
    session = Session(given.run, settings, given.device)
    bus = Bus(given.domain, given.loopback)
    node = Node(session, bus, given.name, given.frame, given.images, not (given.no_clock or given.poses))
    until = time.monotonic() + given.wait
    while time.monotonic() < until and not node._events.get_matched_subscriptions():
        time.sleep(0.01)
    if not given.poses:
        return play(node, given.speed, given.period)
    follower = Follower(node, given.twists, given.axes, given.gap)
    print("waiting for poses", flush=True)
    try:
        return follow(follower, given.silence)
    finally:
        follower.close()


def main(arguments: Iterable[str] | None = None) -> None:
    given = options().parse_args(None if arguments is None else list(arguments))
    try:
        print(f"{run(given)} events")
    except (TidesError, ValueError, OSError, DDSException) as error:
        sys.exit(f"tides.ros2: {error}")
    except KeyboardInterrupt:
        pass


if __name__ == "__main__":
    main()
