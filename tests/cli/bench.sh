# Benchmarks write tables that agree with each other, and pictures; they refuse wrong options, and stop on request.
refuse 2 "no benchmark is called acuracy; did you mean accuracy\?" tides bench acuracy
refuse 2 "no benchmark is called speed; there are accuracy, ablation, blocks, calibrate, determinism, live, sensors, stability and all" \
    tides bench speed
refuse 2 "--row needle-1e6: there is no such row; did you mean needles-1e6\?" tides bench stability --row needle-1e6
refuse 2 "--row: blocks has no rows; --scene chooses a scene" tides bench blocks --row needles-1e6
refuse 2 "no benchmark is called throughput" tides bench throughput
refuse 2 "all takes neither --scene nor --row" tides bench all --scene fan
refuse 2 "--scene: stability has rows" tides bench stability --scene fan
refuse 2 "--row sovled: there is no such row; did you mean solved\?" tides bench determinism --row sovled
refuse 2 "too few arguments" tides bench
refuse 2 "--scene ocluder: neither a scene nor a file; did you mean occluder\?" tides bench accuracy --scene ocluder
touch taken
refuse 1 "taken: can't be made" tides bench accuracy -o taken
echo "not splats" >bad.ply
refuse 1 "bad.ply" tides bench accuracy -q -o bad --scene bad.ply

unset TIDES_DEVICE
expect 0 tides devices --json
grep -q '"index":[[:space:]]*[0-9]' out || skip "no OpenCL device here: the reference would take too long"

# This scene takes a seventh of the time that occluder does, and fires twice as often as nearly_static.
expect 0 tides bench accuracy --quick --scene handheld -o made --pictures svg
out "handheld +p95 <= 2 us +error "
out "handheld +p95 <= 2 us +esim "
out "median <= 0.05 us +error_global"
out "handheld +error_time +1e-05 s .* honest"
out "estimates: [1-9][0-9]* of [1-9][0-9]* runs that estimate"
out "mismatch: .* of the default at tolerance 0.1, at most 0.01 % asked: kept"
out "mismatch: .* of the cubic alone at tolerance 0.003, at most 0.01 % asked: kept"
out "pixels: S - S_ref reaches 0.99.* of a threshold at most: within"
out "exact stream, smooth: in ([0-9]+) of \1 runs halving its steps"
err "exact stream of the smooth image: [0-9]+ events"
for file in accuracy.json accuracy.csv accuracy_time.png accuracy_renders.png; do exists made/$file; done
ls made | grep -q part && fail "a .part is left"
for key in device version cores date run_time_s renders dt_median_us dt_p95_us dt_p99_us mismatch_percent events halved_p99_us \
    honest exact_share verdict worst_residual; do
    grep -q "\"$key\":" made/accuracy.json || fail "accuracy.json lacks $key"
done
# Its legend has each method once, in a colour of its own, and no letter stands outside of the picture.
${PYTHON:-python3} - made/accuracy_time.svg $(cut -d, -f2 made/accuracy.csv | sed 1d | sort -u | wc -l) <<'PY' || fail "the legend is wrong"
import re, sys, xml.dom.minidom
xml.dom.minidom.parse(sys.argv[1])
picture, methods = open(sys.argv[1]).read(), int(sys.argv[2])
width, height = map(float, re.search(r'width="(\d+)px" height="(\d+)px"', picture).groups())
entries = re.findall(r'stroke-width:2.4;[^"]*stroke:(rgb\([^)]*\))[^"]*" d="M ([\d.]+) ([\d.]+) L ([\d.]+) ([\d.]+) "', picture)
legend = [(colour, float(y)) for colour, x, y, end, level in entries if y == level and float(end) - float(x) == 36]
letters = [(float(x), float(y)) for x, y in re.findall(r'<use xlink:href="#glyph[^"]*" x="([\d.]+)" y="([\d.]+)"', picture)]
assert len(legend) == len({colour for colour, _ in legend}) == len({y for _, y in legend}) == methods, (methods, legend)
assert len(letters) > 100 and all(0 < x < width - 6 and 0 < y < height for x, y in letters)
PY
# As many results in both tables; every method is there, on its image.
[ "$(grep -c '"method":' made/accuracy.json)" = $(($(wc -l <made/accuracy.csv) - 1)) ] || fail "JSON and CSV differ in length"
for method in esim quadratic hermite error solved blocks error_time error_global risk; do
    grep -q "^handheld,$method,.*,smooth," made/accuracy.csv || fail "no $method"
done
grep -q "^handheld,esim_inria,.*,inria," made/accuracy.csv || fail "no esim on the inria image"
# What must be true whatever the machine: finer is better, the cubic beats the secant at equal steps, pixels end within their
# thresholds.
column() { awk -F, -v name="$1" -v method="$2" -v setting="$3" '
    NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } $2 == method && $3 == setting { print $at[name] }' made/accuracy.csv; }
less "$(column dt_p95_us esim 32000)" "$(column dt_p95_us esim 2000)" "p95 of 32000 against 2000 frames/s"
less "$(column dt_p95_us hermite 2000)" "$(column dt_p95_us esim 2000)" "p95 of the cubic against the secant"
less "$(column dt_p95_us error 0.003)" "$(column dt_p95_us error 0.1)" "p95 of tolerance 0.003 against 0.1"
less "$(column worst_residual error 0.003)" 1 "the residual"
less "$(column dt_p95_us solved 0.1)" "$(column dt_p95_us error 0.1)" "p95 of events looked up against the cubic alone"
less 0 "$(column points_looked_up solved 0.1)" "points"
[ "$(column points_looked_up error 0.1)" = 0 ] || fail "the cubic alone looks nothing up"

expect 0 tides bench ablation --quick --json --quiet --scene handheld -o made
is_json
[ ! -s err ] || fail "--quiet leaves stderr alone"
grep -q '"bench":[[:space:]]*"ablation"' out || fail "--json should print the results"
for file in ablation.json ablation.csv ablation.png; do exists made/$file; done
for variant in full risk_only risk_only_no_alpha_dot with_masking with_readout global_step solved blocks one_event fixed_step compute_matched \
    differenced_cubic quadratic differenced_quadratic linear differenced_linear straight_line; do
    grep -q "^handheld,$variant," made/ablation.csv || fail "no $variant"
done
# A slope is worth more than the difference of two renders.
column() { awk -F, -v name="$1" -v method="$2" '
    NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } $2 == method { print $at[name] }' made/ablation.csv; }
less "$(column dt_p95_us compute_matched)" "$(column dt_p95_us differenced_cubic)" "p95 with exact against differenced slopes"
# A readout only adds to what the solver is off.
less "$(column dt_p95_us full)" "$(column dt_p95_us with_readout)" "p95 without and with a readout"
less "$(column mismatch_percent full)" "$(column mismatch_percent with_readout)" "mismatches without and with a readout that drops"

expect 0 tides bench blocks --quick -o made
out "^fan +off +[0-9.e-]+ +[0-9.]+ "
err "fan +circuit +.* s  x [0-9.]+ \([0-9.]+ to [0-9.]+\)"
for file in blocks.json blocks.csv blocks.png; do exists made/$file; done
[ "$(grep -c '"block":' made/blocks.json)" = "$(grep -c "^fan," made/blocks.csv)" ] || fail "JSON and CSV differ in length"
for key in settings ratio ratio_low ratio_high ns_per_pixel_step pixel_steps_per_s events_per_s frames_per_s run_time_s processor_time_s; do
    grep -q "\"$key\":" made/blocks.json || fail "blocks.json lacks $key"
done
# Every preset that is installed has its row, and blocks act: those that can change how many events there are in so short a time do.
for preset in "$here"/../../share/presets/*.json; do
    grep -q "^fan,$(basename "$preset" .json),preset," made/blocks.csv || fail "no $(basename "$preset")"
done
cell() { awk -F, -v name="$1" -v block="$2" '
    NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } $2 == block { print $at[name] }' made/blocks.csv; }
[ "$(cell events "off again")" = "$(cell events off)" ] || fail "off differs from off"
for block in mismatch "refractory hold" "shot noise" "hot pixels" "PSF log" "PSF linear" low-pass "low-pass by light" \
    circuit centre-surround "additive noise" dvs128 v2e-noisy; do
    [ "$(cell events "$block")" != "$(cell events off)" ] || fail "$block changes nothing"
done
# Quartiles, since a busy machine may double a median of so few runs.
less "$(cell ratio_low mismatch)" "$(cell ratio_high circuit)" "what mismatch costs against the circuit"
for block in off mismatch circuit davis346; do
    awk -v rate="$(cell pixel_steps_per_s $block)" -v time="$(cell run_time_s $block)" -v steps="$(cell pixel_steps $block)" \
        'BEGIN { exit !(time > 0 && steps > 0 && rate * time / steps > 0.999 && rate * time / steps < 1.001) }' ||
        fail "the throughput of $block isn't its pixel steps over its time"
done

# The page has what is in the folder, pictures too.
for name in accuracy ablation blocks; do grep -q "<h2 id=\"$name\">" made/index.html || fail "the page lacks $name"; done
grep -q 'src="data:image/png;base64,iVBORw0KGgo' made/index.html || fail "the page has no picture"
grep -Eq '(src|href)="?(http|/|[a-z]+\.png)' made/index.html && fail "the page needs other files"
${PYTHON:-python3} - made/index.html made/blocks.png <<'END' || fail "the page's picture isn't the file's"
import base64, re, sys
page = open(sys.argv[1]).read()
pictures = [base64.b64decode(p, validate=True) for p in re.findall(r'base64,([^"]*)"', page)]
sys.exit(open(sys.argv[2], "rb").read() not in pictures)
END

# Rows that pass, one that must be refused, and one that fails: results are written, and the exit code says it.
expect 0 tides bench stability --row needles-1e6 --row start-1e9 --row giants-1e18 -o made
out "^3 rows: 3 pass \(1 of them refused with the message that they must have\), 0 fail"
err "\[1/3\] pass  needles-1e6 .* us 0 +%"
err "\[3/3\] pass  giants-1e18 .*make it smaller"
for file in stability.json stability.csv stability.png; do exists made/$file; done
[ "$(grep -c '"row":' made/stability.json)" = $(($(wc -l <made/stability.csv) - 1)) ] || fail "JSON and CSV differ in length"
for key in verdict why same_bits L_error L_bound L_dot_error dt_p95_us mismatch_percent times_benign peak_memory_mb bounds; do
    grep -q "\"$key\":" made/stability.json || fail "stability.json lacks $key"
done
cell() { awk -F, -v name="$1" -v row="$2" '
    NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } $1 == row { print $at[name] }' made/stability.csv; }
[ "$(cell same_bits needles-1e6)" = 1 ] || fail "the device hasn't the float reference's bits"
less 0 "$(cell L_error needles-1e6)" "no error against the double reference"
less 10000 "$(cell events needles-1e6)" "the events of needles"
# A million splats in a second of processor time: none has them.
hurried() { (ulimit -t 1 && exec "$@"); }
expect 1 hurried tides bench stability --quiet --row gaussians-1e6 -o made
err "1 rows fail; made/stability.json says why"
grep -q "^gaussians-1e6,.*,FAIL,died of signal" made/stability.csv || fail "a row that fails should say so"
# A driver or an allocator may also exit: the row says with which code.
echo 'void _exit(int); int tides_simulator_create(void) { _exit(3); }' >exits.c
if ${CC:-cc} -shared -fPIC -o exits.so exits.c 2>compiled; then
    preloaded() { (LD_PRELOAD=$PWD/exits.so ASAN_OPTIONS=${ASAN_OPTIONS:-}:verify_asan_link_order=0 exec "$@"); }
    expect 1 preloaded tides bench stability --quiet --row needles-1e6 -o made
    grep -q "^needles-1e6,.*,FAIL,.*exited with code 3, without a result" made/stability.csv || fail "a row should name its exit"
fi

# One hash for each run, whatever the way; and it is that of the events of `tides simulate`.
expect 0 tides bench determinism --quick --row solved -o made
grep -Eqx '[0-9a-f]{64}  solved' out || fail "one hash for the run"
[ "$(grep -c "^solved,.*,same," made/determinism.csv)" = 8 ] || fail "eight ways, all the same"
grep -q "^solved,killed,.*,same,.*,[1-9],[0-9.]*$" made/determinism.csv || fail "nothing was killed"
ls made | grep -Eq '\.cut|checkpoint|part$' && fail "files of the ways are left"
if "${PYTHON:-/usr/bin/python3}" -c 'import h5py' 2>/dev/null; then
    settings=$(sed -n 's/^.*"settings":[[:space:]]*"\(.*\)",*$/\1/p' made/determinism.json | sed 's/[^ ][^ ]*/--set &/g')
    # shellcheck disable=SC2086
    expect 0 tides simulate made/run.json -qo made/e.h5 --device cpu $settings
    made=$("${PYTHON:-/usr/bin/python3}" - <<-'PY'
	import hashlib
	import h5py
	import numpy
	events = h5py.File("made/e.h5", "r")["events"]
	packed = numpy.zeros(len(events["x"]), "<i8, <u2, <u2, i1")
	for name, field in zip(("t_ns", "x", "y", "p"), packed.dtype.names):
	    packed[field] = events[name][:]
	packed["f3"] = numpy.where(events["p"][:] > 0, 1, -1)
	print(hashlib.sha256(packed.tobytes()).hexdigest())
	PY
    )
    grep -q "\"sha256\":.*\"$made\"" made/determinism.json || fail "the hash isn't that of the events"
fi

set -m # so that the job doesn't start with SIGINT ignored
tides bench accuracy --quick --scene fan -o stopped >out 2>err &
await grep -q "Gaussians" err
kill -INT $!
wait $!
[ $? = 1 ] || fail "the exit code should be 1"
tail -n 1 err | grep -q "stopped on request; nothing was written" || fail "it should say that it was stopped"
missing stopped/accuracy.json

# Live runs are told a pose every millisecond; every step has its latency.
expect 0 tides bench calibrate --quick -o made
less "$(value made/calibrate.json refused)" 0.5 "the first sensor, refused"
cat >python <<'END'
#!/bin/sh
[ "$1 $2 $3 $5 $6" = "-m tides.ros2_bench --json --packets 10" ] || exit 1
echo '[{"rate": 1e6, "packets": 10, "lost": 6, "events": 10000, "seconds": 0.02, "first_ms": 3, "ms": [1, 2, 3, 4]}]' >"$4"
END
chmod +x python
TIDES_PYTHON=./python expect 0 tides bench live --quick -o made
out "demo +tiles +10 "
out "^1000 kev/s +ros2 +4 +2 +4 +4 +4 +3 +0.5 +1000$"
grep -q "^1000 kev/s,ros2,4,.*,6$" made/live.csv || fail "live.csv lacks the feed's row"
for key in median_ms p99_ms worst_ms first_ms events_per_step; do
    grep -q "\"$key\":[[:space:]]*[0-9.]*[1-9]" made/live.json || fail "live.json lacks $key"
done
exists made/live.png
for python in "" false; do
    TIDES_PYTHON=$python expect 0 tides bench live --quick --scene random -o feedless
    err "the ROS 2 feed isn't in the table: .*pip install 'tides\[ros2\]'"
    out "^random +default +10 "
done

# What each sensor costs, against the ideal one in turns.
expect 0 tides bench sensors --quick -o made
out "^demo +davis346 "
for file in sensors.json sensors.csv sensors.png; do exists made/$file; done
[ "$(grep -c "^demo,.*,preset," made/sensors.csv)" = 14 ] || fail "sensors.csv should have 14 presets"
for key in run_time_ratio ratio ratio_low compare_s events; do
    grep -q "\"$key\":[[:space:]]*[0-9.]*[1-9]" made/sensors.json || fail "sensors.json lacks $key"
done
grep -q '<h2 id="sensors">' made/index.html || fail "the page lacks sensors"
