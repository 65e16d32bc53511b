# tides camera: paths by formula, placed by a scene or by hand.
expect 0 tides scene plane --size 173x130 -o room.ply
for kind in orbit dolly handheld look-at; do
    expect 0 tides camera $kind --scene room.ply -o $kind.json --size 64x48 --fov 50 --json
    is_json
    expect 0 tides info $kind.json
    expect 0 tides render room.ply -qo $kind.exr --set camera.orbit_s=null --set camera.file=$kind.json --time 0.5
done
number() { python3 -c "import json,sys; d=json.load(open('$1')); print($2)"; }
expect 0 tides camera orbit --from 0,-1,-3 --target 0,0,0 --up 0,-1,0 --turn 8 --start 1 --stop 3 --output turn.json
[ "$(number turn.json 'd["samples"][0]["t"], d["samples"][-1]["t"]')" = "1 3" ] || fail "--start and --stop"
[ "$(number turn.json 'all(abs(s["position"][1] + 1) < 1e-9 for s in d["samples"])')" = True ] || fail "its height isn't kept"
[ "$(number turn.json '[round(v, 6) + 0.0 for v in d["samples"][-1]["position"]]')" = "[3.0, -1.0, 0.0]" ] || fail "a quarter turn"
[ "$(number turn.json '[round(v, 6) + 0.0 for v in d["samples"][0]["position"]]')" = "[0.0, -1.0, -3.0]" ] || fail "its start"
expect 0 tides camera dolly --from 3,-1,0 --to 3,-2,0 -qo dolly2.json
[ "$(number dolly2.json 'd["samples"][-1]["position"]')" = "[3, -2, 0]" ] || fail "--to"
expect 0 tides camera handheld --from 0,0,-3 --shake 0.1 --sway 2 --frequency 3 -qo a.json
expect 0 tides camera handheld --from 0,0,-3 --shake 0.1 --sway 2 --frequency 3 --seed 7 -qo b.json
cmp -s a.json b.json && fail "--seed does nothing"

expect 0 tides camera look-at --from 0,0,-3 -qo away.json --target 0,0,-9 --size 64x48
expect 0 tides render room.ply -o away.png --set camera.orbit_s=null --set camera.file=away.json
err "nothing of the scene is in view at 0 s"
expect 0 tides simulate room.ply -o away.h5 --set camera.orbit_s=null --set camera.file=away.json --set time.stop=0.01
err "nothing of the scene was in view"
away="--set camera.orbit_s=null --set camera.file=away.json --set time.stop=0.01"
expect 0 tides simulate room.ply -o away.h5 $away --set method=esim --set frames_per_second=200
err "nothing of the scene was in view"
expect 0 tides frames room.ply -o away $away --set exposure.frames_per_second=200
err "nothing of the scene was in view"
expect 0 tides dataset room.ply -o away-set --layout blinkflow $away \
    --set 'rig.cameras=[{"name": "a"}, {"name": "b", "T_B_C": [[-1,0,0,0.1],[0,1,0,0],[0,0,-1,0],[0,0,0,1]]}]'
err "nothing of the scene was in view of 1 of 2 cameras"
expect 0 tides simulate room.ply -qo away.h5 $away
silent
refuse 2 "did you mean orbit" tides camera obrit --scene room.ply -o x.json
refuse 2 "from where" tides camera orbit -o x.json
refuse 2 "three numbers" tides camera orbit --from 1,2 -o x.json
refuse 2 "to where" tides camera dolly --from 1,2,3 -o x.json
refuse 2 "between 0 and 180" tides camera orbit --from 1,2,3 --fov 190 -o x.json
refuse 2 "after --start" tides camera orbit --from 1,2,3 --stop -1 -o x.json
refuse 2 "WIDTHxHEIGHT" tides camera orbit --from 1,2,3 --size 3 -o x.json
refuse 1 "can't be opened" tides camera orbit --scene gone.ply -o x.json
missing x.json
# Numbers as people write them, and times as they gave them.
expect 0 tides camera dolly --from 0.05,-1,0 --to 0.15,-2,0 --start 0.05 --stop 0.15 -qo short.json
grep -q '"t": 0.05, "position": \[0.05, -1, 0\]' short.json || fail "seventeen digits of 0.05"
refuse 1 "time 0.3 s lies outside the path, which covers 0.05 s to 0.15 s" tides render room.ply -qo x.png --set camera.orbit_s=null --set camera.file=short.json --time 0.3 --set camera.width=64 --set camera.height=48 --set camera.fx=50 --set time.start=0.06 --set time.stop=0.1
