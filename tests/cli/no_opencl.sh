# A machine without OpenCL: an error tells so, and the reference works.
unset TIDES_DEVICE
make_scene
mkdir empty
export OCL_ICD_VENDORS=$PWD/empty
expect 0 tides devices --device reference
out "reference"
if [ "$(grep -c . out)" -gt 2 ]; then skip "this OpenCL loader doesn't follow OCL_ICD_VENDORS"; fi
expect 1 tides devices
err "OpenCL"
refuse 1 "OpenCL" tides simulate run.json -o e.h5
expect 0 tides simulate run.json -qo e.h5 --device reference
