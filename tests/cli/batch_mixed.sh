# One manifest with every kind of output, done by two processes at once in one folder, like machines with shared storage. Each
# output equals that of its command alone. Finished ones aren't changed, and runs that changed are made again.
make_scene
{ printf 'YUV4MPEG2 W8 H6 F20:1 Ip Cmono\n'
    for level in 040 120 200; do
        printf 'FRAME\n'
        head -c 48 /dev/zero | tr '\0' "\\$level"
    done; } >video.y4m
cat >mixed.json <<-'JSON'
	{ "base": "run.json", "set": { "scene.metres_per_unit": 1 }, "command": "frames",
	  "runs": [ { "name": "frames", "set": { "exposure.frames_per_second": 100 } },
	            { "name": "events", "command": "simulate" },
	            { "name": "esim", "command": "simulate", "set": { "method": "esim" } },
	            { "name": "video", "command": "simulate", "file": "video.y4m" },
	            { "name": "data", "command": "simulate", "set": { "dataset.layout": "ecd" } },
	            { "name": "look", "command": "render", "options": ["--time", "0.02", "--truth", "depth"] },
	            { "name": "imu", "command": "imu", "set": { "imu.down": [0, 1, 0] } },
	            { "name": "tracks", "command": "tracks", "set": { "tracks.count": 4 } },
	            { "name": "compare", "command": "compare", "options": ["--methods", "esim"], "set": { "time.stop": 0.01 } } ] }
JSON
tides batch mixed.json -o m --shard 2/2 >other 2>&1 &
expect 0 tides batch mixed.json -o m --shard 1/2
wait $! || fail "the other process: $(cat other)"
expect 0 tides batch mixed.json -o m --summary
out "9 done \(9 of them before\), 0 failed"

same() { cmp -s "$1" "$2" || fail "$1 isn't $2"; }
unit="--set scene.metres_per_unit=1"
expect 0 tides frames run.json -qo frames $unit --set exposure.frames_per_second=100
same m/frames/frames/frame_000001.png frames/frame_000001.png
expect 0 tides simulate run.json -qo events.h5 $unit
same m/events/events.h5 events.h5
expect 0 tides render run.json -qo look.exr $unit --time 0.02 --truth depth
same m/look/render.exr look.exr
expect 0 tides imu run.json -qo imu.csv $unit --set imu.down=[0,1,0]
same m/imu/imu.csv imu.csv
expect 0 tides tracks run.json -qo tracks.npz $unit --set tracks.count=4
same m/tracks/tracks.npz tracks.npz
exists m/data/dataset/events.txt
exists m/video/events.h5
exists m/compare/compare/compare.csv
grep -q '"options":.*"--time", "0.02"' m/look/result.json || fail "the result should say how it was made"

# Again: nothing. Other options, or an output that was taken away: that alone.
before=$(stat -c %i:%y m/*/result.json | sha256sum)
expect 0 tides batch mixed.json -o m
out "9 done \(9 of them before\)"
[ "$(stat -c %i:%y m/*/result.json | sha256sum)" = "$before" ] || fail "what is finished was touched"
sed -i 's/"0.02"/"0.01"/' mixed.json
rm -r m/frames/frames
expect 0 tides batch mixed.json -o m
out "9 done \(7 of them before\)"
cmp -s m/look/render.exr look.exr && fail "another time should be another picture"
same m/frames/frames/frame_000001.png frames/frame_000001.png

# Another command: what the one before left is removed, whichever the two are.
cp mixed.json kept.json
sed -i 's/"name": "imu", "command": "imu"/"name": "imu", "command": "simulate"/; s/"name": "events", "command": "simulate"/"name": "events", "command": "tracks"/
    s/"name": "data", "command": "simulate", "set": { "dataset.layout": "ecd" }/"name": "data", "command": "simulate"/' mixed.json
expect 0 tides batch mixed.json -o m
out "9 done \\(6 of them before\\)"
exists m/imu/events.h5
missing m/imu/imu.csv
exists m/events/tracks.npz
missing m/events/events.h5
missing m/events/stats.json
exists m/data/events.h5
missing m/data/dataset
grep -q '^"events","done",.*,"tracks","scene.metres_per_unit=1",,1' m/summary.csv || fail "the summary should say which command made it"
grep -q '^"imu","done",.*,"simulate",' m/summary.csv || fail "the summary should say simulate"
mv kept.json mixed.json
expect 0 tides batch mixed.json -o m

# What fails, fails alone; what can't be is said at once.
sed -i 's/"0.01", "--truth"/"x", "--truth"/' mixed.json
expect 1 tides batch mixed.json -o m
err "look failed: .*--time x: not a number"
out "8 done"
echo '{"base": "run.json", "runs": [{"name": "a", "command": "framse"}]}' >bad.json
refuse 1 'command "framse" is none of .*did you mean "frames"' tides batch bad.json -o b
echo '{"base": "run.json", "runs": [{"name": "a", "options": ["-q"]}]}' >bad.json
refuse 1 "options are given without a command" tides batch bad.json -o b
echo '{"base": "run.json", "runs": [{"name": "a", "command": "frames", "options": [1]}]}' >bad.json
refuse 1 "options holds something else than texts" tides batch bad.json -o b
echo '{"base": "run.json", "runs": [{"name": "pipe", "file": "-"}]}' >bad.json
expect 1 tides batch bad.json -o b
err "pipe failed: .*a batch has none to read"
