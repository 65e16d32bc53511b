# A new run file: it has keys with their defaults and explanations, and runs unchanged.
make_scene
expect 0 tides init -o new.json --scene scene.ply --camera path.txt
out "new.json: tides simulate new.json"
keys=$(tides simulate --help | grep -cE '^  [a-z_0-9]+(\.[a-z_0-9]+)* \[')
[ "$(grep -c '": .* // ' new.json)" = "$keys" ] || fail "new.json doesn't hold $keys keys with a comment each"
all=$(tides simulate --help-all | grep -cE '^  [a-z_0-9]+(\.[a-z_0-9]+)* \[')
expect 0 tides init -qo all.json --all --scene scene.ply --camera path.txt
[ "$(grep -c '": .* // ' all.json)" = "$all" ] || fail "all.json doesn't hold $all keys with a comment each"
[ "$all" -gt "$keys" ] || fail "--all has no more keys"
grep -q '^    // "threshold_on": 0.2, // C+: rise of L that fires an ON event \[log units\]$' new.json || fail "a row is wrong"
grep -q '^    // "rules": "smooth", // .*: smooth|inria|gsplat$' new.json || fail "the choices are missing"
size="--set camera.width=48 --set camera.height=36 --set camera.fx=50 --set time.stop=0.04 --set stepping.step_s=0.002"
expect 0 tides simulate new.json -qo a.h5 $size
expect 0 tides simulate run.json -qo b.h5
expect 0 tides simulate all.json -qo a.h5 $size
cmp a.h5 b.h5 || fail "the template's defaults aren't the defaults"

# A preset acts on it, from the file and from --set; --set wins over both, and what a preset doesn't get to set is said.
sed 's|// "preset": null,|"preset": "dvs128",|' new.json >preset.json
expect 0 tides simulate preset.json -qo p.h5 $size
cmp -s a.h5 p.h5 && fail "a preset in a file of init does nothing"
expect 0 tides simulate new.json -o q.h5 $size --set sensor.preset=dvs128
grep -q "preset" err && fail "nothing is kept from the preset"
cmp p.h5 q.h5 || fail "p.h5 q.h5 differ"
sed 's|// "threshold_on": 0.2,|"threshold_on": 0.3,|' preset.json >own.json
expect 0 tides simulate own.json -o r.h5 $size
grep -q "preset dvs128: given otherwise, and so not set by it: sensor.threshold_on$" err || fail "not said what a preset didn't set"
cmp -s p.h5 r.h5 && fail "the file's own key doesn't win over the file's preset"
expect 0 tides simulate own.json -o s.h5 $size --set sensor.preset=dvs128
cmp p.h5 s.h5 || fail "p.h5 s.h5 differ"
expect 0 tides simulate own.json -qo s.h5 $size --set sensor.preset=dvs128 --set sensor.threshold_on=0.3
cmp r.h5 s.h5 || fail "r.h5 s.h5 differ"

refuse 1 "new.json: is there already; name another with -o, or replace it with --force" tides init -o new.json
expect 0 tides init -o new.json --force --scene 'a"b.ply' --json
grep -q '"file": "a\\"b.ply",' new.json || fail "a quote in a name"
grep -q '"file":[[:space:]]*"new.json"' out || fail "--json"
mkdir empty
cd empty
expect 0 tides init -q
silent
exists run.json
cd ..

# Comments: to the end of the line, not within texts, and errors keep their place.
printf '%s\n' '// first' '{ "scene": { "file": "http://x.ply" }, // "time": {' '  "camera": { "file": "path.txt" } } // last' >c.json
refuse 1 "http://x.ply" tides simulate c.json -o c.h5 $size
printf '%s\n' '{ // one' '  "time": / }' >c.json
refuse 1 "c.json:2:[0-9]+: not valid JSON" tides simulate c.json -o c.h5 $size
