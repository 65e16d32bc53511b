#!/bin/sh
# The wheel's extras where nothing of ours is: a fresh virtual environment for each, in which pip installs the wheel with that extra alone,
# and the first commands of its page of the guide are run as they stand there. What would wait for a person is told to end.
# usage: check_extras.sh WHEEL [EXTRA...]     (play usd mujoco ros2)
set -eu
wheel=$(realpath "$1")
shift
root=$(pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
[ $# -gt 0 ] || set -- play usd mujoco ros2

block() { # PAGE: the lines of its first block, without pip's
    awk '/^```sh/ { inside = 1; next } /^```/ && inside { exit } inside' "docs/guide/$1.md" | grep -v '^pip install' |
        sed -e "s|python_ctypes/|$root/python_ctypes/|; s|[[:space:]]*#.*||" \
            -e '/^python -m tides.play/s/$/ --no-browser --alone 2/' -e '/--poses/s/$/ --silence 2/' -e '/^python -m tides.ros2/s/$/ --loopback/'
}

for extra in "$@"; do
    page=$extra
    [ "$extra" != mujoco ] || page=physics
    block "$page" >"$work/commands.sh"
    [ -s "$work/commands.sh" ] || { echo "docs/guide/$page.md has no first block"; exit 1; }
    python3 -m venv "$work/$extra"
    if ! "$work/$extra/bin/pip" install -q "$wheel[$extra]" >"$work/pip.log" 2>&1; then
        echo "skipped  $extra: pip can't install it: $(tail -n 1 "$work/pip.log")"
        continue
    fi
    mkdir "$work/$extra.out"
    if ! (cd "$work/$extra.out" && env -u PYTHONPATH -u TIDES_LIBRARY PATH="$work/$extra/bin:$PATH" sh -eux "$work/commands.sh") >"$work/log" 2>&1; then
        cat "$work/log"
        echo "FAIL     $extra"
        exit 1
    fi
    echo "ok       $extra: $(wc -l <"$work/commands.sh") commands of docs/guide/$page.md"
done
