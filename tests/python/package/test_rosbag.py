"""tides.rosbag without the rosbags package names it; tests/clients tests the module with it."""

import sys

import pytest


def test_what_is_missing_is_named(monkeypatch):
    monkeypatch.delitem(sys.modules, "tides.rosbag", raising=False)
    monkeypatch.setitem(sys.modules, "rosbags.highlevel", None)
    with pytest.raises(ImportError, match=r"pip install tides\[rosbags\]"):
        import tides.rosbag  # noqa: F401
