# Labels: columns beside the events on request, equal after an interruption; refused for formats that can't hold them.
make_scene
narrow="--set readout.enabled=true --set readout.tick_s=2e-5 --set readout.k0=1"
filter="--set frontend.photoreceptor_cutoff_hz=200"
expect 0 tides simulate run.json -qo plain.h5 $filter
expect 0 tides info plain.h5 --json
! grep -q labels out || fail "nobody asked for labels"
expect 0 tides simulate run.json -qo full.h5 $filter --set sensor.labels=true
silent
expect 0 tides info full.h5
out "^labels +cause  fired  frontend$"
expect 0 tides simulate run.json -qo late.h5 $filter $narrow --set readout.jitter_law=delay --set sensor.labels=true
expect 0 tides simulate run.json -qo bare.h5 --set sensor.labels=true

# Other formats and methods on frames have no place for them.
refuse 1 "x.raw: .*has no place for labels: write HDF5" tides simulate run.json -o x.raw --set sensor.labels=true
missing x.raw
refuse 1 "sensor.labels is true.*method \"tides\"" tides simulate run.json -o x.h5 --set sensor.labels=true --set method=esim

# Converting and cutting say that they drop them.
expect 0 tides convert full.h5 full.csv
grep -q "the labels of full.h5 aren't kept" err || fail "convert should say that labels are dropped"
expect 0 tides cut full.h5 cut.h5 --start 0 --stop 0.01 --json
out "\"labels_dropped\":[[:space:]]*true"
expect 0 tides info cut.h5 --json
! grep -q labels out || fail "cut.h5 shouldn't have labels"

# Interrupted and gone on with.
set -m # so that jobs don't start with SIGINT ignored
awk 'BEGIN { for (i = 0; i <= 400; i++) printf "%g %g 0 0 0 0 0 1\n", i * 0.01, 0.3 * sin(i * 0.3) }' >path.txt
long="$filter $narrow --set sensor.labels=true --set sensor.threshold_on=0.03 --set time.stop=0.5 --set stepping.step_s=0.002"
expect 0 tides simulate run.json -qo whole.h5 $long
signal_at_checkpoint KILL tides simulate run.json -qo parts.h5 --checkpoint 0.005 $long
refuse 1 "sensor.labels|differ" tides simulate run.json -qo parts.h5 --resume $long --set sensor.labels=false
expect 0 tides simulate run.json -qo parts.h5 --resume $long

"${PYTHON:-/usr/bin/python3}" -c 'import h5py' 2>/dev/null || exit 0
"${PYTHON:-/usr/bin/python3}" - <<-'PY' || fail "labels are wrong"
	import h5py, numpy as np
	def read(name):
	    events = h5py.File(name + ".h5", "r")["events"]
	    return {key: events[key][:] for key in events if events[key].shape} # height and width are numbers
	plain, full, late, bare, whole, parts = map(read, ("plain", "full", "late", "bare", "whole", "parts"))
	assert all((plain[key] == full[key]).all() for key in plain), "labels change events"
	assert (full["fired"] == full["t_ns"]).all() and full["fired"].dtype == "<i8"
	assert full["frontend"].dtype == "<f4" and (full["frontend"] != 0).mean() > 0.9
	lag = np.sign(full["frontend"]) == np.where(full["p"] == 1, -1, 1)
	assert lag.mean() > 0.9, "a low-pass lags"
	assert (bare["frontend"] == 0).all() and (bare["cause"] == 0).all()
	assert (late["fired"] <= late["t_ns"]).all() and (late["fired"] < late["t_ns"]).any()
	assert set(whole) == set(parts) and all(whole[key].tobytes() == parts[key].tobytes() for key in whole), "resumed"
PY
