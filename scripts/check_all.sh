#!/bin/sh
# Targets of make, one after the other, whatever fails: a line for each as it ends, with its minutes; what it said is kept in
# build/logs/all/TARGET.log. Where nothing was there to check with, it is skipped.
# usage: check_all.sh TARGET...     environment: MAKE
set -u
logs=build/logs/all
mkdir -p "$logs"
passed=0 failed=0 skipped=0
for target in "$@"; do
    log=$logs/$target.log
    begun=$(date +%s)
    word=ok
    ${MAKE:-make} --no-print-directory "$target" >"$log" 2>&1 </dev/null || word=FAIL
    seconds=$(($(date +%s) - begun))
    [ $word = ok ] && tail -n 1 "$log" | grep -qE '^0 passed, 0 failed|: skipped$' && word=skip
    case $word in ok) passed=$((passed + 1)) ;; skip) skipped=$((skipped + 1)) ;; *) failed=$((failed + 1)) ;; esac
    printf '%-4s %-18s %4d.%d min  %s\n' $word "$target" $((seconds / 60)) $((seconds % 60 / 6)) "$(tail -n 1 "$log" | cut -c 1-100)"
    [ $word != FAIL ] || tail -n 40 "$log" | sed 's/^/     | /'
done
echo "$passed passed, $failed failed, $skipped skipped"
[ $failed = 0 ]
