# Noise, presets and the readout from the command line: they take effect, are counted, and survive an interruption.
make_scene
expect 0 tides simulate run.json -o clean.h5 --json
cp out clean.json
[ "$(value clean.json events)" = "$(value clean.json events_signal)" ] || fail "without noise every event is the signal's"
[ "$(value clean.json events_written)" = "$(value clean.json events)" ] || fail "without a readout all is written"

# A preset, with keys of the run file on top of it; its events have causes.
strong="--set frontend.shot_noise_hz=500 --set sensor.leak_rate_hz=200 --set frontend.hot_pixel_fraction=0.01"
expect 0 tides simulate run.json -o noisy.h5 --set sensor.preset=v2e-noisy $strong --preview noisy.png
out "^causes +signal [0-9.]+.*, leak [0-9.]+.*, shot noise [0-9.]+.*, hot pixels [0-9.]+"
exists noisy.png
expect 0 tides simulate run.json -o noisy2.h5 --set sensor.preset=v2e-noisy $strong --json
for key in events_signal events_leak events_shot events_hot; do
    [ "$(value out $key)" -gt 0 ] || fail "$key should be above 0"
done
[ "$(value out events)" = $(($(value out events_signal) + $(value out events_leak) + $(value out events_shot) + \
    $(value out events_hot))) ] || fail "the causes should sum to the events"
cmp -s noisy.h5 noisy2.h5 || fail "the same seed should make the same file"
expect 0 tides simulate run.json -qo seeded.h5 --set sensor.preset=v2e-noisy $strong --seed 5
cmp -s noisy.h5 seeded.h5 && fail "another seed should make another file"
if "${PYTHON:-/usr/bin/python3}" -c 'import h5py' 2>/dev/null; then
    "${PYTHON:-/usr/bin/python3}" - <<-'PY' || fail "causes or run are wrong in noisy.h5"
	import h5py, json
	f = h5py.File("noisy.h5", "r")
	cause, run = f["events/cause"][:], json.loads(f.attrs["run"])
	assert set(cause) == {0, 1, 2, 3} and len(cause) == f.attrs["count"]
	assert "cause" not in h5py.File("clean.h5", "r")["events"]
	sensor = run["sensor"]
	assert sensor["threshold_sigma"] == 0.05 and sensor["refractory_law"] == "drop_keep", "the preset's"
	assert sensor["leak_rate_hz"] == 200 and run["frontend"]["shot_noise_hz"] == 500, "the command line's"
	PY
fi

# A preset of one's own, beside the run file; the run file's keys win.
mkdir -p sub
cat >sub/mine.json <<-JSON
	{ "about": "mine", "sensor": { "threshold_on": { "value": 0.5, "source": "measured" }, "threshold_off": 0.1 } }
JSON
sed 's|"stepping"|"sensor": { "preset": "sub/mine.json", "threshold_off": 0.3 }, "stepping"|' run.json >own.json
expect 0 tides simulate own.json -qo own.h5
expect 0 tides simulate run.json -qo same.h5 --set sensor.threshold_on=0.5 --set sensor.threshold_off=0.3
expect 0 tides info own.h5 --json
count=$(value out events)
expect 0 tides info same.h5 --json
[ "$count" = "$(value out events)" ] || fail "a preset's threshold should be a threshold"
refuse 1 "sensor.preset = \"dvs127\" is none of davis240, .*v2e-noisy" tides simulate run.json -o x.h5 --set sensor.preset=dvs127
refuse 1 "none.json" tides simulate run.json -o x.h5 --set sensor.preset=sub/none.json
echo '{ "sensor": { "treshold_on": 1 } }' >bad.json
refuse 1 "preset bad.json: unknown key .*did you mean" tides simulate run.json -o x.h5 --set sensor.preset=bad.json
echo '{ "stepping": { "mode": "fixed" } }' >bad.json
refuse 1 "stepping.*a preset holds" tides simulate run.json -o x.h5 --set sensor.preset=bad.json
echo '{ "image": { "transfer": "srgb" } }' >bad.json
refuse 1 "image.transfer: of image a preset holds log_eps alone" tides simulate run.json -o x.h5 --set sensor.preset=bad.json
echo '{ "image": { "log_eps": { "value": 0.051, "source": "measured" } } }' >dark.json
expect 0 tides simulate run.json -qo dark.h5 --set sensor.preset=dark.json
expect 0 tides simulate run.json -qo same.h5 --set image.log_eps=0.051
expect 0 tides info dark.h5 --json
count=$(value out events)
expect 0 tides info same.h5 --json
[ "$count" = "$(value out events)" ] || fail "a preset's black level should be the black level"
echo '{ "sensor": { "threshold_on": { "source": "?" } } }' >bad.json
refuse 1 "sensor.threshold_on has no value" tides simulate run.json -o x.h5 --set sensor.preset=bad.json
echo '{ "sensor": ' >bad.json
refuse 1 "isn't valid JSON" tides simulate run.json -o x.h5 --set sensor.preset=bad.json

# The readout: nothing comes out that didn't go in, and a narrow one delays and drops.
narrow="--set readout.enabled=true --set readout.tick_s=2e-5 --set readout.k0=1 --set readout.queue_capacity=8"
expect 0 tides simulate run.json -o narrow.h5 $narrow --json
cp out narrow.json
[ "$(value narrow.json events)" = "$(value clean.json events)" ] || fail "the readout shouldn't change what fires"
[ "$(value narrow.json events_dropped)" -gt 0 ] || fail "a narrow readout should drop"
[ "$(value narrow.json events_delayed)" -gt 0 ] || fail "a narrow readout should delay"
expect 0 tides info narrow.h5 --json
[ "$(value out events)" = $(($(value narrow.json events) - $(value narrow.json events_dropped))) ] || fail "events are lost"
[ "$(value out events)" = "$(value narrow.json events_written)" ] || fail "events_written isn't what the file holds"
# One's own presets by name, where the configuration of the user is; tools know the library's by theirs.
export XDG_CONFIG_HOME=$PWD/config
mkdir -p config/tides/presets
printf '{ "about": "mine", "sensor": { "threshold_on": 0.21, "threshold_off": 0.23 } }' >config/tides/presets/mine-1.json
expect 0 tides simulate run.json -qo named.h5 --set sensor.preset=mine-1
expect 0 tides simulate run.json -qo given.h5 --set sensor.threshold_on=0.21 --set sensor.threshold_off=0.23
expect 0 tides convert named.h5 named.csv -q
expect 0 tides convert given.h5 given.csv -q
cmp named.csv given.csv || fail "the preset should be found by name"
expect 0 tides info mine-1
out "^about +mine"
out "sensor.threshold_on +0.21"
expect 0 tides info davis346
out "^kind +preset"
out "^guesses +0$"
out "sensor.threshold_on +derived, 0.134 to 0.431: .*libcaer"
expect 0 tides info gen3
out "^guesses +9$"
expect 0 tides presets
out "^imx636 +1280x720 +0.223 "
out "^Left to the run: camera.width"
expect 0 tides presets --json
[ "$(grep -c '"guesses":' out)" = 15 ] || fail "fifteen presets"
refuse 1 "nope: can't be opened: there is no such file, nor a preset of that name" tides info nope
printf '{ "sensor": { "treshold_on": 1 } }' >config/tides/presets/bad.json
refuse 1 "unknown key \"sensor.treshold_on\"" tides info bad
unset XDG_CONFIG_HOME
HOME=$PWD/home && mkdir -p home/.config && cp -r config/tides home/.config && export HOME
expect 0 tides info mine-1

# Two runs share a sensor by its maps: other seeds, and nothing drawn but what the first has drawn.
drawn="--set sensor.threshold_sigma=0.03 --set sensor.dead_pixel_fraction=0.1 --set frontend.noise_sigma=0.2"
expect 0 tides simulate run.json -qo first.h5 $drawn --seed 7 --maps maps.h5
expect 0 tides simulate run.json -qo shared.h5 --set sensor.maps=maps.h5 --seed 8
expect 0 tides simulate run.json -qo other.h5 $drawn --seed 8
for name in first shared other; do expect 0 tides convert $name.h5 $name.csv -q; done
cmp first.csv shared.csv || fail "the sensor isn't the same"
cmp -s first.csv other.csv && fail "another seed should be another sensor"
refuse 1 "maps.h5: threshold_on isn't an array of" tides simulate run.json -o x.h5 --set sensor.maps=maps.h5 --set camera.scale=0.5
refuse 1 "none.npz" tides simulate run.json -o x.h5 --set sensor.maps=none.npz
refuse 1 "--maps x.h5|x.h5" tides simulate run.json -o x.h5 --maps x.h5

# A camera's own biases, a line each.
printf '{DiffBn_coarse: 4, DiffBn_fine: 39, OFFBn_coarse: 4, OFFBn_fine: 0, ONBn_coarse: 6, ONBn_fine: 200}\n' >biases.yaml
expect 0 tides simulate run.json -o biased.h5 --set sensor.biases=biases.yaml
err "biases biases.yaml: ON and diff: sensor.threshold_on 0.413"
err "frontend.photoreceptor_cutoff_hz is kept"
