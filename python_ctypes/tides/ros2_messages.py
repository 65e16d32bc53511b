"""ROS 2's messages as DDS has them, for tides.ros2: builtin_interfaces, std_msgs, geometry_msgs, sensor_msgs, rosgraph_msgs, and
event_camera_msgs. Types are pkg::msg::dds_::Name_."""

# No postponed annotations: they are needed when the classes are made.
import sys
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final
from cyclonedds.idl.types import array, float64, int32, sequence, uint8, uint32, uint64

_SECOND = 1_000_000_000


def _name(kind: str) -> str:
    package, name = kind.split("/")
    return f"{package}::msg::dds_::{name}_"


def _with_bytes(message: Any, last: str, use_version_2: Any) -> bytes:
    """A message whose last member is bytes, appended as one block: cyclonedds handles single bytes, half a microsecond each.
    An empty sequence is its count alone, 4 bytes."""
    data = bytes(getattr(message, last))
    rest = IdlStruct.serialize(replace(message, **{last: b""}), use_version_2=use_version_2)
    return rest[:-4] + len(data).to_bytes(4, sys.byteorder) + data


@dataclass
@final
class Time(IdlStruct, typename=_name("builtin_interfaces/Time")):
    sec: int32
    nanosec: uint32


@dataclass
@final
class Clock(IdlStruct, typename=_name("rosgraph_msgs/Clock")):
    clock: Time


@dataclass
@final
class Header(IdlStruct, typename=_name("std_msgs/Header")):
    stamp: Time
    frame_id: str


@dataclass
@final
class Point(IdlStruct, typename=_name("geometry_msgs/Point")):
    x: float64
    y: float64
    z: float64


@dataclass
@final
class Vector3(IdlStruct, typename=_name("geometry_msgs/Vector3")):
    x: float64
    y: float64
    z: float64


@dataclass
@final
class Quaternion(IdlStruct, typename=_name("geometry_msgs/Quaternion")):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
@final
class Pose(IdlStruct, typename=_name("geometry_msgs/Pose")):
    position: Point
    orientation: Quaternion


@dataclass
@final
class PoseStamped(IdlStruct, typename=_name("geometry_msgs/PoseStamped")):
    header: Header
    pose: Pose


@dataclass
@final
class Twist(IdlStruct, typename=_name("geometry_msgs/Twist")):
    linear: Vector3
    angular: Vector3


@dataclass
@final
class TwistStamped(IdlStruct, typename=_name("geometry_msgs/TwistStamped")):
    header: Header
    twist: Twist


@dataclass
@final
class Image(IdlStruct, typename=_name("sensor_msgs/Image")):
    header: Header
    height: uint32
    width: uint32
    encoding: str
    is_bigendian: uint8
    step: uint32
    data: sequence[uint8]

    def serialize(self, buffer: Any = None, endianness: Any = None, use_version_2: Any = None) -> bytes:
        return _with_bytes(self, "data", use_version_2)


@dataclass
@final
class RegionOfInterest(IdlStruct, typename=_name("sensor_msgs/RegionOfInterest")):
    x_offset: uint32
    y_offset: uint32
    height: uint32
    width: uint32
    do_rectify: bool


@dataclass
@final
class CameraInfo(IdlStruct, typename=_name("sensor_msgs/CameraInfo")):
    header: Header
    height: uint32
    width: uint32
    distortion_model: str
    d: sequence[float64]
    k: array[float64, 9]
    r: array[float64, 9]
    p: array[float64, 12]
    binning_x: uint32
    binning_y: uint32
    roi: RegionOfInterest


@dataclass
@final
class Imu(IdlStruct, typename=_name("sensor_msgs/Imu")):
    header: Header
    orientation: Quaternion
    orientation_covariance: array[float64, 9]
    angular_velocity: Vector3
    angular_velocity_covariance: array[float64, 9]
    linear_acceleration: Vector3
    linear_acceleration_covariance: array[float64, 9]


@dataclass
@final
class EventPacket(IdlStruct, typename=_name("event_camera_msgs/EventPacket")):
    header: Header
    height: uint32
    width: uint32
    seq: uint64
    time_base: uint64
    encoding: str
    is_bigendian: bool
    events: sequence[uint8]

    def serialize(self, buffer: Any = None, endianness: Any = None, use_version_2: Any = None) -> bytes:
        return _with_bytes(self, "events", use_version_2)


# -- from values, and back --------------------------------------------------------------------------------------------------


def stamp(ns: int) -> Time:
    if not 0 <= ns < 2**31 * _SECOND:
        raise ValueError(f"ROS' clock has no {ns / _SECOND:.9g} s: it goes from 0 to 2^31 s; begin the run later (time.start)")
    return Time(ns // _SECOND, ns % _SECOND)


def nanoseconds(time: Any) -> int:
    return int(time.sec) * _SECOND + int(time.nanosec)


def header(ns: int, frame: str) -> Header:
    return Header(stamp(ns), frame)


def camera_info(of: Header, lens: Any) -> CameraInfo:
    """A lens in ROS' terms. Pixel centres are whole numbers in ROS, so that the principal point is half a pixel less."""
    cx, cy, bent = lens.cx - 0.5, lens.cy - 0.5, lens.lens
    if bent.model == "equidistant":
        model, numbers = "equidistant", [bent.k1, bent.k2, bent.k3, bent.k4]
    else:  # a pinhole has no coefficients
        model = "plumb_bob"
        numbers = [] if bent.model == "none" else [bent.k1, bent.k2, bent.p1, bent.p2, bent.k3]
    k = [lens.fx, 0.0, cx, 0.0, lens.fy, cy, 0.0, 0.0, 1.0]
    p = [lens.fx, 0.0, cx, 0.0, 0.0, lens.fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0]
    same = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
    return CameraInfo(of, lens.height, lens.width, model, numbers, k, same, p, 0, 0, RegionOfInterest(0, 0, 0, 0, False))


def imu(of: Header, rate: Any, force: Any) -> Imu:
    """Angular rate (3) [rad/s] and specific force (3) [m/s^2]; no orientation, for which ROS' mark is -1."""
    unknown = [0.0] * 9
    turns, goes = (Vector3(*(float(one) for one in values)) for values in (rate, force))
    return Imu(of, Quaternion(0.0, 0.0, 0.0, 1.0), [-1.0] + [0.0] * 8, turns, unknown, goes, unknown)


def evt3(t: np.ndarray, x: np.ndarray, y: np.ndarray, p: np.ndarray) -> bytes:
    """Events in order of t [ns] as EVT 3 words, rounded down to microseconds: each packet can be decoded alone. Words are
    TIME_HIGH 0x8 and TIME_LOW 0x6 (12 bits each), ADDR_Y 0x0, ADDR_X 0x2 with the polarity in bit 11."""
    if len(x) and (int(x.max()) > 2047 or int(y.max()) > 2047):
        raise ValueError("EVT 3 has 11 bits for x and y: this sensor has more than 2048 pixels a side")
    us = t // 1000

    def changes(values: np.ndarray) -> np.ndarray:
        return np.concatenate([[True], values[1:] != values[:-1]]) if len(values) else np.empty(0, bool)

    words = np.stack(
        [0x8000 | (us >> 12) & 0xFFF, 0x6000 | us & 0xFFF, y.astype(np.int64), 0x2000 | (p > 0) * 0x800 | x.astype(np.int64)], 1
    )
    wanted = np.stack([changes(us >> 12), changes(us), changes(y), np.ones(len(us), bool)], 1)
    return bytes(words[wanted].astype("<u2").tobytes())
