#!/bin/sh
# Runs one fuzz target for a while, from the seeds of tests/fuzz/seeds.txt and what earlier runs found.
# usage: fuzz.sh PROGRAM SECONDS
set -u
program=$1 seconds=$2
name=$(basename "$program")
corpus=build/fuzz-corpus/$name
mkdir -p "$corpus"
# Lines are "target file"; libFuzzer takes folders, so seeds are copied beside what it finds.
awk -v name="$name" '$1 == name {print $2}' tests/fuzz/seeds.txt | while read -r seed; do
    cp "$seed" "$corpus/seed_$(echo "$seed" | tr '/' '_')"
done
# Binary formats: made by a program.
seeds=build/fuzz-seeds
python3 tests/fuzz/make_seeds.py "$seeds" || exit 1
[ ! -d "$seeds/$name" ] || cp "$seeds/$name"/* "$corpus"
echo "$name for $seconds s (corpus: $corpus)"
log=$corpus.log
if "$program" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -malloc_limit_mb=256 -max_len=65536 -artifact_prefix="$corpus." \
    -print_final_stats=1 "$corpus" >"$log" 2>&1; then
    grep -E 'number_of_executed_units|new_units_added' "$log" | sed 's/^/    /'
else
    tail -n 60 "$log"
    echo "FAILED: $name; replay with: $program $(ls -t "$corpus".*-* 2>/dev/null | head -n 1)"
    exit 1
fi
