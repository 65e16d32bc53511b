"""Finds the command line tool `tides`."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

from ._library import PATH, VERSION


def tool_beside() -> str | None:
    """The tool beside the library: in this package, in build/, as make install puts it, or for a system's library the
    system's."""
    if "/" in PATH:
        folder = Path(PATH).resolve().parent
        places = [folder / "tides", folder.parent / "bin" / "tides"]
    else:
        places = [Path(sys.base_prefix) / "bin" / "tides"]
    found = [path for path in places if path.is_file()]
    return str(found[0]) if found else None


def tool_path(named: str | None = None) -> str:
    """The tool `named`, else the one beside the library, else PATH's. RuntimeError: it has another version."""
    tool = named or tool_beside() or shutil.which("tides")
    if tool is None:
        raise FileNotFoundError(f"the tool `tides` is neither beside {PATH} nor in PATH: run make install, or name it")
    said = subprocess.run([tool, "--version"], capture_output=True, text=True, check=True).stdout.split()
    if said[-1:] != [VERSION]:
        raise RuntimeError(f"{tool} is version {' '.join(said[-1:])}, and this package is for {VERSION}")
    return tool
