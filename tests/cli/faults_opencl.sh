# Calls of OpenCL that fail, one after the other (fault_opencl.c): one line about it and exit code 1, or the same events if the
# run could go on without. No OpenCL object and no file is left, and no process crashes or hangs. All calls with
# TIDES_FAULTS=all, else some.
ldd "$(command -v tides)" | grep -q asan && skip "PoCL keeps what it has at exit"
shim=$PWD/shim.so
${CC:-cc} -O1 -shared -fPIC -o "$shim" "$here/fault_opencl.c" -ldl || skip "the shim needs glibc"
make_scene
unset TIDES_DEVICE
tides devices --json >devices.json 2>err
grep -q '"kind":[[:space:]]*"cpu"' devices.json || skip "no OpenCL processor here"

# with AT COMMAND...: call number AT fails; `count` gets the shim's line.
with() {
    local at=$1
    shift
    rm -f count
    FAULT_AT=$at FAULT_COUNT=count LD_PRELOAD=$shim timeout 60 "$@" >out 2>err </dev/null
}
numbers() {
    awk -v n="$1" -v few="$2" -v all="${TIDES_FAULTS:-}" 'BEGIN {
        step = all == "all" || n <= few ? 1 : n / few
        for (k = 1; k < n; k += step) print int(k)
        if (n > 0) print n
    }'
}

# sweep FEW COMMAND...: writes e.h5, and any of its calls may fail.
sweep() {
    local few=$1 k n code live name tried=0 without=0
    shift
    with 0 "$@" # builds the kernels
    with 0 "$@" || fail "it should run"
    read -r n live name <count
    [ "$n" -gt 100 ] || fail "$n calls: the shim isn't asked"
    [ "$live" = 0 ] || fail "$live objects are left"
    mv e.h5 whole.h5
    for k in $(numbers "$n" "$few"); do
        with "$k" "$@"
        code=$?
        read -r _ live name <count || fail "call $k of $n: it ended without its exit"
        tried=$((tried + 1))
        case $code in
            0) cmp -s e.h5 whole.h5 || fail "$name, $k of $n: it did without, but not the same"
                without=$((without + 1)) ;;
            1) [ "$(wc -l <err)" = 1 ] && grep -q '^tides: ' err || fail "$name, $k of $n: not one line"
                missing e.h5 ;;
            *) fail "$name, $k of $n: exit code $code" ;;
        esac
        [ "$live" = 0 ] || fail "$name, $k of $n: $live objects are left"
        rm -f e.h5*
    done
    report "calls of OpenCL: $tried of $n failed; it did without $without"
}

sweep 10 tides simulate run.json -qo e.h5 --device cpu --set time.stop=0.01
sweep 16 tides simulate run.json -qo e.h5 --device cpu --set time.stop=0.01 --set stepping.solve=double --set stepping.unit=block
