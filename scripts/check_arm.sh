#!/bin/bash
# The same bits on arm64, shown on x86-64: library, tool and tests are cross-built and run under qemu-user against Debian's arm64
# packages. Prints a line for each check and 'N passed, N failed'; exits 77 where something is missing.
# usage: check_arm.sh [PART...]     as root; all parts where none is named; they go side by side:
#   hashes   the runs of `tides bench determinism --quick` on the float reference: the hash of their events, and x86-64's is the same
#   wheel    `make wheel` by arm64's own compiler; pip installs it where there is python3 and pip alone, and README's example runs
#   tests    unit and golden tests, without a device
#   pocl     three of the runs on PoCL, and the kernels' tests, each in one thread
# environment: ROOT for arm64's systems, made once (1.5 GB); CROSS the compiler (make's own CC is this machine's); NATIVE this
#   machine's tool; JOBS; LIMIT processor seconds of emulation for a program of tests, which is late past them: it is named, and
#   neither passed nor failed; TESTS, KERNELS, RUNS, POCL_RUNS
set -u
root=${ROOT:-$PWD/build/arm64} native=${NATIVE:-build/release/tides} limit=${LIMIT:-800} jobs=${JOBS:-2}
bare=$root.bare
compiler="${CROSS:-aarch64-linux-gnu-gcc} --sysroot=$root"
multiarch=aarch64-linux-gnu config=arm
out=build/$config
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

say() { printf '%-6s %s\n' "$1" "$2"; }
pass() { say ok "$1"; }
fail() { say FAIL "$1"; }
skipped() { echo "skipped: $1"; exit 77; }

[ "$(uname -m)" = x86_64 ] || skipped "this isn't x86-64: make check is what there is to run"
[ "$(id -u)" = 0 ] || skipped "chroots need root"
for need in ${compiler%% *} qemu-aarch64-static mmdebstrap; do
    command -v "$need" >/dev/null ||
        skipped "no $need (apt install gcc-aarch64-linux-gnu qemu-user-static binfmt-support mmdebstrap arch-test)"
done
[ -e /proc/sys/fs/binfmt_misc/register ] || mount -t binfmt_misc binfmt_misc /proc/sys/fs/binfmt_misc 2>/dev/null
[ -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ] || update-binfmts --enable qemu-aarch64 2>/dev/null
[ -e /proc/sys/fs/binfmt_misc/qemu-aarch64 ] || skipped "the kernel doesn't hand arm64's programs to qemu (binfmt_misc; apt install binfmt-support)"

# -- systems -----------------------------------------------------------------------------------------------------------
# Unpacked and known to dpkg, but not set up: that would take half an hour of emulation, and neither compilers nor tests ask for it.
small=libstdc++6,bash,coreutils,sed,grep,mawk,findutils,diffutils,debianutils,dpkg,python3,python3-pip,ca-certificates
packages=$small,gcc,libc6-dev,libc-bin,make,pkg-config,python3-setuptools,python3-wheel,pocl-opencl-icd,ocl-icd-opencl-dev,opencl-headers
packages=$packages,libopenexr-dev,libpng-dev,libcjson-dev,libhdf5-dev,zlib1g-dev,libdeflate-dev,libzstd-dev,liblz4-dev,libwebp-dev
packages=$packages,libcairo2-dev,fonts-dejavu-core,libcmocka-dev

system() { # ROOT PACKAGES
    [ ! -f "$1/made" ] || return 0
    rm -rf "$1" && mkdir -p "$1"
    mmdebstrap --quiet --variant=extract --skip=cleanup/apt --architectures=arm64 --include="$2" bookworm "$1" || return 1
    ln -sf bash "$1/bin/sh"
    dpkg --root="$1" --force-all --no-triggers --unpack "$1"/var/cache/apt/archives/*.deb >"$work/unpacked" 2>&1 # licences are asked of it
    grep -q '^Unpacking libc6' "$work/unpacked" || { tail -n 3 "$work/unpacked"; return 1; }
    rm -f "$1"/var/cache/apt/archives/*.deb
    find "$1/usr/lib" "$1/lib" -type l -lname '/*' | while read -r link; do # else they are this machine's
        ln -srf "$1$(readlink "$link")" "$link"
    done
    mkdir -p "$1/tmp" "$1/proc" "$1/sys" && chmod 1777 "$1/tmp"
    touch "$1/made"
}
system "$root" "$packages" || skipped "Debian's arm64 packages can't be had"

# within ROOT FOLDER COMMAND...: in the system, with /proc, this folder bound in it, and an environment of its own ($lent too)
within() {
    mkdir -p "$1$PWD" "$1$work"
    # shellcheck disable=SC2016,SC2086 # its own words
    unshare --mount sh -c 'mount -t proc proc "$0/proc" && mount -t sysfs sysfs "$0/sys" && mount --bind "$1" "$0$1" && mount --bind "$2" "$0$2" &&
        { [ ! -f "$0/cpuinfo" ] || mount --bind "$0/cpuinfo" "$0/proc/cpuinfo"; } && folder=$3 && shift 3 && exec chroot "$0" env -i \
        PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"' "$1" "$PWD" "$work" "$2" HOME="$2" LC_ALL=C ${lent-} sh -c 'cd "$HOME" && exec "$@"' sh "${@:3}"
}

# -- build -------------------------------------------------------------------------------------------------------------
parts=${*:-hashes wheel tests pocl}
programs_of() { for source in "$@"; do echo "$out/${source%.c}"; done; }
programs= kernels=
case " $parts " in *" tests "*) programs=${TESTS-$(programs_of tests/{unit,golden}/test_*.c)} ;; esac
case " $parts " in *" pocl "*) kernels=${KERNELS-$(programs_of tests/kernels/test_*.c)} ;; esac
export QEMU_LD_PREFIX=$root # where qemu finds what arm64's programs link
# shellcheck disable=SC2086 # words
PKG_CONFIG_SYSROOT_DIR=$root PKG_CONFIG_LIBDIR=$root/usr/lib/$multiarch/pkgconfig:$root/usr/share/pkgconfig \
    make -s -j"$jobs" CONFIG=$config CC="$compiler" AR=$multiarch-ar WERROR=-Werror \
    LDFLAGS="-Wl,-rpath-link,$root/usr/lib/$multiarch:$root/lib/$multiarch" all "$out/share/.made" $programs $kernels >"$work/built" 2>&1 ||
    { tail -n 20 "$work/built"; echo "arm64: the build fails"; exit 1; }
machine=$(readelf -h "$out/tides" | sed -n 's/ *Machine: *//p')
[ "$machine" = AArch64 ] || { echo "the tool is $machine's, not AArch64's: CROSS is '$compiler'"; exit 1; }
say built "$machine, $(echo "$programs $kernels" | wc -w) programs of tests"

# -- hashes ------------------------------------------------------------------------------------------------------------
folder=$root.runs # the scene and events are this machine's
# A line for each run, NAME SETTING..., of bench's own table: bench itself would make each in eight ways.
list_runs() {
    cat >"$work/runs.c" <<'END'
#include "bench_determinism.h"
int main(void) {
    const bench quick = {.quick = 1};
    for (const determinism_run *run = determinism_runs; run->name; run++) {
        cli_list sets = {.count = 0};
        determinism_take(&quick, run, &sets);
        printf("%s", run->name);
        for (size_t i = 0; i < sets.count; i++) printf(" %s", sets.items[i]);
        putchar('\n');
    }
    return 0;
}
END
    # shellcheck disable=SC2046 # words
    gcc -std=c99 -D_POSIX_C_SOURCE=200809L -Iinclude $(find cli -type d -printf '-I%p ') $(pkg-config --cflags libcjson cairo) \
        "$work/runs.c" cli/bench/bench_determinism_rows.c -o "$work/runs" && "$work/runs" >"$work/list"
}
# The runs' events in scalar C on this machine, beside which those of arm64 are held.
here() {
    mkdir -p "$folder"
    if ! list_runs || ! "$native" bench determinism --quick --quiet --device reference-f32 --row fixed -o "$folder" >/dev/null; then
        fail "the list of runs, or the demo's world, on this machine"
        return 1
    fi
    while read -r name sets; do
        # shellcheck disable=SC2086 # words
        "$native" simulate "$folder/run.json" $(set_of $sets) --device reference-f32 -q -o "$work/$name.csv" </dev/null || fail "$name: not here"
    done <"$work/list"
}
set_of() { printf -- '--set %s ' "$@"; }
vectors() { # KIND COMMAND...: `tides devices` gives that kind's device NEON's vectors
    local kind=$1 row
    shift
    row=$("$@" devices --device "$kind" | grep "^\* .* $kind " | tr -s ' ')
    case $row in *", vectors of 128 bits (NEON)"*) pass "tides devices: ${row#\* }" ;; *) fail "tides devices names no NEON: $row" ;; esac
}
hash_of() { sha256sum "$1" 2>/dev/null | cut -c 1-16; }

# compare NAME DEVICE TOOL...: its events by the tool, and those of this machine
compare() {
    local name=$1 device=$2 began=$SECONDS there=$work/there.$1.$2.csv said=$work/said.$1.$2
    shift 2
    # shellcheck disable=SC2046 # words
    "$@" simulate "$folder/run.json" $(set_of $(sed -n "s/^$name //p" "$work/list")) --device "$device" -q -o "$there" >"$said" 2>&1
    if [ "$(wc -l <"$work/$name.csv")" -lt 2 ]; then
        fail "$name: without events there is nothing to compare"
    elif cmp -s "$work/$name.csv" "$there"; then
        pass "$(hash_of "$there")  $name, $device, $(($(wc -l <"$there") - 1)) events ($((SECONDS - began)) s)"
    else
        fail "$name, $device: $(hash_of "$work/$name.csv") here, $(hash_of "$there") there: $(head -n 1 "$said")"
    fi
    rm -f "$there"
}
hashes() {
    vectors reference "$out/tides"
    for name in ${RUNS-$(cut -d' ' -f1 "$work/list")}; do
        while [ "$(jobs -rp | wc -l)" -ge "$jobs" ]; do wait -n; done
        compare "$name" reference-f32 "$out/tides" &
    done
    wait
}

# -- wheel -------------------------------------------------------------------------------------------------------------
# Objects are the cross compiler's; arm64's links them, and python packs them. The example takes the reference: a bare system has no
# OpenCL device, and PyPI no driver of one for arm64.
wheel() {
    local began=$SECONDS
    within "$root" "$PWD" make -s wheel-built CONFIG=$config CC=$multiarch-gcc WHEELS=build/python_arm >"$work/said" 2>&1 ||
        { fail "make wheel"; tail -n 5 "$work/said"; return; }
    wheel=$(ls build/python_arm/tides-*_aarch64.whl) || { fail "the wheel's name says no aarch64"; return; }
    pass "${wheel##*/}, $(($(stat -c %s "$wheel") / 1000000)) MB ($((SECONDS - began)) s)"
    system "$bare" "$small" || { fail "the bare system"; return; }
    . scripts/lent.sh
    lend "$bare"
    place=/srv/wheel
    rm -rf "$bare$place" && mkdir -p "$bare$place"
    cp "$wheel" "$bare$place"
    example >"$bare$place/example.py"
    began=$SECONDS
    lent="$(settings) TIDES_DEVICE=reference"
    within "$bare" $place sh -ec 'python3 -m pip install -q --user --break-system-packages ./*.whl
        .local/bin/tides devices
        python3 example.py' >"$work/said" 2>&1
    lent=
    cat "$work/said"
    (library=$(realpath "${native%/*}/libtides.so") packages=$PWD/python_ctypes && cd "$work" &&
        TIDES_DEVICE=reference TIDES_LIBRARY=$library PYTHONPATH=$packages "${PYTHON:-python3}" "$bare$place/example.py" >"$work/said" 2>&1)
    if [ -s "$work/events.raw" ] && cmp -s "$work/events.raw" "$bare$place/events.raw"; then
        pass "$(hash_of "$work/events.raw")  README's example in a bare system ($((SECONDS - began)) s)"
    else
        fail "README's example: $(hash_of "$work/events.raw") here, $(hash_of "$bare$place/events.raw") there"
    fi
}

# -- tests -------------------------------------------------------------------------------------------------------------
# one [COMMAND...] PROGRAM, by COMMAND: a line 'WORD PROGRAM (seconds of the processor)'. One that hangs ends after an hour, and fails (124).
one() {
    local name=${!#} said=$work/said.$BASHPID used code word reason
    name=${name#"$out"/tests/}
    TIMEFORMAT=%U
    # shellcheck disable=SC2030,SC3045
    used=$( { time (ulimit -St "$limit"; "${@:1:$#-1}" timeout -k 5 3600 "${!#}" >"$said" 2>&1 </dev/null); code=$?; } 2>&1; exit $code)
    code=$?
    case $code in
        0 | 77) word=ok; grep -qE '^\[  PASSED  \] [1-9]' "$said" || word=skip ;;
        152) word=late ;;
        *) word=FAIL ;;
    esac
    reason=$(grep -m 1 -oE 'skipped: .*' "$said" | cut -c 1-80)
    printf '%-6s %s (%s s%s)\n' $word "$name" "${used##*$'\n'}" "${reason:+; ${reason#skipped: }}"
    [ $word != FAIL ] || { echo "  exit $code"; grep -E 'ERROR|LINE|FAILED' "$said" | head -n 5 | sed 's/^/  /'; }
    rm -f "$said"
}
tests() {
    export -f one && export out work limit
    export OCL_ICD_VENDORS=/nonexistent # this machine's drivers; PoCL's turn is below
    # shellcheck disable=SC2086 # words
    printf '%s\n' $programs | xargs -P "$jobs" -n 1 bash -c 'one "$0"' | tee "$work/tests"
    summary tests
    unset OCL_ICD_VENDORS
}
summary() { # PART, whose lines are in its file
    say "$1" "$(awk '{sub(/\(/, "", $3); all += $3} END{printf "%d s of the processor", all}' "$work/$1"), $(grep -c '^skip ' "$work/$1") programs skipped"
}

# -- PoCL --------------------------------------------------------------------------------------------------------------
# It starts a linker, which must be arm64's too: a chroot. LLVM asks /proc/cpuinfo, which is that of a Cortex-A72 (Raspberry Pi 4) here.
pocl() {
    printf '%s\t: %s\n' processor 0 Features 'fp asimd evtstrm crc32 cpuid' 'CPU implementer' 0x41 'CPU architecture' 8 \
        'CPU variant' 0x0 'CPU part' 0xd08 'CPU revision' 3 >"$root/cpuinfo"
    mkdir -p "$root.cache"
    lent="POCL_CACHE_DIR=$root.cache POCL_MAX_PTHREAD_COUNT=1" # with two threads qemu 7.2 has died of a segmentation fault
    vectors cpu within "$root" "$PWD" "$out/tides"
    for name in ${POCL_RUNS-fixed default sensor}; do compare "$name" cpu within "$root" "$PWD" "$out/tides"; done
    export -f one within && export out work limit root lent
    # shellcheck disable=SC2086 # words
    printf '%s\n' $kernels | xargs -P "$jobs" -n 1 bash -c 'one within "$root" "$PWD" "$0"' | tee "$work/kernels"
    summary kernels
    rm -f "$root/cpuinfo"
    lent=
}

# Parts go side by side: most of them are one program.
run_parts() {
    local part
    case " $parts " in *" hashes "* | *" pocl "*) here || return ;; esac
    for part in $parts; do
        case $part in hashes | wheel | tests | pocl) "$part" & ;; *) fail "no part '$part'" ;; esac
    done
    wait
}
run_parts | tee "$work/all"
late=$(awk '$1 == "late" {printf " %s", $2}' "$work/all")
[ -z "$late" ] || echo "too long under emulation ($limit s of the processor), not counted: $(echo "$late" | wc -w):$late"
passed=$(grep -c '^ok ' "$work/all") failed=$(grep -c '^FAIL ' "$work/all")
echo "$passed passed, $failed failed"
[ "$failed" = 0 ] && [ "$passed" -gt 0 ]
