#!/bin/sh
# Small runs on other OpenCL devices than PoCL's, on the path of GPUs, one pixel a work-item.
# Oclgrind interprets kernels and watches each access. Its events are the scalar float reference's to the bit, and it has nothing
# to say: no data race within or between work-groups, no access outside a buffer, no call that misuses the API.
# rusticl, Mesa's, on llvmpipe: it has no fused multiply-add (lib/device/device.c), so events are near the reference's. A run, all its
# kernels compiled, takes 12 to 30 s of a core and 0.4 GB.
# environment: TIDES the command line tool, ROWS a pattern of case: only those runs
#
# -disable-llvm-passes: Oclgrind 21.10 doesn't know llvm.experimental.noalias.scope.decl, which clang leaves wherever it inlines
# what returns a struct. Its --uninitialized isn't asked for: it tells of padded candidates whose records a printf in the same
# kernel shows to be written.
set -u
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0 failed=0 skipped=0
small='--set time.stop=0.005 --set camera.width=20 --set camera.height=17 --set camera.fx=18 --set camera.fy=18 --set camera.cx=10 --set camera.cy=8'
export OCLGRIND_BUILD_OPTIONS='-O0 -disable-llvm-passes'

fail() {
    failed=$((failed + 1))
    echo "$1: $2"
    head -n 30 "$work/log"
}

# The events' columns, not the file: its attributes name the device.
events() { "$TIDES" convert "$1" "$1.csv" --to csv-ns >"$work/log" 2>&1; }

# The same by reference-f32, once for each name: some are of both devices.
reference() {
    # shellcheck disable=SC2086
    [ -s "$work/$name.h5.csv" ] || {
        "$TIDES" simulate "$scene" -q $small $settings --device reference-f32 -o "$work/$name.h5" >"$work/log" 2>&1 &&
            events "$work/$name.h5"
    }
}

# run NAME SETTING...: with these keys set, the same wherever the name is
run() {
    name=$1
    shift
    case $name in ${ROWS:-*}) ;; *) return ;; esac
    settings=
    for one in "$@"; do settings="$settings --set $one"; done
    "on_$device"
}

on_oclgrind() {
    # shellcheck disable=SC2086 # words on purpose
    if ! oclgrind --data-races --check-api --max-errors 20 "$TIDES" simulate "$scene" -q $small $settings --device oclgrind \
        -o "$work/device.h5" >"$work/log" 2>&1; then
        fail "$name" "the run failed"
    elif [ -s "$work/log" ]; then
        fail "$name" "Oclgrind says"
    elif ! events "$work/device.h5" || ! reference; then
        fail "$name" "the reference failed"
    elif ! cmp "$work/device.h5.csv" "$work/$name.h5.csv" >"$work/log" 2>&1; then
        fail "$name" "other events than reference-f32"
    else
        passed=$((passed + 1))
        echo "ok   oclgrind, $name: $(grep -c . "$work/device.h5.csv") events"
    fi
}

# Pixel by pixel the same events; 32 ns were the most between two of them.
on_rusticl() {
    # shellcheck disable=SC2086
    if ! OCL_ICD_VENDORS=$work/vendors RUSTICL_ENABLE=llvmpipe timeout 600 "$TIDES" simulate "$scene" -q $small $settings \
        --device rusticl -o "$work/device.h5" >"$work/log" 2>&1; then
        fail "$name" "the run failed, or took 10 minutes"
    elif ! events "$work/device.h5" || ! reference; then
        fail "$name" "the reference failed"
    else
        for one in device "$name"; do sed 1d "$work/$one.h5.csv" | sort -t, -k2,2n -k3,3n -k1,1n >"$work/$one.pixels"; done
        paste -d, "$work/device.pixels" "$work/$name.pixels" | awk -F, '
            $2 != $6 || $3 != $7 || $4 != $8 { print "other events: " $0; bad = 1; exit }
            { d = $1 < $5 ? $5 - $1 : $1 - $5; if (d > most) most = d }
            END { if (NR < 10 || most > 500) bad = 1; print NR " events, off by " most + 0 " ns at most"; exit bad }' >"$work/log" ||
            { fail "$name" "far from reference-f32"; return; }
        passed=$((passed + 1))
        echo "ok   rusticl, $name: $(cat "$work/log")"
    fi
}

# Whether to go on with `device`.
is_there() {
    case $device in
        oclgrind) command -v oclgrind >/dev/null && return ;;
        rusticl) mkdir -p "$work/vendors" && echo libRusticlOpenCL.so.1 >"$work/vendors/rusticl.icd" &&
            OCL_ICD_VENDORS=$work/vendors RUSTICL_ENABLE=llvmpipe "$TIDES" devices 2>/dev/null | grep -q rusticl && return ;;
    esac
    echo "check-devices: $device isn't installed (apt install $1): skipped"
    skipped=$((skipped + 1))
    return 1
}

# Another scene: the same wall, which flies past a camera at rest.
cat >"$work/moving.json" <<'JSON'
{
  "scene":    { "file": "scene.ply", "objects": [{ "file": "scene.ply", "trajectory": "path.txt" }] },
  "camera":   { "file": "still.txt" },
  "time":     { "start": 0.0, "stop": 0.005 },
  "stepping": { "mode": "error" }
}
JSON
cp tests/install/scene.ply tests/install/path.txt "$work" && printf '0 0 0 -6 0 0 0 1\n0.06 0 0 -6 0 0 0 1\n' >"$work/still.txt"

device=rusticl
if is_there mesa-opencl-icd; then
    scene=tests/install/run.json
    run 'fixed steps'
    run 'hard order' stepping.mode=error image.rules=inria
    run 'blocks' stepping.mode=error stepping.unit=block stepping.solve=off
    run 'events looked up' stepping.mode=error
    scene=$work/moving.json
    run 'moving objects' stepping.solve=off
fi

device=oclgrind
if is_there oclgrind; then
    scene=tests/install/run.json
    run 'fixed steps'
    run 'error control' stepping.mode=error stepping.solve=off
    run 'hard order' stepping.mode=error image.rules=inria
    run 'blocks' stepping.mode=error stepping.unit=block stepping.solve=off
    run 'events looked up' stepping.mode=error
    run 'blur' stepping.mode=error frontend.psf_sigma_px=0.8
    scene=$work/moving.json
    run 'moving objects' stepping.solve=off
    run 'moving objects, solved'
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ $failed = 0 ]
