# A batch of datasets: one manifest makes several, each in another layout, with thresholds, paths and seeds drawn from ranges
# and lists. Finished ones aren't changed, and a killed one is made again.
make_scene
awk '{ $2 *= 1.5; print }' path.txt >faster.txt
cat >sets.json <<-'JSON'
	{ "base": "run.json", "set": { "scene.metres_per_unit": 0.5, "dataset.truth_hz": 50, "dataset.picture_hz": 50 },
	  "grid": { "dataset.layout": ["ecd", "tum", "blinkflow,evimo"] },
	  "draw": { "count": 2, "seed": "s", "set": { "dataset.layout": ["dsec", "mvsec"], "sensor.threshold_on": [0.1, 0.3],
	            "camera.file": ["path.txt", "faster.txt"], "sensor.threshold_sigma": [0.01, 0.03], "seed": [1, 1000] } } }
JSON
expect 0 tides batch sets.json -o sets.d --jobs 2
[ "$(ls -d sets.d/*/dataset | wc -l)" = 5 ] || fail "five datasets, not $(ls -d sets.d/*/dataset | wc -l)"
[ -s sets.d/dataset.layout=ecd/dataset/events.txt ] || fail "ECD's events are missing"
[ -s sets.d/dataset.layout=tum/dataset/groundtruth.txt ] || fail "TUM's poses are missing"
for path in sets.d/dataset.layout=blinkflow*/dataset/blinkflow sets.d/dataset.layout=blinkflow*/dataset/evimo; do
    [ -d "$path" ] || fail "of two layouts each has a folder: $path"
done
out "5 done"
cat sets.d/*/job.json | grep -o 'sensor.threshold_on=[0-9.]*' | sort -u | wc -l | grep -qx 2 || fail "thresholds should be drawn"
grep -q '"pictures":[[:space:]]*3' sets.d/dataset.layout=ecd/result.json || fail "the result should say what the dataset has"
expect 0 tides dataset run.json -o alone --set dataset.layout=ecd --set scene.metres_per_unit=0.5 --set dataset.truth_hz=50 \
    --set dataset.picture_hz=50
cmp -s alone/events.txt sets.d/dataset.layout=ecd/dataset/events.txt || fail "a batch's dataset isn't the dataset alone"

before=$(stat -c %i:%y sets.d/*/dataset sets.d/*/result.json | sha256sum)
expect 0 tides batch sets.json -o sets.d
out "5 done \(5 of them before\)"
[ "$(stat -c %i:%y sets.d/*/dataset sets.d/*/result.json | sha256sum)" = "$before" ] || fail "finished datasets were touched"

# Killed half way, and killed before the result.
cd sets.d/dataset.layout=tum || exit 1
rm -r dataset result.json stats.json && mkdir dataset.part && touch dataset.part/half
cd ../dataset.layout=ecd && rm result.json && cd ../.. || exit 1
expect 0 tides batch sets.json -o sets.d
out "5 done \(3 of them before\)"
[ -s sets.d/dataset.layout=tum/dataset/groundtruth.txt ] || fail "what a killed run left should be made anew"
missing sets.d/dataset.layout=tum/dataset.part
# Killed behind its events: they needn't be made again.
rm -r sets.d/dataset.layout=tum/dataset sets.d/dataset.layout=tum/*.json
expect 0 tides batch sets.json -o sets.d --only dataset.layout=tum
[ -s sets.d/dataset.layout=tum/dataset/groundtruth.txt ] || fail "it should be made anew"
# Killed before the result, and its statistics damaged: an error that names the file, without which the run is made anew.
rm sets.d/dataset.layout=ecd/result.json && echo '{' >sets.d/dataset.layout=ecd/stats.json
expect 1 tides batch sets.json -o sets.d --only dataset.layout=ecd
err "stats.json: can't be read back, or lacks a statistic: remove it"
rm sets.d/dataset.layout=ecd/stats.json
expect 0 tides batch sets.json -o sets.d --only dataset.layout=ecd
# Taken away: made anew, not done without it.
rm -r sets.d/dataset.layout=ecd/dataset
expect 0 tides batch sets.json -o sets.d --only dataset.layout=ecd
[ -s sets.d/dataset.layout=ecd/dataset/groundtruth.txt ] || fail "a dataset that was taken away should be made anew"
# Other keys: the dataset of before goes.
sed -i 's/"scene.metres_per_unit": 0.5/"scene.metres_per_unit": 0.25/' sets.json
expect 0 tides batch sets.json -o sets.d --only dataset.layout=ecd
cmp -s alone/groundtruth.txt sets.d/dataset.layout=ecd/dataset/groundtruth.txt && fail "the dataset should be another one"
# What can't be one fails by itself.
sed -i 's/"ecd", /"kitti", "ecd", /' sets.json
expect 1 tides batch sets.json -o sets.d
err "kitti failed: .*'kitti' is none of"
refuse 2 "the layout is missing" tides dataset run.json -o x
