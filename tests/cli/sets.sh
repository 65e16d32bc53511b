# Paths in --set are relative to the shell's folder if they exist there, else to the run file's; and presets as users' files.
make_scene
mkdir sub
mv run.json path.txt scene.ply sub/
printf '{"about": "mine", "sensor": {"threshold_on": {"value": 0.6, "source": "made up"}, "threshold_off": 0.6}}' >mine.json
expect 0 tides simulate sub/run.json -qo all.h5 --stats all.json
expect 0 tides simulate sub/run.json -qo few.h5 --stats few.json --set sensor.preset=mine.json
silent
less "$(value few.json events)" "$(value all.json events)" "the shell's preset has higher thresholds"

# Of several keys that take paths; quoted, and in lists of objects.
sed 's/0 0 0 0 0 0 1$/0 0 0 0 0 0 1/; s/0\.25/0/; s/0\.1 /0 /; s/0\.05/0/' sub/path.txt >still.txt
cp sub/scene.ply second.ply
for set in camera.file=still.txt 'camera.file="still.txt"'; do
    expect 0 tides simulate sub/run.json -qo still.h5 --stats still.json --set "$set"
    [ "$(value still.json events)" = 0 ] || fail "$set: a camera at rest sees nothing move"
done
expect 0 tides simulate sub/run.json -vqo two.h5 --set 'scene.objects=[{"file": "second.ply"}]'
refuse 1 "sub/third.ply: can't be opened" tides simulate sub/run.json -o no.h5 --set 'scene.objects=[{"file": "third.ply"}]'

# What only the run file's folder has is that, and of two a line says which.
expect 0 tides simulate sub/run.json -qo same.h5 --stats same.json --set camera.file=path.txt
[ "$(value same.json events)" = "$(value all.json events)" ] || fail "the run file's own folder still counts"
cp still.txt path.txt
expect 0 tides simulate sub/run.json -o other.h5 --stats other.json --set camera.file=path.txt
err "--set: path.txt is in the shell's folder, and another one beside sub/run.json: the shell's is taken"
[ "$(value other.json events)" = 0 ] || fail "the shell's path.txt was to be taken"

# A manifest's paths are those of a file.
printf '{"base": "sub/run.json", "runs": [{"name": "one", "set": {"camera.file": "path.txt"}}]}' >manifest.json
expect 0 tides batch manifest.json -qo all_runs
[ "$(value all_runs/one/stats.json events)" = "$(value all.json events)" ] || fail "a manifest isn't typed in a shell"

# Presets are shown, and what is wrong with one.
expect 0 tides info mine.json
out "^kind +preset"
out "^about +mine"
out "sensor.threshold_on +0.6"
printf '{"about": "mine", "sensor": {"threshold_n": 0.6}}' >slip.json
refuse 1 "threshold_n.*did you mean .sensor.threshold_on" tides info slip.json
