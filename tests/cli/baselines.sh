# Every method on a scene and on frames. The frames are rendered from the scene, so that both agree.
make_scene
for method in tides esim v2e iebcs dvs-voltmeter; do
    expect 0 tides simulate run.json -q -o scene_$method.h5 --stats scene_$method.json --set method=$method \
        --set esim.contrast_threshold_pos=0.2 --set esim.contrast_threshold_neg=0.2 --set frames_per_second=500
    [ "$(value scene_$method.json events)" -gt 100 ] || fail "$method: a wall that slides by should fire more"
    expect 0 tides info scene_$method.h5 --json
    [ "$(value scene_$method.json events)" = "$(value out events)" ] || fail "$method: stats and file differ"
done
# 500 renders a second for 0.04 s, both ends included; adaptive ESIM renders as often as the image asks for.
[ "$(value scene_v2e.json renders_full_frame_equivalent)" = 21 ] || fail "v2e should see 21 renders"
[ "$(value scene_esim.json renders_full_frame_equivalent)" != 21 ] || fail "ESIM chooses its own renders"

mkdir frames
: >frames/timestamps.txt
for k in $(seq 0 20); do
    t=$(awk -v k="$k" 'BEGIN { printf "%.3f", k / 500 }')
    expect 0 tides render run.json --time "$t" -o frames/f$k.exr
    echo "$t" >>frames/timestamps.txt
done
echo '{ "frames": { "file": "frames" } }' >frames.json
for method in tides esim v2e iebcs dvs-voltmeter; do
    expect 0 tides simulate frames.json -o frames_$method.h5 --stats frames_$method.json --set method=$method \
        --set esim.contrast_threshold_pos=0.2 --set esim.contrast_threshold_neg=0.2
    out "^method +$method"
    [ "$(value frames_$method.json events)" -gt 100 ] || fail "$method: frames should fire more"
done
# v2e sees the same frames either way; EXR keeps single precision.
awk -v a="$(value scene_v2e.json events)" -v b="$(value frames_v2e.json events)" 'BEGIN { exit !(b > 0.99 * a && b < 1.01 * a) }' ||
    fail "v2e: a scene's renders and the same frames from files differ"
# The same run again gives the same file, another seed doesn't.
expect 0 tides simulate frames.json -q -o v2e.h5 --set method=v2e
expect 0 tides simulate frames.json -q -o again.h5 --set method=v2e
cmp -s v2e.h5 again.h5 || fail "two equal runs differ"
expect 0 tides simulate frames.json -q -o other.h5 --set method=v2e --seed 2
for name in v2e other; do
    expect 0 tides convert $name.h5 $name.txt
done
cmp -s v2e.txt other.txt && fail "the seed should matter"

# A rate in place of times: 500 Hz are the same instants.
expect 0 tides simulate frames.json -q -o rate.h5 --set method=v2e --set frames.frames_per_second=500 --json
[ "$(value out events)" = "$(value frames_v2e.json events)" ] || fail "500 Hz should be the same times"

refuse 1 "nothing of that lies within time.start = 5" tides simulate frames.json -o e.h5 --set time.start=5 --set time.stop=6
refuse 1 "no such file" tides simulate frames.json -o e.h5 --set frames.file=nowhere
refuse 1 "scene.file and frames.file are both given" tides simulate run.json -o e.h5 --set frames.file=frames
refuse 1 "esim.log_eps = 0 is out of range" tides simulate frames.json -o e.h5 --set esim.log_eps=0
refuse 1 "method v2e on frames keeps no checkpoints; run it again without resume" tides simulate frames.json -o e.h5 --set method=v2e --resume
refuse 1 "--preview shows a rendered image" tides simulate frames.json -o e.h5 --preview p.png
refuse 1 "no scene to render" tides render frames.json -o o.exr
rm frames/timestamps.txt
refuse 1 "have no times" tides simulate frames.json -o e.h5
missing e.h5

# V2CE's sampler: two voxel grids of 3x2 px, an event of each polarity; whole voxels are at the planes' own times.
grids() {
    npy_header "$1"
    head -c "$2" /dev/zero
    printf '\001'
    head -c 165 /dev/zero
    printf '\001'
    head -c "$3" /dev/zero
}
grids '2, 2, 10, 2, 3' 19 54 >voxels.npy
echo '{ "frames": { "file": "voxels.npy" }, "method": "ldati" }' >voxels.json
expect 0 tides simulate voxels.json -q -o voxels.csv
[ "$(tr '\n' ' ' <voxels.csv)" = "t,x@3,y@2,on 11111,1,0,1 33333,2,1,0 " ] || fail "LDATI: $(cat voxels.csv)"
expect 0 tides simulate voxels.json -q -o slower.csv --set ldati.fps=10
grep -q '^100000,2,1,0$' slower.csv || fail "ldati.fps sets the intervals' length"
expect 0 tides simulate voxels.json -q -o part.csv --set time.stop=0.04
[ "$(wc -l <part.csv)" = 3 ] || fail "of an interval that isn't all in the run, what is"
expect 0 tides simulate voxels.json -q -o part.csv --set time.stop=0.02
[ "$(wc -l <part.csv)" = 2 ] || fail "no event after the run's end"
refuse 1 "method \"ldati\" takes voxel grids" tides simulate run.json -o e.h5 --set method=ldati
refuse 1 "nothing of that lies within" tides simulate voxels.json -o e.h5 --set time.start=1 --set time.stop=2
refuse 1 "frames have the shape" tides simulate voxels.json -o e.h5 --set method=v2e --set frames.frames_per_second=30
refuse 1 "is a folder; voxel grids come from" tides simulate frames.json -o e.h5 --set method=ldati
grids '2, 2, 5, 12' 19 54 >voxels.npy
refuse 1 "don't make 20 values per pixel" tides simulate voxels.json -o e.h5
missing e.h5
