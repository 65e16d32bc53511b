#!/bin/sh
# The wheel where nothing of ours is: chroots of Debian 12 and 13 with python3 and pip alone, as a user without rights. In each, pip
# installs the wheel with its extra `cpu`, and README's example and `tides demo` must be done within two minutes of having it.
# usage: check_wheel.sh WHEEL     as root, with debootstrap; SUITES="bookworm trixie", CHROOTS=/var/tmp/tides_chroots keeps them
# pip reaches the index as it does here: PIP_*, proxies and the certificates of this machine are lent to the chroot.
set -eu
wheel=$(realpath "$1")
chroots=${CHROOTS:-/var/tmp/tides_chroots}
[ "$(id -u)" = 0 ] || { echo "check_wheel: chroots need root" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "check_wheel: apt install debootstrap" >&2; exit 1; }

. scripts/lent.sh

fresh() { # SUITE ROOT: the system once, a new user's home each time
    if [ ! -f "$2/etc/debian_version" ]; then
        echo "debootstrap $1"
        debootstrap --variant=minbase --include=python3-pip,ca-certificates "$1" "$2" >"$2.log" 2>&1 || { tail -n 5 "$2.log"; exit 1; }
    fi
    rm -rf "$2/home/user"
    mkdir -p "$2/home/user"
    cp "$wheel" "$2/home/user"
    example >"$2/home/user/example.py"
    cp scripts/wheel_inside.sh "$2/home/user/inside.sh"
    lend "$2"
    chown -R 1000:1000 "$2/home/user"
}

mkdir -p "$chroots"
for suite in ${SUITES:-bookworm trixie}; do
    root=$chroots/$suite
    fresh "$suite" "$root"
    echo "== $suite: $(basename "$wheel")"
    # /proc, /sys: where drivers read what the processor is. unshare: they are gone again with the command.
    # shellcheck disable=SC2046 # one word a setting
    unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount -t sysfs sysfs "$0/sys" && exec chroot --userspec=1000:1000 "$@"' "$root" "$root" \
        env -i HOME=/home/user PATH=/home/user/.local/bin:/usr/bin:/bin $(settings) sh -eu /home/user/inside.sh "$(basename "$wheel")"
done
