#!/bin/sh
# Tests in Python against the event file that a small run writes: what people's own readers (h5py) see.
# environment: TIDES the command line tool, PYTHON the interpreter; the tests find the file through TIDES_TEST_EVENTS.
set -u
ls tests/python/test_*.py >/dev/null 2>&1 || { echo "no tests in tests/python"; exit 77; }
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
"$TIDES" simulate tests/install/run.json -o "$work/events.h5" || exit 1
TIDES_TEST_EVENTS="$work/events.h5" PYTHONDONTWRITEBYTECODE=1 "${PYTHON:-/usr/bin/python3}" -m pytest -q -p no:cacheprovider tests/python
