#!/bin/sh
# The shared library exports what the public headers declare: no less (a function is missing), no more (an internal leaks).
# _end, _edata, __bss_start: gold and lld export what they say of sections themselves.
# usage: check_symbols.sh [LIBRARY]     default: libtides.so of $OUT, or of build/release
set -u
library=${1:-${OUT:-build/release}/libtides.so}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
sh scripts/public_functions.sh >"$work/declared"
nm -D --defined-only "$library" | awk '$3 !~ /^(_end|_edata|__bss_start)$/ {print $3}' | LC_ALL=C sort -u >"$work/exported"
missing=$(LC_ALL=C comm -23 "$work/declared" "$work/exported")
extra=$(LC_ALL=C comm -13 "$work/declared" "$work/exported")
[ -s "$work/declared" ] || { echo "no declarations were found in include/"; exit 1; }
[ -z "$missing" ] || { echo "declared but not exported:"; echo "$missing"; }
[ -z "$extra" ] || { echo "exported but not declared:"; echo "$extra"; }
[ -z "$missing$extra" ]
