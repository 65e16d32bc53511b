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
# Ground truth: what is named and nothing else; depths in units, and in metres where those are known; a panel each.
expect 0 tides render run.json --time 0.02 -qo t.exr --truth flow,depth
expect 0 tides info t.exr
for channel in L flow_u flow_v depth depth_median; do out "name $channel "; done
grep -Eq "name (alpha|instance|normal_x|Z) " out && fail "these weren't asked for"
grep -aq "tides_depth_unit.*string.*units" t.exr || fail "the unit of depths isn't said"
expect 0 tides render run.json --time 0.02 -qo t.exr --png t.png --truth all --metres --set scene.metres_per_unit=0.5
expect 0 tides info t.exr
for channel in alpha instance normal_x normal_y normal_z; do out "name $channel "; done
grep -aq "tides_depth_unit.*string....\+m" t.exr || fail "depths should be in metres"
[ "$(head -c 24 t.png | tail -c 8 | head -c 4 | od -An -tu1 | awk '{print $3 * 256 + $4}')" -gt \
    "$(head -c 24 f.png | tail -c 8 | head -c 4 | od -An -tu1 | awk '{print $3 * 256 + $4}')" ] || fail "ground truth has no panels"
expect 0 tides render run.json --time 0.02 -qo d.exr --displacement-to 0.01
expect 0 tides info d.exr
for channel in displacement_u displacement_v displacement_visible; do out "name $channel "; done
grep -aq "tides_displacement_to_s" d.exr || fail "where things are displaced to isn't said"
refuse 1 "0.5" tides render run.json -o i.exr --displacement-to 0.5
refuse 1 "set scene.metres_per_unit" tides render run.json -o x.exr --truth depth --metres
# Time: the start where not given, and an error outside the path.
expect 0 tides render run.json -o h.exr --json
out '"time_s":[[:space:]]*0,'
refuse 1 "0.5" tides render run.json --time 0.5 -o i.exr
missing i.exr
# A file is what its name says, and a name that doesn't fit is refused before anything is rendered.
expect 0 tides render run.json -o "capital letters.EXR" --png capitals.PNG -q
exists "capital letters.EXR"
refuse 2 "-o x.jpg: should end in .exr.* or in .png" tides render run.json -o x.jpg
refuse 2 "--png x.exr: should end in .png.*-o" tides render run.json --png x.exr
refuse 2 "-o .exr: should end in .exr" tides render run.json -o .exr
for file in x.png x.exr .exr; do missing $file; done
[ "$(head -c 4 f.png | tail -c 3)" = PNG ] || fail "f.png isn't a PNG"
# A splat that single precision can't hold where it is seen: named, with pixel and time, and nothing is written.
sed 's/vertex 108/vertex 109/' scene.ply >giant.ply
echo "0 0 4 1 1 1 3 46 46 46 1 0 0 0" >>giant.ply
for device in reference reference-f32; do
    refuse 1 "pixel \(0, 0\) is nan at 0.01 s.*Gaussian 108 of object 0" \
        tides render run.json --time 0.01 -o giant.exr --set scene.file=giant.ply --device $device
    refuse 1 "pixel .* at 0 s.*Gaussian 108 of object 0" \
        tides simulate run.json -q -o giant.h5 --set scene.file=giant.ply --device $device
done
missing giant.exr
missing giant.h5
