# First steps with a downloaded splat file: a picture and events in two commands, then a run file and a path of the user's own.
expect 0 tides scene plane --size 173x130 -o room.ply
small="--set camera.width=80"
expect 0 tides render room.ply -o look.png $small
err "room.ply: a scene without a run file: an orbit is found"
out "height +60"
exists look.png
expect 0 tides simulate room.ply -o orbit.h5 $small --set time.stop=0.02
out "^events +[1-9]"
expect 0 tides simulate room.ply -qo turned.h5 $small --set time.stop=0.02 --set 'camera.up=[1,0,0]'
silent
cmp -s orbit.h5 turned.h5 && fail "camera.up does nothing"
expect 0 tides simulate --set scene.file=room.ply -qo named.h5 $small --set time.stop=0.02
cmp orbit.h5 named.h5 || fail "--set scene.file alone is another run"
mkdir -p model/point_cloud/iteration_7
cp room.ply model/point_cloud/iteration_7/point_cloud.ply
expect 0 tides simulate model -qo model.h5 $small --set time.stop=0.02
expect 0 tides simulate model/ -qo slash.h5 $small --set time.stop=0.02 # as a shell completes it
cmp model.h5 slash.h5 || fail "a model's folder with a slash is another run"

# What tides makes itself stands on its feet, at a glance too.
expect 0 tides scene fan --gaussians 300 -qo fan.h5
expect 0 tides info fan.h5
out "^up +0 +1 +0"
expect 0 tides camera orbit --scene fan.h5 -o around.json
out "^up +0 +1 +0"

# init with a scene alone is the same run, to change.
expect 0 tides init --scene room.ply -o mine.json
grep -q '^    "orbit_s": 12.0, //' mine.json || fail "init doesn't give an orbit"
expect 0 tides simulate mine.json -qo mine.h5 $small --set time.stop=0.02
cmp orbit.h5 mine.h5 || fail "init's run is another one"
refuse 1 "camera.file and camera.orbit_s are both given" tides simulate mine.json -o x.h5 --set camera.file=a.json
echo '{ "scene": { "file": "room.ply" } }' >none.json
refuse 1 "camera.file is missing" tides simulate none.json -o x.h5
