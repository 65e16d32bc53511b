# Every method on one run: tables, picture, order, and what can go wrong.
make_scene
# A number of a method's row: of_method FILE METHOD KEY, the first after the method's name.
of_method() { awk -v m="\"$2\"" -v k="\"$3\":" '$1 == "\"method\":" { on = index($2, m) } on && $1 == k { sub(",", "", $2); print $2; exit }' "$1"; }

expect 0 tides compare run.json -o all --keep --set stepping.solve=off
out '^exact +[0-9]+ .* 0\.'
for told in "mismatch % .*reference events; lower is better" "ratio .*; 1 is best" "VP .*nothing is near; lower is better"; do
    out "^$told"
    grep -Eq "<td class=text>${told%% *}.*${told##*; }" all/index.html || fail "the page doesn't say what ${told%% *} means"
done
out '^dvs-voltmeter .* frames_per_second 1000$'
for file in compare.json compare.csv compare.png index.html exact.html esim.html exact.h5 tides.h5 esim.h5 esim-fixed.h5 v2e.h5 dvs-voltmeter.h5 iebcs.h5; do
    exists all/$file
done
for name in exact tides esim v2e; do grep -q "<tr><td class=text>$name</td>" all/index.html || fail "the page lacks $name"; done
grep -q 'src="data:image/png;base64,iVBORw0KGgo' all/index.html || fail "the page has no picture"
grep -q '<a href="esim.html">' all/index.html || fail "the page doesn't lead to the events"
head -c 4 all/compare.png | grep -q PNG || fail "compare.png is no PNG"
[ "$(wc -l <all/compare.csv)" = 7 ] || fail "a row for each of six methods"
awk 'NR == 1 { n = split($0, a, ",") } END { exit !(n > 60) }' all/compare.csv || fail "columns of every metric"
# What the mathematics says: the cubic under error control, straight lines between frames (in L, then in Y), and last those
# that don't place events between frames. The exact stream is settled a hundred times better than the best.
p95() { of_method all/compare.json "$1" dt_p95_us; }
less "$(p95 tides)" "$(p95 esim-fixed)" "tides, ESIM"
less "$(p95 esim-fixed)" "$(p95 dvs-voltmeter)" "ESIM, DVS-Voltmeter"
less "$(p95 dvs-voltmeter)" "$(p95 v2e)" "DVS-Voltmeter, v2e"
less "$(p95 dvs-voltmeter)" "$(p95 iebcs)" "DVS-Voltmeter, IEBCS"
less "$(p95 esim-fixed)" "$(p95 esim)" "ESIM at 41 renders, at its own few"
# Steps of 2 ms are all that this scene wants, and each is looked into once: as many renders as at 1000 frames per second.
[ "$(of_method all/compare.json tides renders)" -le "$(of_method all/compare.json esim-fixed renders)" ] || fail "more renders than ESIM"
out '^tides .* stepping.tolerance 0.01$'
less "$(value all/compare.json halved_p95_us)" "$(p95 tides)" "the exact stream"
[ "$(of_method all/compare.json tides mismatch_percent)" = 0 ] || fail "tides should have every event"
# The table is what tides metrics says of the kept files, but for their microseconds.
expect 0 tides metrics all/exact.h5 all/v2e.h5 --json --only match
less "$(awk -v a="$(value out dt_median_us)" -v b="$(of_method all/compare.json v2e dt_median_us)" \
    'BEGIN { d = a - b; print (d < 0 ? -d : d) }')" 0.001 "tides metrics, tides compare"

# Looked up, as by default, events are nearer yet.
expect 0 tides compare run.json -o looked --methods tides
out '^tides .* stepping.tolerance 0.1$'
less "$(of_method looked/compare.json tides dt_p95_us)" "$(p95 tides)" "events looked up, the cubic's"
[ "$(of_method looked/compare.json tides mismatch_percent)" = 0 ] || fail "tides should have every event looked up"

# A recording beside: twice as many rows, and its own values.
expect 0 tides compare run.json -o recorded --methods esim-fixed,tides --recording all/v2e.h5 --window 0.01 --theme dark --pictures svg
${PYTHON:-python3} -c 'import xml.dom.minidom as m; m.parse("recorded/compare.svg")' || fail "compare.svg isn't XML"
# What methods do differently is to be seen: ESIM's events stand off from the exact ones by lines in the colours of 10 us to 1 ms, and
# TIDES's stand on them, in that of less than 1 us.
${PYTHON:-python3} - recorded/compare.svg <<'PY' || fail "compare.svg shows no difference"
import re, sys
picture = open(sys.argv[1]).read()
def shade(colour): return "rgb(" + ",".join(f"{round(int(colour[i:i+2], 16) / 2.55, 1):g}" for i in (0, 2, 4)) + ")"
rounded = re.sub(r"([\d.]+)%", lambda share: f"{round(float(share[1]), 1):g}", picture)
lines = re.findall(r'stroke:(rgb\([^)]*\))[^"]*" d="M ([\d.]+) ([\d.]+) L ([\d.]+) ([\d.]+) "', rounded)
off = [1 for colour, x, y, end, level in lines if y == level and abs(float(end) - float(x)) > 4 and colour in (shade("f2b82e"), shade("ff8244"))]
on = rounded.count("fill:" + shade("4ea5e0"))
print(len(off), "lines,", on, "marks")
assert len(off) >= 20 and on >= 20
PY
out '^recording +[0-9]+'
[ "$(wc -l <recorded/compare.csv)" = 5 ] || fail "a row for each method and reference"
expect 0 tides compare run.json -o recorded --methods tides --recording all/exact.h5 --json
is_json
[ "$(value out chamfer_px)" != "" ] || fail "--json should have the table"
# The run's own settings in place of ideal pixels: v2e's low-pass and noise come back.
expect 0 tides compare run.json -o own --methods v2e --as-configured --quiet --set v2e.pos_thres=0.3
silent
grep -q '"v2e.neg_thres=0.2"' own/compare.json && fail "the run file's own thresholds should stay"
grep -q '"v2e.pos_thres":[[:space:]]0.3' own/compare.json || fail "v2e.pos_thres should be the run file's"

# Frames: straight lines between them are TIDES's own way and no truth. Its row has no score; ESIM goes the same way.
mkdir frames
for k in $(seq 0 8); do
    t=$(awk -v k="$k" 'BEGIN { printf "%.3f", k / 200 }')
    expect 0 tides render run.json --time "$t" -o frames/f$k.exr
    echo "$t" >>frames/timestamps.txt
done
echo '{ "frames": { "file": "frames" } }' >frames.json
expect 0 tides compare frames.json -o seen
out "TIDES's own way, no truth"
grep -q '"exact"' seen/compare.json && fail "on frames nothing is exact"
out '^tides +- '
${PYTHON:-python3} -c 'import json; r = json.load(open("seen/compare.json")); assert "lines" in r and not any("against_exact" in m for m in r["methods"] if m["method"] == "tides")' || fail "TIDES is held against itself"
less "$(of_method seen/compare.json esim dt_p95_us)" 0.01 "ESIM on frames"
grep -q esim-fixed seen/compare.csv && fail "on frames ESIM has one sampling only"

# A method that fails takes no other with it.
expect 1 tides compare run.json -o part --methods esim,v2e --as-configured --set v2e.cs_lambda_pixels=2
err '^tides: v2e failed: .*v2e.cs_tau_p_ms'
out '^v2e +failed: '
out '^esim +[0-9]+'
exists part/compare.png
[ "$(wc -l <part/compare.csv)" = 3 ] || fail "a failure has its row"

# A recording and its simulations over the same time, pixels, and without what no light makes: its floors, and which scores can be
# read. On frames nothing is exact beside a recording, and of a measured sensor neither.
expect 0 tides simulate run.json -o real.h5 --set sensor.threshold_sigma=0.02 --set seed=5
expect 0 tides compare run.json -o fair --methods tides,v2e --recording real.h5 --as-configured --start 0.01 --stop 0.03 --json \
    --set sensor.threshold_sigma=0.02
is_json
${PYTHON:-python3} - fair/compare.json <<'PY' || fail "the recording's table"
import json, sys
report = json.load(open(sys.argv[1]))
assert "exact" not in report and abs(report["compared"]["start_s"] - 0.01) < 1e-12 and abs(report["compared"]["stop_s"] - 0.03) < 1e-12
rows = {row["method"]: row["against_recording"]["comparison"] for row in report["methods"]}
floor = report["floors"]["seeds"]["comparison"]
# The recording is a simulation of another seed: TIDES is as near to it as two seeds are, and v2e isn't.
assert abs(rows["tides"]["victor_purpura_fraction"] - floor["victor_purpura_fraction"]) < 0.1
assert rows["v2e"]["victor_purpura_fraction"] > rows["tides"]["victor_purpura_fraction"]
assert 0 <= report["floors"]["pixels"]["comparison"]["rate_error_1ms"] < 1
assert any(text.startswith("v2e.pos_thres=") for text in report["methods"][1]["settings"])
PY
for file in fair/recording.png fair/compare.tex fair/index.html; do exists $file; done
[ -e fair/compare.png ] && fail "nothing was exact there"
grep -q 'begin{tabular}{lr' fair/compare.tex || fail "compare.tex is no table"
expect 0 tides compare frames.json -o on_frames --methods tides,esim --recording real.h5
out '^floor: seeds'
out '^compared +[-0-9.e]+ to 0.04'
! grep -q '"lines"\|"exact"' on_frames/compare.json || fail "straight lines beside a recording"
# Masked pixels are nowhere, and their events are counted.
echo '24 18' >mask.txt
expect 0 tides compare run.json -o masked --methods tides --recording real.h5 --as-configured --mask mask.txt
expect 0 tides compare run.json -o alike --methods tides --recording real.h5 --as-configured --tolerance 0.002 --all-events
[ "$(value alike/compare.json masked_events)" = 0 ] || fail "nothing was masked"
# Searched, a method is no further off than it was before.
expect 0 tides compare run.json -o before --methods esim-fixed --recording real.h5 --as-configured --set frames_per_second=200
expect 0 tides compare run.json -o searched --methods esim-fixed --recording real.h5 --as-configured --search 5 --set frames_per_second=200
out '^searched .* 5 runs'
[ "$(awk -v a="$(value searched/compare.json victor_purpura_fraction)" -v b="$(value before/compare.json victor_purpura_fraction)" 'BEGIN { print (a <= b) }')" = 1 ] ||
    fail "a search made it worse"
refuse 2 "are of a --recording" tides compare run.json --search 5
refuse 1 "isn't within the run's 0 to 0.04 s" tides compare run.json -o no --recording real.h5 --start 0.02 --stop 0.05
printf 'hot\n' >words.txt
refuse 1 "line 1 should be a pixel's x and y" tides compare run.json -o no --recording real.h5 --mask words.txt
refuse 1 "is 48x36 px and the run 64x36" tides compare run.json -q -o no --recording real.h5 --set camera.width=64

refuse 2 "no method is called esmi; did you mean esim\?" tides compare run.json --methods tides,esmi
refuse 2 "tides is there twice" tides compare run.json --methods tides,tides
refuse 2 "above 0" tides compare run.json --window 0
refuse 2 "--pictures png: should be svg or pdf" tides compare run.json --pictures png
printf 't,x,y,p\n500000,3,4,1\n500010,3,4,0\n' >late.csv
refuse 1 "has no events from 0 to 0.04 s, the run's time" tides compare run.json -o no --recording late.csv
printf 't,x,y,p\n500,3,4,1\n510,60,4,0\n' >wide.csv
refuse 1 "wide.csv: is 61x5 px and the run 48x36 px" tides compare run.json -o no --recording wide.csv
refuse 1 "nothing fires" tides compare run.json -q -o no --set sensor.threshold_on=50 --set sensor.threshold_off=50
{
    npy_header '2, 10, 2, 3'
    head -c 120 /dev/zero
} >voxels.npy
refuse 1 "method ldati: a voxel grid has lost the signal" tides compare frames.json -o no --set method=ldati \
    --set frames.file=voxels.npy
missing no/compare.json
