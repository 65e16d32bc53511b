# Event files of every format: simulated, converted there and back, cut, described.
make_scene
expect 0 tides simulate run.json -q -o e.h5
expect 0 tides info --json e.h5
count=$(value out events)
[ "$count" -gt 200 ] || fail "too few events to test with"

# A dataset in a layout of a later HDF5 (its message's version is 5) is one, and the library's version is what can't read it.
${PYTHON:-python3} - <<'PYTHON'
data = open("e.h5", "rb").read()
open("newest.h5", "wb").write(data.replace(b"\3\2\2", b"\5\2\2"))
PYTHON
refuse 1 "newest.h5: /events/p is a dataset that HDF5 [0-9.]+ can't open: .*libver" tides info newest.h5

# The simulator writes any format; the events are those of the native file, floored to microseconds.
for file in s.raw s.dat s.es s.aedat4 s.csv s.npy s.txt s.npz; do
    expect 0 tides simulate run.json -q -o $file
    missing $file.part
    expect 0 tides info --json $file
    [ "$(value out events)" = "$count" ] || fail "$file: $(value out events) events, not $count"
    [ "$(value out disorder)" = 0 ] || fail "$file isn't in order"
done
expect 0 tides info s.raw
out "^layout +evt3"
out "^width +48"
out "^size_from +file"
out "^on_percent +[0-9]"
out "^rate_hz +[0-9]"
expect 0 tides simulate run.json -o s.raw --preview p.png
exists p.png
refuse 2 "only an HDF5 file" tides simulate run.json -o s.raw --resume
refuse 2 "only an HDF5 file" tides simulate run.json -o s.raw --checkpoint 5
refuse 1 "no format of event files ends in .mp4" tides simulate run.json -q -o s.mp4
mkdir -p hidden
expect 0 tides convert -q s.raw hidden/.s # a name, and no ending: HDF5
expect 0 tides info hidden/.s
out "^layout +tides"

# Exact formats give the native file back, byte for byte in its datasets; the others what they floored.
expect 0 tides convert -q e.h5 t.ns.csv
expect 0 tides convert -q t.ns.csv t.h5 --from csv-ns
expect 0 tides convert -q t.h5 again.ns.csv
cmp -s t.ns.csv again.ns.csv || fail "nanoseconds were lost on the way through HDF5"
expect 0 tides convert -q t.h5 t.txt
expect 0 tides convert -q t.txt back.ns.csv --width 48 --height 36
cmp -s t.ns.csv back.ns.csv || fail "nanoseconds were lost on the way through text"
expect 0 tides convert -q e.h5 floored.csv
expect 0 tides convert -q floored.csv t.csv # simultaneous now, what was a few nanoseconds apart: sorted by place
for file in u.raw u.evt2.raw u.evt21.raw u.evt4.raw u.dat u.es u.aedat4 u.npy u.openeb.csv u.ecf.hdf5; do
    expect 0 tides convert -q t.csv $file
    silent
    expect 0 tides convert -q $file back.csv --width 48 --height 36
    cmp -s t.csv back.csv || fail "$file holds other events"
done
expect 0 tides convert s.raw from_raw.csv --json
out '"from":[[:space:]]*"evt3"'
out '"to":[[:space:]]*"csv"'
expect 0 tides convert -q s.raw by_name --to es
expect 0 tides info by_name
out "^layout +es"
expect 0 tides convert --help
out "^  evt3 "
refuse 1 "did you mean evt" tides convert s.raw x.raw --to evt33
refuse 1 "outside the image" tides convert s.raw small.raw --width 8 --height 8
missing small.raw
missing small.raw.part
refuse 2 "not a number of pixels" tides convert s.raw x.raw --width 0.5

# Out of order, and simultaneous: put in order. Two events of a pixel in one microsecond are told.
printf '0.000003 1 2 1\n0.000001 5 0 0\n0.000001 4 0 1\n0.0000012 5 0 1\n' >late.txt
expect 0 tides convert late.txt late.csv
out "1 events were out of order"
err "1 events share their pixel"
printf 't,x@6,y@3,on\n1,4,0,1\n1,5,0,0\n1,5,0,1\n3,1,2,1\n' | cmp -s - late.csv || fail "late.csv isn't in order"
refuse 1 "before time 0" tides convert --rebase late.txt based.csv
printf '7.5 1 2 1\n7.500001 5 0 0\n' >absolute.txt
expect 0 tides convert -q --rebase absolute.txt based.csv
printf 't,x@6,y@3,on\n0,1,2,1\n1,5,0,0\n' | cmp -s - based.csv || fail "times don't count from the first event"
printf -- '-0.5 1 2 1\n' >early.txt
refuse 1 "before time 0.*--rebase" tides convert -q early.txt x.dat

# Cut in time and space; the pieces are the whole.
expect 0 tides cut e.h5 one.ns.csv --stop 0.02 -q
expect 0 tides cut e.h5 two.ns.csv --start 0.02 -q
tail -n +2 two.ns.csv | cat one.ns.csv - | cmp -s - t.ns.csv || fail "two pieces aren't the whole"
expect 0 tides cut e.h5 window.csv --roi 10,5,20,15
out "20 x 15 px"
awk -F, 'NR > 1 && ($2 > 19 || $3 > 14) { exit 1 }' window.csv || fail "an event outside the window"
awk -F, 'NR > 1 && $2 >= 10 && $2 < 30 && $3 >= 5 && $3 < 20 { n++ } END { print n + 0 }' floored.csv >inside
[ "$(($(wc -l <window.csv) - 1))" = "$(cat inside)" ] || fail "the window holds other events"
refuse 2 "nothing to cut" tides cut e.h5 x.h5
refuse 2 "isn't before" tides cut e.h5 x.h5 --start 2 --stop 1
refuse 2 "x,y,width,height" tides cut e.h5 x.h5 --roi 1,2,3
refuse 1 "doesn't lie within" tides cut e.h5 x.h5 --roi 40,0,20,10
missing x.h5

# Files that are no event files, and damaged ones: one line, and no output.
printf 'hello\n' >text.raw
refuse 1 "text.raw" tides convert text.raw x.dat
head -c $(($(wc -c <s.raw) - 1)) s.raw >cut.raw
refuse 1 "cut off" tides info cut.raw
refuse 1 "cut off" tides convert cut.raw x.dat
missing x.dat
refuse 1 "No such file" tides convert absent.raw x.dat
