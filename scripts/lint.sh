#!/bin/sh
# Format, static analysis, kernels through clang's OpenCL front end, sizes, shell syntax, and the house as a whole: includes
# that go down only, citations of what is in the repository, openings, guards. Every stage runs; any finding fails.
# environment: TIDY_FLAGS compiler flags, WARNINGS, JOBS processes at a time. usage: lint.sh [STAGE...], default all
set -u
jobs=${JOBS:-2}
failed=
stages=${*:-format clang tidy cppcheck kernels sizes shell top arrows circles wide oracle cites openings guards libm types words prose}

# One process for many files: one for each took minutes on a busy machine.
stage_format() {
    sh scripts/sources.sh | xargs -P "$jobs" -n 64 clang-format-14 --dry-run --Werror || { echo "make format"; return 1; }
}

# What clang warns of and gcc doesn't, without a build: check-clang and fuzz take too long to be run often. fault_shim.c casts
# what dlsym gives to functions, as POSIX asks and ISO C forbids.
stage_clang() {
    find lib cli tests -name '*.c' ! -path 'tests/install/*' ! -name fault_shim.c | LC_ALL=C sort |
        xargs -P "$jobs" -n 64 clang-14 $TIDY_FLAGS $WARNINGS -Werror -fsyntax-only
}

stage_tidy() {
    find lib cli tests -name '*.c' ! -path 'tests/install/*' | LC_ALL=C sort |
        xargs -P "$jobs" -I{} sh -c 'clang-tidy-14 --quiet {} -- $TIDY_FLAGS 2>/dev/null'
}

# Whether a pointer could be const is a matter of taste to cppcheck 2.10's style checks; the rest of its classes are on.
stage_cppcheck() {
    cppcheck --quiet --std=c99 --library=posix --enable=warning,performance,portability --inline-suppr --error-exitcode=1 \
        -j "$jobs" --suppress=missingIncludeSystem --suppressions-list=scripts/cppcheck.supp \
        -D'H5E_BEGIN_TRY={' -D'H5E_END_TRY=}' -Iinclude -Ilib/base -Ilib -I. \
        $(printf -- '-I%s ' cli/*) lib cli tests/support
}

# As lib/device/program.c builds them: one pixel per work-item, as on GPUs, and the width that CPUs get; what names no
# precision in double too. Every switch of kernels/choices.h is given a value. With OpenCL's functions as clang declares
# them, and as kernels/builtins.h does.
stage_kernels() {
    found=0
    own="-cl-no-stdinc -include $(clang-14 -print-resource-dir)/include/opencl-c-base.h -include kernels/builtins.h"
    switches=$(grep -oh 'TD_BUILD_[A-Z_0-9]*' kernels/* | sort -u | sed 's/.*/-D&=1/')
    for program in kernels/*.cl; do
        dialects='1 16'
        grep -qw float "$program" || dialects='1 16 1,-DTD_REAL_DOUBLE=1 4,-DTD_REAL_DOUBLE=1 8,-DTD_REAL_DOUBLE=1'
        for dialect in $dialects; do
            for declared in '-Xclang -finclude-default-header' "$own"; do
                clang-14 -x cl -cl-std=CL1.2 $declared -fsyntax-only -Wall -Wextra -Werror -Ikernels -DTD_OPENCL=1 \
                    -DTD_LANES=$(echo "$dialect" | tr , ' ') $switches "$program" || found=1
            done
        done
    done
    return $found
}

stage_sizes() {
    sh scripts/sources.sh | xargs awk '
        length($0) > 128 { printf "%s:%d: %d columns (at most 128)\n", FILENAME, FNR, length($0); bad = 1 }
        FNR == 500       { printf "%s: 500 lines or more: split it\n", FILENAME; bad = 1 }
        FNR == 1 && FILENAME !~ /install/ && !/^\/\*/ { printf "%s:1: no opening comment\n", FILENAME; bad = 1 }
        /[ \t]$/         { printf "%s:%d: space at the end of the line\n", FILENAME, FNR; bad = 1 }
        END { exit bad }'
}

stage_shell() {
    found=0
    for script in scripts/*.sh kernels/*.sh tests/*/*.sh .ci/run; do
        case $(head -n 1 "$script") in *bash) bash -n "$script" ;; *) sh -n "$script" ;; esac || found=1
    done
    return $found
}

# The top level is what README shows: a test that ran in the wrong folder has left its files there before.
stage_top() {
    git rev-parse --git-dir >/dev/null 2>&1 || return 0 # an unpacked archive
    if git ls-files | cut -d/ -f1 | LC_ALL=C sort -u |
        grep -vxE '\.ci|\.clang-(format|tidy)|\.gitignore|LICENSE|Makefile|README.md|(cli|docs|include|kernels|lib|python_ctypes|scripts|share|tests)'; then
        echo "above: not of the top level"
        return 1
    fi
}

stage_arrows() { ${PYTHON:-python3} scripts/house.py arrows; }
stage_circles() { ${PYTHON:-python3} scripts/house.py circles; }
stage_wide() { ${PYTHON:-python3} scripts/house.py wide; }

# tests/oracle knows the library by its public headers alone, and what works the truth out not even by these.
stage_oracle() {
    found=0
    grep -n '#include "' tests/oracle/*.[ch] | grep -vE '"(tests/oracle|tides)/[a-z_]+\.h"' && found=1
    for part in curve scene image doubt events brute parts worlds worlds_light; do
        grep -nE '"tides/|oracle/(library|verdict|trial)\.h"' tests/oracle/$part.[ch] && found=1
    done
    return $found
}

stage_cites() { ${PYTHON:-python3} scripts/house.py cites; }
stage_openings() { ${PYTHON:-python3} scripts/house.py openings; }
stage_guards() { ${PYTHON:-python3} scripts/house.py guards; }
stage_libm() { ${PYTHON:-python3} scripts/house.py libm; }
# Whoever imports the package has checkers that read its types: its examples are such users. Without mypy only that is said.
stage_types() {
    ${PYTHON:-python3} -m mypy --version >/dev/null 2>&1 || { echo "no mypy: not checked (make deps-lint)"; return 0; }
    MYPYPATH=python_ctypes ${PYTHON:-python3} -m mypy --strict --follow-imports=silent --cache-dir=/dev/null \
        --disable-error-code=import-not-found --disable-error-code=import-untyped python_ctypes/examples/*.py
}

stage_prose() { ${PYTHON:-python3} scripts/prose.py; }
stage_words() { ${PYTHON:-python3} scripts/docs/header.py --check include/tides/*.h; }

for stage in $stages; do
    if output=$("stage_$stage" 2>&1); then
        echo "ok   $stage"
    else
        failed="$failed $stage"
        echo "FAIL $stage"
        echo "$output" | sed 's/^/     | /'
    fi
done
[ -z "$failed" ] || { echo "lint failed:$failed (make format rewrites the format)"; exit 1; }
