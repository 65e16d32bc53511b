# Outputs that can't be written are told at once, before the work.
make_scene
refuse 1 "none/e.h5" tides simulate run.json -o none/e.h5
refuse 1 "none/s.json: can't be written" tides simulate run.json -o e.h5 --stats none/s.json
refuse 1 "run.json/p.png: can't be written" tides simulate run.json -o e.h5 --preview run.json/p.png
missing e.h5
missing e.h5.part
refuse 1 "none/f.exr" tides render run.json -o none/f.exr
refuse 1 "none/out.h5" tides convert scene.ply none/out.h5
refuse 1 "out.xyz" tides convert scene.ply out.xyz
: >file
refuse 1 "file: can't be made" tides demo -o file
[ -e /dev/full ] || exit 0
tides --help >/dev/full 2>err
[ $? = 1 ] || fail "a full stdout is a failure"
err "standard output"
