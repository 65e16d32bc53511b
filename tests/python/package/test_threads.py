"""Simulations in threads, and Ctrl-C within one."""

import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
import tides
from conftest import again


def in_threads(*works):
    results = [None] * len(works)

    def run(index):
        results[index] = works[index]()

    threads = [threading.Thread(target=run, args=(index,)) for index in range(len(works))]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return results


def test_threads_of_a_device(scene, camera):
    """As many as it is told, and the same events."""
    one, three = tides.Device("reference-f32", threads=1), tides.Device("reference-f32", threads=3)
    assert (one.threads, three.threads) == (1, 3)
    assert tides.Device("reference-f32", threads=0).threads == 0  # as many as there are processors
    made = [again(scene, camera, device=device).run() for device in (one, three)]
    assert len(made[0]) > 1000 and made[0].tobytes() == made[1].tobytes()


@pytest.mark.parametrize("device", ["reference", "auto"])
def test_two_threads_give_the_same(scene, camera, device):
    """Each its own device, and both on one: calls then take turns."""
    if device == "auto" and not tides.devices():
        pytest.skip("no OpenCL device")
    one = again(scene, camera, device=device).run()
    assert len(one) > 1000
    shared = tides.Device(device)
    for spec in (device, shared):
        simulations = [again(scene, camera, device=spec) for _ in range(2)]
        for events in in_threads(*(simulation.run for simulation in simulations)):
            assert np.array_equal(events, one)
    simulation = again(scene, camera, device=device)
    halves = in_threads(simulation.run, simulation.run)  # one object: the first takes all
    assert sorted(len(half) for half in halves) == [0, len(one)]


def test_other_threads_run_meanwhile(scene, camera):
    """The GIL is released: a counting thread gets on while C simulates, in one of many runs where the machine is busy."""
    count, done = [0], threading.Event()

    def counting():
        while not done.is_set():
            count[0] += 1
            time.sleep(1e-4)

    def counted():
        simulation, before = again(scene, camera), count[0]
        simulation.run()
        return count[0] - before

    thread = threading.Thread(target=counting)
    thread.start()
    try:
        assert any(counted() > 5 for _ in range(50))
    finally:
        done.set()
        thread.join()


def test_cancel_from_another_thread(scene, camera):
    long = tides.Camera(tides.Trajectory.orbit(radius=4, angular_speed=1, stop=100), camera.intrinsics)
    simulation = again(scene, long)
    threading.Timer(0.3, simulation.cancel).start()
    with pytest.raises(tides.errors.Cancelled):
        simulation.run()


def test_objects_of_one_device_take_turns(scene, camera):
    with tides.Device("reference") as device:
        first, second = (again(scene, camera, device=device) for _ in range(2))
        order, thread = [], []

        def step(fraction, stage):
            if not order:
                thread.append(threading.Thread(target=second.run, kwargs={"progress": lambda *_: order.append("second")}))
                thread[0].start()
            time.sleep(0.005)  # the other has time to come in between
            order.append("first")

        first.run(progress=step)
        thread[0].join()
        assert order == ["first"] * order.count("first") + ["second"] * order.count("second")
        assert "second" in order
        first.close()
        second.close()


# -- Ctrl-C ---------------------------------------------------------------------------------------------------------------
PROGRAM = """
import sys, time
import tides
from conftest import make_cloud, SIZE
scene = tides.Scene()
scene.add(make_cloud(400))
path = tides.Trajectory.orbit(radius=4, angular_speed=1, stop=600)
camera = tides.Camera(path, tides.Intrinsics.from_fov(*SIZE, 0.8))
simulation = tides.Simulation(scene, camera)
try:
    simulation.write(sys.argv[1], progress=lambda fraction, stage: print("step", flush=True) if fraction > 0.0001 else None)
except KeyboardInterrupt:
    print("stopped", time.monotonic(), time.process_time(), simulation.stats.simulated_s, simulation.stats.events, flush=True)
"""


def processor_time(process):
    """What a process has had of the processors [s]."""
    with open(f"/proc/{process}/stat") as file:
        user, system = file.read().rsplit(")", 1)[1].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


@pytest.mark.parametrize("ending", ["h5", "raw"])
def test_interrupt(tmp_path, ending):
    """A run of minutes stops within 0.5 s of Ctrl-C, by the clock of both processes or, where others are busy, of the processor;
    and leaves a readable file."""
    file = tmp_path / f"events.{ending}"
    here = os.path.dirname(os.path.abspath(__file__))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([here, os.environ.get("PYTHONPATH", "")])}
    process = subprocess.Popen([sys.executable, "-c", PROGRAM, file], stdout=subprocess.PIPE, text=True, env=environment)
    try:
        while process.stdout.readline() != "step\n":
            assert process.poll() is None
        time.sleep(0.3)
        sent, used = time.monotonic(), processor_time(process.pid)
        process.send_signal(signal.SIGINT)
        last = process.communicate(timeout=300)[0].splitlines()[-1].split()
    finally:
        process.kill()
    assert last[0] == "stopped" and process.returncode == 0
    took = float(last[1]) - sent, float(last[2]) - used
    print("stopped after", *took, "s")
    assert min(took) < 0.5
    assert float(last[3]) < 300 and not file.exists()
    part = tides.read_events(f"{file}.part")
    assert 0 < len(part) <= int(last[4])
    assert ending != "h5" or len(part) == int(last[4])
    assert (file.parent / (file.name + ".checkpoint")).exists() == (ending == "h5")
