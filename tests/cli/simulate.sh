# From a run file to events, statistics and a preview, and info on the results.
make_scene
expect 0 tides simulate run.json -o e.h5 --stats s.json --preview p.png
out "^events +[0-9]"
out "real-time factor"
exists e.h5
exists p.png
missing e.h5.part
missing s.json.part
expect 0 tides info e.h5 --json
for key in events events_on events_off; do
    [ -n "$(value s.json $key)" ] && [ "$(value s.json $key)" = "$(value out $key)" ] || fail "$key: stats and file differ"
done
[ "$(value s.json events)" -gt 200 ] || fail "a wall that slides by should fire more"
[ "$(value s.json events)" = $(($(value s.json events_on) + $(value s.json events_off))) ] || fail "on + off isn't all"
[ "$(value out width)x$(value out height)" = 48x36 ] || fail "the size is wrong"
[ "$(value out last_ns)" -lt 40000000 ] || [ "$(value out last_ns)" = 40000000 ] || fail "events after the end"
for key in events_truncated events_suppressed events_dropped renders_full_frame_equivalent tile_jobs tile_jobs_skipped \
    gaussians_total gaussians_projected pairs_evaluated steps_rejected worst_error time_s other run_time_s real_time_factor \
    peak_memory_bytes device version seed; do
    grep -q "\"$key\":" s.json || fail "the statistics lack $key"
done
# What the run has where its stepping left it open is no statistic.
tr -d ' \t\n' <s.json | grep -Eq '"settings":\{"solve":1,"unsolved":0,"unit":1,"tolerance":0\.1\}' || fail "settings aren't a group"
# The stages and `other` sum to the run time.
awk '/"time_s"/ { inside = 1; next } /}/ { inside = 0 }
     { gsub(/[",]/, ""); sub(/:/, "") } inside { sum += $2 } $1 == "run_time_s" { total = $2 }
     END { exit !(sum > 0.99 * total && sum < 1.01 * total) }' s.json || { cat s.json; fail "time_s doesn't sum to run_time_s"; }
# The same run gives the same events; half the threshold gives about twice as many.
expect 0 tides simulate run.json -q -o again.h5
cmp -s e.h5 again.h5 || { tides info e.h5; tides info again.h5; fail "two equal runs differ"; }
expect 0 tides simulate run.json -o half.h5 --json --set sensor.threshold_on=0.1 --set sensor.threshold_off=0.1
awk -v a="$(value s.json events)" -v b="$(value out events)" 'BEGIN { exit !(b > 1.6 * a && b < 2.6 * a) }' || fail "half the threshold"
# Crossings that are cut off in a step fire at its end, where the next packet begins: the stream stays in order.
expect 0 tides simulate run.json -q -o burst.h5 --set stepping.mode=fixed --set stepping.step_s=0.001 \
    --set sensor.max_events_per_step=1 --set sensor.threshold_on=1e-3 --set sensor.threshold_off=1e-3 --stats burst.json
[ "$(value burst.json events_truncated)" -gt 0 ] || fail "nothing was cut off: the case tests nothing"
# A small file takes little room: 300 kB are enough, where a whole chunk of events, 2 MB, was claimed.
(ulimit -f 300 && tides simulate run.json -q -o small.h5 --set image.transfer=linear) || fail "a small .h5 doesn't fit in 300 kB"
expect 0 tides info small.h5
