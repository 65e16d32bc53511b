# Comparing two streams: as a table, as JSON, parts of it, and streams that can't be compared.
make_scene
expect 0 tides simulate run.json -q -o a.h5
expect 0 tides simulate run.json -q -o b.h5 --set sensor.threshold_on=0.25
expect 0 tides metrics a.h5 a.h5 --exact
out "^ +reference +simulated"
out "^events +[0-9]+ +[0-9]+"
out "^chamfer_px +0  .*(lower|1) is b"
out "^ig_nll_excess +0  .*(lower|1) is b"
out "^victor_purpura +0  .*(lower|1) is b"
out "^count_ratio +1  .*(lower|1) is b"
# Each number says what it means.
sed 1,/^$/d out | awk 'NF < 3 { bad = 1; print } END { exit bad }' || fail "numbers without a meaning"
out "^start_ns +-?[0-9]+  "
out "^mismatch_percent +0  .*(lower|1) is b"
[ ! -s err ] || fail "short work needs no progress"
expect 0 tides metrics a.h5 b.h5 --json
cp out ab.json
for key in on_fraction isi_mean_s isi_shape_s isi_spike same_ts same_ts_tile van_rossum_norm; do
    [ "$(grep -c "\"$key\":" ab.json)" = 2 ] || fail "$key should be there for the reference and for the simulated stream"
done
for key in ig_nll ig_nll_self ig_nll_excess isi_w1_decades chamfer_px speed_px_per_s count_ratio count_correlation \
    victor_purpura van_rossum time_difference_us; do
    [ -n "$(value ab.json $key)" ] || fail "$key is missing"
done
for key in matched kernel_distance; do
    grep -q "\"$key\"" ab.json && fail "$key wasn't asked for"
done
awk -v ratio="$(value ab.json count_ratio)" 'BEGIN { exit !(ratio > 0.5 && ratio < 1) }' || fail "a higher threshold fires less"
expect 0 tides info a.h5 --json
[ "$(value out events)" = "$(value ab.json events)" ] || fail "all events should be compared"

# Parts of it.
expect 0 tides metrics a.h5 b.h5 --json --only chamfer,match --window 0.01 --speed 100
[ "$(value out speed_px_per_s)" = 100 ] || fail "the speed is the one that was given"
[ "$(value out chamfer_limit_px)" = 1 ] || fail "100 px/s over 0.01 s are 1 px"
[ -n "$(value out matched)" ] || fail "match was asked for"
grep -q ig_nll out && fail "IG-NLL wasn't asked for"
expect 0 tides metrics a.h5 a.h5 --json --roi 10,5,20,16 --from 0.01 --to 0.03
[ "$(value out width)x$(value out height)" = 20x16 ] || fail "the region's size is wrong"
[ "$(value out start_ns) $(value out stop_ns)" = "10000000 30000000" ] || fail "the interval is wrong"
[ "$(value out events)" -lt "$(value ab.json events)" ] || fail "a region holds less than all"
expect 0 tides metrics a.h5 b.h5 --json --from 0.02
[ "$(value out start_ns)" = 20000000 ] || fail "the start is wrong"
expect 0 tides metrics a.h5 b.h5 --json --only isi --to 0.0000001
grep -q '"ig_nll":[[:space:]]*null' out || fail "what is undefined should be null"
expect 0 tides metrics a.h5 b.h5 --only isi --to 0.0000001
out "^ig_nll +-  "

# What can't be.
refuse 2 "no metric is called chamfr; did you mean chamfer\?" tides metrics a.h5 b.h5 --only isi,chamfr
refuse 2 "no metric is called " tides metrics a.h5 b.h5 --only isi,
refuse 2 "x,y,width,height" tides metrics a.h5 b.h5 --roi 1,2,3
refuse 2 "x,y,width,height" tides metrics a.h5 b.h5 --roi 1,2,0,4
refuse 2 "above 0" tides metrics a.h5 b.h5 --window 0
refuse 2 "--from must come before --to" tides metrics a.h5 b.h5 --from 2 --to 1
refuse 2 "too few arguments" tides metrics a.h5
refuse 1 "outside the sensor of 48x36" tides metrics a.h5 b.h5 --roi 40,0,20,20
refuse 1 "nowhere.h5" tides metrics a.h5 nowhere.h5
refuse 1 "scene.ply: is a PLY file, not an event file" tides metrics a.h5 scene.ply
expect 0 tides simulate run.json -q -o small.h5 --set camera.width=40
refuse 1 "a.h5 is 48x36 px and small.h5 40x36 px" tides metrics a.h5 small.h5
