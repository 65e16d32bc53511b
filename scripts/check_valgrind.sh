#!/bin/sh
# Programs of $VALGRIND_PROGRAMS and a small simulation on the reference device (OpenCL drivers compile code as they run,
# which valgrind can't follow). environment: TIDES the command line tool
set -u
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0 failed=0
check() {
    name=$1
    shift
    if TIDES_DEVICE=reference valgrind --quiet --leak-check=full --errors-for-leak-kinds=definite --error-exitcode=99 \
        --suppressions=scripts/valgrind.supp "$@" >"$work/log" 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "$name:"
        cat "$work/log"
    fi
}
for program in $VALGRIND_PROGRAMS; do check "$program" "$program"; done
check simulate "$TIDES" simulate tests/install/run.json --device reference -o "$work/events.h5"
echo "$passed passed, $failed failed, 0 skipped"
[ $failed = 0 ]
