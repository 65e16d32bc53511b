# Reading event files that don't tell it themselves: columns, units, streams, the zero, windows of another clock, invalid
# events. Each file has a form that other tools write; the truth is 400 events, 346 x 260 px, 0.02 s.
awk 'BEGIN { srand(5); t = 1000
    for (i = 0; i < 400; i++) { t += int(100 * rand()); printf "%d,%d,%d,%d\n", t, 346 * rand(), 260 * rand(), 2 * rand() } }' >t.csv
{ echo "t,x@346,y@260,on"; cat t.csv; } >truth.csv
sort truth.csv >sorted.csv
expect 0 tides convert -q truth.csv truth.h5
same() { # same NAME OPTION...: it holds the truth, and is read without an error
    expect 0 tides convert -q "$1" out.csv --width 346 --height 260 "${@:2}"
    sort out.csv | cmp -s - sorted.csv || fail "$1 holds other events"
}
columns() { awk -F, -v OFS="$1" '{ '"$2"' }' t.csv; }

columns , 'printf "%.6f,%d,%d,%d\n", $1 / 1e6, $2, $3, $4' >seconds.csv # 20 ms became 20 ns
columns , 'print $2, $3, $4, $1' >xypt.csv
columns , 'print $2, $3, $1, 2 * $4 - 1' >xytp.csv
columns ' ' 'print $1, $2, $3, $4' >us.txt
{ printf '"Timestamp [ns]","X","Y","Polarity"\r'; columns , 'printf "%d000,%d,%d,%d\r", $1, $2, $3, $4'; } >cr.csv
{ printf '\xef\xbb\xbfts;x;y;pol\r\n'; columns ';' 'printf "%d;%d;%d;%d\r\n", $1, $2, $3, $4'; } >bom.csv
{ echo "# made by a tool"; echo "#timestamp[us] x y polarity"; cat us.txt; } >hash.txt
columns , 'print NR - 1, $1, $2, $3, $4' >index.csv
for file in seconds.csv xypt.csv xytp.csv us.txt cr.csv bom.csv hash.txt index.csv t.csv; do same $file; done
expect 0 tides convert seconds.csv out.csv
err "seconds.csv: columns t x y p, told apart by their values; times taken as seconds, since they have decimals"
expect 0 tides info xytp.csv
out "^read_as +columns x y t p"

# What other tools call columns, and how they write polarities.
{ echo "# Format: time(us),x,y,polarity"; cat t.csv; } >jaer.csv
{ printf 'time_us\tx_px\ty_px\tpol\n'; columns '\t' 'print $1, $2, $3, $4'; } >px.tsv
{ echo "sec,x,y,is_on"; columns , 'printf "%.6f,%d,%d,%s\n", $1 / 1e6, $2, $3, $4 ? "ON" : "OFF"'; } >words.csv
{ echo "event_time_us,pixel_x,pixel_y,event_polarity"; cat t.csv; } >event.csv
for file in jaer.csv px.tsv words.csv event.csv; do same $file; done
columns , 'print 1000 * $1, $2, $3, $4' >ns.csv # a unit that is taken is said
expect 0 tides convert ns.csv x.csv
err "ns.csv: columns t x y p, .*; times taken as microseconds, being whole numbers: --unit"
same ns.csv --unit ns
{ echo "ts.secs,ts.nsecs,x,y,p"; columns , 'print 0, 1000 * $1, $2, $3, $4'; } >parts.csv
{ echo 400; cat us.txt; } >count.txt
columns ' ' 'print $1, $2, $3, $4, 0' >five.txt
columns ' ' 'print $1, $2, $3' >three.txt
{ echo "t;x;y;p"; columns ';' 'printf "0,%06d;%d;%d;%d\n", $1, $2, $3, $4'; } >comma.csv
refuse 1 "parts.csv: its header names more than one column t: write one" tides convert parts.csv x.csv
refuse 1 "count.txt: its first line has 1 numbers, the next 4" tides convert count.txt x.csv
refuse 1 "five.txt: has 5 columns and no header that names them: --columns" tides convert five.txt x.csv
refuse 1 "three.txt: has 3 columns and no header" tides convert three.txt x.csv
refuse 1 "comma.csv:2: the time is \"0,00" tides convert comma.csv x.csv
printf '<?xml version="1.0"?>\n<a/>\n' >cameras.xml
refuse 1 "cameras.xml: is an XML file" tides info cameras.xml
printf '%% date 2026\n%% evt 5.0\n%% end\n\0\0\0\0' >evt5.raw
refuse 1 "evt5.raw: is an EVT of a version that isn't read.*metavision_file_to_csv" tides convert evt5.raw x.csv
printf '#!AER-DAT3.1\r\n#Format: RAW\r\n' >three.aedat
refuse 1 "three.aedat: is an AEDAT 3 recording, not an event file: AEDAT 2 and 4 are read" tides convert three.aedat x.csv
gzip -c t.csv >t.csv.gz
refuse 1 "t.csv.gz: is gzip.*gunzip" tides convert t.csv.gz x.csv
printf '\xff\xfe{\0}\0' >wide.json # as PowerShell's > writes
refuse 1 "wide.json: is text in UTF-16, not a run file: save it as UTF-8" tides simulate wide.json -o x.h5
mkdir bag2
echo 'rosbag2_bagfile_information:' >bag2/metadata.yaml
refuse 1 "bag2: is the folder of a ROS 2 bag.*python -m tides.bag bag2 FOLDER" tides info bag2
refuse 1 "bag2: is the folder of a ROS 2 bag.*python -m tides.bag bag2 FOLDER" tides convert bag2 x.csv
echo '[{"img_name": "a"}]' >list.json # a list isn't a preset
refuse 1 "list.json" tides info list.json

{ echo t_us,x,y,p; columns , 'print $1 % 5000, $2, $3, $4'; } >again.csv
expect 0 tides convert again.csv x.csv
err "again.csv: times go back by 0.00[45][0-9]* s, as of a clock that begins again"
printf '#usda 1.0\n' >scene.usda
refuse 1 "scene.usda: is an OpenUSD scene.*python -m tides.usd scene.usda scene.h5" tides info scene.usda
refuse 1 "scene.usda: is an OpenUSD scene.*python -m tides.usd scene.usda scene.h5" tides simulate scene.usda -o x.h5
echo '{}' >a.lcc2
refuse 1 "a.lcc2: is no LCC2 scene: its totalLevels" tides info a.lcc2

# What nothing decides, somebody says.
columns , 'print 7919 * NR * NR % 1000003, $2, $3, $4' >shuffled.csv
columns , 'print 7919 * NR % 1000003, $2, $3, $4' >sawtooth.csv
refuse 1 "shuffled.csv: none of its columns ascends.*--columns" tides convert shuffled.csv x.h5
refuse 1 "sawtooth.csv: none of its columns ascends" tides convert sawtooth.csv x.h5
columns , 'printf "%d.5,%d,%d,%d\n", $1, $2, $3, $4' >halves.csv
columns , 'print $3, 5, $2, $4, $1' >odd.csv
same odd.csv --columns y,-,x,p,t
expect 0 tides convert -q halves.csv x.csv --unit us
sort x.csv | cmp -s - sorted.csv || fail "half a microsecond is floored"
expect 0 tides info odd.csv --columns y,-,x,p,t
out "^events +400"
refuse 1 "truth.h5: its columns have names" tides convert truth.h5 x.csv --columns t,x,y,p
expect 0 tides convert -q truth.h5 truth.raw
refuse 1 "truth.raw: is evt3, for which a unit" tides convert truth.raw x.csv --unit us
missing x.h5

# Events that can't be: counted, and said.
{ cat us.txt; echo "99999 1308 5 1"; echo "99999 5 5 4294967295"; } >invalid.txt
refuse 1 "invalid.txt:402: the polarity.*--drop-invalid" tides convert invalid.txt x.csv
same invalid.txt --drop-invalid
expect 0 tides convert invalid.txt x.csv --drop-invalid --width 346 --height 260
err "invalid.txt: 2 invalid events were left out"
expect 0 tides convert invalid.txt x.csv --drop-invalid --width 346 --height 260 --json
out '"invalid_dropped":[[:space:]]*2'

# A clock that counts from 1970: windows that miss it name its span, and end; --rebase brings them together.
columns ' ' 'printf "1589163150.%06d %d %d %d\n", $1, $2, $3, $4' >epoch.txt
expect 0 tides convert -q epoch.txt epoch.h5 --width 346 --height 260
span="epoch.h5: lasts from 1589163150.00[0-9]* to 1589163150.0[0-9]* s, .*--rebase"
refuse 1 "$span" tides view epoch.h5 -o h%04d.png --start 0.005 --window 0.003
refuse 1 "$span" tides view epoch.h5 -o h.png --time 0.005
refuse 1 "epoch.h5: lasts from 1589163150.00[0-9]* to 1589163150.0[1-9][0-9]* s" tides view epoch.h5 -o h.png --start 0.1 --stop 0.2
refuse 1 "$span" tides view epoch.h5 -o h.html --start 0.005 --stop 0.01
refuse 1 "$span" tides export epoch.h5 -o h.npy --start 0.005 --window 0.005
refuse 1 "$span" tides export epoch.h5 -o h.npy --start 0.005 --window 0.005 --stop 0.02
refuse 1 "$span" tides cut epoch.h5 h.h5 --start 0.005 --stop 0.02
refuse 1 "$span" tides cut epoch.h5 h.h5 --stop 0.02
refuse 1 "$span" tides metrics epoch.h5 epoch.h5 --from 0.005 --to 0.01
refuse 1 "there would be .* windows" tides export truth.h5 -o h.npy --start 0 --stop 1e9 --window 0.005
[ -z "$(ls h* 2>/dev/null | grep -v halves | grep -v hash)" ] || fail "nothing should be written: $(ls h*)"
expect 0 tides view epoch.h5 -o h%04d.png --start 0.005 --stop 0.011 --window 0.003 --rebase
err "epoch.h5: time 0 is 1589163150.00[0-9]* s of its clock, its first event"
exists h0001.png
missing h0002.png
expect 0 tides view epoch.h5 -qo h.html --start 0.005 --stop 0.01 --rebase
expect 0 tides export epoch.h5 -o h.npy --start 0.005 --window 0.005 --stop 0.015 --rebase --json
[ "$(value out windows)" = 2 ] || fail "two windows of 5 ms"
expect 0 tides cut epoch.h5 h.h5 --start 0.005 --stop 0.01 --rebase --json
[ "$(value out first_ns)" -ge 5000000 ] || fail "times count from the zero"
expect 0 tides cut epoch.h5 h2.h5 --start 0.006 --stop 0.011 --rebase --offset 0.001 --json
expect 0 tides metrics h.h5 h2.h5 --offset -0.001 --only match --json
out '"missing":[[:space:]]*0'
out '"dt_max_us":[[:space:]]*0'

# One zero for a recording: where the list of its frames lies beside the events, its first frame, as frames.rebase has it.
zero_of() { # zero_of FILE ZERO WHAT: --rebase counts from there
    expect 0 tides convert "$1" x.h5 --width 346 --height 260 --rebase
    err "time 0 is ${2}0* s of its clock, its first $3"
}
first=$(head -n 1 epoch.txt | cut -d ' ' -f 1)
mkdir -p ecd/images eds
cp epoch.txt ecd/events.txt
printf '1589163149.500000 images/frame_00000000.png\n1589163149.540000 images/frame_00000001.png\n' >ecd/images.txt
zero_of ecd/events.txt 1589163149.5 frame
columns , 'printf "1589163150%06d,%d,%d,%d\n", $1, $2, $3, $4' >eds/events.csv
for rows in '1589163149900000\n1589163149940000\n' '# frame timestamp[us]\n0 1589163149900000\n1 1589163149940000\n' \
    'index,name,timestamp\n7,a.png,1589163149900000\n8,b.png,1589163149940000\n'; do
    printf "$rows" >eds/images_timestamps.txt
    zero_of eds/events.csv 1589163149.9 frame
done
for rows in '# Image list\n1 1 0 0 0 0 0 0 1 a.png\n\n2 1 0 0 0 0 0 0 1 b.png\n' '0.5 a.png\n0.6 b.png\n' 'no times here\n'; do
    printf "$rows" >ecd/images.txt # COLMAP's, of another clock, of none
    zero_of ecd/events.txt "$first" event
done

# Two clocks that share nothing aren't compared, or are brought together.
refuse 1 "share no time.*--rebase" tides metrics truth.h5 epoch.h5
expect 0 tides metrics truth.h5 epoch.h5 --rebase --only match --json
out '"matched":[[:space:]]*400'

# A folder of two cameras.
mkdir -p seq/events/left seq/events/right
cp truth.h5 seq/events/left/events.h5
expect 0 tides cut truth.h5 seq/events/right/events.h5 --stop 0.01 -q
refuse 1 "seq: holds events in .*left and in .*right: .*--stream" tides info seq
same seq --stream left
