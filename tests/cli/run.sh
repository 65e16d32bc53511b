#!/bin/bash
# Runs every case of this directory against a built `tides`, each in a scratch directory of its own.
# usage: [TIDES=path/to/tides] run.sh [CASE...]     a case is a file NAME.sh here; harness.bash has its vocabulary
set -u

# In the background of a script SIGINT is ignored, which no shell can take back for its children, and cases send it.
[ -z "$(trap -p INT)" ] || exec env --default-signal=INT "$BASH" "${BASH_SOURCE[0]}" "$@"

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
tool=${TIDES:-$here/../../build/tides}
[ -x "$tool" ] || { echo "$tool: not built; run make, or set TIDES" >&2; exit 2; }
scratch=$(mktemp -d "${TMPDIR:-/tmp}/tides-cli-XXXXXX")
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/bin"
ln -s "$(realpath "$tool")" "$scratch/bin/tides"
export PATH=$scratch/bin:$PATH
unset TIDES_DEVICE

passed=0 failed=0 skipped=0
[ $# -gt 0 ] || set -- "$here"/*.sh
for case in "$@"; do
    name=$(basename "$case" .sh)
    [ "$name" = run ] && continue
    mkdir -p "$scratch/$name"
    SECONDS=0
    (cd "$scratch/$name" && source "$here/harness.bash" && source "$here/$name.sh") >"$scratch/$name.log" 2>&1
    case $? in
        0) passed=$((passed + 1)); echo "ok   $name ($SECONDS s)" ;;
        77) skipped=$((skipped + 1)); echo "skip $name: $(tail -n 1 "$scratch/$name.log")" ;;
        *) failed=$((failed + 1)); echo "FAIL $name"; sed 's/^/     | /' "$scratch/$name.log" ;;
    esac
done
echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" = 0 ]
