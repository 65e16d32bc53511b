# The filters of cameras: in a run, and with equal results on the run's recording.
make_scene
sets="--set sensor.threshold_on=0.05 --set sensor.threshold_off=0.05"
expect 0 tides simulate run.json -qo all.h5 $sets
expect 0 tides simulate run.json -o run.h5 $sets --set filters.trail=trail --set filters.trail_s=0.005 --json
cp out run.json.facts
[ "$(value run.json.facts trail)" -gt 0 ] || fail "the trail filter should drop some"
[ "$(value run.json.facts events)" = $(($(value run.json.facts events_written) + $(value run.json.facts trail))) ] || fail "events are lost"
expect 0 tides convert all.h5 file.csv --filter trail=trail --filter filters.trail_s=0.005
out "^filtered_trail +[0-9]+ events"
expect 0 tides convert run.h5 run.csv -q
cmp file.csv run.csv || fail "the run's filter and the file's should be the same"
expect 0 tides convert all.h5 file.h5 --filter trail=trail --filter trail_s=0.005 --json
[ "$(value out filtered_trail)" = "$(value run.json.facts trail)" ] || fail "the count should be the run's"
refuse 1 "filters.tail" tides convert all.h5 x.h5 --filter tail=trail
refuse 1 "none of|one of" tides convert all.h5 x.h5 --filter trail=cut
refuse 1 "afk_stop" tides convert all.h5 x.h5 --filter afk=band_stop --filter afk_stop=7
refuse 1 "bounds|above" tides simulate run.json -o x.h5 --set filters.activity_low_start=5 --set filters.activity_low_stop=4
[ ! -e x.h5 ] || fail "what was refused should leave no file"
echo '{ "about": "mine", "sensor": {}, "filters": { "trail": "trail", "trail_s": 0.005 } }' >mine.json
expect 0 tides simulate run.json -qo preset.h5 $sets --set sensor.preset=mine.json
expect 0 tides convert preset.h5 preset.csv -q
cmp preset.csv run.csv || fail "a preset's filters should be the run's"
