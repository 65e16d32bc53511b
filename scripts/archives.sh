#!/bin/sh
# The linker's words for libraries, with an archive in place of each shared library that the system has one of.
# usage: archives.sh CC -LDIR... -lNAME...
# For `make wheel`: Debian's libhdf5.so alone draws in curl, Kerberos and LDAP, thirty libraries of which an HDF5 file needs none.
# The C library stays shared, and so does OpenCL's loader, which finds drivers as the system does.
set -eu
compiler=$1
shift
folders=
for word; do
    case $word in -L*) folders="$folders ${word#-L}" ;; esac
done

find_archive() { # lib*.a
    for folder in $folders; do
        if [ -f "$folder/$1" ]; then
            echo "$folder/$1"
            return
        fi
    done
    # shellcheck disable=SC2086 # words: "ccache gcc"
    found=$($compiler -print-file-name="$1")
    [ "$found" = "$1" ] || echo "$found"
}

for word; do
    case $word in
        -lm | -lpthread | -ldl | -lrt | -lOpenCL) archive= ;;
        -l*) archive=$(find_archive "lib${word#-l}.a") ;;
        *) archive= ;;
    esac
    echo "${archive:-$word}"
done
