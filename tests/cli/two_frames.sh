# Scene and cameras in two coordinate frames: nerfstudio's dataparser_transforms.json joins them wherever it lies, and an error
# tells if it is missing.
make_scene
# The scene's cameras in the data's frame: x' = scale (R x + t), with R a quarter turn about z; what was applied before counts too.
poses() { # rows of the first pose; of the second one a step to its right
	printf '{ %s "w": 48, "h": 36, "fl_x": 50, "frames": [ { "file_path": "1.png", "transform_matrix": %s }, { "file_path": "2.png", "transform_matrix": %s } ] }' "$1" "$2" "$3"
}
mkdir -p there data
poses '' '[[1,0,0,0],[0,-1,0,0],[0,0,-1,0],[0,0,0,1]]' '[[1,0,0,0.3],[0,-1,0,0],[0,0,-1,0],[0,0,0,1]]' >there/transforms.json
# R = [[0,-1,0],[1,0,0],[0,0,1]], t = (1, 2, 30), scale 0.1: x = R^T (x' / 0.1 - t).
poses '' '[[0,-1,0,-2],[-1,0,0,1],[0,0,-1,-30],[0,0,0,1]]' '[[0,-1,0,-2],[-1,0,0,-2],[0,0,-1,-30],[0,0,0,1]]' >data/transforms.json
run="run.json --set camera.fx=null --set camera.duration_s=0.04"
json='{ "transform": [[0,-1,0,1],[1,0,0,2],[0,0,1,30]], "scale": 0.1 }'
expect 0 tides simulate $run -o lost.h5 --set camera.file=data/transforms.json
err "cameras see next to nothing of the scene, or stand far outside.*dataparser_transforms.json.*camera.frame"
echo "$json" >data/dataparser_transforms.json
expect 0 tides render $run -o found.exr --set camera.file=data/transforms.json
err "trainer's frame by .*data/dataparser_transforms.json"
grep -q "next to nothing" err && fail "a frame that was found is not missing"
events() { tides simulate $run -qo e.h5 --json "$@" >made.json && value made.json events; }
wanted=$(events --set camera.file=there/transforms.json)
[ "${wanted:-0}" -gt 100 ] || fail "the scene should make events, not ${wanted:-none}"
near() { # as many events but for rounding
	local made=$(events --set camera.file=data/transforms.json "$@")
	awk -v a="$made" -v b="$wanted" 'BEGIN { exit !(a > 0.99 * b && a < 1.01 * b) }' || fail "$made events, not $wanted"
}
near
mv data/dataparser_transforms.json .
expect 0 tides render $run -o beside.exr --set camera.file=data/transforms.json
err "trainer's frame by dataparser_transforms.json"
cmp -s found.exr beside.exr || fail "beside the scene it is the same file"
mv dataparser_transforms.json other.json
near --set camera.frame=other.json
cp other.json dataparser_transforms.json
expect 0 tides simulate $run -qo none.h5 --set camera.file=data/transforms.json --set camera.frame=none
[ "$(events --set camera.file=data/transforms.json --set camera.frame=none)" != "$wanted" ] || fail "none should leave the cameras"
# transforms.json that has half of it in its poses already.
poses '"applied_transform": [[0,-1,0,0],[1,0,0,0],[0,0,1,0]],' '[[1,0,0,-1],[0,-1,0,-2],[0,0,-1,-30],[0,0,0,1]]' \
	'[[1,0,0,2],[0,-1,0,-2],[0,0,-1,-30],[0,0,0,1]]' >data/transforms.json
expect 0 tides render $run -o applied.exr --set camera.file=data/transforms.json
near
echo '{ "scale": 1 }' >dataparser_transforms.json
refuse 1 "dataparser_transforms.json: transform: is missing" tides render $run -o x.exr --set camera.file=data/transforms.json
