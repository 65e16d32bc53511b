# A dataset's folder appears whole or not at all, with every camera of the rig. Each wrong input gives one line.
make_scene
metric="--set scene.metres_per_unit=0.5 --set dataset.truth_hz=20"
expect 0 tides dataset run.json -o one --layout ecd --quiet $metric
silent
for file in events.txt images.txt groundtruth.txt calib.txt depthmaps.txt images/frame_00000000.png; do
    [ -s "one/$file" ] || fail "one/$file should be there"
done
[ -s one/contact.png ] || fail "the contact sheet is missing"
missing one.part
expect 0 tides dataset run.json -o two/ --layout ecd --layout blinkflow --json $metric \
    --set 'rig.cameras=[{"name": "a"}, {"name": "b", "T_B_C": [[1,0,0,0.1],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]'
out "\"cameras\":[[:space:]]*2"
cmp -s one/events.txt two/ecd/a/events.txt || fail "a rig's first camera makes the events that the run makes"
[ -s two/blinkflow/b/events_left/events.h5 ] || fail "the second camera's events are missing"

missing two/.part
refuse 1 "one: is there already" tides dataset run.json -o one --layout ecd $metric
refuse 1 "metres_per_unit" tides dataset run.json -o three --layout ecd
refuse 1 "'kitti' is none of" tides dataset run.json -o three --layout kitti
refuse 2 "the layout is missing" tides dataset run.json -o three
refuse 2 "the output is missing" tides dataset run.json --layout ecd
refuse 1 "at one place" tides dataset run.json -o three --layout ecd --set 'rig.cameras=[{"name": "a"}, {"name": "b"}]'
touch file
refuse 1 "can't be made" tides dataset run.json -o file/x --layout blinkflow
missing three
missing three.part
expect 0 tides dataset --help
out "mvsec +MVSEC"

# A run may end where its path ends.
expect 0 tides dataset run.json -o end --layout kubric --set dataset.picture_hz=50 --set exposure.exposure_s=0
[ -s end/annotations.npy ] || fail "end/annotations.npy should be there"
