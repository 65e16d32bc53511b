# The vocabulary of the cases; run.sh sources it in front of each.

# Ends the case with what went wrong and what the last command said.
fail() {
    echo "FAILED: $*"
    [ -f out ] && sed 's/^/  stdout: /' out
    [ -f err ] && sed 's/^/  stderr: /' err
    exit 1
}
# A line for whoever ran a sweep (make faults), and for the log.
report() { echo "$*" | tee -a "${TIDES_FAULTS_COUNTS:-/dev/null}"; }
skip() { echo "$*"; exit 77; }

# expect CODE COMMAND...: runs it, keeps stdout and stderr in the files out and err.
expect() {
    local wanted=$1 code
    shift
    echo "\$ $*"
    "$@" >out 2>err </dev/null
    code=$?
    [ "$code" = "$wanted" ] || fail "exit code $code, not $wanted"
}
out() { grep -Eq -- "$1" out || fail "stdout lacks: $1"; }
err() { grep -Eq -- "$1" err || fail "stderr lacks: $1"; }
silent() { [ ! -s out ] && [ ! -s err ] || fail "it should say nothing"; }
exists() { [ -s "$1" ] || fail "$1 should be there"; }
missing() { [ ! -e "$1" ] || fail "$1 shouldn't be there"; }
is_json() { ${PYTHON:-python3} -m json.tool <out >/dev/null || fail "--json should print JSON alone"; }
# less A B WHAT: two numbers, both there.
less() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && b != "" && a + 0 < b + 0) }' || fail "$3: $1 isn't below $2"; }

# The first 128 bytes of a .npy of bytes: npy_header SHAPE.
npy_header() { printf '\x93NUMPY\x01\x00\x76\x00%-117s\n' "{'descr': '|u1', 'fortran_order': False, 'shape': ($1), }"; }

# The last command printed one line on stderr, "tides: ...", that matches, and nothing on stdout.
error_line() {
    [ "$(wc -l <err)" = 1 ] || fail "stderr should be one line"
    [ ! -s out ] || fail "an error belongs on stderr"
    err "^tides: "
    err "$1"
}

# refuse CODE PATTERN COMMAND...: it ends with CODE and one error line that matches.
refuse() {
    local code=$1 pattern=$2
    shift 2
    expect "$code" "$@"
    error_line "$pattern"
}

# A number of the JSON in a file: value FILE KEY.
value() { sed -n "s/^[[:space:]]*\"$2\":[[:space:]]*\([-0-9.e+]*\),\{0,1\}\$/\1/p" "$1" | head -n 1; }

# A chequered wall of 12x9 splats 4 units in front of a camera that slides past it, and a run file: 48x36 px, 0.04 s.
make_scene() {
    awk 'BEGIN {
        print "ply\nformat ascii 1.0\nelement vertex 108"
        n = split("x y z f_dc_0 f_dc_1 f_dc_2 opacity scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3", names, " ")
        for (i = 1; i <= n; i++) print "property float " names[i]
        print "end_header"
        for (j = 0; j < 9; j++) for (i = 0; i < 12; i++) {
            c = (i + j) % 2 ? 1.2 : -1.4
            printf "%g %g 4 %g %g %g 3 -1.9 -1.9 -4 1 0 0 0\n", (i - 5.5) * 0.35, (j - 4) * 0.35, c, c, c
        }
    }' >scene.ply
    printf '0 0 0 0 0 0 0 1\n0.02 0.1 0 0 0 0 0 1\n0.04 0.25 0.05 0 0 0 0 1\n' >path.txt
    cat >run.json <<-JSON
	{ "scene": { "file": "scene.ply" },
	  "camera": { "file": "path.txt", "width": 48, "height": 36, "fx": 50 },
	  "time": { "stop": 0.04 },
	  "stepping": { "step_s": 0.002 } }
	JSON
}

# Small work runs on the reference unless a case says otherwise: it needs no OpenCL.
export TIDES_DEVICE=reference

# await COMMAND...: until it succeeds, however slow the machine is.
await() {
    local end=$((SECONDS + 300))
    until "$@"; do
        [ $SECONDS -lt $end ] || fail "five minutes passed without: $*"
        sleep 0.02
    done
}

# R, S, D: the process goes on; T: it is stopped; Z or nothing: it has ended.
state_of() { awk '{ print $3 }' /proc/$1/stat 2>/dev/null; }
ended() { [[ $(state_of $1) != [RSDT] ]]; }
reaped() { [ ! -e /proc/$1 ]; }

# paused COMMAND...: becomes it, a process that stands still at its first checkpoint (pause_checkpoint.c, which make_pause has built).
# PAUSE_ONCE: a file that the first to stand still makes; others go on.
make_pause() {
    [ -e pause.so ] || ${CC:-cc} -O1 -shared -fPIC -o pause.so "$here/pause_checkpoint.c" -ldl || skip "the shim needs glibc"
}
paused() {
    LD_PRELOAD=$PWD/pause.so ASAN_OPTIONS=${ASAN_OPTIONS:-}:verify_asan_link_order=0 exec "$@"
}

# signal_at_checkpoint SIGNAL COMMAND...: starts it and sends the signal once it has left a (new) checkpoint, where it stands still
# until then. Leaves its exit code in `code`. For after `set -m`: jobs don't start with SIGINT ignored.
signal_at_checkpoint() {
    local signal=$1 run state
    shift
    make_pause
    paused "$@" >out 2>err &
    run=$!
    while state=$(state_of $run) && [[ $state == [RSD] ]]; do sleep 0.01; done
    [ "$state" = T ] || fail "it ended before it was interrupted"
    kill -"$signal" $run
    kill -CONT $run 2>/dev/null # what was killed is gone
    await reaped $run           # until the shell knows that it goes on, `wait` takes its stop for an end
    wait $run
    code=$?
}
