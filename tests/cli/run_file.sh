# Wrong run files and settings: exit 1, one line with key, value, range.
make_scene
run() { refuse 1 "$1" tides simulate run.json -o e.h5 "${@:2}"; }
run "unknown key \"sensor.treshold_on\"; did you mean \"sensor.threshold_on\"\?" --set sensor.treshold_on=1
run "camera.width = 0 is out of range; it must lie in \[1, 16384\] px" --set camera.width=0
run "image.log_eps = \"nan\" is not a number" --set image.log_eps=nan
run "sensor.threshold_on = -1 is out of range" --set sensor.threshold_on=-1
run "time.stop = 0 s is not after time.start = 0 s" --set time.stop=0
run "stepping.mode = \"riks\" is none of fixed, risk, error; did you mean risk\?" --set stepping.mode=riks
# What was, and is no more, says what does its work.
run "--set: stepping.mode = \"error_risk\" is gone: \"error\" finds" --set stepping.mode=error_risk
run "--set: stepping.paths is gone: tiles are projected" --set stepping.paths=true
run "--set: stepping.budget is gone: a looser stepping.tolerance" --set stepping.budget=3
run "--set: stepping.solve = \"float\" is gone: \"double\" is" --set stepping.solve=float
run "error control estimates the error of the hermite model only" --set stepping.model=linear
run "method = \"eism\" is none of tides, esim" --set method=eism
run "seed = \"x\" is not a 64-bit number" --seed x
run "image.rules = \"smoth\" is none of smooth, inria, gsplat" --set image.rules=smoth
run "--set foo: write key=value" --set foo
missing e.h5
missing e.h5.part
# A size beside the file's own focal length is another part of the view: said in one line, and not where the length is given too.
expect 0 tides simulate run.json -o e.h5 --set camera.width=24 --set time.stop=0.004
err "^tides: run.json: camera.fx = 50 px stays the run file's.* camera.scale shows the same in other pixels$"
expect 0 tides simulate run.json -o e.h5 --set camera.width=24 --set camera.fx=25 --set time.stop=0.004
expect 0 tides render run.json -o e.exr --set camera.scale=0.5
out "^height +18"
grep -q camera err && fail "camera.scale is the same view"
rm e.h5 e.exr
run_text() { printf '%s' "$2" >bad.json; refuse 1 "$1" tides simulate bad.json -o e.h5; }
run_text "bad.json:1:[0-9]+: not valid JSON" '{"scene": '
run_text "bad.json:3:1: not valid JSON" '{"time": {"stop": 1},

]}'
run_text "bad.json: unknown key \"senor\"; did you mean \"sensor\"" '{"senor": {}}'
run_text "bad.json: seed is given twice" '{"seed": "1", "seed": "2"}'
run_text "bad.json: camera.file is missing" '{"scene": {"file": "scene.ply"}}'
run_text "bad.json: time.stop = \"1\" is not a number" '{"time": {"stop": "1"}}'
run_text "bad.json: camera.width = 0 is out of range" '{"camera": {"width": 0}}'
# Keys as --set writes them, mixed with groups; twice is twice in either way.
printf '%s' '{"scene.file": "scene.ply", "camera": {"file": "path.txt", "width": 48, "height": 36, "fx": 50}, "time.stop": 0.004}' >dotted.json
expect 0 tides simulate dotted.json -qo dotted.h5
run_text "bad.json: time.stop is given twice" '{"time": {"stop": 1}, "time.stop": 2}'
run_text "bad.json: unknown key \"sensor.treshold_on\"; did you mean" '{"sensor.treshold_on": 1}'
# What people write, and what they need to hear.
run "scene.file is empty: give a text in quotes" --set 'scene.file=""'
run "sensor.preset = \"DAVIS346\" is none of .*; did you mean davis346\?" --set sensor.preset=DAVIS346
run_text "camera.file is missing: .*; or camera.orbit_s" '{"scene": {"file": "scene.ply"}}'
run "/dev/zero: is a device, which has no end" --set scene.file=null --set camera.file=null --set frames.file=/dev/zero
long=$(printf 'a%.0s' {1..247}).h5
refuse 1 "the name has 250 bytes; give it at most 239" tides simulate run.json -o $long
# A run that is refused leaves nothing, and leaves alone what an interrupted one has left.
run "stepping.solve" --set stepping.mode=fixed --set stepping.solve=double
missing e.h5.part
echo interrupted >e.h5.part
run "stepping.solve" --set stepping.mode=fixed --set stepping.solve=double
[ "$(cat e.h5.part)" = interrupted ] || fail "what an interrupted run has left is gone"
rm e.h5.part
# A device for what needs none.
expect 0 tides init -o new.json --device gpu
err "--device gpu changes nothing: tides init uses no device"
expect 0 tides simulate run.json -qo e.h5
expect 0 tides metrics e.h5 e.h5 --device 77
err "tides metrics uses no device"
