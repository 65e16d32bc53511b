# Folders of data sets: info tells their content, convert makes one file of them, and ambiguous ones need an option.
make_scene
expect 0 tides simulate run.json -q -o events.h5
mkdir -p dsec/events/left ergb/events ergb/images
cp events.h5 dsec/events/left/events.h5
expect 0 tides info --json events.h5
value out events >count
expect 0 tides info --json dsec
[ "$(value out events)" = "$(cat count)" ] || fail "the folder has other events than its file"
out '"kind":[[:space:]]*"events"'
expect 0 tides convert -q dsec all.csv
expect 0 tides info --json all.csv
[ "$(value out events)" = "$(cat count)" ] || fail "events were lost on the way"
mkdir dsec/events/right
cp events.h5 dsec/events/right/events.h5
refuse 1 "dsec: holds events in dsec/events/left and in dsec/events/right: name one of them" tides info dsec
refuse 1 "name one of them" tides convert dsec both.h5
expect 0 tides convert -q dsec/events/right one.h5
expect 0 tides convert -q events.h5 vid2e.npz
mkdir npz
cp vid2e.npz npz/0000000000.npz
expect 0 tides info --json npz
out '"layout":[[:space:]]*"npz"'
[ "$(value out events)" = "$(cat count)" ] || fail "the folder of .npz has other events"
mkdir empty
refuse 1 "empty: .*DSEC" tides convert empty none.h5

# Of what tides dataset writes, too: ECD's text with its pictures' size, MVSEC's file beside others, BlinkFlow's camera; poses of
# ECD and TUM, whose images.txt isn't COLMAP's.
expect 0 tides dataset run.json -qo set --layout ecd --layout mvsec --layout blinkflow --layout evimo --layout tum \
    --set scene.metres_per_unit=1
for layout in ecd mvsec blinkflow; do
    expect 0 tides info --json set/$layout
    [ "$(value out events)" = "$(cat count)" ] || fail "set/$layout has other events"
    expect 0 tides info --json events.h5
    width=$(value out width)
    expect 0 tides info --json set/$layout
    [ "$(value out width)" = "$width" ] || fail "set/$layout has another width"
done
refuse 1 "set/evimo: is a folder without events" tides convert set/evimo none.h5
expect 0 tides info --json set/tum
out '"format":[[:space:]]*"tum"'
expect 0 tides render run.json --set camera.file=set/ecd -o view.png
mkdir two
touch two/a_data.hdf5 two/b_data.hdf5
refuse 1 "two: holds 2 recordings, a_data.hdf5 and others: name one" tides convert two none.h5
