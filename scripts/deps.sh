#!/bin/sh
# Installs the Debian packages that are missing, and only those.
# usage: deps.sh build|check|lint|coverage|docs [-q]     -q: say nothing when nothing is missing
# check: and the browser that tests of pages use, where it can be had: without it they are skipped.
# Works as root, or through sudo; without either it prints the line to run and fails.
set -u

build='build-essential pkg-config pocl-opencl-icd ocl-icd-opencl-dev opencl-headers libopenexr-dev libpng-dev libcjson-dev
libhdf5-dev zlib1g-dev libdeflate-dev libzstd-dev liblz4-dev libwebp-dev libcairo2-dev fonts-dejavu-core libcmocka-dev cmake python3 python3-numpy python3-h5py python3-pytest
python3-pip python3-setuptools python3-wheel python3-venv python3-distributed'
lint='mypy clang-14 libclang-rt-14-dev clang-tidy-14 clang-format-14 cppcheck valgrind oclgrind mesa-opencl-icd'
coverage='gcovr'
docs='doxygen mandoc'

case ${1-} in
    build) wanted=$(echo $build) ;;
    browser) wanted=chromium ;; # 414 MB, in 20 s: not for whoever only builds
    check)
        sh "$0" build ${2-} || exit 1
        sh "$0" browser ${2-} || echo "deps: no chromium: tests of pages in a browser are skipped"
        exit 0
        ;;
    lint) wanted=$(echo $build $lint) ;;
    coverage) wanted=$(echo $build $coverage) ;;
    docs) wanted=$(echo $build $docs) ;;
    *) echo "usage: $0 build|check|lint|coverage|docs [-q]" >&2; exit 2 ;;
esac
quiet=${2-}

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "deps: this isn't a Debian-like system: install what corresponds to: $wanted"
    exit 0
fi

# The wanted packages that aren't installed (dpkg-query knows a removed package too: its state then isn't "installed").
missing() {
    have=" $(dpkg-query -W -f='${Package} ${db:Status-Status}\n' $wanted 2>/dev/null | awk '$2 == "installed" {printf "%s ", $1}')"
    for package in $wanted; do
        case $have in *" $package "*) ;; *) printf '%s ' "$package" ;; esac
    done
}

need=$(missing)
if [ -z "$need" ]; then
    if [ "$quiet" != -q ]; then
        echo "All packages are there. In one line, for another machine:"
        echo "  sudo apt-get install -y --no-install-recommends $wanted"
    fi
    exit 0
fi
echo "Missing packages: $need"
echo "Or install them yourself:"
echo "  sudo apt-get install -y --no-install-recommends $need"

if [ "$(id -u)" = 0 ]; then
    as_root=
elif command -v sudo >/dev/null; then
    as_root=sudo
    [ -t 0 ] || as_root='sudo -n' # nobody is there to type a password
else
    echo "deps: neither root nor sudo: run the line above as root, then make again" >&2
    exit 1
fi

install() {
    $as_root env DEBIAN_FRONTEND=noninteractive \
        apt-get -o DPkg::Lock::Timeout=300 install -y --no-install-recommends $need
}

# Package lists may be absent (containers) or name versions that the mirror has dropped: one update, one more try.
install || { $as_root apt-get update; install; }

need=$(missing)
if [ -n "$need" ]; then
    echo "deps: could not install: $need" >&2
    echo "deps: run as root: apt-get update && apt-get install -y --no-install-recommends $need" >&2
    exit 1
fi
