# A simulated sensor is measured again, and becomes a preset that a run accepts, and a page. Recordings that don't fit are
# refused.
make_scene
sensor="--set sensor.threshold_on=0.1 --set sensor.threshold_off=0.14 --set image.log_eps=0.05"
expect 0 tides simulate run.json -o e.h5 $sensor
expect 0 tides calibrate e.h5 run.json -o mine.json --page page --fix offset_s=0 --fix frontend.photoreceptor_cutoff_hz=0
out '^threshold_on +0\.(09[7-9]|10[0-3])'
out '^threshold_off +0\.1(3[6-9]|4[0-4])'
out '^pole_s .*given'
exists mine.json
exists page/calibrate.png
grep -q 'src="data:image/png;base64,iVBORw0KGgo' page/index.html || fail "the page has no picture"
grep -q "threshold_off" page/index.html || fail "the page has no values"
expect 0 tides simulate run.json -o again.h5 --set sensor.preset=mine.json

expect 0 tides calibrate e.h5 run.json --json --fix pole_s=0 --fix offset_s=0 --quiet
is_json
# Thresholds aren't given, names are known ones, and a region is four numbers.
refuse 1 'measured' tides calibrate e.h5 run.json --fix threshold_on=0.1
expect 2 tides calibrate e.h5 run.json --fix threshold=0.1
err 'is no value that is measured'
expect 2 tides calibrate e.h5 run.json --roi 1,2,3
expect 2 tides calibrate e.h5 run.json --start now
# Another clock, by more than light is known for: no time in common.
refuse 1 'no events from' tides calibrate e.h5 run.json --offset 100 -q
# Neither the recording nor the run is replaced.
refuse 1 'e.h5' tides calibrate e.h5 run.json -o e.h5
refuse 1 'run.json' tides calibrate e.h5 run.json -o run.json
# Polarities that are exchanged: refused, with the reason, and no preset.
expect 0 tides convert e.h5 e.txt
awk '{ $4 = 1 - $4; print }' e.txt >x.txt
expect 1 tides calibrate x.txt run.json -o no.json
err 'exchanged'
missing no.json
