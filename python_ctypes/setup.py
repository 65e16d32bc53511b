"""Builds the wheel py3-none-linux_x86_64 with the library and the command line tool inside.

The library is TIDES_LIBRARY's, or the source tree's build/libtides.so, which make builds where it isn't there; the tool is the
one beside it. The library goes by its soname, under which the tool looks for it in its own folder. What it links
(OpenCL loader, HDF5, OpenEXR, libpng, ...) stays the system's, which is why the wheel isn't called manylinux.
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
        inside, source = Path(self.build_lib) / "tides", library()
        for old in inside.glob("libtides.so*"):  # an earlier build's
            old.unlink()
        shutil.copyfile(source, inside / f"libtides.so.{version().split('.')[0]}")
        shutil.copy(source.parent / "tides", inside / "tides")


class PlatformWheel(bdist_wheel):
    """Any Python 3, this platform."""

    def finalize_options(self):
        super().finalize_options()
        self.root_is_pure = False

    def get_tag(self):
        return "py3", "none", super().get_tag()[2]


class BinaryDistribution(Distribution):
    def has_ext_modules(self):
        return True


SCRATCH.mkdir(parents=True, exist_ok=True)
setup(
    version=version(),
    distclass=BinaryDistribution,
    cmdclass={"build_py": BuildWithLibrary, "bdist_wheel": PlatformWheel},
    options={"build": {"build_base": str(SCRATCH)}, "egg_info": {"egg_base": str(SCRATCH)}},
)
