# One frame as EXR and PNG.
make_scene
expect 0 tides render run.json --time 0.02 -o f.exr --png f.png -q
silent
exists f.png
missing f.exr.part
expect 0 tides info f.exr
out "^kind +exr"
out "^width +48"
for channel in Y L L_dot A A_dot coverage contributors; do out "name $channel "; done
grep -Eq "name (R|Z) " out && fail "colour and depth weren't asked for"
expect 0 tides render run.json --time 0.02 -o g.exr --rgb --depth --json
out '"time_s":[[:space:]]*0.02'
expect 0 tides info g.exr
for channel in R G B R_dot G_dot B_dot Z Z_dot; do out "name $channel "; done
# Time: the start where not given, and an error outside the path.
expect 0 tides render run.json -o h.exr --json
out '"time_s":[[:space:]]*0,'
refuse 1 "0.5" tides render run.json --time 0.5 -o i.exr
missing i.exr
[ "$(head -c 4 f.png | tail -c 3)" = PNG ] || fail "f.png isn't a PNG"
