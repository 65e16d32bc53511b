"""Flies a camera by keys and mouse: a body whose velocities follow the controls smoothly, so that its path has no corners.

The camera has OpenCV's axes: x right, y down, z forward. Angular velocities are in world axes [rad/s], as in poses."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..live import _angular, _quaternion
from ..trajectory import Pose

FASTEST_TURN = 4.0  # [rad/s]
KEY_TURN = 0.15  # [rad/s] by a key; with Shift three times that
MOST_LOOK = 1.0  # [rad] greatest lead of the mouse over the camera
UPRIGHT = math.cos(math.radians(8))  # limit of looking straight up or down


@dataclass
class Controls:
    """A pilot's controls: `move` (3) along the camera's axes and `turn` (3: right, down, clockwise), each -1 to 1; `look` (2)
    [rad]: movement of the mouse to the right and down since the last step; `fast`; `orbit`: circle about the scene."""

    move: Any = (0.0, 0.0, 0.0)
    turn: Any = (0.0, 0.0, 0.0)
    look: Any = (0.0, 0.0)
    fast: bool = False
    orbit: bool = True

    @property
    def idle(self) -> bool:
        return not (any(self.move) or any(self.turn) or any(self.look))


def rotation(turned: np.ndarray) -> np.ndarray:
    """The rotation by |turned| about `turned` (3) [rad]: Rodrigues' formula."""
    angle = float(np.linalg.norm(turned))
    x, y, z = turned / angle if angle > 0 else turned
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * (cross @ cross)


class Flight:
    """A camera that begins at `pose`. It circles about `centre` with `up` as the axis; `speed` [scene units/s] is full speed."""

    def __init__(self, pose: Pose, centre: Any, up: Any, speed: float, orbit_rate: float):
        self.rotation, self.position = np.array(pose.rotation), np.array(pose.position)
        self.velocity, self.angular = np.array(pose.position_dot), _angular(pose)
        self.centre, self.up = np.array(centre, float), np.array(up, float) / np.linalg.norm(up)
        self.speed, self.orbit_rate = speed, orbit_rate
        self._look = np.zeros(2)

    def pose(self) -> tuple[Any, ...]:
        """The camera's pose in the form that `Live` takes."""
        return self.position, _quaternion(self.rotation), self.velocity, self.angular

    def step(self, controls: Controls, dt: float, response: float) -> tuple[Any, ...]:
        """Advances by `dt` [s]; velocities follow the controls within `response` [s]."""
        self._look = np.clip(self._look + controls.look, -MOST_LOOK, MOST_LOOK)
        if controls.orbit and controls.idle:
            return self._circle(dt)
        share = 1 - math.exp(-dt / response)
        wanted = self.rotation @ (np.array(controls.move, float) * self.speed * (3 if controls.fast else 1))
        velocity = self.velocity + share * (wanted - self.velocity)
        angular = self.angular + share * (self._turning(controls, response) - self.angular)
        self.position = self.position + 0.5 * dt * (self.velocity + velocity)
        turned = 0.5 * dt * (self.angular + angular)
        self.rotation = _orthonormal(rotation(turned) @ self.rotation)
        self.velocity, self.angular = velocity, angular
        return self.pose()

    def _turning(self, controls: Controls, response: float) -> np.ndarray:
        """The angular velocity that the controls ask for: about `up`, the camera's right and its forward axis."""
        rates = self._look / (2 * response)
        self._look = self._look * 0.5
        keys = np.array(controls.turn, float) * KEY_TURN * (3 if controls.fast else 1)
        yaw, pitch = np.clip(rates + keys[:2], -FASTEST_TURN, FASTEST_TURN)
        right, forward = self.rotation[:, 0], self.rotation[:, 2]
        height = float(forward @ self.up)
        if (height > UPRIGHT and pitch < 0) or (height < -UPRIGHT and pitch > 0):
            pitch = 0.0
        made: np.ndarray = -yaw * self.up - pitch * right + keys[2] * forward
        return made

    def _circle(self, dt: float) -> tuple[Any, ...]:
        """Advances on a circle about the scene, exactly, so that it closes."""
        self.angular = self.orbit_rate * self.up
        turn = rotation(dt * self.angular)
        self.position = self.centre + turn @ (self.position - self.centre)
        self.rotation = _orthonormal(turn @ self.rotation)
        self.velocity = np.cross(self.angular, self.position - self.centre)
        self._look[:] = 0
        return self.pose()


def _orthonormal(made: np.ndarray) -> np.ndarray:
    """The nearest rotation matrix: products of rotations drift away from one."""
    u, _, v = np.linalg.svd(made)
    nearest: np.ndarray = u @ v
    return nearest
