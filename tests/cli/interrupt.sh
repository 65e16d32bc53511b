# A request to stop ends the run cleanly: exit 1, one line, and the events so far stay readable in the .part file.
make_scene
awk 'BEGIN { for (i = 0; i <= 4000; i++) printf "%g %g 0 0 0 0 0 1\n", i * 0.01, 0.2 * sin(i * 0.15) }' >path.txt
set -m # so that the job doesn't start with SIGINT ignored
for signal in INT TERM; do
    tides simulate run.json -qo e.h5 --set time.stop=40 --set stepping.step_s=0.001 >out 2>err &
    for _ in $(seq 100); do
        [ -s e.h5.part ] && break
        sleep 0.05
    done
    sleep 1
    kill -$signal $!
    wait $!
    [ $? = 1 ] || fail "the exit code should be 1"
    error_line "stopped on request; the [0-9]+ events so far are in e.h5.part"
    missing e.h5
    expect 0 tides info e.h5.part
    out "^kind +events"
    rm e.h5.part
done
