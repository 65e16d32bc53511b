#!/bin/sh
# Small runs on Oclgrind, an OpenCL device that interprets kernels and watches each access: the path of GPUs, one pixel a
# work-item. Its events are the scalar float reference's to the bit, and it has nothing to say: no data race within or between
# work-groups, no access outside a buffer, no call that misuses the API.
# environment: TIDES the command line tool, ROWS a pattern of case: only those runs
#
# -disable-llvm-passes: Oclgrind 21.10 doesn't know llvm.experimental.noalias.scope.decl, which clang leaves wherever it inlines
# what returns a struct. Its --uninitialized isn't asked for: it tells of padded candidates whose records a printf in the same
# kernel shows to be written.
set -u
if ! command -v oclgrind >/dev/null; then
    echo "check-devices: oclgrind isn't installed (apt install oclgrind): skipped"
    exit 77
fi
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0 failed=0
small='--set time.stop=0.005 --set camera.width=20 --set camera.height=17 --set camera.fx=18 --set camera.fy=18 --set camera.cx=10 --set camera.cy=8'
export OCLGRIND_BUILD_OPTIONS='-O0 -disable-llvm-passes'

fail() {
    failed=$((failed + 1))
    echo "$1: $2"
    head -n 30 "$work/log"
}

# The events' columns, not the file: its attributes name the device.
events() { "$TIDES" convert "$1" "$1.csv" --to csv-ns >"$work/log" 2>&1; }

# run NAME SETTING...: both devices, with these keys set
run() {
    name=$1
    shift
    case $name in ${ROWS:-*}) ;; *) return ;; esac
    settings=
    for one in "$@"; do settings="$settings --set $one"; done
    # shellcheck disable=SC2086 # words on purpose
    if ! oclgrind --data-races --check-api --max-errors 20 "$TIDES" simulate "$scene" -q $small $settings --device oclgrind \
        -o "$work/device.h5" >"$work/log" 2>&1; then
        fail "$name" "the run failed"
    elif [ -s "$work/log" ]; then
        fail "$name" "Oclgrind says"
    elif ! "$TIDES" simulate "$scene" -q $small $settings --device reference-f32 -o "$work/float.h5" >"$work/log" 2>&1 ||
        ! events "$work/device.h5" || ! events "$work/float.h5"; then
        fail "$name" "the reference failed"
    elif ! cmp "$work/device.h5.csv" "$work/float.h5.csv" >"$work/log" 2>&1; then
        fail "$name" "other events than reference-f32"
    else
        passed=$((passed + 1))
        echo "ok   $name: $(grep -c . "$work/device.h5.csv") events"
    fi
}

scene=tests/install/run.json
run 'fixed steps'
run 'error control' stepping.mode=error
run 'hard order' stepping.mode=error image.rules=inria
run 'blocks' stepping.mode=error stepping.unit=block
run 'paths' stepping.mode=error stepping.paths=true
run 'events looked up' stepping.mode=error stepping.solve=float
run 'in double' stepping.mode=error stepping.solve=double stepping.unit=block stepping.paths=true
run 'blur' stepping.mode=error frontend.psf_sigma_px=0.8
# The same wall, which flies past a camera at rest.
cat >"$work/moving.json" <<'JSON'
{
  "scene":    { "file": "scene.ply", "objects": [{ "file": "scene.ply", "trajectory": "path.txt" }] },
  "camera":   { "file": "still.txt" },
  "time":     { "start": 0.0, "stop": 0.005 },
  "stepping": { "mode": "error" }
}
JSON
cp tests/install/scene.ply tests/install/path.txt "$work" && printf '0 0 0 -6 0 0 0 1\n0.06 0 0 -6 0 0 0 1\n' >"$work/still.txt"
scene=$work/moving.json
run 'moving objects'
run 'moving objects, solved' stepping.solve=double stepping.unit=block stepping.paths=true
echo "$passed passed, $failed failed, 0 skipped"
[ $failed = 0 ]
