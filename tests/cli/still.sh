# A scene at rest: no events, and a valid file.
make_scene
printf '0 0 0 0 0 0 0 1\n' >path.txt
expect 0 tides simulate run.json -o e.h5
out "^events +0 "
err "no events: the image stays the same: camera and scene are at rest"
expect 0 tides simulate run.json -qo e.h5
silent
expect 0 tides info e.h5 --json
[ "$(value out events)" = 0 ] || fail "events out of nothing"
# Why else nothing fires: nothing reaches the threshold, pixels are dead or masked, the readout drops all, frames are alike.
make_scene
expect 0 tides simulate run.json -o e.h5 --set sensor.threshold_on=5 --set sensor.threshold_off=5
err "no pixel's L changes by more than [0-9.]+ in 17 pictures of the run, [0-9.]+ % of the threshold of 5: lower sensor.threshold_on"
expect 0 tides simulate run.json -o e.h5 --set sensor.dead_pixel_fraction=1
err "all pixels are dead"
expect 0 tides simulate run.json -o e.h5 --set sensor.b_min=1
err "all pixels are masked: the largest coverage is 0.[0-9]+, and sensor.b_min is 1"
expect 0 tides simulate run.json -o e.h5 --set readout.enabled=true --set readout.p0=1
err "readout and filters dropped all [0-9]+ that pixels fired"
for k in 0 1 2; do { npy_header "3, 4, 4"; head -c 48 /dev/zero; } >frames.npy; done
expect 0 tides simulate --set frames.file=frames.npy --set frames.frames_per_second=100 -o e.h5
err "no events: the frames are all alike"
