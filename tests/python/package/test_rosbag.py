"""tides.rosbag and tides.bag without the package that they need say which; tests/clients has what they do with it."""

import importlib
import sys

import pytest


@pytest.mark.parametrize("name", ["tides.rosbag", "tides.bag"])
def test_what_is_missing_is_named(monkeypatch, name):
    monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(ImportError, match=r"pip install tides\[rosbags\]"):
        importlib.import_module(name)
