#!/bin/sh
# Installs into an empty folder, builds programs against what is there through pkg-config and CMake, runs them, and uninstalls again.
# environment: MAKE, CC, PKG_CONFIG, CONFIG
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=/opt/tides
root=$work/root$prefix
# A make inside a test has no share in the outer make's job server; its variables (CFLAGS=...) stay.
MAKEFLAGS=$(echo " ${MAKEFLAGS-}" | sed -e 's/ -j[0-9]*//g' -e 's/ --jobserver-[^ ]*//g')
export MAKEFLAGS

install_to() { ${MAKE:-make} --no-print-directory -s CONFIG="${CONFIG:-release}" "$1" DESTDIR="$work/root" PREFIX=$prefix; }

# A library that pkg-config doesn't find is named before anything is compiled.
if said=$(${MAKE:-make} -n PKG_CONFIG=false all 2>&1); then echo "make goes on without any library"; exit 1; fi
case $said in *"false finds no libpng "*) ;; *) echo "make doesn't name what is missing: $said"; exit 1 ;; esac

install_to install
export PKG_CONFIG_PATH="$root/lib/pkgconfig"
flags=$(${PKG_CONFIG:-pkg-config} --cflags --libs tides)
echo "pkg-config: $flags"
cp -r tests/install/* "$work"
mv "$work/run.json" "$work/room.json" # of which the README's program counts the events
sed -n '/^<!-- check: file program.c -->$/,/^```$/p' README.md | sed '1,2d;$d' >"$work/program.c"
for program in ten_lines program; do
    # shellcheck disable=SC2086
    ${CC:-gcc} -std=c99 -Wall -Wextra -Wpedantic -Werror "$work/$program.c" $flags -o "$work/$program"
    echo "$program:" && (cd "$work" && LD_LIBRARY_PATH="$root/lib" "./$program" scene.ply)
done

# find_package(tides), and which versions it takes.
if command -v cmake >/dev/null; then
    configure() { cmake -S "$work/cmake" -B "$work/made" -DCMAKE_PREFIX_PATH="$root" -DWANTED="$1" >"$work/cmake.log" 2>&1; }
    version=$(${PKG_CONFIG:-pkg-config} --modversion tides)
    for wanted in 99.0 "${version%.*}.$((${version##*.} + 1))"; do
        if configure "$wanted"; then echo "cmake: find_package(tides $wanted) takes version $version"; exit 1; fi
        rm -rf "$work/made"
    done
    { configure "$version" && cmake --build "$work/made" >>"$work/cmake.log" 2>&1; } || { cat "$work/cmake.log"; exit 1; }
    (cd "$work" && made/room scene.ply)
else
    echo "cmake isn't installed: find_package(tides) isn't tested"
fi

# The tool finds its library by itself, and says the version that pkg-config says.
version=$("$root/bin/tides" --version)
echo "$version"
case $version in *"$(${PKG_CONFIG:-pkg-config} --modversion tides)"*) ;; *) echo "version differs from tides.pc"; exit 1 ;; esac
readelf -d "$root/lib/libtides.so" | grep -q 'SONAME.*libtides\.so\.[0-9]*\]' || { echo "libtides.so has no soname"; exit 1; }

# Every command has its page; the completions are scripts.
for page in $("$root/bin/tides" --help | sed -n 's/^  \([a-z][a-z]*\) .*/tides-\1/p') tides; do
    [ -s "$root/share/man/man1/$page.1" ] || { echo "$page.1 isn't installed"; exit 1; }
done
[ -s "$root/share/man/man5/tides-run.5" ] || { echo "tides-run.5 isn't installed"; exit 1; }
bash -n "$root/share/bash-completion/completions/tides"
[ -s "$root/share/zsh/site-functions/_tides" ] || { echo "the zsh completion isn't installed"; exit 1; }

install_to uninstall
left=$(find "$work/root" -type f -o -type l)
[ -z "$left" ] || { echo "uninstall left:"; echo "$left"; exit 1; }
