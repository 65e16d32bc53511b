"""A simulated sensor is measured again, and a run accepts its preset."""

import math

import numpy as np
import pytest
import tides

SENSOR = {"sensor.threshold_on": 0.1, "sensor.threshold_off": 0.13, "image.log_eps": 0.05}


@pytest.fixture
def world(tmp_path, scene):
    scene.save(tmp_path / "s.ply")
    angles = np.linspace(-0.5, 0.5, 41)
    rows = [f"{0.005 * i:.3f} {1.2 * math.sin(6 * a):.6f} {0.5 * math.sin(9 * a):.6f} -4 0 0 0 1" for i, a in enumerate(angles)]
    (tmp_path / "p.txt").write_text("\n".join(rows) + "\n")
    (tmp_path / "run.json").write_text(
        '{"scene": {"file": "s.ply", "background": [0.1, 0.1, 0.1]}, "image": {"transfer": "linear"},'
        '"camera": {"file": "p.txt", "width": 48, "height": 36, "fx": 50}, "time": {"stop": 0.2}, "device": "reference"}'
    )
    return tmp_path


def test_a_sensor_is_measured(world):
    with tides.Session(world / "run.json", set=SENSOR) as session:
        session.write(world / "e.h5")
    with tides.Session(world / "run.json") as session:
        stages = []
        found = tides.calibrate(
            world / "e.h5", session, fix={"offset_s": 0, "frontend.photoreceptor_cutoff_hz": 0}, progress=lambda share, stage: stages.append(stage)
        )
        assert not found.refused and found.pairs > 300 and "error bars" in stages
        assert abs(found.measured.threshold_on["value"] - 0.1) < 0.003 and abs(found.measured.threshold_off["value"] - 0.13) < 0.004
        assert found.measured.pole_s["state"] == "given" and found.measured.threshold_on["state"] == "measured"
        assert found.map.shape == (9, 12) and found.pole_scan.shape == (25, 2) and len(found.rate) == len(found.rate_s)
        found.write(world / "mine.json")
        values = tides.Run(world / "run.json", set={"sensor.preset": str(world / "mine.json")}).values
        assert abs(values.sensor.threshold_on - found.measured.threshold_on["value"]) < 1e-6
        with pytest.raises(ValueError, match="log_eps"):
            tides.calibrate(world / "e.h5", session, fix={"log_ep": 1})
        few = tides.calibrate(world / "e.h5", session, start=0.01, stop=0.03, roi=(20, 16, 2, 2), static=world / "e.h5")
        assert few.refused and few.preset is None and few.notes
        with pytest.raises(ValueError, match="no preset"):
            few.write(world / "none.json")
