"""Small datasets in every layout, each with a feature that is difficult for a layout, and the renderer's values at their
times."""

import json
from types import SimpleNamespace

import numpy as np
import tides

METRES, LENGTH = 0.5, 0.1
PICTURE_HZ, TRUTH_HZ = 40, 20
LAYOUTS = [one.name for one in tides.dataset_layouts()]


def mount(x, yaw):
    """A camera to the right of the body's, turned to it."""
    made = np.eye(4)
    made[:3, :3] = [[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]]
    made[0, 3] = x
    return made.tolist()


def rig(yaw=0.0):
    return {"rig.cameras": [{"name": "left"}, {"name": "right", "T_B_C": mount(0.1, yaw)}]}


RADTAN = {"camera.lens": "radtan", "camera.k1": -0.15, "camera.k2": 0.02, "camera.p1": 0.002, "camera.p2": -0.001}
LATE = 1_000_000_000
PIXEL = {f"camera.{key}": value for key, value in dict(width=1, height=1, fx=30, fy=30, cx=0.5, cy=0.5).items()}
SENSITIVE = {"sensor.threshold_on": 0.01, "sensor.threshold_off": 0.01}
WORLDS = {
    "rig": rig(),
    "lens": {**rig(yaw=-0.05), **RADTAN},
    "one": {},
    "pixel": {**PIXEL, **SENSITIVE},
    "none": {"sensor.threshold_on": 50, "sensor.threshold_off": 50},
    "moving": {"scene.file": "moving.h5"},
    "late": {"camera.start_s": 1 - LATE, "time.start": LATE, "time.stop": LATE + LENGTH},
}


def save_run(folder):
    random = np.random.default_rng(3)
    cloud = tides.Gaussians.from_colours(
        random.uniform(-1, 1, (60, 3)), random.uniform(0.15, 0.3, (60, 3)), random.uniform(0, 1, (60, 3))
    )
    scene = tides.Scene()
    scene.add(cloud, name="cloud")
    scene.save(folder / "cloud.h5")
    place = random.normal(size=(300, 3))
    place *= 0.4 / np.linalg.norm(place, axis=1, keepdims=True)  # small splats on a ball: each moves as its points do
    ball = tides.Gaussians.from_colours(place, np.full((300, 3), 0.06), random.uniform(0, 1, (300, 3)))
    scene.add(ball, tides.Trajectory.orbit(target=(0, 1, 0), radius=1, angular_speed=-3, start=1, stop=1.2), name="ball")
    scene.save(folder / "moving.h5")
    path = tides.Trajectory.orbit(radius=4, angular_speed=2, start=1, stop=1 + LENGTH + 0.01)
    tides.Camera(path, tides.Intrinsics.from_fov(24, 18, 0.6)).save(folder / "path.json")
    run = {
        "scene": {"file": "cloud.h5", "metres_per_unit": METRES},
        "camera": {"file": "path.json"},
        "time": {"start": 1, "stop": 1 + LENGTH},
        "stepping": {"step_s": 0.01},
        "tracks": {"count": 50},
        "dataset": {"picture_hz": PICTURE_HZ, "truth_hz": TRUTH_HZ},
        "imu": {"down": [0, 1, 0]},
    }
    (folder / "run.json").write_text(json.dumps(run))


def make(folder, name):
    """The dataset's folder; of each side its events; of the left camera truth, displacements and poses."""
    settings = WORLDS[name]
    sides = ["left", "right"] if "rig.cameras" in settings else ["left"]
    with tides.Session(folder / "run.json", settings, device="reference-f32") as session:
        session.dataset(folder / name, LAYOUTS)
        start, events = session.values.start, {"left": session.simulate()}
        if len(sides) > 1:
            with session.vary({"rig.camera": "right"}) as other:
                events["right"] = other.simulate()
        us = [round(1e6 * start) + 50000 * k for k in range(3)]
        times = [one / 1e6 for one in us]
        same = {"tracks.rate_hz": PICTURE_HZ, "tracks.count": 50, "time.stop": us[2] / 1e6}
        with session.vary(same) as other:
            other.write_tracks(folder / f"{name}.npz")
            tracks = dict(np.load(folder / f"{name}.npz"))
        with session.renderer() as renderer:
            truth = [renderer.truth(t) for t in times]
            forward = [renderer.displacement(a, b) for a, b in zip(times, times[1:])]
            backward = [renderer.displacement(b, a) for a, b in zip(times, times[1:])]
        poses = [session.camera.trajectory.at(t) for t in times]
        lens = session.intrinsics
    return SimpleNamespace(**{key: value for key, value in locals().items() if key not in ("session", "renderer", "other")})


def camera_folder(world, layout, side):
    """Where a layout that is of one camera has it."""
    return world.folder / world.name / layout / (side if len(world.sides) > 1 else "")
