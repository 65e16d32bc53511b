#!/bin/sh
# Makes Debian packages of an installed tree, with dpkg-dev alone: libtides0, libtides-dev, tides, python3-tides.
# usage: deb.sh ROOT OUTPUT     ROOT: what `make install PREFIX=/usr` put there, in Debian's folders; the packages go to OUTPUT
# environment: VERSION, MAJOR, DEB_MAINTAINER
set -eu
root=$(realpath "$1")
output=$(realpath "$2")
architecture=$(dpkg --print-architecture)
libdir=usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)
maintainer=${DEB_MAINTAINER:-The TIDES authors <tides@localhost.localdomain>}
stages=$(mktemp -d)
trap 'rm -rf "$stages"' EXIT
umask 022

# Moves PATH... of the tree to a package. What is never moved would be lost, so the tree must be empty in the end.
take() { # package, paths
    package=$1
    shift
    for path; do
        mkdir -p "$stages/$package/$(dirname "$path")"
        mv "$root/$path" "$stages/$package/$path"
    done
}

# What the package's programs link, as packages with the versions that their symbols ask for.
linked() { # package, programs
    package=$1
    shift
    mkdir -p "$stages/control/debian"
    printf 'Source: tides\n\nPackage: %s\nArchitecture: any\n' "$package" >"$stages/control/debian/control"
    (cd "$stages/control" && dpkg-shlibdeps -O -x"libtides$MAJOR" -l"$stages/libtides$MAJOR/$libdir" "$@" 2>/dev/null) |
        sed -n 's/^shlibs:Depends=//p'
}

# The packages' common part: licence, changes, sums, sizes. The description is standard input.
finish() { # package, section, architecture, fields...
    package=$1 section=$2 arch=$3
    shift 3
    folder=$stages/$package
    docs=$folder/usr/share/doc/$package
    mkdir -p "$folder/DEBIAN" "$docs"
    {
        printf 'Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/\n\nFiles: *\nCopyright: '
        sed -n 's/^Copyright (c) //p' LICENSE
        printf 'License: Expat\n'
        sed '1,4d; s/^$/./; s/^/ /' LICENSE
    } >"$docs/copyright"
    {
        printf 'tides (%s) unstable; urgency=medium\n\n  * What is new: docs/CHANGELOG.md of the sources.\n\n' "$VERSION"
        printf ' -- %s  %s\n' "$maintainer" "$(git log -1 --format=%cD 2>/dev/null || date -R)"
    } | gzip -9n >"$docs/changelog.gz"
    (cd "$folder" && find usr -type f -exec md5sum {} + | LC_ALL=C sort -k 2) >"$folder/DEBIAN/md5sums"
    {
        printf 'Package: %s\nVersion: %s\nSource: tides\nArchitecture: %s\nMaintainer: %s\n' "$package" "$VERSION" "$arch" "$maintainer"
        printf 'Section: %s\nPriority: optional\nInstalled-Size: %s\n' "$section" "$(du -sk "$folder/usr" | cut -f 1)"
        for field; do [ -z "$field" ] || printf '%s\n' "$field"; done
        cat
    } >"$folder/DEBIAN/control"
    dpkg-deb --root-owner-group --build "$folder" "$output" >/dev/null
}

find "$root/$libdir" "$root/usr/bin" -type f -name '*tides*' ! -name '*.cmake' ! -name '*.pc' -exec \
    strip --strip-unneeded --remove-section=.comment --remove-section=.note {} +
find "$root/usr/share/man" -type f -exec gzip -9n {} +
mkdir -p "$root/usr/share/zsh/vendor-completions"
mv "$root/usr/share/zsh/site-functions/_tides" "$root/usr/share/zsh/vendor-completions/_tides"

library=libtides$MAJOR
take "$library" "$libdir/libtides.so.$MAJOR" "$libdir/libtides.so.$VERSION"
chmod 644 "$stages/$library/$libdir/libtides.so.$VERSION"
mkdir -p "$stages/$library/DEBIAN"
echo "libtides $MAJOR $library (>= $VERSION)" >"$stages/$library/DEBIAN/shlibs"
echo 'activate-noawait ldconfig' >"$stages/$library/DEBIAN/triggers"
finish "$library" libs "$architecture" 'Multi-Arch: same' \
    "Depends: $(linked "$library" "$stages/$library/$libdir/libtides.so.$VERSION")" 'Recommends: pocl-opencl-icd | opencl-icd' <<'END'
Description: event cameras in continuous time from Gaussian splats - library
 Takes a scene of 3D Gaussian splats and a camera path, renders log-luminance
 and its exact time derivative, and solves for every threshold crossing.
END

take libtides-dev usr/include "$libdir/libtides.so" "$libdir/pkgconfig" "$libdir/cmake"
finish libtides-dev libdevel "$architecture" 'Multi-Arch: same' "Depends: $library (= $VERSION)" <<'END'
Description: event cameras in continuous time from Gaussian splats - headers
 What C and C++ programs need to use the library, with files for pkg-config and
 CMake.
END

take tides usr/bin/tides usr/share/man usr/share/bash-completion usr/share/zsh/vendor-completions usr/share/tides
finish tides science "$architecture" "Depends: $library (= $VERSION), $(linked tides "$stages/tides/usr/bin/tides")" <<'END'
Description: event cameras in continuous time from Gaussian splats - tool
 Simulates, converts, compares and views event streams, renders frames with
 ground truth, and writes datasets.
END

python=usr/lib/python3/dist-packages/tides
mkdir -p "$stages/python3-tides/$python" "$stages/python3-tides/DEBIAN"
cp python_ctypes/tides/*.py python_ctypes/tides/py.typed "$stages/python3-tides/$python"
mkdir -p "$stages/python3-tides/$python/play"
cp python_ctypes/tides/play/*.py python_ctypes/tides/play/page.html "$stages/python3-tides/$python/play"
find "$stages/python3-tides/$python" -type f -exec chmod 644 {} +
printf '#!/bin/sh\nset -e\nif command -v py3compile >/dev/null; then py3compile -p python3-tides; fi\n' \
    >"$stages/python3-tides/DEBIAN/postinst"
printf '#!/bin/sh\nset -e\nif command -v py3clean >/dev/null; then py3clean -p python3-tides; fi\n' \
    >"$stages/python3-tides/DEBIAN/prerm"
chmod 755 "$stages/python3-tides/DEBIAN/postinst" "$stages/python3-tides/DEBIAN/prerm"
finish python3-tides python all "Depends: $library (= $VERSION), python3 (>= 3.9), python3-numpy" \
    "Recommends: tides (= $VERSION)" <<'END'
Description: event cameras in continuous time from Gaussian splats - Python
 The whole interface of the library for Python, with numpy arrays.
END

left=$(find "$root" ! -type d)
[ -z "$left" ] || { echo "deb: in no package: $left" >&2; exit 1; }
