"""Plain values, errors by kind, devices, run files."""

import inspect
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import tides

RUN = "tests/install/run.json"


def test_defaults_and_words():
    stepping = tides.Stepping(mode="fixed", step_s=0.02)
    assert (stepping.mode, stepping.model, stepping.step_s, stepping.risk.w_b) == ("fixed", "hermite", 0.02, 0.3)
    stepping.mode = tides.api.TIDES_STEPPING_RISK
    assert stepping.mode == "risk"
    stepping.risk.w_b = 0.5
    other = stepping.copy(model="linear")
    assert (other.risk.w_b, other.model, stepping.model) == (0.5, "linear", "hermite")
    assert other != stepping and other.copy(model="hermite") == stepping
    assert "mode='risk'" in repr(stepping) and stepping.to_dict().mode == "risk"
    image = tides.ImageParams(luminance=(1, 0, 0))
    assert image.luminance == (1, 0, 0) and image.size > 0
    assert tides.Sensor().refractory_law == "hold"


def test_wrong_names_and_words_are_refused():
    with pytest.raises(TypeError, match="did you mean 'threshold_on'"):
        tides.Sensor(treshold_on=1)
    with pytest.raises(AttributeError, match="did you mean 'threshold_on'"):
        tides.Sensor().treshold_on = 1
    with pytest.raises(AttributeError):
        tides.Sensor().size = 3
    with pytest.raises(ValueError, match="hermite"):
        tides.Stepping(model="hermit")
    with pytest.raises(ValueError):
        tides.Stepping(mode=77)
    with pytest.raises(TypeError):
        tides.Stepping(step_s="long")


def test_wrong_types_name_field_and_expectation():
    for fields, message in (
        ({"step_s": "long"}, "Stepping.step_s: 'long', where a number is needed"),
        ({"local": 1.5}, "Stepping.local: 1.5, where a whole number from -2147483648 to 2147483647 is needed"),
        ({"risk": 3}, "Stepping.risk: 3, where a tides_risk"),
    ):
        with pytest.raises(TypeError, match=message):
            tides.Stepping(**fields)
    with pytest.raises(ValueError, match=r"mode: \[1\] is none of fixed \(0\), risk"):
        tides.Stepping(mode=[1])
    with pytest.raises(TypeError, match="ImageParams.luminance: 1, where 3 times a number"):
        tides.ImageParams(luminance=1)
    with pytest.raises(ValueError, match="ImageParams.luminance: .*, where 3 times a number"):
        tides.ImageParams(luminance=(1, 0))  # ctypes would make the third 0
    with pytest.raises(ValueError, match="Sensor.seed: -1, where a whole number from 0 to 18446744073709551615"):
        tides.Sensor(seed=-1)  # ctypes would wrap it
    with pytest.raises(TypeError, match="tides_risk.w_b: 'much', where a number"):
        tides.Stepping().risk.w_b = "much"
    with pytest.raises(AttributeError, match="did you mean 'w_b'"):
        tides.Stepping().risk.wb = 0.5
    with pytest.raises(TypeError, match="FramesOptions.timestamps: 3, where a text"):
        tides.FramesOptions(timestamps=3)
    assert tides.Sensor(seed=np.uint64(2**63), threshold_on=np.float32(0.25)).seed == 2**63
    assert tides.ImageParams(luminance=np.array([0, 1, 0])).luminance == (0, 1, 0)


def test_wrong_arguments_name_themselves():
    run = tides.Run(RUN)
    scene, camera = run.open()
    renderer = tides.Renderer(scene, camera, device="reference")
    for wrong, message in (
        (lambda: tides.Simulation("room.ply", camera), "Simulation: scene: 'room.ply', where a Scene is needed"),
        (lambda: tides.Simulation(scene, camera.trajectory), "Simulation: camera: .*, where a Camera is needed"),
        (lambda: tides.Simulation(scene, camera, sensor=0.3), "Simulation: sensor: 0.3, where a Sensor is needed"),
        (lambda: tides.Simulation(scene, camera, stepping="error"), "Simulation: stepping: 'error', where a Stepping"),
        (lambda: tides.Simulation(scene, camera, readout=1), "Simulation: readout: 1, where a Readout is needed"),
        (lambda: tides.Renderer(scene, camera, image="inria"), "Renderer: image: 'inria', where an ImageParams is needed"),
        (lambda: tides.Camera("path.txt"), "Camera: trajectory: 'path.txt', where a Trajectory is needed"),
        (lambda: tides.Camera(camera.trajectory, (64, 48)), "Camera: intrinsics: .64, 48., where an Intrinsics is needed"),
        (lambda: renderer.frame("0.1"), "time: '0.1', where a number is needed"),
        (lambda: renderer.frame(0.01, trajectory=camera), "trajectory: Camera.*, where a Trajectory is needed"),
        (lambda: tides.Trajectory.orbit(radius="far"), "tides_orbit.radius: 'far', where a number is needed"),
        (lambda: tides.Trajectory.handheld((0, 0, 0), (0, 0, 1), seed=0.5), "tides_handheld.seed: 0.5, where a whole number"),
        (lambda: tides.Scene(RUN.replace("run.json", "scene.ply"), scale="1"), "scale: '1', where a number is needed"),
        (lambda: tides.Run(RUN, "sensor.seed=1"), "settings of the run file: 'sensor.seed=1', where a dict is needed"),
        (lambda: tides.Sensor(0.3), "Sensor: 0.3 has no name: its fields are given as name=value"),
    ):
        with pytest.raises(TypeError, match=message):
            wrong()


def test_presets(tmp_path):
    run = tides.Run(RUN, {"sensor.preset": "davis346"})
    sensor = tides.Sensor(preset="davis346", threshold_on=0.3)
    ours = run.sensor.copy(threshold_on=0.3, **{name: getattr(sensor, name) for name in given(run)})
    assert sensor == ours and sensor.threshold_sigma == 0.035 and sensor != tides.Sensor(threshold_on=0.3)
    assert tides.Readout(preset="davis346").kind == "requested"
    assert "davis346" in tides.preset_names() and len(tides.preset_names()) == len(set(tides.preset_names()))
    assert tides.Sensor(preset="ideal").threshold_sigma == 0 and tides.Sensor(preset=None) == tides.Sensor()
    (tmp_path / "mine.json").write_text('{"sensor": {"leak_rate_hz": 0.5}}')
    assert tides.Sensor(preset=tmp_path / "mine.json").leak_rate_hz == 0.5
    with pytest.raises(tides.errors.BadConfig, match="did you mean davis346"):
        tides.Sensor(preset="davis34")
    with pytest.raises(TypeError, match="no 'preset'"):
        tides.Stepping(preset="davis346")


VALUES = [one for one in vars(tides).values() if isinstance(one, type) and hasattr(one, "to_dict")]


@pytest.mark.parametrize("kind", VALUES)
def test_fields_are_documented(kind):
    told = {line.split(" = ")[0].strip(): line for line in inspect.getdoc(kind).splitlines() if " = " in line}
    for name, default in kind().to_dict().items():
        if isinstance(default, dict):
            assert any(one.startswith(f"{name}.") for one in told), name
        else:
            shown = tuple(default) if isinstance(default, list) else default
            assert f"{name} = {shown!r}" in told[name]
    names = set(inspect.signature(kind).parameters) - {"preset"}
    assert names == set(kind().to_dict()) - {"from"}  # which Python can't take as a keyword


def test_fields_say_units_and_ranges():
    for kind, lines in (
        (tides.Sensor, ("threshold_on = 0.2: .*log units", "refractory_law = 'hold': .*drop_keep", "leak_rate_hz = 0.0: .*Hz")),
        (tides.Stepping, ("step_s = .*: .*\\[s\\], .* to ", "risk.w_b = 0.3: .", "model = 'hermite': .*quadratic")),
        (tides.Lens, ("model = 'none': one of none, radtan, equidistant",)),
        (tides.ImageParams, ("dilation = .*\\[px\\^2\\], 0 to 100", "smoothing.near_fade = .*near planes")),
    ):
        for line in lines:
            assert re.search(f"^ *{line}", kind.__doc__, re.M), line
    assert list(inspect.signature(tides.Sensor).parameters)[0] == "preset"


def given(run):
    """Of a run's sensor, what its file says itself: not the preset's."""
    names = tides.Sensor().to_dict()
    return [name for name in names if run.gives(f"sensor.{name}") or run.gives(f"frontend.{name}") or name == "seed"]


def test_devices():
    rows = tides.devices()
    assert [row.index for row in rows] == list(range(len(rows)))
    with tides.Device("reference") as device:
        assert device.facts.kind == "reference" and "Device(" in repr(device)
    assert device.closed and repr(device) == "Device(closed)"
    device.close()
    with pytest.raises(ValueError, match="closed"):
        device.facts
    with pytest.raises(tides.errors.NoDevice, match="no such thing") as raised:
        tides.Device("no such thing")
    assert isinstance(raised.value, RuntimeError) and raised.value.name == "TIDES_NO_DEVICE"


def test_errors_by_kind(tmp_path):
    with pytest.raises(FileNotFoundError) as raised:
        tides.Scene(tmp_path / "nothing.ply")
    assert raised.value.status == tides.api.TIDES_FILE_NOT_FOUND and "nothing.ply" in str(raised.value)
    (tmp_path / "bad.ply").write_text("ply\nnot really\n")
    with pytest.raises(tides.errors.BadFile) as raised:
        tides.Scene(tmp_path / "bad.ply")
    assert isinstance(raised.value, OSError)
    with pytest.raises(ValueError):
        tides.Trajectory([0, 0], np.zeros((2, 3)), [[1, 0, 0, 0]] * 2)


def test_run():
    run = tides.Run(RUN, {"sensor.threshold_on": 0.3, "stepping.model": "linear"})
    assert run.sensor.threshold_on == 0.3 and run.stepping.model == "linear" and run.stop == 0.05
    assert isinstance(run.sensor, tides.Sensor) and isinstance(run.intrinsics, tides.Intrinsics)
    assert json.loads(run.json)["sensor"]["threshold_on"] == 0.3
    assert run.gives("sensor.threshold_on") and not run.gives("sensor.threshold_off") and not run.gives("sensor.no")
    scene, camera = run.open()
    assert scene.count == 20 and camera.intrinsics.width == 64
    again = tides.Run(text=run.json, directory="tests/install")
    assert again.sensor == run.sensor
    as_dict = tides.Run(text=json.loads(run.json), directory="tests/install")
    assert as_dict.json == again.json
    with pytest.raises(AttributeError, match="did you mean"):
        run.sensors
    with pytest.raises(tides.errors.BadConfig, match="sensor.threshold_on"):
        tides.Run(RUN, {"sensor.treshold_on": 1})
    with pytest.raises(ValueError, match="one of them"):
        tides.Run()


def test_run_simulates_and_renders():
    run = tides.Run(RUN)
    events = run.simulate(device="reference")
    with run.simulation("reference") as simulation:
        assert np.array_equal(simulation.run(), events) and len(events) > 1000
    with run.renderer("reference") as renderer:
        assert renderer.frame(0.01)["L"].shape == (48, 64)


def test_parameters_and_template(tmp_path):
    table = {row.key: row for row in tides.parameters()}
    row = table["sensor.threshold_on"]
    assert row.type == "number" and row.fallback == "0.2" and row.common and row.sentence
    assert table["stepping.mode"].choices == ["fixed", "risk", "error"]
    template = json.loads(tides.run_template("room.ply", "path.json"))
    assert template["scene"]["file"] == "room.ply" and template["camera"]["file"] == "path.json"


def test_facts():
    facts = tides.Run(RUN).values
    assert facts["start"] == facts.start == 0.0 and "start" in facts
    assert math.isclose(facts.stop, 0.05)


def test_files_are_whole_or_as_they_were(tmp_path):
    there, link = tmp_path / "there.txt", tmp_path / "link.txt"
    tides.files.write_bytes(there, b"first")
    link.symlink_to(there)
    tides.files.check_writable(link)
    assert tides.files.part_name(there) == f"{there}.part"
    tides.files.write_bytes(link, b"second\0")
    assert there.read_bytes() == b"second\0" and link.is_symlink()
    with pytest.raises(tides.TidesError, match=str(tmp_path)):
        tides.files.check_writable(tmp_path)
    with pytest.raises(tides.TidesError, match=str(tmp_path)):
        tides.files.write_bytes(tmp_path / "no" / "folder.txt", b"")
    assert sorted(tmp_path.iterdir()) == [link, there]


def test_the_nearest_name_is_what_errors_suggest():
    keys = [one.key for one in tides.parameters()]
    assert tides.nearest_name("sensor.treshold_on", keys) == "sensor.threshold_on"
    with pytest.raises(tides.TidesError, match='did you mean "sensor.threshold_on"'):
        tides.Run(RUN, {"sensor.treshold_on": 1})
    assert tides.nearest_name("sede", ["sensor", "seed"]) == "seed"  # neighbours swapped: one slip
    assert tides.nearest_name("sen", ["seed", "sensor"]) == "sensor"  # an abbreviation
    assert tides.nearest_name("xylophone", keys) is None and tides.nearest_name("seed", []) is None
    assert tides.nearest_name("größe", ["seed", "grösse"]) == "grösse"


def test_what_people_hand_over():
    """numpy's numbers, arrays and Paths are settings; what C would misread is refused."""
    run = tides.Run(RUN, {"sensor.threshold_on": np.float32(0.25), "camera.width": np.int64(48), "image.luminance": np.array([0, 1, 0])})
    assert run.sensor.threshold_on == 0.25 and run.intrinsics.width == 48 and run.image.luminance == (0, 1, 0)
    moved = tides.Run(text={"scene": {"file": Path("scene.ply")}, "camera": {"file": Path("path.txt"), "fx": np.float64(50)}})
    assert moved.values.scene_file.endswith("scene.ply")
    for wrong in (lambda: tides.Run(RUN + "\0x"), lambda: tides.Run(RUN, {"scene.file": "a\0b"}), lambda: tides.Scene("a\0b")):
        with pytest.raises(ValueError, match="NUL"):
            wrong()
    with pytest.raises(TypeError, match="a run file holds numbers"):
        tides.Run(RUN, {"sensor.threshold_on": object()})
    assert repr(run).startswith("Run('/") and "sensor.threshold_on" in repr(run)
    path = tides.Trajectory.orbit(radius=4, angular_speed=1, stop=0.05)
    assert repr(path).startswith("Trajectory of ") and repr(path).endswith(" poses, 0 to 0.05 s")
    assert "0x" not in str(inspect.signature(tides.Sensor)) and "tides_circuit(" in str(inspect.signature(tides.Sensor))
    with pytest.raises(ValueError, match=r"isn't between 0 and pi: radians are needed; 90 degrees are math.radians\(90\)"):
        tides.Intrinsics.from_fov(346, 260, 90)
    with pytest.raises(ValueError, match=r"rgb: uint8, where linear light .*255"):
        tides.Gaussians.from_colours([[0, 0, 1]], 0.1, np.array([[255, 0, 0]], np.uint8))
    for columns, what in (([2**63], [1]), "64 bits"), (([1], [2]), "p: values"):
        with pytest.raises(ValueError, match=what):
            tides.make_events(np.array(columns[0], np.uint64), [0], [0], columns[1])
    assert tides.make_events([1, 2, 3], [0] * 3, [0] * 3, [True, False, True])["p"].tolist() == [1, -1, 1]


def test_modules_that_need_more_are_there():
    assert {"Run", "metrics", "api"} <= set(tides.__all__)  # not those two: `import *` would want their dependencies
    for name in ("bag", "distributed", "rosbag", "usd"):
        try:
            assert getattr(tides, name).__name__ == f"tides.{name}"
        except ImportError as missing:  # their own dependencies
            assert "tides" not in str(missing.name)
    with pytest.raises(AttributeError, match="did you mean 'Sensor'"):
        tides.Senso
