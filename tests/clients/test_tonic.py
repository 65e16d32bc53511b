"""tonic's own datasets: DSEC of a DSEC folder by tides, MVSEC of a ROS 1 bag made of tides' ROS 2 bag. Files lie where tonic's
downloads would, under names of recordings that it knows."""

import shutil
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import readers
import worlds
from worlds import METRES


@pytest.fixture(scope="module")
def world(of):
    return of("rig")


NAME = "thun_00_a"
PLACES = {
    "events_left": "events/left",
    "events_right": "events/right",
    "images_rectified_left": "images/left/rectified",
    "disparity_event": "disparity/event",
    "optical_flow_forward_event": "flow/forward",
    "optical_flow_backward_event": "flow/backward",
}
TIMES = {
    "image_timestamps": "images/timestamps.txt",
    "disparity_timestamps": "disparity/timestamps.txt",
    "optical_flow_forward_timestamps": "flow/forward_timestamps.txt",
}


def refuse(*arguments, **options):
    raise RuntimeError("FreeImage isn't here")


# It asks the network for FreeImage, though without it pypng does as well.
IMAGEIO = SimpleNamespace(
    plugins=SimpleNamespace(freeimage=SimpleNamespace(download=lambda: None)),
    v2=SimpleNamespace(imread=refuse),
    core=SimpleNamespace(request=SimpleNamespace(InitializationError=RuntimeError)),
)


def test_dsec(world, tmp_path, monkeypatch):
    datasets = readers.import_client("tonic").datasets
    monkeypatch.setitem(sys.modules, "imageio", IMAGEIO)
    ours, theirs = world.folder / "rig/dsec", tmp_path / "DSEC" / NAME
    theirs.mkdir(parents=True)
    for name, place in PLACES.items():
        (theirs / name).symlink_to(ours / place)
    for name, place in TIMES.items():
        (theirs / name).mkdir()
        shutil.copy(ours / place, theirs / name / f"{NAME}_{name}.txt")
    data = ["events_left", "events_right", "images_rectified_left", "image_timestamps"]
    targets = ["disparity_event", "disparity_timestamps", "optical_flow_forward_event", "optical_flow_forward_timestamps"]
    dataset = datasets.DSEC(str(tmp_path), [NAME], data, [*targets, "optical_flow_backward_event"])
    (left, right, pictures, times), (disparity, when, forward, spans, backward) = dataset[0]
    for got, side in ((left["events_left"], "left"), (right["events_right"], "right")):
        events = world.events[side]
        assert np.array_equal(got["t"], events["t"] // 1000) and np.array_equal(got["p"], events["p"] > 0)
        assert np.array_equal(got["x"], events["x"]) and np.array_equal(got["y"], events["y"])
    assert pictures.shape == (5, 18, 24, 3) and times.tolist() == [world.us[0] + 25000 * k for k in range(5)]
    for got, moves in ((forward, world.forward), (backward, world.backward)):
        for flow, move in zip(got, moves):
            wanted, known = np.stack([move["u"], move["v"]], -1), flow[..., 2] == 1
            assert known.any() and np.array_equal(known, np.isfinite(wanted).all(-1))
            assert np.abs(flow[..., :2] - wanted)[known].max() <= 0.5 / 128
    depth = world.truth[1]["depth_median"]
    seen = depth > 0
    assert np.abs(disparity[1][seen] / 256 - world.lens.fx * 0.1 / depth[seen]).max() <= 0.5 / 256
    assert when.tolist() == world.us and spans.tolist() == [world.us[:2], world.us[1:]]


@pytest.fixture(scope="module")
def bags(world, tmp_path_factory):
    """As MVSEC's: data and ground truth apart, and depth both raw and rectified, which without a lens are one."""
    readers.import_client("rosbags")
    import tides.rosbag

    folder = tmp_path_factory.mktemp("bags")
    sides = ("left", "right")
    kept = {f"/{side}/{kind}": f"/davis/{side}/{kind}" for side in sides for kind in ("events", "imu", "image_raw", "pose")}
    gone = {f"/{side}/{kind}": None for side in sides for kind in ("optic_flow", "camera_info")}
    depth = {f"/{side}/depth": [f"/davis/{side}/depth_image_{kind}" for kind in ("raw", "rect")] for side in sides}
    at = folder / "MVSEC" / "motorcycle"
    at.mkdir(parents=True)
    for name in ("data", "gt"):
        tides.rosbag.write_rosbag(at / f"motorcycle_{name}.bag", world.folder / "rig/ros2", {**kept, **gone, **depth})
    return folder


def test_mvsec(world, bags, monkeypatch):
    tonic = readers.import_client("tonic")
    dataset = tonic.datasets.MVSEC(str(bags), "motorcycle")
    # importRosbag 1.0.4, which reads them for it, shifts bytes as bytes: numpy 2 doesn't widen them any more, and refuses.
    with pytest.raises(OverflowError, match="out of bounds for uint8"):
        dataset[0]
    module = sys.modules["importRosbag.messageTypes.dvs_msgs_EventArray"]
    wide = SimpleNamespace(**vars(np))
    wide.frombuffer = lambda data, dtype: np.frombuffer(data, dtype).astype(np.uint32)
    monkeypatch.setattr(module, "np", wide)
    (left, right, imu, _, pictures, _), (depth, _, pose) = dataset[0]
    for got, events in ((left, world.events["left"]), (right, world.events["right"])):
        us = events["t"] // 1000
        assert np.abs(got["t"] - (us - us[0])).max() <= 1  # seconds as doubles, cut off
        assert np.array_equal(got["x"], events["x"]) and np.array_equal(got["p"], events["p"] > 0)
    assert pictures.shape == (5, 18, 24, 3) and len(imu["ts"]) == 21 and len(pose["ts"]) == 21
    for got, truth in zip(depth, world.truth):
        wanted = truth["depth_median"]
        assert np.array_equal(got, np.where(wanted > 0, METRES * wanted, np.nan).astype(np.float32), equal_nan=True)
