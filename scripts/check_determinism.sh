#!/bin/sh
# One hash for each run of `tides bench determinism`, whatever the way, and the same from builds by other compilers and from
# Python. Prints them; what differs is shown, and fails.
# environment: TIDES the command line tool, OTHERS other builds of it, OUT the folder of the library, PYTHON; QUICK=--quick
set -u
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failed=0
"$TIDES" bench determinism ${QUICK:-} -o "$work/own" >"$work/own.txt" || failed=1
cat "$work/own.txt"
count=$(wc -l <"$work/own.txt")
for other in ${OTHERS:-}; do
    "$other" bench determinism --quiet ${QUICK:-} -o "$work/other" || failed=1
    # a run's hash stands in the header, before the rows of its ways
    for file in own other; do sed -n '/"results":/q;s/^[[:space:]]*"sha256":[[:space:]]*//p' "$work/$file/determinism.json" >"$work/$file.hashes"; done
    if [ -s "$work/own.hashes" ] && cmp -s "$work/own.hashes" "$work/other.hashes"; then
        echo "$other: the same $count"
    else
        echo "$other: other hashes than $TIDES:"
        diff "$work/own.hashes" "$work/other.hashes"
        failed=1
    fi
done
TIDES_LIBRARY="$PWD/${OUT:-build/release}/libtides.so" PYTHONPATH="$PWD/python_ctypes" PYTHONDONTWRITEBYTECODE=1 \
    "${PYTHON:-/usr/bin/python3}" - "$work/own" <<'PY' || failed=1
import hashlib, json, sys
try:
    import numpy
except ImportError:
    sys.exit("Python: numpy isn't there (apt install python3-numpy)")
import tides

wrong, folder = 0, sys.argv[1]
runs = json.load(open(f"{folder}/determinism.json"))["runs"]
for run in runs:
    settings = {}
    for text in run["settings"].split():
        key, value = text.split("=", 1)
        try:
            settings[key] = json.loads(value)
        except ValueError:
            settings[key] = value
    with tides.Session(f"{folder}/run.json", settings) as session:
        events = session.simulate()
    packed = numpy.zeros(len(events), "<i8, <u2, <u2, i1")
    for field, name in zip(packed.dtype.names, ("t", "x", "y", "p")):
        packed[field] = events[name]
    if hashlib.sha256(packed.tobytes()).hexdigest() != run["sha256"]:
        print(f"Python: other events in {run['run']}")
        wrong = 1
print("Python: differs" if wrong else f"Python: the same {len(runs)}")
sys.exit(wrong)
PY
exit $failed
