#!/bin/sh
# What of lib/ ran, from the counts that tests of $OUT have left: lines, branches, the files with the most that didn't run, and
# $OUT/report/index.html. Fails below 90 % of the lines or 80 % of the branches.
# environment: OUT the configuration's folder, JOBS
set -u
if ! command -v gcovr >/dev/null; then
    echo "coverage: gcovr isn't installed (apt install gcovr): skipped"
    exit 77
fi
report=$OUT/report
mkdir -p "$report"
# A count that two threads wrote at once may be off, or negative: it isn't what is asked for.
gcovr --root . --filter 'lib/' --object-directory "$OUT" "$OUT" -j "${JOBS:-2}" --gcov-ignore-parse-errors \
    --html-details "$report/index.html" --html-title 'TIDES: lib/' --csv "$report/files.csv" --txt "$report/summary.txt" \
    --fail-under-line 90 --fail-under-branch 80 --print-summary
code=$?
echo "most lines not reached:"
# filename,line_total,line_covered,line_percent,branch_total,branch_covered,branch_percent,...
awk -F, 'NR > 1 { printf "%6d lines %6d branches  %s\n", $2 - $3, $5 - $6, $1 }' "$report/files.csv" | sort -rn | head -n 15
exit $code
