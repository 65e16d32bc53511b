"""Runs last: checks that every function of the library has a wrapper that an earlier test called."""

import pytest
import tides
from conftest import CALLS

FILES = {"api", "baselines", "calibrate", "values", "world", "simulation", "events", "event_reading", "session", "dataset", "exposure", "page", "threads"}


def test_every_function_was_called(request):
    collected = {item.path.stem for item in request.session.items}
    if not {f"test_{name}" for name in FILES} <= collected or request.config.getoption("keyword"):
        pytest.skip("only a part of the tests was run")
    missing = sorted(set(tides.api.FUNCTIONS) - set(CALLS))
    assert not missing, "no test of the Python package calls these: wrap them in python_ctypes/tides, and test that"
