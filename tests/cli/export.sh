# Arrays for networks: shapes, windows, known events in known cells, refusals.
printf 't,x@6,y@3,on\n1000,4,1,1\n2000,0,2,0\n2500,0,2,0\n12000,5,0,1\n' >four.csv
printf 't,x@6,y@3,on\n' >empty.csv

# floats FILE COUNT: the last COUNT float32 of a file, one per line.
floats() { tail -c $((4 * $2)) "$1" | od -An -v -tf4 -w4 | tr -d ' '; }
shape() { head -c 128 "$1" | tr -d '\0' | grep -ao "'shape': ([^)]*)"; }

# Frames of 6 ms: OFF then ON, rows from the top. 2 windows of 2 x 3 x 6, the last at the very end.
expect 0 tides export four.csv -o f.npy --as frame --window 0.006 --start 0.001
out "f.npy: 1 x 2 x 3 x 6 float32"
out "1 events after the last whole window"
[ "$(shape f.npy)" = "'shape': (1, 2, 3, 6)" ] || fail "the shape is $(shape f.npy)"
floats f.npy 36 | awk 'NR == 13 && $1 != 2 { bad = 1 } NR == 29 && $1 != 1 { bad = 1 } { sum += $1 } END { exit bad || sum != 3 }' ||
    fail "two OFF at (0, 2), one ON at (4, 1), and nothing else"
expect 0 tides export four.csv -o f.npy --as frame --window 0.006 --start 0.001 --partial --json
[ "$(value out windows) $(value out events_left_out)" = "2 0" ] || fail "--partial takes the last one in"

# Surfaces remember what was before their window: exp(-age / decay).
expect 0 tides export four.csv -o s.npy --as surface --decay 0.01 --start 0.011 --stop 0.012 -q
silent
floats s.npy 36 | awk 'function near(a, b) { return a - b < 1e-6 && b - a < 1e-6 }
    NR == 13 && !near($1, exp(-0.95)) { bad = 1 } NR == 29 && !near($1, exp(-1.1)) { bad = 1 }
    NR != 13 && NR != 29 && $1 != 0 { bad = 1 } END { exit bad }' || fail "the surface is wrong"

# Voxel grids: TimeLens' bins lie on the window's ends, so that an event halfway is in the middle one alone.
printf 't,x@2,y@1,on\n5000,1,0,0\n9000,0,0,1\n' >two.csv
expect 0 tides export two.csv -o v.npy --style timelens --start 0 --stop 0.010 -q
[ "$(floats v.npy 10 | tr '\n' ' ')" = "0 0 0 0 0 -1 0.4 0 0.6 0 " ] || fail "the grid is $(floats v.npy 10 | tr '\n' ' ')"
expect 0 tides export two.csv -o v.npy --style dsec --bins 3 --normalise none --json
[ "$(value out planes)" = 3 ] || fail "three bins were asked for"
[ "$(floats v.npy 6 | tr '\n' ' ')" = "0 -1 0 0 1 0 " ] || fail "from the first event to the last: $(floats v.npy 6 | tr '\n' ' ')"

# Windows of N events; every format; empty recordings.
expect 0 tides export four.csv -o n.npz --as frame --events 2 --json
[ "$(value out windows)" = 2 ] || fail "four events are two windows of two"
for ending in npy npz h5 exr; do
    expect 0 tides export four.csv -o a.$ending -q
    exists a.$ending
    missing a.$ending.part
    expect 0 tides export empty.csv -o e.$ending -q
done
expect 0 tides info a.exr
out "voxel.0004"

refuse 2 "did you mean frame" tides export four.csv -o x.npy --as frames
refuse 2 "should be one of voxel, frame, surface" tides export four.csv -o x.npy --as qqqqqqqqq
refuse 2 "for --as voxel" tides export four.csv -o x.npy --as frame --bins 3
refuse 2 "for --as surface" tides export four.csv -o x.npy --decay 1
refuse 2 "not both" tides export four.csv -o x.npy --window 1 --events 3
refuse 2 "needs --window" tides export four.csv -o x.npy --step 1
refuse 2 "whole number" tides export four.csv -o x.npy --bins 0
refuse 2 "at most a million" tides export four.csv -o x.npy --as surface --decay 0
refuse 2 "say where" tides export four.csv
refuse 2 "beyond 63 years" tides export four.csv -o x.npy --start 3e9
refuse 1 ".npy, .npz, .h5 or .exr" tides export four.csv -o x.txt
refuse 1 "shorter than one window" tides export four.csv -o x.npy --window 10
refuse 1 "one window" tides export four.csv -o x.exr --window 0.001
refuse 1 "No such file" tides export absent.raw -o x.npy
missing x.npy
missing x.npy.part
missing x.exr

# Windows of a recording of ours begin where the run does, and end where it ends, whatever its first and last events are.
make_scene
expect 0 tides simulate run.json -qo run.h5
expect 0 tides export run.h5 -o r.npy --window 0.01 --json
[ "$(value out windows) $(value out start_ns) $(value out stop_ns)" = "4 0 40000000" ] || fail "a run of 0.04 s is four windows of 0.01 s"
expect 0 tides export run.h5 -o r.npy --window 0.01 --start 0.005 --json
[ "$(value out windows) $(value out start_ns)" = "3 5000000" ] || fail "--start wins"
