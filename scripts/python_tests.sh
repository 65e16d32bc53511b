#!/bin/sh
# Tests in Python: the event files that a small run writes, now and at 1.4e9 s, as people's own readers (h5py) see it; and the package.
# environment: TIDES the command line tool, OUT the folder of the library, CC, PYTHON the interpreter; the tests find the file
# through TIDES_TEST_EVENTS, and the library through TIDES_LIBRARY.
set -u
ls tests/python/test_*.py >/dev/null 2>&1 || { echo "no tests in tests/python"; exit 77; }
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
"$TIDES" simulate tests/install/run.json -o "$work/events.h5" || exit 1
# The same run at an absolute time, whose file counts from t_offset.
"$TIDES" simulate tests/install/run.json -o "$work/epoch.h5" --set camera.start_s=-1400000000 \
    --set time.start=1400000000 --set time.stop=1400000000.05 || exit 1
TIDES_LIBRARY="$PWD/${OUT:-build/release}/libtides.so" PYTHONPATH="$PWD/python_ctypes" TIDES_TEST_EVENTS="$work/events.h5 $work/epoch.h5" \
    PYTHONDONTWRITEBYTECODE=1 "${PYTHON:-/usr/bin/python3}" -m pytest -q -p no:cacheprovider tests/python
