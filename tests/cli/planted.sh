# Links that another user has put in a shared folder where a command writes: nothing is written through them.
make_scene
intact() { [ "$(cat victim)" = ours ] || fail "$1 went through a link"; [ ! -e nowhere ] || fail "$1 made what a link leads to"; }
planted() { # PART COMMAND...: refused with one line that names the part
    local part=$1
    shift
    for target in victim nowhere; do
        ln -sfn $target "$part"
        refuse 1 "$part: is a link" "$@"
        intact "$*"
    done
    rm "$part"
    intact "$*"
}
echo ours >victim
planted e.h5.part tides simulate run.json -o e.h5
planted e.raw.part tides simulate run.json -o e.raw
planted s.json.part tides simulate run.json -o e.h5 --stats s.json
planted p.png.part tides simulate run.json -o e.h5 --preview p.png
missing e.h5
expect 0 tides simulate run.json -qo e.h5
planted o.exr.part tides render run.json -o o.exr
planted m.npy.part tides render run.json --rectify m.npy
planted p.json.part tides camera orbit -o p.json --from 1,0,0
planted b.h5.part tides scene disc -o b.h5 --gaussians 50
planted i.json.part tides init -o i.json
planted c.csv.part tides convert e.h5 c.csv
planted c.h5.part tides cut e.h5 c.h5 --start 0
planted v.png.part tides view e.h5 -o v.png
planted v.html.part tides view e.h5 -o v.html
planted v.y4m.part tides view e.h5 -o v.y4m
planted a.npy.part tides export e.h5 -o a.npy
planted t.npz.part tides tracks run.json -o t.npz
mkdir f && planted f/frame_000000.png.part tides frames run.json -o f

# Checkpoints, too; what was there stays.
cp e.h5 before.h5
planted e.h5.checkpoint.part tides simulate run.json -o e.h5 --keep-checkpoint
planted e.h5.checkpoint.part tides simulate run.json -o e.h5 --checkpoint 0.001
cmp e.h5 before.h5 || fail "a run that is refused should leave what was there"

# A folder is made by us, or not written.
ln -s nowhere d.part
refuse 1 "d.part: is there" tides dataset run.json -o d --layout ecd --set scene.metres_per_unit=1
intact dataset
mkdir -p out.d/one
ln -s ../../victim out.d/one/log.txt
echo '{ "base": "run.json", "runs": [ { "name": "one" } ] }' >batch.json
expect 1 tides batch batch.json -o out.d
intact log
