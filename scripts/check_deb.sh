#!/bin/sh
# The Debian packages in a fresh chroot of the release that they were made on: apt installs them with what they depend on, the tool, a
# program linked by pkg-config and the Python package run, and after a purge nothing is left.
# usage: check_deb.sh FOLDER     as root, with debootstrap; CHROOTS=/var/tmp/tides_chroots keeps the system
set -eu
packages=$(realpath "$1")
chroots=${CHROOTS:-/var/tmp/tides_chroots}
suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
[ "$(id -u)" = 0 ] || { echo "check_deb: chroots need root" >&2; exit 1; }
command -v debootstrap >/dev/null || { echo "check_deb: apt install debootstrap" >&2; exit 1; }
if command -v lintian >/dev/null; then
    # Who publishes packages says who they are (DEB_MAINTAINER); here nobody does.
    lintian --allow-root --fail-on error,warning --suppress-tags bogus-mail-host,bogus-mail-host-in-debian-changelog "$packages"/*.deb
else
    echo "lintian isn't installed: its checks are left out"
fi

base=$chroots/$suite-deb
if [ ! -f "$base/etc/debian_version" ]; then
    mkdir -p "$chroots"
    debootstrap --variant=minbase "$suite" "$base" >"$base.log" 2>&1 || { tail -n 5 "$base.log"; exit 1; }
fi
root=$chroots/deb-test
rm -rf "$root"
trap 'rm -rf "$root"' EXIT
cp -a "$base" "$root"
cp /etc/resolv.conf "$root/etc/resolv.conf"
mkdir "$root/packages"
cp "$packages"/*.deb tests/install/scene.ply tests/install/ten_lines.c "$root/packages"
cat >"$root/packages/inside.sh" <<'END'
set -eu
export DEBIAN_FRONTEND=noninteractive
listed() { find / -xdev -path /proc -prune -o -iname '*tides*' -print | grep -v '^/packages\|^/var/lib/dpkg\|^/var/log' || true; }
apt-get update -qq
apt-get install -y -qq --no-install-recommends gcc libc6-dev pkg-config pocl-opencl-icd /packages/*.deb >/tmp/log 2>&1 || { tail /tmp/log; exit 1; }
tides devices
gcc -std=c99 -Wall -Werror /packages/ten_lines.c $(pkg-config --cflags --libs tides) -o /tmp/ten_lines
/tmp/ten_lines /packages/scene.ply
cd /tmp
python3 -c 'import tides; print("Python:", tides.__version__, tides.library_path, [device.name for device in tides.devices()])'
python3 -m tides --version
dpkg -V libtides0 libtides-dev tides python3-tides
apt-get purge -y -qq libtides0 libtides-dev tides python3-tides >/tmp/log 2>&1 || { tail /tmp/log; exit 1; }
left=$(listed)
[ -z "$left" ] || { echo "purge left: $left"; exit 1; }
echo ok
END
# shellcheck disable=SC2046 # one word a setting
unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount -t sysfs sysfs "$0/sys" && exec chroot "$@"' "$root" "$root" \
    env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin $(env | grep -iE '^(https?|no)_proxy=' || true) sh /packages/inside.sh
