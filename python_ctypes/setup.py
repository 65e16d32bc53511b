"""Builds the wheel with the library and the command line tool inside. There are two:

`make wheel` names a folder that has all that goes in, what library and tool link too (TIDES_WHEEL, made by stage.py), and the pages of
the manual (TIDES_PAGES). That wheel is a manylinux one: it needs nothing but the C library.

`pip install ./python_ctypes` takes TIDES_LIBRARY's library, or the source tree's build/libtides.so, which make builds where it isn't
there, and the tool beside it. The library goes by its soname, under which the tool looks for it in its own folder. What they link
(OpenCL loader, HDF5, OpenEXR, libpng, ...) stays the system's: the wheel is linux_x86_64, for this machine.
"""

import os
import re
import shutil
import subprocess
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py
from setuptools.dist import Distribution
from wheel.bdist_wheel import bdist_wheel

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
STAGED = Path(os.environ["TIDES_WHEEL"]) if os.environ.get("TIDES_WHEEL") else None
SCRATCH = ROOT / "build" / "python" / "scratch"  # what setuptools leaves behind


def version():
    numbers = dict(re.findall(r"^TIDES_VERSION_(\w+) = (\d+)$", (HERE / "tides" / "_api.py").read_text(), re.M))
    return f"{numbers['MAJOR']}.{numbers['MINOR']}.{numbers['PATCH']}"


def library():
    named = os.environ.get("TIDES_LIBRARY")
    built = Path(named) if named else ROOT / "build" / "libtides.so"
    if not built.exists() and not named:
        subprocess.run(["make", "-C", str(ROOT), f"-j{os.cpu_count() or 1}", "all"], check=True)
    return built.resolve(strict=True)


class BuildWithLibrary(build_py):
    def run(self):
        super().run()
        inside = Path(self.build_lib) / "tides"
        for old in [*inside.glob("lib*.so*"), inside / "licences", inside / "fonts"]:  # an earlier build's
            shutil.rmtree(old) if old.is_dir() else old.unlink(missing_ok=True)
        if STAGED:
            shutil.copytree(STAGED, inside, ignore=shutil.ignore_patterns("platform"), dirs_exist_ok=True)
            shutil.copyfile(ROOT / "LICENSE", inside / "licences" / "tides.txt")
            return
        source = library()
        shutil.copyfile(source, inside / f"libtides.so.{version().split('.')[0]}")
        shutil.copy(source.parent / "tides", inside / "tides")


class PlatformWheel(bdist_wheel):
    """Any Python 3; this platform, or what stage.py found it to be good for."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return "py3", "none", (STAGED / "platform").read_text().strip() if STAGED else super().get_tag()[2]


class BinaryDistribution(Distribution):
    def has_ext_modules(self):
        return True


def pages():
    """Man pages and completions, below the environment's share/, where man and bash look."""
    folder = os.environ.get("TIDES_PAGES")
    if not folder:
        return []
    made = [Path(os.path.relpath(path, HERE)) for path in sorted(Path(folder).iterdir())]
    sections = [(f"share/man/man{n}", [str(path) for path in made if path.suffix == f".{n}"]) for n in (1, 5)]
    bash = [str(path) for path in made if path.suffix == ".bash"]
    return [*sections, ("share/bash-completion/completions", bash)]


SCRATCH.mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    data_files=pages(),
    distclass=BinaryDistribution,
    cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": PlatformWheel},
    options={"build": {"build_base": str(SCRATCH)}, "egg_info": {"egg_base": str(SCRATCH)}},
)
