"""Shared by the tests of the Python package: small worlds, and a count of the C functions that were called."""

import collections
import os
import signal

import numpy as np
import pytest
import tides

os.environ.setdefault("TIDES_DEVICE", "reference")  # where a test names none
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # in the background of a script; what tests start would ignore theirs too
    signal.signal(signal.SIGINT, signal.default_int_handler)

SIZE = (48, 36)
CALLS = collections.Counter()


def counted(name, function):
    def count(*arguments):
        CALLS[name] += 1
        return function(*arguments)

    return count


for one in tides.api.FUNCTIONS:
    setattr(tides.lib, one, counted(one, getattr(tides.lib, one)))


def make_cloud(n=150, seed=1):
    """Gaussians of random colours in a cube."""
    print("seed", seed)
    random = np.random.default_rng(seed)
    return tides.Gaussians.from_colours(
        random.uniform(-1, 1, (n, 3)), random.uniform(0.05, 0.2, (n, 3)), random.uniform(0, 1, (n, 3))
    )


@pytest.fixture
def cloud():
    return make_cloud()


@pytest.fixture
def scene(cloud):
    made = tides.Scene()
    made.add(cloud, name="cloud")
    return made


@pytest.fixture
def camera():
    path = tides.Trajectory.orbit(radius=4, angular_speed=2, start=0, stop=0.1)
    return tides.Camera(path, tides.Intrinsics.from_fov(*SIZE, 0.8))


@pytest.fixture
def simulation(scene, camera):
    return tides.Simulation(scene, camera, stepping=tides.Stepping(step_s=0.01))


@pytest.fixture
def events(simulation):
    return simulation.run()


def again(scene, camera, **more):
    return tides.Simulation(scene, camera, stepping=tides.Stepping(step_s=0.01), **more)
