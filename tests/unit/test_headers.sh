#!/bin/sh
# Each public header compiles alone, twice over, as strict C99, C++11 and C++17; and C++ sees every function with C linkage.
set -u
CC=${CC:-gcc}
CXX=${CXX:-g++}
passed=0 failed=0
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

try() { # name, command...
    name=$1
    shift
    if "$@" >"$work/log" 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "$name:"
        cat "$work/log"
    fi
}

strict='-Wall -Wextra -Wpedantic -Wundef -Wconversion -Werror -Iinclude'
for header in include/tides.h include/tides/*.h; do
    name=${header#include/}
    printf '#include <%s>\n#include <%s>\nint unused;\n' "$name" "$name" >"$work/one.c"
    cp "$work/one.c" "$work/one.cpp"
    try "$name as C99" $CC -std=c99 $strict -Wstrict-prototypes -fsyntax-only "$work/one.c"
    for standard in c++11 c++17; do
        try "$name as $standard" $CXX -std=$standard $strict -Wshadow -fsyntax-only "$work/one.cpp"
    done
done

# A header without extern "C" would ask the linker for a mangled name.
functions=$(sh scripts/public_functions.sh)
{
    echo '#include <tides.h>'
    echo 'typedef void (*any)(); extern const any all[]; const any all[] = {'
    for function in $functions; do echo "(any)&$function,"; done
    echo '};'
} >"$work/all.cpp"
linkage() {
    $CXX -std=c++11 -Iinclude -c "$work/all.cpp" -o "$work/all.o" || return 1
    nm -u "$work/all.o" | grep -E ' _Z' && return 1
    [ "$(nm -u "$work/all.o" | grep -c ' tides_')" = "$(echo "$functions" | wc -l)" ]
}
try "C linkage" linkage

echo "$passed passed, $failed failed, 0 skipped"
[ $failed = 0 ]
