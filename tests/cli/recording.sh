# A recording in the form of a downloaded dataset: info on its folder, the run file that init makes of it, and missing frames
# and paths.
make_scene
expect 0 tides dataset run.json -o seq --layout ecd --quiet --set scene.metres_per_unit=1 --set dataset.picture_hz=200 --set exposure.exposure_s=0
exists seq/events.txt
exists seq/images.txt
expect 0 tides info seq --json
is_json
for fact in '"frames_in":[[:space:]]"images"' '"frames":[[:space:]]' '"poses_in":[[:space:]]"groundtruth.txt"' '"calib"'; do
    out "$fact"
done
[ "$(value out frames_width)" = 48 ] || fail "the frames' size"
expect 0 tides init seq -o seq.json
out 'tides calibrate seq seq.json -o sensor.json'
grep -q '^    "file": "seq/images"' seq.json || fail "frames.file should be the recording's"
grep -q '// "fx": 50,' seq.json || fail "the lens should stand in a comment"
expect 0 tides simulate seq.json -o simulated.h5 --quiet
exists simulated.h5
refuse 1 "is there already" tides init seq -o seq.json
refuse 2 "a recording has no --scene or --camera" tides init seq -o other.json --scene scene.ply
refuse 1 "goes into this folder" tides init seq -o seq/run.json
mkdir bare && cp seq/events.txt bare/
refuse 1 "no frames with times" tides init bare -o bare.json

# Another camera's frames: not pixel for pixel.
mkdir apart apart/images && cp seq/events.txt apart/
for k in 0 1 2; do expect 0 tides render run.json --time 0.0$k -o apart/images/$k.exr --set camera.scale=0.5; echo 0.0$k >>apart/images/timestamps.txt; done
printf '0.001 47 35 1\n' >>apart/events.txt
sort -n apart/events.txt -o apart/events.txt
expect 0 tides info apart
out 'another camera took them'

# A path that ends before the run: by how much, and that it may go on.
refuse 1 "lacks 0.01 s at its end.*camera.extrapolate" tides simulate run.json -o no.h5 --set time.stop=0.05
expect 0 tides simulate run.json -o longer.h5 --set time.start=-0.01 --set time.stop=0.05 --set camera.extrapolate=true
err 'path.txt goes on as its ends do: it lacks 0.01 s at its beginning, 0.01 s at its end'
expect 0 tides simulate run.json -o same.h5 --set camera.extrapolate=true
silent_err() { [ ! -s err ] || ! grep -q extrapolate err || fail "nothing lacks"; }
silent_err

# Frames that are few, far apart and coarse say so; dense ones don't.
mkdir few dense
for k in 0 1 2 3 4; do
    expect 0 tides render run.json --time 0.0$k -o few/$k.exr
    echo 0.0$k >>few/timestamps.txt
    expect 0 tides render run.json --time 0.000$k -o dense/$k.exr
    echo 0.000$k >>dense/timestamps.txt
done
echo '{ "frames": { "file": "few" } }' >few.json
echo '{ "frames": { "file": "dense" } }' >dense.json
expect 0 tides simulate few.json -o few.h5
err 'frames.file: 100 frames per second say little of the light'
expect 0 tides simulate dense.json -o dense.h5
grep -q 'frames.file' err && fail "dense frames say enough"
expect 0 tides simulate seq.json -o dark.h5 --set image.log_eps=0.001 --set sensor.threshold_on=0.1 --set sensor.threshold_off=0.1
