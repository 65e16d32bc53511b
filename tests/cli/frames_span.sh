# Start and end of a run on frames, for every kind of file; events of partial intervals; messages about clocks and values.
array() { ${PYTHON:-python3} - "$@" || fail "no array"; }
# Seven frames of 8x6 px at 3 Hz, each pixel brighter from one to the next: as bytes, and as the same in [0, 1].
array <<'PY'
import struct, zlib, os
def npy(dtype, shape, data):
    head = "{'descr': '%s', 'fortran_order': False, 'shape': %s, }" % (dtype, shape)
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", 118) + (head.ljust(117) + "\n").encode() + data
values = [[40 + 25 * k + (p * 7) % 20 for p in range(48)] for k in range(7)]
flat = [v for frame in values for v in frame]
open("bytes.npy", "wb").write(npy("|u1", (7, 6, 8), bytes(flat)))
open("unit.npy", "wb").write(npy("<f8", (7, 6, 8), struct.pack("<336d", *(v / 255 for v in flat))))
open("whole.npy", "wb").write(npy("<f4", (7, 6, 8), struct.pack("<336f", *flat)))
open("half.npy", "wb").write(npy("<f4", (7, 6, 8), struct.pack("<336f", *(v + 0.5 for v in flat))))
open("ten.npy", "wb").write(npy("<u2", (7, 6, 8), struct.pack("<336H", *(4 * v for v in flat))))
os.mkdir("pictures")
def chunk(name, body):
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
for k, frame in enumerate(values):
    rows = b"".join(b"\0" + bytes(frame[8 * y : 8 * y + 8]) for y in range(6))
    head = struct.pack(">IIBBBBB", 8, 6, 8, 0, 0, 0, 0)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    open(f"pictures/f{k}.png", "wb").write(png)
with open("video.y4m", "wb") as file:
    file.write(b"YUV4MPEG2 W8 H6 F3:1 Cmono XCOLORRANGE=FULL\n")
    for frame in values:
        file.write(b"FRAME\n" + bytes(frame))
open("epoch.txt", "w").write("".join(f"{1589163150 + k / 3:.6f}\n" for k in range(7)))
PY
for file in pictures bytes.npy unit.npy video.y4m; do
    rate='"frames_per_second": 3,'
    [ $file = video.y4m ] && rate=
    echo "{\"frames\": {$rate \"file\": \"$file\"}}" >run.json
    methods="tides esim v2e iebcs dvs-voltmeter"
    [ $file = pictures ] || methods=esim
    for method in $methods; do
        set_="--set method=$method --set v2e.shot_noise_rate_hz=0 --set v2e.leak_rate_hz=0 --set esim.contrast_threshold_pos=0.1"
        expect 0 tides simulate run.json -qo all.h5 --stats all.json $set_
        [ "$(value all.json simulated_s)" = 2 ] || fail "$file, $method: seven frames at 3 Hz last 2 s, not $(value all.json simulated_s)"
        [ -f "$method.events" ] || value all.json events >"$method.events"
        [ "$(value all.json events)" = "$(cat "$method.events")" ] || fail "$file, $method: other events than of other files"
        expect 0 tides convert all.h5 all.txt
        # A microsecond less is a microsecond less; half an interval at each end is what the whole ones have there.
        expect 0 tides simulate run.json -qo most.h5 --stats most.json $set_ --set time.stop=1.999999
        less "$(awk '$1 < 1.999999' all.txt | wc -l)" "$(($(value most.json events) + 2))" "$file, $method: the last interval is lost"
        expect 0 tides simulate run.json -qo part.h5 $set_ --set time.start=0.5 --set time.stop=1.5
        expect 0 tides convert part.h5 part.txt
        expect 0 tides simulate run.json -qo all.h5 $set_ --set time.start=0.3333333333333333
        expect 0 tides convert all.h5 all.txt
        [ "$(wc -l <part.txt)" -gt 10 ] || fail "$file, $method: too few events to judge"
        awk '$1 < 1.5' part.txt >part.cut
        awk '$1 >= 0.5 && $1 < 1.5' all.txt | cmp -s - part.cut || fail "$file, $method: a part isn't that of the whole"
    done
done

# Clocks that count from 1970.
echo '{"frames": {"file": "bytes.npy", "timestamps": "epoch.txt"}, "method": "esim"}' >epoch.json
expect 0 tides simulate epoch.json -qo epoch.h5 --stats epoch_stats.json
less 1.99 "$(value epoch_stats.json simulated_s)" "frames of 2 s"
less "$(value epoch_stats.json simulated_s)" 2.01 "frames of 2 s"
refuse 1 "last from 1589163150 to 1589163152 s,.* frames.rebase to true" tides simulate epoch.json -o no.h5 --set time.stop=2
refuse 1 "time.start = 3 s is not before the last frame, at 2 s" tides simulate run.json -o no.h5 --set time.start=3
expect 0 tides simulate epoch.json -qo based.h5 --set frames.rebase=true --set time.stop=2

# Values whose full scale isn't told.
run() { echo "{\"frames\": {\"file\": \"$1\", \"frames_per_second\": 3}, \"method\": \"esim\"}" >run.json; }
run unit.npy
expect 0 tides simulate run.json -o unit.h5 --stats unit.json
! grep -q "full scale" err || fail "nothing is guessed here"
run whole.npy
expect 0 tides simulate run.json -o whole.h5 --stats whole.json
[ "$(grep -c "full scale is taken to be 255" err)" = 1 ] || fail "it should be said once"
[ "$(value unit.json events)" = "$(value whole.json events)" ] || fail "floats of 0 to 255 are bytes"
run half.npy
refuse 1 "floats go up to 2.*frames.full_scale" tides simulate run.json -o no.h5
expect 0 tides simulate run.json -qo half.h5 --set frames.full_scale=255
run ten.npy
refuse 1 "integers go up to .* of 65535.*frames.full_scale" tides simulate run.json -o no.h5
expect 0 tides simulate run.json -qo ten.h5 --set frames.full_scale=1020 --stats ten.json
[ "$(value unit.json events)" = "$(value ten.json events)" ] || fail "ten bits of 1020 are bytes of 255"
missing no.h5

# An array alone has no times: what gives them is named, and does.
refuse 1 "bytes.npy: its frames have no times: .*frames.frames_per_second" tides simulate bytes.npy -o no.h5
refuse 1 "bytes.npy: its frames have no times: .*frames.frames_per_second" tides simulate --set frames.file=bytes.npy -o no.h5
refuse 1 "pictures: its frames have no times: .*frames.frames_per_second" tides simulate --set frames.file=pictures -o no.h5
expect 0 tides simulate bytes.npy -qo alone.h5 --set frames.frames_per_second=3
expect 0 tides simulate pictures -qo alone.h5 --set frames.frames_per_second=3
expect 0 tides simulate --set frames.file=bytes.npy -qo alone.h5 --set frames.frames_per_second=3

# A file whose frames have another name: those that there are are named.
expect 0 tides scene plane -qo names.h5 --gaussians 50 --size 16x12
refuse 1 "names.h5: has no dataset Y, frames, images or voxels, but .*: call the frames so" \
    tides simulate --set frames.file=names.h5 -o e.h5
