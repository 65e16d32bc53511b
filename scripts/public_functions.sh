#!/bin/sh
# Prints the names of the functions that the public headers declare, sorted, one per line.
cat include/tides.h include/tides/*.h | tr '\n' ' ' | grep -o 'TIDES_API [^(;]*(' | sed -n 's/.*[ *]\(tides_[a-z0-9_]*\) *($/\1/p' |
    LC_ALL=C sort -u
