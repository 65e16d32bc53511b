# A run on an OpenCL device, if there is one: nearly the events of the reference.
make_scene
expect 0 tides devices --json
grep -q '"index":[[:space:]]*[0-9]' out || skip "no OpenCL device here"
expect 0 tides simulate run.json -o r.h5 --json
value out events >reference.count
unset TIDES_DEVICE
expect 0 tides simulate run.json -o c.h5 --json --device 0
awk -v a="$(cat reference.count)" -v b="$(value out events)" 'BEGIN { exit !(b > 0.99 * a && b < 1.01 * a) }' ||
    fail "$(value out events) events, the reference has $(cat reference.count)"
