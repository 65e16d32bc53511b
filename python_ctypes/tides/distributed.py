"""Batches beyond one machine, on Dask: `tides batch` whose runs are spread over the workers of a cluster.

    from dask.distributed import Client, LocalCluster      # or SLURMCluster, SSHCluster, KubeCluster, a scheduler's address
    import tides.distributed
    client = Client(LocalCluster(threads_per_worker=1))
    summary = tides.distributed.map("grid.json", client, "results", progress=True)

Workers run the command line tool, a process per run. So DIR holds, file by file, what `tides batch grid.json -o results` leaves,
and each of the two can continue what the other began.

What a cluster needs: this package and `tides` on every worker, of one version; manifest, what its runs read, and DIR under the
same paths everywhere (shared storage; relative paths count from the client's working directory); files must keep their content
once they are written, as NFS and Lustre have it.

Threads and devices: a thread of a worker takes one run at a time. On CPUs give every worker one thread, and the node as many
workers as it has cores and memory for; `threads` is what a run's device may use. On GPUs start one worker with one thread for
each, with its TIDES_DEVICE (an index of `tides devices`) in its environment.

It needs Dask: pip install tides[dask], or apt install python3-distributed.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
import time
import uuid
from pathlib import Path
from typing import Any

try:
    from distributed import Client, Future, Worker, as_completed, get_worker
except ImportError as missing:
    raise ImportError(
        "tides.distributed needs Dask: pip install tides[dask], or apt install python3-distributed"
    ) from missing

from . import _api, errors
from ._progress import Progress, shower
from ._tool import tool_path
from ._values import Facts
from ._warn import warn

_POLL_S = 0.5  # delay until a worker notices that the batch should stop
_STOP_S = 60.0  # time for runs to save their state
_SEEN_S = 60.0  # until all machines see a new file: NFS caches folders for up to that
_TOLD = 5  # failures quoted in a warning


def _command(job: dict[str, Any], *options: str) -> list[str]:
    device = ["--device", job["device"]] if job["device"] else []
    return [tool_path(job["tool"]), "batch", job["manifest"], "-o", job["out_dir"], "--quiet", *device, *options]


def _words(said: str) -> str:
    """The last line of the tool's output."""
    return (said.strip().splitlines() or ["ended without a message"])[-1].removeprefix("tides: ")


# -- on a worker ----------------------------------------------------------------------------------------------------------
class _Here:
    """A worker's data of one batch: whether it should stop, and which of its runs are under way. It is stored at the worker,
    so that looking needs no network."""

    def __init__(self) -> None:
        self.stop = threading.Event()
        self.runs: set[str] = set()

    @staticmethod
    def of(worker: Worker, token: str) -> "_Here":
        return worker.__dict__.setdefault("tides_batches", {}).setdefault(token, _Here())


def _tell_stop(token: str, dask_worker: Worker) -> int:
    """Tells a worker to stop. Returns how many runs are still saving their state."""
    here = _Here.of(dask_worker, token)
    here.stop.set()
    return len(here.runs)


def _say(process: subprocess.Popen[str], stop: threading.Event) -> str:
    """The process's output until it ends. The process is asked to end when `stop` is set."""
    while True:
        try:
            return process.communicate(timeout=_POLL_S)[1]
        except subprocess.TimeoutExpired:
            if stop.is_set():
                process.terminate()


def _run_tool(name: str, job: dict[str, Any], stop: threading.Event) -> None:
    options = ["--only", name, "--jobs", "1", "--threads", str(job["threads"]), "--checkpoint", str(job["checkpoint_s"])]
    command = _command(job, *options, "--parent", str(os.getpid()))
    process = subprocess.Popen(
        command,
        cwd=job["folder"],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,  # Ctrl-C is handled by `stop`
    )
    try:
        said = _say(process, stop)
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
    if process.returncode != 0 and not stop.is_set():
        raise errors.TidesError(_words(said).removeprefix(f"{name} failed: "))


def _work(name: str, job: dict[str, Any]) -> None:
    """Does one run, unless the batch should stop. The run ends with the worker, even if that is killed (--parent)."""
    here = _Here.of(get_worker(), job["token"])
    if here.stop.is_set():
        return
    here.runs.add(name)
    try:
        _run_tool(name, job, here.stop)
    finally:
        here.runs.discard(name)


def _spare_interrupt(group: int, machine: str) -> None:
    """Ignores a terminal's Ctrl-C, which also reaches the workers of a LocalCluster and would end them before their runs have
    saved."""
    main = threading.current_thread() is threading.main_thread()
    if main and os.getpgrp() == group and os.uname().nodename == machine:
        signal.signal(signal.SIGINT, signal.SIG_IGN)


# -- at the client --------------------------------------------------------------------------------------------------------
def _summary(job: dict[str, Any]) -> Facts:
    """The present summary.json, written by the tool."""
    done = subprocess.run(_command(job, "--summary", "--json"), cwd=job["folder"], capture_output=True, text=True)
    if not done.stdout:
        raise errors.make(_api.TIDES_BAD_CONFIG, "TIDES_BAD_CONFIG", _words(done.stderr))
    return json.loads(done.stdout, object_hook=Facts)


def _settled_summary(job: dict[str, Any], finished: set[str]) -> Facts:
    """The summary, once it shows the runs that workers on other machines finished."""
    until = time.monotonic() + _SEEN_S
    while True:
        summary = _summary(job)
        unseen = [row for row in summary.runs if row.name in finished and row.state != "done"]
        if not unseen or time.monotonic() > until:
            return summary
        time.sleep(1)


def _leave_failure(job: dict[str, Any], row: Facts, words: str) -> None:
    """Writes failure.json, as the tool does when it can: here the run's process was killed."""
    folder = Path(job["folder"] or "", job["out_dir"], row.name)
    folder.mkdir(exist_ok=True)
    part = folder / "failure.json.part"
    part.unlink(missing_ok=True)
    with part.open("x") as file:  # fails where a file or link exists
        json.dump({**{key: row[key] for key in ("name", "hash", "file", "set")}, "error": words}, file, indent=1)
    part.replace(folder / "failure.json")


def _stop(client: Client, token: str, futures: list[Future]) -> None:
    """Cancels runs that wait, and gives runs under way time to save."""
    client.cancel(futures)
    until = time.monotonic() + _STOP_S
    while any(client.run(_tell_stop, token, on_error="ignore").values()) and time.monotonic() < until:
        time.sleep(_POLL_S)


class _Batch:
    """The runs under way, and the results of those that ended."""

    def __init__(self, job: dict[str, Any], rows: list[Facts], progress: Progress):
        self.job, self.rows = job, {row.name: row for row in rows}
        self.keys = {f"tides-{job['token']}-{name}": name for name in self.rows}
        self.finished: set[str] = set()
        self.failed: dict[str, str] = {}
        self.progress = progress

    def submit(self, client: Client, retries: int) -> list[Future]:
        return client.map(_work, list(self.rows), job=self.job, key=list(self.keys), retries=retries, pure=False)

    def end(self, future: Future) -> str:
        """Takes the result of a run that has ended, and returns the run's name."""
        name = self.keys[future.key]
        if future.status == "finished":
            self.finished.add(name)
            return name
        error = future.exception() if future.status == "error" else RuntimeError("cancelled at the cluster")
        self.failed[name] = str(error)
        if not isinstance(error, errors.TidesError):  # the tool can't know: the worker was killed
            _leave_failure(self.job, self.rows[name], self.failed[name])
        return name

    def tell(self, name: str, shown: Any) -> None:
        fraction = (len(self.finished) + len(self.failed)) / len(self.rows)
        if shown is not None:
            shown(fraction, name)
        elif callable(self.progress) and self.progress(fraction, name):
            raise errors.make(_api.TIDES_CANCELLED, "TIDES_CANCELLED", "stopped on request; the same call goes on from there")

    def run(self, client: Client, retries: int) -> None:
        """Does every run. After an exception (Ctrl-C) runs under way have saved their state."""
        shown = shower() if self.progress is True else None
        client.run(_spare_interrupt, os.getpgrp(), os.uname().nodename, on_error="ignore")
        futures = self.submit(client, retries)
        try:
            for future in as_completed(futures):
                self.tell(self.end(future), shown)
                future.release()  # else Dask would repeat the run if its worker is lost
        except BaseException:
            _stop(client, self.job["token"], futures)
            raise
        finally:
            if shown is not None:
                shown.close()


def _warn(batch: _Batch, summary: Facts) -> None:
    rows = [row for row in summary.runs if row.state == "failed" or (row.state == "waiting" and row.name in batch.failed)]
    quoted = [f"{row.name}: {row.get('error', batch.failed.get(row.name))}" for row in rows[:_TOLD]]
    if len(rows) > _TOLD:
        quoted.append("...")
    if rows:
        warn(f"{len(rows)} of {len(summary.runs)} runs failed: {'; '.join(quoted)}", RuntimeWarning)


def map(
    manifest: str | os.PathLike[str],
    client: Client,
    out_dir: str | os.PathLike[str],
    *,
    threads: int = 1,
    device: str | int | None = None,
    checkpoint_s: float = _api.TIDES_CHECKPOINT_S,
    retries: int = 1,
    progress: Progress = None,
    tool: str | None = None,
) -> Facts:
    """Simulates the runs of a batch's manifest on the workers of `client`, into folders of `out_dir`, and returns the summary:
    runs (a list of Facts: name, state, events, error ...), done, failed, waiting: the content of out_dir/summary.json.

    By the hash that `tides batch` keeps, finished runs are skipped and interrupted ones continued, whichever machine they were
    on. If a worker dies, its run loses at most the last `checkpoint_s` seconds, and continues on another worker. After
    `distributed.scheduler.allowed-failures` (3) such deaths the run counts as failed. A run that fails is tried `retries` times
    more; then it is in the summary, and a RuntimeWarning names it when the others are done. BadConfig: the manifest is wrong.

    Ctrl-C (or a true return of `progress`, which is told the fraction of runs that ended, and the last one's name) lets the
    runs under way save their state, writes the summary, and raises; the same call goes on from there.

    threads: of one run on a CPU device. device: as `tides --device`; else the run file's, else each worker's TIDES_DEVICE.
    tool: the command line tool on the workers and here, where it is neither beside the library nor in PATH."""
    inside, outside = os.fspath(manifest), os.fspath(out_dir)
    job = {
        "manifest": inside,
        "out_dir": outside,
        "folder": None if os.path.isabs(inside) and os.path.isabs(outside) else os.getcwd(),
        "device": None if device is None else str(device),
        "threads": threads,
        "checkpoint_s": checkpoint_s,
        "tool": tool,
        "token": uuid.uuid4().hex,
    }
    batch = _Batch(job, [row for row in _summary(job).runs if row.state != "done"], progress)
    try:
        if batch.rows:
            batch.run(client, retries)
    finally:
        summary = _settled_summary(job, batch.finished)
    _warn(batch, summary)
    return summary
