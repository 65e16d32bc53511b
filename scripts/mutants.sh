#!/bin/sh
# Mutants of formulas (tests/mutants.txt): each is built in a copy of the sources, and at least one of its tests must fail.
# usage: mutants.sh [PATTERN]   only those whose line has it. environment: MAKE, JOBS
set -u
here=$PWD
copy=$here/build/mutants
mkdir -p "$copy"
killed=0 alive=0
tab=$(printf '\t')
while IFS=$tab read -r file old new tests; do
    case $file in '' | '#'*) continue ;; esac
    case "$file $old" in *"${1-}"*) ;; *) continue ;; esac
    for folder in Makefile include lib kernels cli share tests; do cp -R -p -u "$here/$folder" "$copy"; done
    cp "$here/$file" "$copy/$file" # cp -u leaves a mutant that is newer than its original, where one was left
    if ! "${PYTHON:-/usr/bin/python3}" - "$copy/$file" "$old" "$new" <<'PY'; then
import sys
path, old, new = sys.argv[1:]
text = open(path).read()
if text.count(old) != 1:
    sys.exit(f"{path}: {text.count(old)} times: {old}")
open(path, "w").write(text.replace(old, new))
PY
        alive=$((alive + 1))
        continue
    fi
    programs=
    for test in $tests; do programs="$programs build/release/tests/$test"; done
    # shellcheck disable=SC2086
    if ! (cd "$copy" && ${MAKE:-make} -s -j"${JOBS:-2}" $programs >build.log 2>&1 </dev/null); then
        echo "not built: $file: $new"
        tail -n 3 "$copy/build.log"
        alive=$((alive + 1))
    else
        by=
        for test in $tests; do
            (cd "$copy" && timeout 600 "build/release/tests/$test" >test.log 2>&1 </dev/null) || { by=$test && break; }
        done
        if [ -n "$by" ]; then
            killed=$((killed + 1))
            echo "killed by $by: $file: $new"
        else
            alive=$((alive + 1))
            echo "ALIVE: $file: $new"
        fi
    fi
    cp "$here/$file" "$copy/$file"
done <tests/mutants.txt
echo "$killed passed, $alive failed, 0 skipped"
[ $alive = 0 ]
