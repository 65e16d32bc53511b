# System calls that fail, one after the other (fault_shim.c): one line, exit code 1, the old file is still there, and no .part
# is left, except for recordings whose message names it. All of them with TIDES_FAULTS=all, else some of each.
ldd "$(command -v tides)" | grep -q asan && skip "the sanitiser's allocator wants to be the first"
shim=$PWD/shim.so
${CC:-cc} -O1 -shared -fPIC -o "$shim" "$here/fault_shim.c" -ldl || skip "the shim needs glibc"
make_scene
expect 0 tides simulate run.json -qo base.h5
log=$PWD/log

# with CALL AT COMMAND...: the command's call number AT fails; its line in `count` says how many there were.
with() {
    local call=$1 at=$2
    shift 2
    rm -f count
    FAULT_CALL=$call FAULT_AT=$at FAULT_COUNT=count LD_PRELOAD=$shim "$@" >out 2>err </dev/null
}
# calls CALL: how many of that kind the command before made.
calls() { awk -v c="$1" '{ print c == "ours" ? $1 : c == "hdf5" ? $2 : c == "others" ? $4 : $5 }' count | tail -n 1; }

# -- files -------------------------------------------------------------------------------------------------------------------

# numbers N FEW: 1 to N, or about FEW of them, the first and the last too.
numbers() {
    awk -v n="$1" -v few="$2" -v all="${TIDES_FAULTS:-}" 'BEGIN {
        step = all == "all" || n <= few ? 1 : n / few
        for (k = 1; k < n; k += step) print int(k)
        if (n > 0) print n
    }'
}

told() { [ "$(wc -l <err)" = 1 ] && grep -q '^tides: ' err; }

# fails FILE COMMAND...: whatever fails of writing FILE.
fails() {
    local file=$1 call k n code
    shift
    echo old >"$file"
    for call in write fsync rename close; do
        export FAULT_NEAR=$file
        [ $call != close ] || FAULT_NEAR=$file.part # what is closed when it is in place lost nothing any more
        with $call 0 "$@" || fail "$file: it should be written"
        n=$(calls $call)
        [ "${n:-0}" -ge 1 ] || fail "$file: nothing to $call"
        for k in $(numbers "$n" 2); do
            echo old >"$file"
            rm -f "$file".part*
            with $call "$k" "$@"
            code=$?
            # what is closed without having been written loses nothing: only the last close matters
            [ "$code" = 0 ] && [ $call = close ] && [ "$k" != "$n" ] && continue
            [ "$code" = 1 ] || fail "$file: $call $k of $n: exit code $code"
            told || fail "$file: $call $k of $n: not one line"
            [ "$(cat "$file")" = old ] || fail "$file: $call $k of $n: the old file is gone"
            if [ -e "$file.part" ]; then
                grep -Eq "$file\.part" err && [ "$1 $2" = "tides simulate" ] || fail "$file: $call $k of $n leaves a .part"
            fi
            files=$((files + 1))
        done
    done
    unset FAULT_NEAR
    rm -f "$file" "$file".part*
}

files=0
fails e.h5 tides simulate run.json -qo e.h5
fails e.raw tides simulate run.json -qo e.raw
fails s.json tides simulate run.json -qo x.h5 --stats s.json
fails p.png tides simulate run.json -qo x.h5 --preview p.png
fails f.exr tides render run.json -qo f.exr
fails s.h5 tides convert scene.ply s.h5 -q
fails s.ply tides convert scene.ply s.ply -q
fails c.csv tides convert base.h5 c.csv -q
fails c.h5 tides convert base.h5 c.h5 -q
fails p.hdf5 tides convert base.h5 p.hdf5 --to ecf -q
fails v.png tides view base.h5 -qo v.png
fails a.npy tides export base.h5 -qo a.npy
fails a.h5 tides export base.h5 -qo a.h5

report "write, fsync, rename, close: $files failed"

# A folder that can't be put on the disk: the file is in place by then.
mkdir folder
FAULT_NEAR=folder with fsync 0 tides convert scene.ply folder/s.ply -q
[ "$(calls fsync)" = 2 ] || fail "the file and its folder should be put on the disk"
FAULT_NEAR=folder with fsync 2 tides convert scene.ply folder/s.ply -q && fail "its folder isn't on the disk"
told && err "folder/s.ply: is written, but its folder"

# A disk that is full from some point on.
for file in e.h5 e.raw s.ply; do
    case $file in e.*) set -- tides simulate run.json -qo $file ;; *) set -- tides convert scene.ply $file -q ;; esac
    FAULT_NEAR=$file FAULT_AFTER=1 with write 1 "$@" && fail "$file: the disk is full"
    told && err "No space left" || fail "$file: not one line"
    missing $file
done

# A FIFO whose reader has enough, long before all is written.
mkfifo fifo
awk 'BEGIN { for (i = 1; i < 40000; i++) printf "%.6f %d %d %d\n", i * 1e-5, i % 48, i % 36, i % 2 }' >many.txt
head -c 10 fifo >/dev/null &
refuse 1 "fifo: can't be written: Broken pipe" tides convert many.txt fifo --from ecd --to csv -q --width 48 --height 36
[ -p fifo ] || fail "the FIFO should stay"

# -- memory ------------------------------------------------------------------------------------------------------------------

# Whoever doesn't get it: the tool ends with one line, or does without. HDF5 1.10 crashes by itself where it doesn't get
# memory (code 99), or damages the heap and leaves it to glibc to end the process later, outside of HDF5 (a B-tree's node without
# memory for its keys has no list of children yet, and H5B_create frees one): those are counted apart, and nothing else may crash.
rm -f e.h5* s.json
# Without memory for deflate HDF5 stores chunks as they are: other bytes, the same events.
same() {
    cmp -s e.h5 whole.h5 && return
    tides convert e.h5 same.csv -q && tides convert whole.h5 whole.csv -q && cmp -s same.csv whole.csv
}
# What glibc says when it finds the heap in a state that it can't have made.
heap_is_damaged() { grep -Eq '^(corrupted|double free|free\(\)|malloc|realloc|unlink|munmap_chunk\(\)|invalid)' err; }
# memory WHO FEW NAME OPTIONS...: of a run with these options.
memory() {
    local who=$1 few=$2 name=$3 n k code tried=0 crashes=0 damages=0
    shift 3
    with memory 0 tides simulate run.json -qo e.h5 --stats s.json "$@" || fail "it should run"
    cp e.h5 whole.h5
    n=$(calls "$who")
    for k in $(numbers "$n" "$few"); do
        rm -f e.h5* s.json*
        FAULT_WHO=$who with memory "$k" timeout 60 tides simulate run.json -qo e.h5 --stats s.json "$@"
        code=$?
        tried=$((tried + 1))
        case $code in
            0) same && [ -s s.json ] || fail "memory of $who, $k of $n: it did without, but not the same" ;;
            1) told || [ "$who" != ours ] || fail "memory of $who, $k of $n: not one line" ;;
            99) crashes=$((crashes + 1)) ;;
            98) [ "$who" = hdf5 ] && heap_is_damaged || fail "memory of $who, $k of $n: a crash outside of HDF5"
                damages=$((damages + 1)) ;;
            *) fail "memory of $who, $k of $n: exit code $code" ;;
        esac
        missing s.json.part
    done
    report "memory of $who, $name: $tried of $n failed; HDF5 crashed in $crashes, damaged the heap in $damages"
    [ "$who" != ours ] || [ "$crashes" = 0 ] || fail "HDF5 crashed where ours got no memory"
}
memory ours 40 "a run"
memory ours 30 "events looked up" --set stepping.solve=double --set stepping.unit=block --set time.stop=0.01
unset TIDES_DEVICE
tides devices --json >devices.json 2>err
grep -q '"kind":[[:space:]]*"cpu"' devices.json &&
    memory ours 20 "events looked up on the processor" --device cpu --set stepping.solve=double --set stepping.unit=block \
        --set time.stop=0.01
export TIDES_DEVICE=reference
memory others 20 "a run"
memory hdf5 20 "a run"

# -- Python ------------------------------------------------------------------------------------------------------------------

python=${PYTHON:-python3}
"$python" -c 'import numpy' 2>/dev/null || exit 0
library=$(ldd "$(realpath "$(command -v tides)")" | awk '/libtides/ { print $3 }')
export TIDES_LIBRARY=$library PYTHONPATH=$here/../../python_ctypes PYTHONDONTWRITEBYTECODE=1
cat >write.py <<'PY'
import sys, tides
try:
    tides.write_events("e.h5", tides.make_events([1000, 2000], [1, 2], [3, 4], [1, -1]), 8, 8)
except tides.TidesError as error:
    sys.exit(f"tides: {error}")
PY
echo old >e.h5
export FAULT_NEAR=e.h5
for call in write fsync rename close; do
    [ $call != close ] || FAULT_NEAR=e.h5.part
    with $call 0 "$python" write.py || fail "Python: it should be written"
    n=$(calls $call)
    for k in $(numbers "$n" 2); do
        echo old >e.h5
        rm -f e.h5.part*
        with $call "$k" "$python" write.py
        code=$?
        [ "$code" = 0 ] && [ $call = close ] && [ "$k" != "$n" ] && continue
        [ "$code" = 1 ] && told || fail "Python: $call $k of $n: exit code $code"
        [ "$(cat e.h5)" = old ] || fail "Python: $call $k of $n: the old file is gone"
        [ ! -e e.h5.part ] || err "e.h5\.part"
    done
done
