#!/bin/sh
# Loops that are compiled for wide vectors (TD_WIDE, lib/base/td_wide.h) have vectors: where a compiler makes a branch of a
# choice it goes number by number without a word, and takes two to three times as long.
# usage: check_wide.sh [LIBRARY]     default: libtides.so of $OUT, or of build/release
set -u
library=${1:-${OUT:-build/release}/libtides.so}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
objdump -d --no-show-raw-insn "$library" >"$work/text" || exit 1
awk '
    /^[0-9a-f]+ <.*>:$/ { name = $2 ~ /\.(avx2|avx512f)(\.[a-z0-9.]+)?>:$/ ? $2 : ""; if (name) wide[name] += 0; next }
    name && /%[yz]mm/   { wide[name]++ }
    END                 { for (name in wide) print wide[name], name }' "$work/text" | tr -d '<>:' >"$work/clones"
[ -s "$work/clones" ] || { echo "skipped: $library has no loops of several widths (gcc on x86-64 makes them, sanitizers don't)"; exit 77; }
awk '$1 == 0 { print $2 ": no instruction of it is on whole vectors"; found = 1 } END { exit found }' "$work/clones"
