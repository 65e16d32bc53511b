"""Lets OpenCL's loader find the CPU driver that pip installed: the extra `cpu` (pip install 'tides-...whl[cpu]').

The loader looks into one folder, /etc/OpenCL/vendors or the one that OCL_ICD_VENDORS names, and pip can't write to the
first. So a folder of the user's holds the system's entries and pip's driver, and OCL_ICD_VENDORS names it. The variable is
set in this process before its first call of OpenCL, and so in processes that it starts, such as the tool. If the user has
set one of the loader's variables, nothing changes.
"""

from __future__ import annotations

import importlib.metadata
import os
import sys
import warnings
import zlib
from pathlib import Path

SYSTEM = Path("/etc/OpenCL/vendors")
LOADERS = ("OCL_ICD_VENDORS", "OPENCL_VENDOR_PATH", "OCL_ICD_FILENAMES")
#: Distributions that have a driver, and the driver's file.
DRIVERS = {"intel-opencl-rt": "libintelocl.so"}


def installed() -> Path | None:
    """The driver that pip installed for this Python."""
    for distribution, name in DRIVERS.items():
        try:
            files = importlib.metadata.files(distribution) or []
        except importlib.metadata.PackageNotFoundError:
            continue
        found = [Path(str(file.locate())).resolve() for file in files if file.name == name]
        if found and found[0].is_file():
            return found[0]
    return None


def _entries(driver: Path) -> dict[str, str]:
    """The loader's files by name: the system's, and the driver's."""
    system = {path.name: path.read_text() for path in sorted(SYSTEM.glob("*.icd"))} if SYSTEM.is_dir() else {}
    return {**system, f"pip-{driver.stem}.icd": f"{driver}\n"}


def _write(folder: Path, entries: dict[str, str]) -> None:
    """Makes the folder hold the entries and no other. Files are replaced whole, for processes that read them meanwhile."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in entries.items():
        path = folder / name
        if not path.exists() or path.read_text() != text:
            part = folder / f"{name}.{os.getpid()}"
            part.unlink(missing_ok=True)
            with part.open("x") as file:  # fails where a file or link exists
                file.write(text)
            part.replace(path)
    for path in folder.glob("*.icd"):
        if path.name not in entries:
            path.unlink(missing_ok=True)


def offer() -> None:
    """Makes the loader find pip's driver. Warns where it can't."""
    if any(os.environ.get(name) for name in LOADERS):
        return
    driver = installed()
    if driver is None:
        return
    cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = cache / "tides" / f"opencl-{zlib.crc32(sys.prefix.encode()):08x}"
    try:
        _write(folder, _entries(driver))
    except OSError as error:
        warnings.warn(f"{driver} isn't used, since {folder} can't be written ({error}); OCL_ICD_VENDORS={driver} uses it alone")
        return
    os.environ["OCL_ICD_VENDORS"] = str(folder)
