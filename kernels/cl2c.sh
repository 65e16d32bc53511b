#!/bin/sh
# Turns kernel files into C: one string per line (ISO C99 caps literals at 4095 characters), one table entry per file.
# usage: cl2c.sh FILE... > kernels_embedded.c
echo '/* Generated from kernels/ by cl2c.sh. */'
echo '#include "lib/device/td_kernel_source.h"'
names=
for file in "$@"; do
    name=$(basename "$file" | tr '.' '_')
    names="$names $name:$(basename "$file")"
    echo "static const char *const lines_$name[] = {"
    sed -e 's/\\/\\\\/g' -e 's/"/\\"/g' -e 's/??/?\\?/g' -e 's/^/    "/' -e 's/$/\\n",/' "$file"
    echo '    0};'
done
echo 'const td_kernel_source td_kernel_sources[] = {'
for entry in $names; do echo "    {\"${entry#*:}\", lines_${entry%%:*}},"; done
echo '    {0, 0}};'
