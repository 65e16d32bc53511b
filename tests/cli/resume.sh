# A run interrupted by Ctrl-C or by kill -9 continues with --resume, and gives the same events as a run without interruption.
make_scene
awk 'BEGIN { for (i = 0; i <= 400; i++) printf "%g %g 0 0 0 0 0 1\n", i * 0.01, 0.3 * sin(i * 0.3) }' >path.txt
set -m # so that jobs don't start with SIGINT ignored

# The datasets' bytes, without the attributes (a run that was extended is another run file).
datasets() {
    "${PYTHON:-/usr/bin/python3}" - "$@" <<-'PY'
	import sys
	import h5py
	files = [h5py.File(name, "r") for name in sys.argv[1:3]]
	for name in ("t_ns", "t", "x", "y", "p"):
	    a, b = (f["events/" + name] for f in files)
	    assert a.dtype == b.dtype and a[:].tobytes() == b[:].tobytes(), name
	a, b = (f["ms_to_idx"][:] for f in files)
	assert a.dtype == b.dtype and a.tobytes() == b.tobytes(), "ms_to_idx"
	for name in ("count", "stop_ns", "width", "height"):
	    assert files[0].attrs[name] == files[1].attrs[name], name
	assert files[0].attrs["run"] == files[1].attrs["run"], "run"
	PY
}
"${PYTHON:-/usr/bin/python3}" -c 'import h5py' 2>/dev/null && have_h5py=1 || have_h5py=
same() {
    if [ -n "$have_h5py" ]; then
        datasets "$1" "$2" || fail "$1 and $2 differ"
    else
        cmp -s "$1" "$2" || fail "$1 and $2 differ"
    fi
}

# interrupt SIGNAL OPTIONS...: starts a run of e.h5 and sends the signal once there is a (new) checkpoint.
interrupt() {
    local signal=$1
    shift
    signal_at_checkpoint "$signal" tides simulate run.json -qo e.h5 --checkpoint 0.005 "$@"
    exists e.h5.checkpoint
    exists e.h5.part
    [ -n "${finished:-}" ] || missing e.h5
}

small="--set sensor.threshold_on=0.03 --set sensor.threshold_off=0.03 --set time.stop=0.5"
for mode in "--set stepping.mode=fixed --set stepping.step_s=0.002" "--set stepping.mode=error --set stepping.step_s=0.005"; do
    expect 0 tides simulate run.json -o whole.h5 --json --preview whole.png $small $mode
    count=$(value out events)
    for signal in KILL INT; do
        interrupt $signal $small $mode
        if [ $signal != KILL ]; then
            [ $code = 1 ] || fail "the exit code should be 1"
            error_line "stopped on request; the [0-9]+ events so far are in e.h5.part; --resume goes on from there"
            missing e.h5.part.tail
        fi
        expect 0 tides info e.h5.part
        # Interrupted again while it goes on, then to the end.
        interrupt KILL --resume $small $mode
        echo half >e.h5.checkpoint.part # what a kill within a save leaves
        expect 0 tides simulate run.json -o e.h5 --resume --stats s.json --preview p.png $small $mode
        same whole.h5 e.h5
        [ "$(value s.json events)" = "$count" ] || fail "the statistics count $(value s.json events) events of $count"
        for left in e.h5.part e.h5.part.tail e.h5.checkpoint e.h5.checkpoint.part; do missing $left; done
        cmp -s whole.png p.png || fail "the previews differ"
        rm e.h5 s.json p.png
    done
done

# A later stop extends an interrupted run.
interrupt KILL $small $mode
expect 0 tides simulate run.json -qo e.h5 --resume $small $mode --set time.stop=0.6
expect 0 tides simulate run.json -qo whole.h5 $small $mode --set time.stop=0.6
same whole.h5 e.h5
rm e.h5

# Other runs are refused, and nothing is lost by asking.
interrupt KILL $small $mode
cp e.h5.checkpoint kept.checkpoint
cp e.h5.part kept.part
refuse 1 "e.h5.checkpoint: is of another run: image.log_eps is 0.001 there and 0.002 here" \
    tides simulate run.json -qo e.h5 --resume $small $mode --set image.log_eps=0.002
mv scene.ply scene.kept
sed 's/ 3 -1.9 / 3 -1.8 /' scene.kept >scene.ply
refuse 1 "e.h5.checkpoint: is of another run: the scene changed" tides simulate run.json -qo e.h5 --resume $small $mode
mv scene.kept scene.ply
head -c 3000 kept.checkpoint >e.h5.checkpoint
refuse 1 "e.h5.checkpoint: .*damaged or cut short" tides simulate run.json -qo e.h5 --resume $small $mode
cp kept.checkpoint e.h5.checkpoint
mv e.h5.part moved
refuse 1 "e.h5.part: can't be opened" tides simulate run.json -qo e.h5 --resume $small $mode
mv moved e.h5.part
cmp -s e.h5.part kept.part || fail "e.h5.part was touched"
expect 0 tides simulate run.json -qo e.h5 --resume $small $mode
rm e.h5

# Without --resume a run starts anew; with it but without a checkpoint too, and says so.
interrupt KILL $small $mode
expect 0 tides simulate run.json -qo e.h5 $small $mode
missing e.h5.checkpoint
missing e.h5.part.tail
expect 0 tides simulate run.json -o e3.h5 --resume $small $mode
err "tides: e3.h5.checkpoint isn't there: starting from the beginning"
same e.h5 e3.h5
expect 0 tides simulate run.json -qo e3.h5 --resume $small $mode
silent
expect 0 tides simulate run.json -o e3.h5 --resume $small $mode --set time.stop=0.52
err "tides: e3.h5 is finished, and kept no checkpoint \(--keep-checkpoint\): starting from the beginning"

# A finished run that kept its checkpoint goes on to a later stop, wherever in a step it stopped; interrupted on the way, too, and
# until the longer file is complete the shorter one is there.
expect 0 tides simulate run.json -qo whole.h5 $small $mode
expect 0 tides simulate run.json -qo e.h5 --keep-checkpoint $small $mode --set time.stop=0.2333
exists e.h5.checkpoint
missing e.h5.part
cp e.h5 short.h5
refuse 1 "e.h5.checkpoint: is of another run: image.log_eps is" tides simulate run.json -qo e.h5 --resume $small $mode --set image.log_eps=0.002
refuse 1 "e.h5.checkpoint: was made at .* after time.stop" tides simulate run.json -qo e.h5 --resume $small $mode --set time.stop=0.1
missing e.h5.part
finished=1
interrupt INT --resume $small $mode
finished=
cmp -s e.h5 short.h5 || fail "the finished file was touched"
expect 0 tides simulate run.json -vo e.h5 --resume $small $mode
err "going on at 0\.[0-9]+ s, after [0-9]+ events"
same whole.h5 e.h5
for left in e.h5.part e.h5.part.tail e.h5.checkpoint; do missing $left; done

# Another recording in its place, whoever writes it, takes the checkpoint with it: --resume would go on after events of that one.
expect 0 tides simulate run.json -qo e.h5 --keep-checkpoint $small $mode --set time.stop=0.2333
echo half >e.h5.checkpoint.part
expect 0 tides convert whole.h5 e.h5 -q
missing e.h5.checkpoint
missing e.h5.checkpoint.part
# And a copy that no writer of ours knows of is refused by its events, as is a .part; both stay as they are.
expect 0 tides simulate run.json -qo e.h5 --keep-checkpoint $small $mode --set time.stop=0.2333
cp e.h5 own.h5
expect 0 tides simulate run.json -qo other.h5 $small $mode --set time.stop=0.2333 --set sensor.threshold_on=0.02
for name in e.h5 e.h5.part; do
    cp other.h5 $name
    refuse 1 "e.h5: is of another recording than its checkpoint" tides simulate run.json -qo e.h5 --resume $small $mode
    cmp -s $name other.h5 || fail "$name was touched"
    missing e.h5.part.tail
    [ $name = e.h5.part ] || missing e.h5.part
done
rm e.h5.part
cp own.h5 e.h5
expect 0 tides simulate run.json -qo e.h5 --resume $small $mode
same whole.h5 e.h5
refuse 2 "--keep-checkpoint: only an HDF5 file" tides simulate run.json -o e.raw --keep-checkpoint
rm e.h5 short.h5

# No checkpoints where none are wanted.
tides simulate run.json -qo none.h5 --checkpoint 0 $small $mode --set time.stop=4 >out 2>err &
await [ -s none.h5.part ]
kill -INT $!
wait $!
error_line "events so far are in none.h5.part$"
missing none.h5.checkpoint
refuse 2 "--checkpoint -1: give seconds" tides simulate run.json -o e.h5 --checkpoint -1
refuse 2 "--checkpoint x: not a number" tides simulate run.json -o e.h5 --checkpoint x
