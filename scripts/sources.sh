#!/bin/sh
# Prints every C file, header and kernel of the project.
find include lib cli kernels tests \( -name '*.[ch]' -o -name '*.cl' \) -type f | LC_ALL=C sort
