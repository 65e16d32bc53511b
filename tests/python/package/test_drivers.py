"""pip's OpenCL driver beside the system's: the value of OCL_ICD_VENDORS, and when it isn't changed."""

import importlib.metadata
import os
import sys
from pathlib import Path

import pytest
from tides import _drivers


@pytest.fixture
def machine(monkeypatch, tmp_path):
    """A system with one driver, a cache, and pip's driver installed; none of the loader's variables."""
    for name in _drivers.LOADERS:
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "vendors").mkdir()
    (tmp_path / "vendors" / "gpu.icd").write_text("libgpu.so.1\n")
    driver = tmp_path / "lib" / "libintelocl.so"
    driver.parent.mkdir()
    driver.write_text("")
    monkeypatch.setattr(_drivers, "SYSTEM", tmp_path / "vendors")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(importlib.metadata, "files", lambda name: [File(driver.with_name("other.so")), File(driver)])
    yield tmp_path
    os.environ.pop("OCL_ICD_VENDORS", None)  # before monkeypatch gives back what was there


class File:
    """An entry of a distribution's RECORD."""

    def __init__(self, path):
        self.path, self.name = path, path.name

    def locate(self):
        return self.path


def offered():
    _drivers.offer()
    folder = os.environ.get("OCL_ICD_VENDORS")
    return folder and {path.name: path.read_text().strip() for path in Path(folder).iterdir()}


def test_drivers_of_both(machine):
    wanted = {"gpu.icd": "libgpu.so.1", "pip-libintelocl.icd": str(machine / "lib" / "libintelocl.so")}
    assert offered() == wanted
    os.environ.pop("OCL_ICD_VENDORS")
    (machine / "vendors" / "gpu.icd").rename(machine / "vendors" / "new.icd")  # the system's have changed
    wanted["new.icd"] = wanted.pop("gpu.icd")
    assert offered() == wanted
    assert os.environ["OCL_ICD_VENDORS"].startswith(str(machine / "cache" / "tides"))


def test_a_system_without_drivers(machine):
    (machine / "vendors" / "gpu.icd").unlink()
    (machine / "vendors").rmdir()
    assert list(offered()) == ["pip-libintelocl.icd"]


@pytest.mark.parametrize("name", _drivers.LOADERS)
def test_the_users_choice_stays(machine, monkeypatch, name):
    monkeypatch.setenv(name, "/mine")
    _drivers.offer()
    assert {other: os.environ.get(other) for other in _drivers.LOADERS} == {**dict.fromkeys(_drivers.LOADERS), name: "/mine"}
    assert not (machine / "cache").exists()
    monkeypatch.delenv(name)


def test_nothing_installed(machine, monkeypatch):
    def none(name):
        raise importlib.metadata.PackageNotFoundError(name)

    monkeypatch.setattr(importlib.metadata, "files", none)
    assert offered() is None


def test_a_driver_that_is_gone(machine):
    (machine / "lib" / "libintelocl.so").unlink()
    assert offered() is None


def test_a_cache_that_cannot_be_written_is_said(machine):
    (machine / "cache").write_text("a file")
    with pytest.warns(UserWarning, match="libintelocl.so isn't used.*OCL_ICD_VENDORS="):
        assert offered() is None


def test_each_environment_has_its_own(machine, monkeypatch):
    offered()
    first = os.environ.pop("OCL_ICD_VENDORS")
    monkeypatch.setattr(sys, "prefix", "/another")
    offered()
    assert os.environ["OCL_ICD_VENDORS"] != first
