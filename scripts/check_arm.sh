#!/bin/bash
# The same bits on arm64, shown on x86-64: library, tool and tests are cross-built, and run under qemu-user against Debian's arm64
# packages. Unit, kernel and golden tests; the runs of `tides bench determinism` on the float reference, and three on PoCL, each
# with the hash of its events here and there. Prints a line for each and 'N passed, N failed'; 77 where something is missing.
# usage: check_arm.sh        an hour or more, most of it emulation: nice -n 19
# environment: ROOT the folder of arm64's packages (made once, 1 GB), CC the cross compiler, NATIVE the tool for this machine,
#              DETERMINISM a folder of `tides bench determinism --quick`, LIMIT seconds for a test, TESTS, RUNS, POCL_RUNS
#              those to run
set -u
root=${ROOT:-$PWD/build/arm64} native=${NATIVE:-build/release/tides} limit=${LIMIT:-1800}
compiler=${CC:-aarch64-linux-gnu-gcc --sysroot=$root}
multiarch=aarch64-linux-gnu config=arm
out=build/$config
passed=0 failed=0 late=
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

say() { printf '%-6s %s\n' "$1" "$2"; }
pass() { passed=$((passed + 1)); say ok "$1"; }
fail() { failed=$((failed + 1)); say FAIL "$1"; }
skipped() { echo "skipped: $1"; exit 77; }

[ "$(uname -m)" = x86_64 ] || skipped "this isn't x86-64: make check is what there is to run"
for need in ${compiler%% *} qemu-aarch64-static mmdebstrap; do
    command -v "$need" >/dev/null ||
        skipped "no $need (apt install gcc-aarch64-linux-gnu qemu-user-static mmdebstrap arch-test)"
done

# -- packages ----------------------------------------------------------------------------------------------------------
# Unpacked alone: setting them up would take half an hour of emulation and gives nothing that compilers or tests ask for.
packages=pocl-opencl-icd,ocl-icd-opencl-dev,opencl-headers,libopenexr-dev,libpng-dev,libcjson-dev,libhdf5-dev,zlib1g-dev
packages=$packages,libdeflate-dev,libzstd-dev,liblz4-dev,libwebp-dev,libcairo2-dev,fonts-dejavu-core,libcmocka-dev,libc6-dev
if [ ! -f "$root/made" ]; then
    mkdir -p "$root"
    mmdebstrap --quiet --variant=extract --architectures=arm64 \
        --include="$packages,bash,coreutils,binutils" bookworm "$root" || skipped "Debian's arm64 packages can't be had"
    ln -sf bash "$root/bin/sh"
    find "$root/usr/lib" "$root/lib" -type l -lname '/*' | while read -r link; do # else they are this machine's
        ln -srf "$root$(readlink "$link")" "$link"
    done
    touch "$root/made"
fi

# -- build -------------------------------------------------------------------------------------------------------------
export PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_LIBDIR=$root/usr/lib/$multiarch/pkgconfig:$root/usr/share/pkgconfig
make -s -j"${JOBS:-2}" CONFIG=$config CC="$compiler" AR=$multiarch-ar WERROR=-Werror \
    LDFLAGS="-Wl,-rpath-link,$root/usr/lib/$multiarch:$root/lib/$multiarch" all tests >"$work/built" 2>&1 ||
    { tail -n 20 "$work/built"; echo "arm64: the build fails"; exit 1; }
say built "$(file -bL "$out/tides" | cut -d, -f1-2)"
unset PKG_CONFIG_SYSROOT_DIR PKG_CONFIG_LIBDIR

emulated() { timeout "$limit" qemu-aarch64-static -L "$root" "$@"; }

# -- tests -------------------------------------------------------------------------------------------------------------
export OCL_ICD_VENDORS=/nonexistent # of this machine: tests that need a device are skipped; PoCL's turn is below
for program in ${TESTS:-"$out"/tests/unit/test_* "$out"/tests/kernels/test_* "$out"/tests/golden/test_*}; do
    case $program in *.o | *.d) continue ;; esac
    began=$SECONDS
    emulated "$program" >"$work/said" 2>&1
    code=$?
    case $code in
        0) pass "${program#"$out"/} ($((SECONDS - began)) s)" ;;
        124) late="$late ${program##*/}"; say late "${program#"$out"/}: not done within $limit s" ;;
        *) fail "${program#"$out"/}: exit $code"; grep -E 'ERROR|LINE|FAILED' "$work/said" | head -n 5 ;;
    esac
done

# -- hashes ------------------------------------------------------------------------------------------------------------
folder=${DETERMINISM:-$work/own}
[ -f "$folder/determinism.json" ] || "$native" bench determinism --quick --quiet --device reference-f32 -o "$folder" >/dev/null ||
    fail "tides bench determinism on this machine"
runs_of() { # a line for each: NAME SETTING...
    "${PYTHON:-python3}" -c 'import json, sys
for run in json.load(open(sys.argv[1]))["runs"]: print(run["run"], run["settings"])' "$folder/determinism.json"
}
hash_of() { sha256sum "$1" 2>/dev/null | cut -c 1-16; }

# compare NAME DEVICE PLACE TOOL...: its events by the tool, which writes below PLACE, and those of this machine in scalar C
compare() {
    name=$1 device=$2 there=$3$work/there.csv
    shift 3
    sets=$(runs_of | sed -n "s/^$name //p" | sed 's/[^ ][^ ]*/--set &/g')
    # shellcheck disable=SC2086 # words
    [ -f "$work/$name.csv" ] ||
        "$native" simulate "$folder/run.json" $sets --device reference-f32 -q -o "$work/$name.csv" || { fail "$name: not here"; return; }
    # shellcheck disable=SC2086
    "$@" simulate "$folder/run.json" $sets --device "$device" -q -o "$work/there.csv" >"$work/said" 2>&1
    if [ "$(wc -l <"$work/$name.csv")" -lt 2 ]; then
        fail "$name: without events there is nothing to compare"
    elif cmp -s "$work/$name.csv" "$there"; then
        pass "$(hash_of "$there")  $name, $device, $(($(wc -l <"$there"))) lines"
    else
        fail "$name, $device: $(hash_of "$work/$name.csv") here, $(hash_of "$there") there: $(head -n 1 "$work/said")"
    fi
    rm -f "$there"
}
for name in $(runs_of | cut -d' ' -f1); do
    case " ${RUNS-$name} " in *" $name "*) compare "$name" reference-f32 '' emulated "$out/tides" ;; esac
done

# -- PoCL --------------------------------------------------------------------------------------------------------------
# It starts a linker, which must be arm64's too: a chroot, and a kernel that hands arm64's programs to qemu (binfmt_misc). It asks
# /proc and /sys what there is, and LLVM /proc/cpuinfo, which is that of a Cortex-A72 (Raspberry Pi 4) here.
place=/opt/tides # in the chroot
inside() {
    # shellcheck disable=SC2016 # its own words
    timeout "$limit" unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount -t sysfs sysfs "$0/sys" &&
        mount --bind "$0$1/cpuinfo" "$0/proc/cpuinfo" && place=$1 && shift && exec env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME="$place" \
        POCL_CACHE_DIR="$place/cache" chroot "$0" "$place/tides" "$@"' "$root" "$place" "$@"
}
if [ "$(id -u)" != 0 ]; then
    say left "PoCL: chroots need root"
elif ! chroot "$root" /bin/true 2>/dev/null; then
    say left "PoCL: the kernel doesn't hand arm64's programs to qemu (binfmt_misc; apt install binfmt-support)"
else
    mkdir -p "$root$place/cache" "$root/proc" "$root/sys" "$root/tmp" "$root$folder" "$root$work"
    cp -L "$out/tides" "$out"/libtides.so.? "$root$place"
    printf '%s\t: %s\n' processor 0 Features 'fp asimd evtstrm crc32 cpuid' 'CPU implementer' 0x41 'CPU architecture' 8 \
        'CPU variant' 0x0 'CPU part' 0xd08 'CPU revision' 3 >"$root$place/cpuinfo"
    inside devices
    cp -r "$folder/." "$root$folder"
    for name in ${POCL_RUNS-fixed default sensor}; do compare "$name" cpu "$root" inside; done
    rm -rf "${root:?}$work"
fi

[ -z "$late" ] || echo "too long under emulation, not counted:$late"
echo "$passed passed, $failed failed"
[ $failed = 0 ]
