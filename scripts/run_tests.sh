#!/bin/bash
# Runs test programs, JOBS at a time, prints one line for each as it ends, and then "N passed, N failed, N skipped" (test cases).
# usage: [JOBS=1] run_tests.sh LOGDIR PROGRAM...     the longest first, so that none is left alone with one core at the end
# Cases are counted from what a program prints: cmocka's report, pytest's last line, or a last line of the form above. A
# program that prints neither is one case: exit 0 passed, 77 skipped. A failing program's output is shown, and the rest run on.
set -u

logs=$1
shift
limit=${TEST_TIMEOUT:-600} # [s] for one program, which shares the machine
jobs=${JOBS:-1}
mkdir -p "$logs"

# Kernel builds are shared by all programs and stay inside build/.
export POCL_CACHE_DIR=${POCL_CACHE_DIR:-$PWD/build/pocl-cache}
mkdir -p "$POCL_CACHE_DIR"

# Prints "passed failed skipped" found in a log, or nothing where no known report is in it.
count_cases() {
    awk '
        /^\[  PASSED  \] [0-9]+ test/  { passed += $4; known = 1 }
        /^\[  FAILED  \] [0-9]+ test/  { failed += $4; known = 1 }
        /^\[  SKIPPED \] [0-9]+ test/  { skipped += $4; known = 1 }
        /^\[       OK \]/              { fine++ }
        /^\[  FAILED  \] [A-Za-z_]/    { bad++ }
        /^[0-9]+ passed, [0-9]+ failed, [0-9]+ skipped$/ { p = $1; f = $3; s = $5; own = 1 }
        /^=*[ ]?[0-9]+ (passed|failed|skipped|error).* in [0-9.]+s/ {
            p = f = s = 0; own = 1
            for (i = 2; i <= NF; i++) {
                if ($i ~ /^passed/) p = $(i - 1)
                if ($i ~ /^(failed|error)/) f += $(i - 1)
                if ($i ~ /^skipped/) s = $(i - 1)
            }
        }
        END {
            if (own) { passed = p; failed = f; skipped = s } # the sum of a script that may show reports too
            else if (!known) { passed = fine; failed = bad } # it died before it could sum up
            if (own || known || fine || bad) print passed + 0, failed + 0, skipped + 0
        }' "$1"
}

# Runs one program: its counts go to the first line of REPORT, what there is to say of it to the rest.
run_one() {
    local program=$1 report=$2 name log command code started elapsed passed failed skipped word seconds=$limit
    name=${program#build/*/}
    name=${name#./}
    name=${name#tests/}
    log=$logs/$(echo "$name" | tr '/' '_').log
    case $program in */*) command=$program ;; *) command=./$program ;; esac
    case $program in *cli/run.sh) seconds=$((3 * limit)) ;; esac # some forty cases in one: 600 s where two checks share 2 slow cores
    started=${EPOCHREALTIME/./}
    { # the braces keep bash's own word about a crash out of the report
        timeout --kill-after=10 "$seconds" "$command" >"$log" 2>&1 </dev/null
        code=$?
    } 2>/dev/null
    elapsed=$(((${EPOCHREALTIME/./} - started) / 100000))
    read -r passed failed skipped < <(count_cases "$log") || passed=none
    if [ "$passed" = none ]; then
        passed=0 failed=0 skipped=0
        case $code in 0) passed=1 ;; 77) skipped=1 ;; *) failed=1 ;; esac
    elif [ $code != 0 ] && [ $code != 77 ] && [ "$failed" = 0 ]; then
        failed=1 # it crashed, or a fixture failed
    fi
    word=ok
    [ "$passed" = 0 ] && word=skip
    [ "$failed" != 0 ] && word=FAIL
    {
        echo "$passed $failed $skipped"
        printf '%-4s %-40s %4d passed %3d failed %3d skipped %5d.%d s\n' $word "$name" "$passed" "$failed" "$skipped" \
            $((elapsed / 10)) $((elapsed % 10))
        if [ "$failed" != 0 ]; then
            [ $code = 124 ] && echo "     stopped after $seconds s"
            echo "     exit code $code; the end of $log:"
            tail -n 120 "$log" | sed 's/^/     | /'
        fi
        [ $code = 77 ] && tail -n 1 "$log" | sed 's/^/     /'
    } >"$report"
}

total_passed=0 total_failed=0 total_skipped=0

# Waits for one of the programs under way, and says how it went.
collect_one() {
    local done_pid passed failed skipped
    wait -n -p done_pid || true
    { read -r passed failed skipped; cat; } <"$reports/${number[$done_pid]}"
    total_passed=$((total_passed + passed))
    total_failed=$((total_failed + failed))
    total_skipped=$((total_skipped + skipped))
    running=$((running - 1))
}

reports=$(mktemp -d) || exit 1
trap 'rm -rf "$reports"' EXIT
trap 'kill $(jobs -p) 2>/dev/null; exit 1' INT TERM
declare -A number
running=0 count=0
for program in "$@"; do
    while [ $running -ge "$jobs" ]; do collect_one; done
    count=$((count + 1)) running=$((running + 1))
    run_one "$program" "$reports/$count" &
    number[$!]=$count
done
while [ $running -gt 0 ]; do collect_one; done
echo "$total_passed passed, $total_failed failed, $total_skipped skipped"
[ "$total_failed" = 0 ]
