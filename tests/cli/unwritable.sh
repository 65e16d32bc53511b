# Outputs that can't be written are reported at once, before any work.
make_scene
refuse 1 "none/e.h5" tides simulate run.json -o none/e.h5
refuse 1 "none/s.json: can't be written" tides simulate run.json -o e.h5 --stats none/s.json
refuse 1 "run.json/p.png: can't be written" tides simulate run.json -o e.h5 --preview run.json/p.png
missing e.h5
missing e.h5.part
refuse 1 "none/f.exr" tides render run.json -o none/f.exr
refuse 1 "none/out.h5" tides convert scene.ply none/out.h5
refuse 1 "out.xyz" tides convert scene.ply out.xyz
: >file
refuse 1 "file: can't be made" tides demo -o file
# A folder is refused before the work, links stay and what they lead to is written, a FIFO is written into or refused.
mkdir folder.h5 folder.json elsewhere
refuse 1 "folder.h5: is a folder" tides simulate run.json -o folder.h5
refuse 1 "folder.json: is a folder" tides simulate run.json -o e.h5 --stats folder.json
refuse 1 "folder.h5: is a folder" tides convert scene.ply folder.h5
missing e.h5
ln -s elsewhere/e.h5 link.h5
ln -s elsewhere/s.json link.json
ln -s elsewhere/p.png link.png
expect 0 tides simulate run.json -qo link.h5 --stats link.json --preview link.png
for name in h5 json png; do [ -L link.$name ] || fail "link.$name should stay a link"; done
exists elsewhere/e.h5
exists elsewhere/s.json
exists elsewhere/p.png
mkfifo fifo.h5 fifo.json fifo.csv fifo.exr
refuse 1 "fifo.h5: is a device or FIFO" tides simulate run.json -o fifo.h5
refuse 1 "fifo.exr: is a device or FIFO" tides render run.json -o fifo.exr
cat fifo.json >s.json &
expect 0 tides simulate run.json -qo e.h5 --stats fifo.json
wait $!
[ "$(value s.json events)" = "$(value elsewhere/s.json events)" ] || fail "the FIFO's reader should get all of it"
cat fifo.csv >e.csv &
expect 0 tides convert e.h5 fifo.csv -q
wait $!
expect 0 tides convert e.h5 whole.csv -q
cmp -s e.csv whole.csv || fail "the FIFO's reader should get all of it"
for name in h5 json csv exr; do [ -p fifo.$name ] || fail "fifo.$name should stay a FIFO"; done
ls elsewhere ./*.part 2>/dev/null | grep -q '\.part' && fail "a .part is left"
[ -e /dev/full ] || exit 0
tides --help >/dev/full 2>err
[ $? = 1 ] || fail "a full stdout is a failure"
err "standard output"

# Two runs that are told to write one file: at least one of them does, the other says so in one line, and the file is whole.
for name in e.h5 e.raw; do
    expect 0 tides simulate run.json -qo "once.$name"
    rm -f "$name"
    tides simulate run.json -qo "$name" 2>first.err &
    first=$!
    tides simulate run.json -qo "$name" 2>second.err
    second=$?
    wait $first
    first=$?
    [ $first = 0 ] || [ $second = 0 ] || fail "$name: neither was written"
    for err in first.err second.err; do [ "$(wc -l <$err)" -le 1 ] || fail "$name: more than one line"; done
    cmp -s "$name" "once.$name" || fail "$name: two runs ruined each other"
    missing "$name.part"
done
