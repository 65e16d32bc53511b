# A driver that is installed but can't start isn't reported as missing: each reason has its own message, with its remedy.
unset TIDES_DEVICE
make_scene
mkdir none entries broken old full
told() { # PATTERN COMMAND...: one line that matches, without the advice to install one
    refuse 1 "$@"
    ! grep -q "install one" err || fail "a driver is installed"
}
unset OPENCL_VENDOR_PATH OCL_ICD_FILENAMES
export OCL_ICD_VENDORS=$PWD/none
expect 0 tides devices --device reference
if [ "$(grep -c . out)" -gt 2 ]; then skip "this OpenCL loader doesn't follow OCL_ICD_VENDORS"; fi
refuse 1 "no OpenCL device was found; install one" tides simulate run.json -o e.h5

# An entry whose library is gone; one that is no library; one that needs what isn't there.
export OCL_ICD_VENDORS=$PWD/entries
echo "$PWD/gone.so" >entries/a.icd
told "entries/a.icd can't be loaded .*gone.so.*: its library is gone: install the driver again, or remove the entry" \
    tides simulate run.json -o e.h5
echo text >broken/lib.so
echo "$PWD/broken/lib.so" >entries/a.icd
told "entries/a.icd can't be loaded .*lib.so.*: install the driver again" tides simulate run.json -o e.h5
OCL_ICD_FILENAMES=$PWD/gone.so told "gone.so" tides simulate run.json -o e.h5

# A library that it needs, in an older version, first on LD_LIBRARY_PATH: as conda's libstdc++ is.
if command -v "${CC:-cc}" >/dev/null; then
    echo 'int needed(void) { return 1; }' >needed.c
    echo 'int needed(void); int driver(void) { return needed(); }' >driver.c
    printf 'V_2 { needed; };\n' >new.map
    printf 'V_1 { other; };\n' >old.map
    echo 'int other(void) { return 1; }' >other.c
    make_library() { ${CC:-cc} -shared -fPIC -Wl,-soname,libneeded.so "-Wl,--version-script=$1" -o "$2/libneeded.so" "$3"; }
    make_library new.map . needed.c && make_library old.map old other.c || skip "this compiler makes no versions"
    ${CC:-cc} -shared -fPIC -o driver.so driver.c -L. -lneeded || skip "this compiler makes no libraries"
    echo "$PWD/driver.so" >entries/a.icd
    LD_LIBRARY_PATH=$PWD/old told "version .V_2. not found.*LD_LIBRARY_PATH puts an older library first: start without it" \
        tides simulate run.json -o e.h5
    LD_LIBRARY_PATH=$PWD told "1 driver is installed and can be loaded, but has no device" tides simulate run.json -o e.h5
fi

# PoCL without a folder to keep kernels in, or with one that can only be read.
unset OCL_ICD_VENDORS
expect 0 tides devices
grep -q "Portable Computing Language" out || skip "no PoCL here"
[ "$(grep -c Portable out)" = "$(grep -Ec '^[* ] [0-9]' out)" ] || skip "other drivers are here, too"
own=${POCL_CACHE_DIR-}
cache="PoCL\) can't keep kernels in .*: set POCL_CACHE_DIR to a folder that can be written"
unset POCL_CACHE_DIR
for home in "HOME=/dev/null/home" "XDG_CACHE_HOME=/dev/null/cache" "POCL_CACHE_DIR=/dev/null/pocl"; do
    told "$cache" env "$home" tides simulate run.json -o e.h5
done
if [ "$(id -u)" = 0 ] && command -v setpriv >/dev/null; then
    chmod 755 . .. && mkdir -m 755 read && mkdir -m 777 write
    other="setpriv --reuid=65534 --regid=65534 --clear-groups"
    if $other tides --version >/dev/null 2>&1; then
        told "kernel .* doesn't build on .*$cache" env POCL_CACHE_DIR=$PWD/read $other tides simulate run.json -o write/e.h5
        told "$cache" env -u XDG_CACHE_HOME HOME=/nonexistent $other tides simulate run.json -o write/e.h5
        expect 0 env POCL_CACHE_DIR=$PWD/write $other tides devices
        out "Portable"
    fi
fi
[ -z "$own" ] || export POCL_CACHE_DIR=$own
