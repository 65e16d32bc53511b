"""tides.usd without the usd-core package names it; tests/clients tests the module with it."""

import sys

import pytest


def test_what_is_missing_is_named(monkeypatch):
    monkeypatch.delitem(sys.modules, "tides.usd", raising=False)
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(ImportError, match=r"pip install tides\[usd\]"):
        import tides.usd  # noqa: F401
