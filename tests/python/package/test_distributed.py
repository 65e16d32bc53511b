"""Batches on Dask: workers leave the same files as `tides batch`, with a worker killed in the middle, and after Ctrl-C."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import tides

pytest.importorskip("distributed")
import tides.distributed  # noqa: E402
from distributed import Client, LocalCluster  # noqa: E402

TOOL = os.environ.get("TIDES")
RUN = Path(__file__).resolve().parents[2] / "install" / "run.json"
pytestmark = pytest.mark.skipif(not TOOL, reason="TIDES names no tool")


@pytest.fixture(scope="module")
def client():
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as made:
        yield made


def make_manifest(folder, **runs):
    """A manifest of short runs, and of `runs` by name."""
    grid = {"sensor.threshold_on": [0.1, 0.2], "sensor.threshold_off": [0.15, 0.3]}
    listed = [{"name": name, "set": keys} for name, keys in runs.items()]
    (folder / "grid.json").write_text(json.dumps({"base": str(RUN), "grid": grid, "runs": listed}))
    return "grid.json"


def equal_folders(one, other):
    """File by file; but for the times in stats.json, and HDF5's inner order in a file that was gone on with."""
    files = sorted(path.relative_to(one) for path in one.rglob("*") if path.is_file())
    assert files == sorted(path.relative_to(other) for path in other.rglob("*") if path.is_file())
    for file in files:
        if file.suffix == ".h5":
            assert np.array_equal(tides.read_events(one / file), tides.read_events(other / file)), file
        elif file.name == "stats.json":
            numbers = [json.loads((folder / file).read_text()) for folder in (one, other)]
            assert numbers[0]["events"] == numbers[1]["events"] > 100
        else:
            assert (one / file).read_bytes() == (other / file).read_bytes(), file
    return len(files)


def whole(folder, manifest="grid.json", code=0):
    """What the command line makes of it in one piece."""
    done = subprocess.run([TOOL, "batch", manifest, "-o", "whole", "-q"], cwd=folder, capture_output=True, text=True)
    assert done.returncode == code, done.stderr
    return folder / "whole"


def worker_of(client, name):
    """Process id of the worker that is at the run."""
    pids = client.run(os.getpid)
    (address,) = [worker for worker, keys in client.processing().items() if any(key.endswith(f"-{name}") for key in keys)]
    return pids[address]


def wait_for(condition, seconds=300):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.01)


LONG = {"stepping.step_s": 3e-6}  # some seconds on the reference device: workers are told to stop every half


def test_killed_worker(client, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    manifest, told, made = make_manifest(tmp_path, long=LONG, late={"time.start": 0.01}), [], []
    checkpoint = tmp_path / "dask" / "long" / "events.h5.checkpoint"

    def work():
        options = {"checkpoint_s": 0.05, "progress": lambda fraction, name: told.append((fraction, name))}
        made.append(tides.distributed.map(manifest, client, "dask", **options))

    thread = threading.Thread(target=work)
    thread.start()
    wait_for(checkpoint.exists)
    witness = checkpoint.parent / "imu.csv"  # an earlier command's: goes where a run starts anew
    witness.write_text("")
    killed = worker_of(client, "long")
    os.kill(killed, signal.SIGKILL)
    assert checkpoint.exists() and not (tmp_path / "dask" / "long" / "result.json").exists()
    thread.join(600)
    (summary,) = made
    assert killed not in client.run(os.getpid).values()
    witness.unlink()  # it is there: the run was gone on with
    assert (summary.done, summary.failed, summary.waiting) == (6, 0, 0)
    assert sorted(name for _, name in told) == sorted(row.name for row in summary.runs) and told[-1][0] == 1
    assert equal_folders(tmp_path / "dask", whole(tmp_path)) == 6 * 7 + 2

    # Again: nothing is done; the command line finds it finished too.
    stamps = {path: path.stat().st_mtime_ns for path in (tmp_path / "dask").rglob("events.h5")}
    assert tides.distributed.map(manifest, client, tmp_path / "dask") == summary
    assert stamps == {path: path.stat().st_mtime_ns for path in (tmp_path / "dask").rglob("events.h5")}


def test_failures_are_told_at_the_end(client, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    manifest = make_manifest(tmp_path, gone={"scene.file": "gone.ply"}, outside={"camera.file": "run.json"})
    told = r"2 of 6 runs failed: gone: .*gone.ply: can't be opened.*; outside: .*run.json: "
    with pytest.warns(RuntimeWarning, match=told) as heard:
        summary = tides.distributed.map(manifest, client, "dask")
    assert [one.filename for one in heard if one.category is RuntimeWarning] == [__file__]
    assert (summary.done, summary.failed) == (4, 2) and "gone.ply" in summary.runs[4].error
    equal_folders(tmp_path / "dask", whole(tmp_path, code=1))


def test_workers_that_die_of_a_run(client, tmp_path, monkeypatch):
    """A run that takes every worker with it ends as a failure, and the others are done."""
    monkeypatch.chdir(tmp_path)
    manifest = make_manifest(tmp_path, deadly={"seed": "666"})
    tool = tmp_path / "tides"
    tool.write_text(
        f"#!/bin/sh\ncase $*:$* in *--parent*--only\\ deadly*) kill -KILL $PPID; sleep 20; exit 1 ;; esac\nexec {TOOL} \"$@\"\n"
    )
    tool.chmod(0o755)
    with pytest.warns(RuntimeWarning, match="1 of 5 runs failed: deadly: .*workers died"):
        summary = tides.distributed.map(manifest, client, "dask", tool=str(tool))
    assert (summary.done, summary.failed) == (4, 1)
    assert json.loads((tmp_path / "dask" / "deadly" / "failure.json").read_text())["hash"] == summary.runs[4].hash


def test_progress_stops(client, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    manifest = make_manifest(tmp_path, long=LONG)
    with pytest.raises(tides.errors.Cancelled):
        tides.distributed.map(manifest, client, "dask", progress=lambda fraction, name: True)
    counts = json.loads((tmp_path / "dask" / "summary.json").read_text())
    assert counts["waiting"] > 0 and counts["failed"] == 0 and counts["done"] > 0


def test_wrong_manifest(client, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "grid.json").write_text('{"base": "run.json", "gird": {}}')
    with pytest.raises(tides.errors.BadConfig, match='unknown key "gird"; did you mean "grid"'):
        tides.distributed.map("grid.json", client, "dask")
    with pytest.raises(FileNotFoundError):
        tides.distributed.map("grid.json", client, "dask", tool="/nowhere/tides")


def test_storage_that_is_late(monkeypatch):
    """Another machine's file may be seen only after a while: the summary waits for what workers finished."""
    late = [tides.distributed.Facts(runs=[tides.distributed.Facts(name="a", state=state)]) for state in ("waiting", "done")]
    monkeypatch.setattr(tides.distributed, "_summary", lambda job: late.pop(0))
    assert tides.distributed._settled_summary({}, {"a"}).runs[0].state == "done" and not late


PROGRAM = """
import tides.distributed
from distributed import Client, LocalCluster
if __name__ == "__main__":
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
        try:
            tides.distributed.map("grid.json", client, "dask", progress=True)
        except KeyboardInterrupt:
            print("stopped", flush=True)
"""


def test_interrupt(client, tmp_path, monkeypatch):
    """Ctrl-C in a terminal, which the cluster's processes get too: the same call then goes on."""
    monkeypatch.chdir(tmp_path)
    manifest = make_manifest(tmp_path, long=LONG)
    (tmp_path / "program.py").write_text(PROGRAM)
    process = subprocess.Popen(
        [sys.executable, "program.py"], start_new_session=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        wait_for((tmp_path / "dask" / "long" / "events.h5.part").exists)
        os.killpg(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=300)
    finally:
        process.kill()
    assert out.splitlines()[-1] == "stopped" and process.returncode == 0, err
    assert (tmp_path / "dask" / "long" / "events.h5.checkpoint").exists()  # long before one was due
    counts = json.loads((tmp_path / "dask" / "summary.json").read_text())
    assert counts["waiting"] > 0 and counts["failed"] == 0
    assert tides.distributed.map(manifest, client, "dask").done == 5
    equal_folders(tmp_path / "dask", whole(tmp_path))


def test_without_dask():
    program = "import sys\nsys.modules['distributed'] = None\nimport tides, tides.distributed"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stderr.splitlines()[-1].startswith("ImportError: tides.distributed needs Dask: pip install tides[dask]")
