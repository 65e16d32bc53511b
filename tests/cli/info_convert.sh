# Scenes there and back, and what info says of every kind of file.
make_scene
expect 0 tides info scene.ply
out "^kind +scene"
out "^gaussians +108"
expect 0 tides convert scene.ply scene.h5
out "scene.h5: 108 Gaussians"
expect 0 tides info scene.h5 --json
out '"gaussians":[[:space:]]*108'
expect 0 tides convert -q scene.h5 back.ply
silent
expect 0 tides convert -q back.ply again.ply
cmp -s back.ply again.ply || fail "writing what was read changes it"
expect 0 tides simulate run.json -q -o a.h5
expect 0 tides simulate run.json -q -o b.h5 --set scene.file=scene.h5
expect 0 tides info --json a.h5
value out events >a.count
expect 0 tides info --json b.h5
[ "$(value out events)" = "$(cat a.count)" ] || fail "the converted scene gives other events"
expect 0 tides info path.txt
out "^kind +path"
out "^format +tum"
out "^samples +3"
out "^stop_s +0.04"
printf 'hello\n' >text
expect 1 tides info text
error_line "text"
printf '\211HDF\r\n\032\nrest' >broken.h5
refuse 1 "broken.h5" tides info broken.h5
printf 'ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nend_header\n' >lying.ply
refuse 1 "lying.ply" tides info lying.ply
