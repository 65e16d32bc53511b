# Nothing moves: no events, and a file that says so.
make_scene
printf '0 0 0 0 0 0 0 1\n' >path.txt
expect 0 tides simulate run.json -o e.h5
out "^events +0 "
expect 0 tides info e.h5 --json
[ "$(value out events)" = 0 ] || fail "events out of nothing"
