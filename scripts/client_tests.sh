#!/bin/sh
# Files of random events in every format, read by the clients that people have: in a virtual environment of their own, made
# once in build/python/clients from tests/clients/requirements.txt, and again where that file or the interpreter changes.
# usage: client_tests.sh [PYTEST OPTION...]
# environment: TIDES the command line tool, OUT the folder of the library, PYTHON the interpreter.
set -u
python=${PYTHON:-/usr/bin/python3}
wanted=tests/clients/requirements.txt
venv=$PWD/build/python/clients
log=$venv.log

skip() {
    echo "skipped: $*"
    exit 77
}

# Without a package index pip knows no version of anything; any other failure is one of the requirements, and fails.
make_environment() {
    rm -rf "$venv"
    "$python" -m venv "$venv" >"$log" 2>&1 || skip "$python makes no virtual environment: $(tail -n 1 "$log")"
    "$venv/bin/pip" install -q --disable-pip-version-check --retries 1 --timeout 20 --no-deps --no-compile --only-binary :all: \
        -r "$wanted" >"$log" 2>&1 && return
    rm -rf "$venv"
    lacking=$(sed -n 's/.*satisfies the requirement \([^ ]*\) .*(from versions: none).*/\1/p' "$log")
    [ -z "$lacking" ] || skip "no package index that has $lacking for $("$python" -V) can be reached"
    cat "$log"
    exit 1
}

stamp="$("$python" -VV 2>&1 | cksum) $(cksum <"$wanted")"
mkdir -p "$(dirname "$venv")"
if [ "$(cat "$venv/stamp" 2>/dev/null)" != "$stamp" ]; then
    make_environment
    echo "$stamp" >"$venv/stamp"
fi

work=$(mktemp -d "$PWD/build/python/files-XXXXXX") || exit 1 # half a gigabyte for a minute
trap 'rm -rf "$work"' EXIT
"$TIDES" simulate -q tests/install/run.json -o "$work/events.h5" || exit 1
TIDES_LIBRARY="$PWD/${OUT:-build/release}/libtides.so" PYTHONPATH="$PWD/python_ctypes" TIDES_TEST_EVENTS="$work/events.h5" \
    PYTHONPYCACHEPREFIX="$PWD/build/python/pycache" "$venv/bin/python" -m pytest -q -p no:cacheprovider \
    --basetemp "$work/files" "$@" tests/clients
