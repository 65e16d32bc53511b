# The demo writes all files that it promises, within a minute.
unset TIDES_DEVICE
expect 0 tides devices --json
grep -q '"index":[[:space:]]*[0-9]' out || skip "no OpenCL device here: the reference would take too long"
expect 0 tides demo -o made
out "^events +[0-9.]+ M"
out "made/run.json"
for file in run.json room.h5 fan.ply fan.json camera.json events.h5 stats.json preview.png frame.exr; do exists made/$file; done
ls made | grep -q part && fail "a .part is left"
[ "$(value made/stats.json events)" -gt 500000 ] || fail "a fan fires more than that"
[ "$(value made/stats.json events_truncated)" = 0 ] || fail "crossings were truncated"
awk -v on="$(value made/stats.json events_on)" -v all="$(value made/stats.json events)" \
    'BEGIN { exit !(on > 0.4 * all && on < 0.6 * all) }' || fail "a periodic motion fires ON and OFF alike"
expect 0 tides demo -o again --json --quiet
is_json
[ ! -s err ] || fail "--quiet leaves stderr alone"
