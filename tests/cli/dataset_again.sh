#!/bin/bash
# A dataset that was stopped, or whose process died, continues from the events that are there, and equals one made at once.
make_scene
awk 'BEGIN { for (i = 0; i <= 600; i++) printf "%g %g 0 0 0 0 0 1\n", i * 0.01, 0.3 * sin(i * 0.3) }' >path.txt
set -m # so that jobs don't start with SIGINT ignored
rig='rig.cameras=[{"name": "a"}, {"name": "b", "T_B_C": [[1,0,0,0.1],[0,1,0,0],[0,0,1,0],[0,0,0,1]]}]'
make=(tides dataset run.json --layout ecd --quiet --set "$rig" --set time.stop=1 --set stepping.step_s=0.001
    --set dataset.picture_hz=2 --set dataset.truth_hz=2 --set scene.metres_per_unit=1)
# stop SIGNAL FILE: once the file is there.
stop() {
    await [ -s "$2" ]
    kill -"$1" $run
    wait $run 2>/dev/null
}
expect 0 "${make[@]}" -o whole
events=cut.part/.events

"${make[@]}" -o cut >told 2>&1 &
run=$!
await [ -s $events/a.h5.part ]
refuse 1 "cut.part: another process is writing it" "${make[@]}" -o cut
stop INT $events/a.h5.part
missing cut
exists $events/a.h5.checkpoint

"${make[@]}" -o cut >told 2>&1 &
run=$!
stop KILL $events/b.h5.part
exists $events/a.seen
before=$(stat -c %i:%y $events/a.h5)
rm $events/b.h5.part # for the next one to be waited for

"${make[@]}" -o cut >out 2>err &
run=$!
stop INT $events/b.h5.part
error_line "stopped on request; cut.part keeps the events so far, and the same command goes on"
[ "$(stat -c %i:%y $events/a.h5)" = "$before" ] || fail "what was whole was made again"

touch cut.part/half
expect 0 "${make[@]}" -o cut
diff -r whole cut >differences || fail "$(head -5 differences)"
missing cut.part

# Events of another run don't stay.
"${make[@]}" -o other >told 2>&1 &
run=$!
stop KILL other.part/.events/b.h5.part
expect 0 "${make[@]}" -o other --set sensor.threshold_on=0.4
expect 0 "${make[@]}" -o alone --set sensor.threshold_on=0.4
diff -r alone other >differences || fail "$(head -5 differences)"

# A folder that isn't a dataset's is nobody's to empty.
mkdir mine.part && echo dear >mine.part/dear
refuse 1 "mine.part: is there" "${make[@]}" -o mine
exists mine.part/dear
