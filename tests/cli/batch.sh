# A batch of small runs: a grid and a list, skipped, repeated after changes, failures at the end, shards. Killed twice and
# continued, it leaves the same files as an uninterrupted one.
make_scene
cat >grid.json <<-'JSON'
	{ "base": "run.json", "set": { "sensor.threshold_off": 0.15 },
	  "grid": { "sensor.threshold_on": [0.1, 0.2], "stepping.mode": ["fixed", "error"] },
	  "runs": [ { "name": "wide", "set": { "camera.width": 64 } }, { "name": "late", "file": "run.json", "set": { "time.start": 0.02 } } ] }
JSON
expect 0 tides batch grid.json -o out.d --jobs 2
[ "$(grep -c '^tides: \[[0-9]*/6\] .* events in ' err)" = 6 ] || fail "a line per run, please"
out "6 done \(0 of them before\), 0 failed"
for name in sensor.threshold_on=0.1,stepping.mode=fixed sensor.threshold_on=0.2,stepping.mode=error wide late; do
    for file in events.h5 stats.json result.json job.json; do exists out.d/$name/$file; done
done
[ "$(wc -l <out.d/summary.csv)" = 7 ] || fail "summary.csv should hold a row per run"
grep -q '^"wide","done",[0-9]*,.*,64,36,' out.d/summary.csv || fail "summary.csv lacks a row"
expect 0 tides simulate run.json -qo alone.h5 --set sensor.threshold_off=0.15 --set camera.width=64
cmp -s alone.h5 out.d/wide/events.h5 || fail "a run of a batch isn't the run alone"

# Again: nothing is done. One more value: one more pair of runs. A changed scene: everything.
stamp() { stat -c %i:%y out.d/*/events.h5 | sha256sum; }
before=$(stamp)
expect 0 tides batch grid.json -o out.d
out "6 done \(6 of them before\)"
[ "$(stamp)" = "$before" ] || fail "finished runs were touched"
sed -i 's/\[0.1, 0.2\]/[0.1, 0.2, 0.4]/' grid.json
expect 0 tides batch grid.json -o out.d
out "8 done \(6 of them before\)"
rm out.d/wide/events.h5
expect 0 tides batch grid.json -o out.d
out "8 done \(7 of them before\)"
cp scene.ply scene.kept
sed -i 's/ 3 -1.9 / 3 -1.8 /' scene.ply
expect 0 tides batch grid.json -o out.d --json
grep -q '"done":[[:space:]]*8' out || fail "--json should print the summary"
cmp -s out out.d/summary.json || fail "--json prints another summary"
[ "$(grep -c 'finished before' err)" = 0 ] || fail "a changed scene should be simulated again"
expect 0 tides batch grid.json -o out.d -q
silent

# Failures are told at the end, and the others are done.
mv scene.kept scene.ply
cat >bad.json <<-'JSON'
	{ "base": "run.json", "runs": [ { "name": "a" }, { "name": "gone", "set": { "scene.file": "gone.ply" } },
	  { "name": "outside", "set": { "camera.file": "run.json" } }, { "name": "z" } ] }
JSON
expect 1 tides batch bad.json -o bad.d
err "^tides: gone failed: gone.ply: can't be opened"
err "^tides: outside failed: run.json: "
out "2 done .*, 2 failed"
grep -q '^"gone","failed"' bad.d/summary.csv || fail "summary.csv should hold failures"

# The summary of what is there runs nothing: failures are known from their folders, and go where a run starts again.
expect 1 tides batch bad.json -o parts.d --only a --only outside
out "1 done \(0 of them before\), 1 failed$"
missing parts.d/summary.json
grep -q '"error":.*run.json: ' parts.d/outside/failure.json || fail "failure.json lacks the reason"
expect 1 tides batch bad.json -o parts.d --summary
out "1 done \(1 of them before\), 2 failed, 1 waiting"
err "^tides: outside failed: run.json: "
missing parts.d/z
[ "$(cut -d, -f1,2 parts.d/summary.csv | tail -n +2 | tr -d '"\n')" = a,donegone,failedoutside,failedz,waiting ] || fail "wrong states"
grep -q '^"outside",.*,"camera.file=""run.json""","run.json: ' parts.d/summary.csv || fail "a failed run should say what was set"
expect 1 tides batch bad.json -o parts.d --summary --json -q
cmp -s out parts.d/summary.json || fail "--json prints another summary"
expect 1 tides batch bad.json -o parts.d -q
cmp parts.d/summary.csv bad.d/summary.csv && cmp parts.d/summary.json bad.d/summary.json || fail "the parts aren't the whole"
cp path.txt kept.txt
echo "no path" >path.txt
expect 1 tides batch bad.json -o parts.d --only a
exists parts.d/a/failure.json
missing parts.d/a/result.json
mv kept.txt path.txt
expect 0 tides batch bad.json -o parts.d --only a --json
grep -q '"waiting":[[:space:]]*0' out || fail "--only --json should print what became of it"
missing parts.d/a/failure.json
refuse 1 "bad.json: no run is called \"gine\"; did you mean \"gone\"\?" tides batch bad.json -o parts.d --only gine
refuse 2 "give one of the two" tides batch bad.json -o parts.d --only a --shard 1/2

# Runs on frames, which have no camera; their pictures, times and tables of noise count, and so does what lies below a model's
# folder: what changes there in place, of the same size, is run again, and nothing else.
mkdir -p pics.d model.d/point_cloud/iteration_3
for k in 00 01 02 03; do expect 0 tides render run.json --time 0.0$k -qo pics.d/$k.exr; done
seq 0 0.01 0.03 >times.txt
cp scene.ply model.d/point_cloud/iteration_3/point_cloud.ply
cat >inputs.json <<-'JSON'
	{ "runs": [ { "name": "v2e", "file": "video.json", "set": { "method": "v2e" } },
	  { "name": "rated", "file": "video.json", "set": { "frames.timestamps": null, "frames.frames_per_second": 100 } },
	  { "name": "model", "file": "run.json", "set": { "scene.file": "model.d" } }, { "name": "plain", "file": "run.json" } ] }
JSON
echo '{ "frames": { "file": "pics.d", "timestamps": "times.txt" }, "method": "esim", "time": { "stop": 0.03 } }' >video.json
expect 0 tides batch inputs.json -o inputs.d
out "4 done \(0 of them before\), 0 failed"
grep -q '^"v2e","done"' inputs.d/summary.csv || fail "a run on frames should have a row"
# Runs again, and says which were done anew.
anew() {
    expect 0 tides batch inputs.json -o inputs.d
    [ "$(sed -n 's/^tides: \[[0-9]*\/[0-9]*\] \(.*\): .* events in .*/\1/p' err | LC_ALL=C sort | tr '\n' ' ')" = "$1" ] || fail "not these were to run again: $1"
}
anew ""
sed -i 's/ 3 -1.9 / 3 -1.8 /' model.d/point_cloud/iteration_3/point_cloud.ply
anew "model "
mkdir -p model.d/renders && echo "no input" >model.d/renders/notes.txt
anew ""
sed -i 's/0.02/0.021/' times.txt
anew "v2e "
cp pics.d/02.exr kept.exr
cat kept.exr >pics.d/02.exr
anew "rated v2e "
mkdir -p model.d/point_cloud/iteration_4
cp scene.ply model.d/point_cloud/iteration_4/point_cloud.ply
anew "model "

# Shards: every run is somebody's, and the whole batch then finds them all.
expect 0 tides batch grid.json -o shards.d --shard 1/3 -q
expect 0 tides batch grid.json -o shards.d --shard 3/3 -q
expect 0 tides batch grid.json -o shards.d --shard 2/3 -q
exists shards.d/summary-2-of-3.json
expect 0 tides batch grid.json -o shards.d --summary
out "8 done \(8 of them before\)"

# Wrong manifests.
wrong() { printf '%s' "$2" >wrong.json; refuse 1 "$1" tides batch wrong.json -o wrong.d; missing wrong.d; }
wrong "wrong.json: is not one JSON object" '{"base": '
wrong "wrong.json: grid and runs are missing" '{"base": "run.json"}'
wrong "wrong.json: unknown key \"gird\"; did you mean \"grid\"\?" '{"gird": {}}'
wrong "wrong.json: base is missing" '{"grid": {"seed": ["1"]}}'
wrong "wrong.json: seed is no list" '{"base": "run.json", "grid": {"seed": "1"}}'
wrong "draw: seed has nothing to draw from" '{"base": "run.json", "draw": {"count": 1, "set": {"seed": []}}}'
wrong "wrong.json: a is the name of two runs" '{"base": "run.json", "runs": [{"name": "a"}, {"name": "a"}]}'
wrong "wrong.json: \.\./a is no name" '{"base": "run.json", "runs": [{"name": "../a"}]}'
wrong "wrong.json: seed=1: --set: unknown key" '{"base": "run.json", "set": {"sede": 1}, "grid": {"seed": ["1"]}}'
wrong "wrong.json: _seed=1~[0-9a-f]{8}: --set: unknown key" '{"base": "run.json", "grid": {".seed": ["1"]}}' # no hidden folder
wrong "did you mean \"sensor.threshold_on\"" '{"base": "run.json", "grid": {"sensor.treshold_on": [1]}}'
refuse 1 "none.json: can't be opened" tides batch none.json -o wrong.d
refuse 2 "the output is missing: -o DIR" tides batch grid.json
refuse 2 "--shard 4/3: give I/N" tides batch grid.json -o wrong.d --shard 4/3
refuse 2 "--jobs 0: give a number" tides batch grid.json -o wrong.d --jobs 0
refuse 2 "--threads no: give a number" tides batch grid.json -o wrong.d --threads no
refuse 1 "process $PPID isn't the one that started this" tides batch grid.json -o wrong.d --parent $PPID

# Forty runs, killed twice. A result differs in nothing from the uninterrupted batch's.
awk 'BEGIN { for (i = 0; i <= 400; i++) printf "%g %g 0 0 0 0 0 1\n", i * 0.01, 0.3 * sin(i * 0.3) }' >path.txt
cat >forty.json <<-'JSON'
	{ "base": "run.json", "set": { "time.stop": 0.02, "stepping.mode": "fixed", "stepping.step_s": 0.001, "camera.width": 24, "camera.height": 18 },
	  "grid": { "sensor.threshold_on": [0.03, 0.04, 0.05, 0.06, 0.07, 0.08, 0.09, 0.1], "image.log_eps": [0.001, 0.002, 0.003, 0.004, 0.005] } }
JSON
expect 0 tides batch forty.json -o whole.d -q
# Of a process that may have ended meanwhile, as any may while the list is made.
runs_of() { cat /proc/[0-9]*/stat 2>/dev/null | awk -v parent=$1 '$4 == parent { print $1 }'; }
# The run that stands still (paused), of the batch $1: until it is killed or goes on the batch can't end, however slow this shell is.
hold() {
    while ! ended $1; do
        for held in $(runs_of $1); do
            [ "$(state_of $held)" = T ] && return
        done
        sleep 0.01
    done
    fail "the batch ended before one of its runs was held"
}
# Whether $2 runs of the folder $1 are finished.
finished() { [ "$(ls $1/*/result.json 2>/dev/null | wc -l)" -ge $2 ]; }
make_pause
export PAUSE_ONCE=$PWD/held

set -m
for round in 1 2; do
    rm -f held
    paused tides batch forty.json -o forty.d -q --jobs 2 --checkpoint 0.0001 >out 2>err &
    hold $!
    await finished forty.d $((10 * round))
    runs=$(runs_of $!)
    kill -KILL $! || fail "the batch ended before it was killed"
    wait $!
    for run in $runs; do await ended $run; done
    ls forty.d/*/*.checkpoint >/dev/null || fail "no checkpoint is left of the run that was killed"
done
expect 0 tides batch forty.json -o forty.d --checkpoint 0.01
out "40 done \([1-3][0-9] of them before\), 0 failed"
(cd whole.d && find . -type f ! -name stats.json ! -name events.h5 | LC_ALL=C sort) >whole.list
(cd forty.d && find . -type f ! -name stats.json ! -name events.h5 | LC_ALL=C sort) >forty.list
diff whole.list forty.list || fail "the folders hold other files"
while read -r file; do cmp "whole.d/$file" "forty.d/$file" || fail "$file differs"; done <whole.list
for name in whole.d/*/; do
    name=$(basename "$name")
    cmp -s whole.d/$name/events.h5 forty.d/$name/events.h5 && continue
    expect 0 tides convert whole.d/$name/events.h5 a.npy -q
    expect 0 tides convert forty.d/$name/events.h5 b.npy -q
    cmp -s a.npy b.npy || fail "the events of $name differ"
done

# With --parent it is killed when its parent is, and so are its runs.
rm -f held
paused sh -c 'tides batch forty.json -o end.d -q --jobs 2 --threads 1 --checkpoint 0.0001 --parent $$ 2>end.err & echo $! >end.pid; wait' &
await [ -s end.pid ]
hold $(cat end.pid)
await finished end.d 1
runs=$(runs_of $(cat end.pid))
kill -KILL $! || fail "the batch ended before its parent"
wait $!
for process in $(cat end.pid) $runs; do await ended $process; done

# Ctrl-C: runs save their state, and the same command goes on.
rm -f held
paused tides batch forty.json -o int.d -q --jobs 2 --checkpoint 0.0001 >out 2>err &
hold $!
await finished int.d 1
kill -INT $!
kill -CONT $held
wait $!
[ $? = 1 ] || fail "the exit code should be 1"
error_line "stopped on request; [0-9]+ of 40 runs are finished; the same command goes on from there"
expect 0 tides batch forty.json -o int.d -q
cmp whole.d/summary.csv int.d/summary.csv || fail "the summaries differ"

# Random draws: between two numbers, or one of a list; the same whatever else is drawn, however many runs there are.
cat >draw.json <<-'JSON'
	{ "base": "run.json", "draw": { "count": 3, "seed": "7", "set": { "sensor.threshold_on": [0.16, 0.34], "seed": [1, 9],
	  "sensor.max_events_per_step": [40, 41], "stepping.model": ["hermite"] } } }
JSON
expect 0 tides batch draw.json -qo draw.d
drawn() { sed -n 's/.*"\(sensor.threshold_on=[^"]*\)".*/\1/p' "$1"; }
[ "$(cat draw.d/draw-0000?/job.json | drawn /dev/stdin | sort -u | wc -l)" = 3 ] || fail "three runs should draw three thresholds"
for job in draw.d/draw-0000?/job.json; do
    drawn "$job" | awk -F= '{ exit !($2 >= 0.16 && $2 <= 0.34) }' || fail "$job: outside of its range"
    grep -Eq '"seed=\\"[1-9]\\""' "$job" || fail "$job: no seed of 1 to 9"
    grep -Eq 'max_events_per_step=4[01]"' "$job" || fail "$job: a whole key should get whole numbers"
done
first=$(drawn draw.d/draw-00000/job.json)
sed -i 's/"count": 3/"count": 4/; s/"seed": \[1, 9\],//' draw.json
expect 0 tides batch draw.json -qo more.d
[ "$(drawn more.d/draw-00000/job.json)" = "$first" ] || fail "other keys and more runs should leave draws as they are"
exists more.d/draw-00003/events.h5
sed -i 's/0.16, 0.34/0.4, 0.34/' draw.json
refuse 1 "lowest is above" tides batch draw.json -o no.d
sed -i 's/"count": 4, //' draw.json
refuse 1 "needs a count" tides batch draw.json -o no.d

# Each run has its run file with every value, which gives the same run from anywhere; drawn and listed values are columns, and
# thresholds can be drawn together.
make_scene
cat >ratio.json <<-'JSON'
	{ "base": "run.json", "draw": { "count": 2, "seed": "1",
	  "set": { "sensor.threshold_on": [0.1, 0.3], "sensor.threshold_off": { "of": "sensor.threshold_on", "times": [1.2, 1.3] } } } }
JSON
expect 0 tides batch ratio.json -qo ratio.d
for run in 0 1; do
    expect 0 tides simulate ratio.d/draw-0000$run/run.json -qo again.h5
    expect 0 tides convert again.h5 again.csv -q
    expect 0 tides convert ratio.d/draw-0000$run/events.h5 batch.csv -q
    cmp -s again.csv batch.csv || fail "run.json gives another run"
done
head -n 1 ratio.d/summary.csv | grep -q ',error,sensor.threshold_on,sensor.threshold_off,seed$' || fail "drawn keys should be columns"
awk -F, 'NR > 1 { on = $(NF - 2); off = $(NF - 1); if (!(off >= 1.2 * on && off <= 1.3 * on && on >= 0.1)) exit 1 }' ratio.d/summary.csv ||
    fail "thresholds should be drawn together: $(cat ratio.d/summary.csv)"
sed -i 's/"of": "sensor.threshold_on"/"of": "sensor.b_min"/' ratio.json
refuse 1 "sensor.threshold_off isn't { \"of\": KEY, \"times\": \[LOWEST, HIGHEST\] } with another KEY" tides batch ratio.json -o ratio.d

# Files of options go to the run's folder, and nowhere else; the batch's own names are no run's.
look() { printf '{ "base": "run.json", "runs": [ { "name": "%s", "command": "render", "options": ["--time", "0.02", "--png", "%s"] } ] }' "$1" "$2" >look.json; }
look look x.png
expect 0 tides batch look.json -qo look.d
exists look.d/look/x.png
missing x.png
for away in ../x.png /elsewhere/x.png a/../../x.png; do
    look look $away
    refuse 1 "is outside of the run's folder" tides batch look.json -o look.d
done
look summary.json x.png
refuse 1 "summary.json is a name that the batch's own files have" tides batch look.json -o look.d

# What a run says before it has a log is its reason.
mkdir -p unlogged.d/a/log.txt
printf '{ "base": "run.json", "runs": [ { "name": "a" } ] }' >unlogged.json
expect 1 tides batch unlogged.json -o unlogged.d
err "a failed: unlogged.d/a/log.txt: can't be written: Is a directory"
grep -q "log.txt: can't be written" unlogged.d/a/failure.json unlogged.d/summary.json || fail "the reason should be kept"

# On a full disk no further run starts, and a summary that isn't there isn't announced.
printf '{ "base": "run.json", "runs": [ { "name": "a" }, { "name": "b" }, { "name": "c" } ] }' >three.json
${CC:-cc} -O1 -shared -fPIC -o full.so "$here/full_disk.c" || skip "a compiler is wanted"
LD_PRELOAD=$PWD/full.so ASAN_OPTIONS=${ASAN_OPTIONS:-}:verify_asan_link_order=0 tides batch three.json -o full.d --jobs 1 >out 2>err && fail "the disk is full"
err "a failed: .*No space left on device"
err "the disk of full.d is full: no further run is started; 2 wait"
grep -q "^summary" out && fail "no summary was written"
missing full.d/b
