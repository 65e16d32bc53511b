"""Devices that compute: OpenCL devices, and the reference in C."""

from __future__ import annotations

from ctypes import POINTER, byref, c_int32

from . import _api
from ._call import call, encoded
from ._handle import Handle
from ._library import lib
from ._values import Facts, constants, plain

_KINDS = {
    number: word for word, number in constants("TIDES_DEVICE_").items() if word in ("cpu", "gpu", "other", "reference")
}


def _facts(info: _api.tides_device_info) -> Facts:
    return Facts(plain(info), kind=_KINDS[info.kind])


def devices() -> list[Facts]:
    """The OpenCL devices: kind ("cpu", "gpu", "other"), index, name, platform, driver, compute_units, lanes, vector_bits,
    fused (0: its events are close to those of other devices, but not equal to the bit), memory_bytes."""
    count = c_int32()
    call("tides_device_list", None, 0, byref(count))
    rows = (_api.tides_device_info * max(1, count.value))()
    call("tides_device_list", rows, count.value, byref(count))
    return [_facts(row) for row in rows[: count.value]]


class Device(Handle):
    """An open device: Device() is TIDES_DEVICE's or the first GPU, else the first CPU; Device("cpu"), "gpu", "reference", an
    index of `devices()`, a part of a name. NoDevice if none matches. Several threads may share one. `threads`: host threads
    for each simulation made with it; 0: as many as processors (default: TIDES_THREADS, else 0). Events don't depend on it.
    PoCL's own threads are limited by POCL_MAX_PTHREAD_COUNT, set before it is loaded.

    OpenCL doesn't survive a fork. In a child forked from a process that has used a device (multiprocessing's default on
    Linux until Python 3.14, PyTorch's DataLoader with workers), calls that need a device raise NoDevice. Use the context
    "spawn" or "forkserver", or open devices only in the children."""

    _destroy = "tides_device_close"

    def __init__(self, spec: str | int | None = None, *, threads: int | None = None):
        made = POINTER(_api.tides_device)()
        call("tides_device_open", encoded(None if spec is None else str(spec)), byref(made))
        super().__init__(made)
        if threads is not None:
            call("tides_device_set_threads", made, threads)

    @property
    def threads(self) -> int:
        """Host threads for each simulation; 0: as many as processors."""
        return lib.tides_device_threads(self._pointer)

    @property
    def facts(self) -> Facts:
        """The facts of a row of `devices()`."""
        info = _api.tides_device_info()
        lib.tides_device_describe(self._pointer, byref(info))
        return _facts(info)

    def __repr__(self) -> str:
        return "Device(closed)" if self.closed else f"Device({self.facts.name!r})"


def opened(device: "Device | str | int | None") -> Device:
    """`device` itself, or the device that a specification names."""
    return device if isinstance(device, Device) else Device(device)
