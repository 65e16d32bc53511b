# A request to stop ends the run: exit 1, one line, and the events so far stay readable in the .part file.
make_scene
awk 'BEGIN { for (i = 0; i <= 4000; i++) printf "%g %g 0 0 0 0 0 1\n", i * 0.01, 0.2 * sin(i * 0.15) }' >path.txt
set -m # so that the job doesn't start with SIGINT ignored
for signal in INT TERM; do
    tides simulate run.json -qo e.h5 --set time.stop=40 --set stepping.step_s=0.001 >out 2>err &
    await [ -s e.h5.part ]
    kill -$signal $!
    wait $!
    [ $? = 1 ] || fail "the exit code should be 1"
    error_line "stopped on request; the [0-9]+ events so far are in e.h5.part"
    missing e.h5
    expect 0 tides info e.h5.part
    out "^kind +events"
    rm e.h5.part
done

# A second one within a second is the same: a terminal and whoever started the tool may each send it.
tides simulate run.json -qo e.h5 --set time.stop=40 --set stepping.step_s=0.001 >out 2>err &
await [ -s e.h5.part ]
kill -INT $!
sleep 0.01
kill -INT $! 2>/dev/null
wait $!
[ $? = 1 ] || fail "a second SIGINT at once should be the first"
error_line "stopped on request; the [0-9]+ events so far are in e.h5.part"
rm e.h5.part

# Within an image too: of pictures, exposures and datasets nothing half done is left. Unheard, they would be finished, and exit 0.
# stopped STAGE COMMAND...: Ctrl-C once STAGE has been at work for a second, or where it ended without.
tells() { grep -qs "$2: [0-9]* %" err || ended $1; }
stopped() {
    local stage=$1
    shift
    rm -f err # what the one before told is no word of this one
    "$@" >out 2>err &
    await tells $! "$stage"
    kill -INT $!
    wait $!
    [ $? = 1 ] || fail "$2: the exit code should be 1"
    [ ! -s out ] || fail "$2: facts of what wasn't done"
    err "^tides: stopped on request"
}
big="--set camera.width=4000 --set camera.height=3000 --set camera.fx=4000" # seconds: a stage is told of after one
stopped rendering tides render run.json -o big.exr --png big.png $big
stopped rendering tides render run.json -o big.exr --truth depth $big
stopped frames tides frames run.json -o frames --set exposure.exposure_s=0.01 $big
err "after 0 of "
[ -z "$(ls frames)" ] || fail "half a frame is left"
stopped pictures tides dataset run.json -o set --layout ecd --set camera.width=1000 --set camera.height=750 --set camera.fx=1000 \
    --set scene.metres_per_unit=1 --set dataset.picture_hz=200 --set stepping.mode=fixed --set stepping.step_s=0.04 \
    --set sensor.threshold_on=50 --set sensor.threshold_off=50
err "set.part keeps the events so far"
for file in big.exr big.exr.part big.png big.png.part set; do missing $file; done
