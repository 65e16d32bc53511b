"""Arrays for networks, against those of $TIDES_SHARED/golden/metrics (rpg_e2vid, DSEC, tonic); skipped where it isn't."""

import os
from pathlib import Path

import numpy as np
import pytest
import tides

ROOT = Path(__file__).resolve().parents[3]
GOLDEN = ROOT / os.environ.get("TIDES_SHARED", "../shared") / "golden" / "metrics"


def arrays(events, width, height):
    return {
        "sim_voxel5": tides.voxel_grid(events, width, height, normalise="none"),
        "sim_voxel5_norm": tides.voxel_grid(events, width, height),
        "sim_dsec15": tides.voxel_grid(events, width, height, style="dsec"),
        "sim_frame": tides.event_frame(events, width, height),
        "sim_ts30ms": tides.time_surface(events, width, height, int(events["t"][-1]), 30e-3),
    }


def test_representations():
    files = sorted(GOLDEN.glob("golden_*.npz"))
    if not files:
        pytest.skip(f"no golden/metrics in {GOLDEN.parents[1]}")
    worst = 0.0
    for file in files:
        wanted = np.load(file)
        if "sim_frame" not in wanted:  # the stream is empty
            continue
        t, x, y, p = (wanted[f"sim_{name}"] for name in "txyp")
        events = tides.make_events(np.rint(1e3 * t).astype(np.int64), x.astype(int), y.astype(int), p.astype(int))
        height, width = wanted["sim_frame"].shape[1:]
        for name, got in arrays(events, width, height).items():
            assert got.shape == wanted[name].shape, (file.name, name)
            worst = max(worst, np.abs(got - wanted[name]).max())
    print(f"{len(files)} files, largest difference {worst:.3g}")
    assert 0 < worst <= 1e-6
