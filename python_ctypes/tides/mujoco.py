"""A live run in MuJoCo's loop: bodies and a camera of an mjModel are where objects and camera of a scene are.

    import mujoco, tides.mujoco
    model = mujoco.MjModel.from_xml_path("throw.xml")
    data = mujoco.MjData(model)
    with tides.mujoco.Loop("run.json", model, data, camera="eye", bodies={"ball": "ball"}) as loop:
        while data.time < 1:
            mujoco.mj_step(model, data)
            events = loop.step()          # what fired since the last step; act on it: data.ctrl[:] = ...

MuJoCo knows positions, orientations and velocities at each of its steps, and all of them are told: between steps the paths are the
cubics through both. It needs the mujoco package: pip install tides[mujoco].
"""

from __future__ import annotations

import os
from typing import Any, Mapping

import numpy as np

try:
    import mujoco
except ImportError as missing:
    raise ImportError("tides.mujoco needs the mujoco package: pip install tides[mujoco]") from missing

from .live import Live, _quaternion, camera_quaternion
from .trajectory import Camera, Intrinsics, Trajectory

_FIXED = mujoco.mjtCamLight.mjCAMLIGHT_FIXED


class Poses:
    """Poses and velocities of an mjModel's bodies and cameras, in a scene's frame and units. `frame`: the scene frame's pose
    in MuJoCo's world (position [m], quaternion wxyz). The simulation's mjData is only read: after mj_step it still has the
    poses before the step, so that new ones are computed in a copy."""

    def __init__(self, model: Any, data: Any, metres_per_unit: float, frame: tuple[Any, Any] = ((0, 0, 0), (1, 0, 0, 0))):
        if not metres_per_unit > 0:
            raise ValueError(f"metres_per_unit: {metres_per_unit}, where a length above 0 is needed")
        self.model, self.data, self.metres_per_unit = model, data, float(metres_per_unit)
        self._own = mujoco.MjData(model)
        self._origin, self._turn = np.asarray(frame[0], float), _matrix(frame[1]).T
        self.update()

    def update(self) -> None:
        """Computes poses for the simulation's present state."""
        own, data = self._own, self.data
        own.qpos[:], own.qvel[:] = data.qpos, data.qvel
        own.mocap_pos[:], own.mocap_quat[:] = data.mocap_pos, data.mocap_quat
        for stage in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_camlight, mujoco.mj_comVel):
            stage(self.model, own)

    def body(self, name: str | int) -> tuple[Any, ...]:
        """(position, quaternion, velocity, angular velocity) of a body's frame, in the form that `Live` takes."""
        number = _number(self.model, mujoco.mjtObj.mjOBJ_BODY, name)
        # XBODY: a body's own frame. BODY: its frame of inertia, whose origin is the centre of mass.
        velocity = self._velocity(mujoco.mjtObj.mjOBJ_XBODY, number)
        return (*self._place(self._own.xpos[number], self._own.xmat[number]), *velocity)

    def camera(self, name: str | int) -> tuple[Any, ...]:
        """Pose and velocities of a camera, in the form that `Live` takes, with OpenCV's axes: MuJoCo's cameras look along -z,
        with y up. A camera that follows something (its mode isn't "fixed") has no velocity in MuJoCo, and gets none
        here."""
        number = _number(self.model, mujoco.mjtObj.mjOBJ_CAMERA, name)
        position, quaternion = self._place(self._own.cam_xpos[number], self._own.cam_xmat[number])
        pose = position, camera_quaternion(quaternion, "opengl")
        if self.model.cam_mode[number] != _FIXED:
            return pose
        return (*pose, *self._velocity(mujoco.mjtObj.mjOBJ_CAMERA, number))

    def _place(self, position: Any, matrix: Any) -> tuple[Any, Any]:
        there = self._turn @ (np.asarray(position) - self._origin) / self.metres_per_unit
        return there, _quaternion(self._turn @ np.reshape(matrix, (3, 3)))

    def _velocity(self, kind: Any, number: int) -> tuple[Any, Any]:
        both = np.empty(6)  # angular [rad/s], then linear [m/s], in world axes
        mujoco.mj_objectVelocity(self.model, self._own, kind, number, both, 0)
        return self._turn @ both[3:] / self.metres_per_unit, self._turn @ both[:3]


class Loop:
    """A `Live` run beside a simulation, with equal clocks: the run's time.start is the simulation's present time. `camera`:
    the mjModel's camera for the run (None: the run's own path); `bodies`: {object of the scene: body}. `metres_per_unit`:
    length of a scene unit; None: scene.metres_per_unit. `frame`: as in `Poses`. `how` is passed to Live: device, keep,
    stop, max_speed ... `live` is that run; with keep=True live.path() has the whole path."""

    def __init__(
        self,
        run: Any,
        model: Any,
        data: Any,
        camera: str | int | None = None,
        bodies: Mapping[str, str | int] | None = None,
        set: dict[str, Any] | None = None,
        *,
        metres_per_unit: float | None = None,
        frame: tuple[Any, Any] = ((0, 0, 0), (1, 0, 0, 0)),
        **how: Any,
    ):
        self._camera, self._bodies, self._began = camera, dict(bodies or {}), float(data.time)
        self.live = Live(run, set, camera=camera is not None, objects=self._bodies, **how)
        try:
            self.poses = Poses(model, data, _unit(self.live, metres_per_unit), frame)
            pose, objects = self._now()
            start = self.live.time
            if pose is not None:
                self.live.tell(pose, start)
            for name, one in objects.items():
                self.live.tell(one, start, name)
        except BaseException:
            self.live.close()
            raise
        self._start = start

    def _now(self) -> tuple[Any, dict[str | int, Any]]:
        pose = None if self._camera is None else self.poses.camera(self._camera)
        return pose, {name: self.poses.body(body) for name, body in self._bodies.items()}

    def step(self) -> np.ndarray:
        """The events up to the simulation's time, as EVENT (n). Call it after each mj_step, or after several, which are then
        one step of the run. ValueError if the simulation's clock stood still or went back, as by mj_resetData."""
        ahead = float(self.poses.data.time) - self._began - (self.live.time - self._start)
        if not ahead > 0:
            raise ValueError(
                f"the simulation is at {self.poses.data.time:.9g} s and the run at {self._began + self.live.time - self._start:.9g} s "
                "of its clock: step it first; after mj_resetData make another Loop"
            )
        self.poses.update()
        pose, objects = self._now()
        return self.live.step(pose, ahead, objects)

    def close(self) -> None:
        self.live.close()

    def __enter__(self) -> "Loop":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


def intrinsics(model: Any, camera: str | int, width: int | None = None, height: int | None = None) -> Intrinsics:
    """A camera's lens: from its fovy, or from sensorsize and focal length if the model has them; in its own resolution, or in
    width x height [px]."""
    number = _number(model, mujoco.mjtObj.mjOBJ_CAMERA, camera)
    own = model.cam_resolution[number]
    w, h = int(width or own[0]), int(height or own[1])
    if width is None and height is None and w == h == 1:
        raise ValueError(f"camera {camera!r}: the model gives it no resolution; say width and height")
    sensor, (fx, fy, cx, cy) = model.cam_sensorsize[number], model.cam_intrinsic[number]
    if sensor[1] > 0:  # lengths on the sensor [m]; all of it is seen: an image of another shape is stretched
        across, down = w / sensor[0], h / sensor[1]
        return Intrinsics(width=w, height=h, fx=fx * across, fy=fy * down, cx=w / 2 - cx * across, cy=h / 2 - cy * down)
    focal = 0.5 * h / np.tan(0.5 * np.radians(model.cam_fovy[number]))
    return Intrinsics(width=w, height=h, fx=focal, fy=focal, cx=0.5 * w, cy=0.5 * h)


def write_camera(
    file: str | os.PathLike[str], poses: Poses, camera: str | int, width: int | None = None, height: int | None = None
) -> None:
    """Writes a path file for a run's camera.file: the camera's present pose, with its lens."""
    position, quaternion = poses.camera(camera)[:2]
    Camera(Trajectory.static(position, quaternion), intrinsics(poses.model, camera, width, height)).save(file)


def _unit(live: Live, given: float | None) -> float:
    said = live.session.values.metres_per_unit
    if given is None and not said > 0:  # also NaN
        raise ValueError("metres_per_unit: the run has no scene.metres_per_unit; set it there, or give it here (1: a unit is a metre)")
    if given is not None and said > 0 and given != said:
        raise ValueError(f"metres_per_unit: {given:g} is given, and the run's scene.metres_per_unit is {said:g}")
    return float(said if given is None else given)


def _number(model: Any, kind: Any, name: str | int) -> int:
    count = model.nbody if kind == mujoco.mjtObj.mjOBJ_BODY else model.ncam
    number = mujoco.mj_name2id(model, kind, name) if isinstance(name, str) else int(name)
    if not 0 <= number < count:
        what = "body" if kind == mujoco.mjtObj.mjOBJ_BODY else "camera"
        names = [mujoco.mj_id2name(model, kind, index) for index in range(count)]
        raise ValueError(f"{what}: the model has no {name!r}; it has {', '.join(map(repr, names)) or 'none'}")
    return number


def _matrix(quaternion: Any) -> np.ndarray:
    """The rotation of a quaternion (wxyz)."""
    made, given = np.empty(9), np.asarray(quaternion, np.float64)
    if not (given.shape == (4,) and abs(given @ given - 1) < 1e-6):
        raise ValueError(f"frame: quaternion {quaternion!r}, where four numbers (wxyz) of length 1 are needed")
    mujoco.mju_quat2Mat(made, given)
    return made.reshape(3, 3)
