#!/bin/sh
# Tests in Python: the event file that a small run writes, as people's own readers (h5py) see it; and the package.
# environment: TIDES the command line tool, OUT the folder of the library, CC, PYTHON the interpreter; the tests find the file
# through TIDES_TEST_EVENTS, and the library through TIDES_LIBRARY.
set -u
ls tests/python/test_*.py >/dev/null 2>&1 || { echo "no tests in tests/python"; exit 77; }
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
"$TIDES" simulate tests/install/run.json -o "$work/events.h5" || exit 1
TIDES_LIBRARY="$PWD/${OUT:-build/release}/libtides.so" PYTHONPATH="$PWD/python_ctypes" TIDES_TEST_EVENTS="$work/events.h5" \
    PYTHONDONTWRITEBYTECODE=1 "${PYTHON:-/usr/bin/python3}" -m pytest -q -p no:cacheprovider tests/python
