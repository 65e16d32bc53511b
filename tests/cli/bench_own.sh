# Benchmarks of the library itself (tests/bench/own): stages, the limit, growth of cost, measures that make the image
# continuous.
own_bench=$(dirname "$(realpath "$(command -v tides)")")/tests/bench/own_bench
[ -x "$own_bench" ] || skip "$own_bench isn't built: make tests"
own() { "$own_bench" "$@"; }
refuse 2 "no benchmark is called accuracy; there are image, scaling, throughput and all" own accuracy
refuse 2 "--row pixel: there is no such row; did you mean pixels\?" own scaling --row pixel
unset TIDES_DEVICE
expect 0 tides devices --json
grep -q '"index":[[:space:]]*[0-9]' out || skip "no OpenCL device here: the reference would take too long"

expect 0 own image --quick --scene handheld -o made
for image in smooth hard_cutoff hard_order inria; do
    out "^handheld +$image "
    grep -q "^handheld,error,.*,$image," made/image.csv || fail "no $image"
done
for key in jumps_per_pixel_s jump_sum_per_pixel_s largest_jump psnr_db largest_difference_x frame_time_s; do
    grep -q "\"$key\":" made/image.json || fail "image.json lacks $key"
done
# smooth jumps less than inria.
jumps() { awk -v image="$1" '/"image":/ { found = index($0, "\"" image "\"") } found && /jump_sum/ { print $2 + 0; exit }' made/image.json; }
less "$(jumps smooth)" "$(jumps inria)" "jumps of smooth against inria"

# Stages add up to frames; the limit makes inria's image, or says why there is none.
expect 0 own throughput --quick -o made
for maker in inria gsplat smooth "smooth Y"; do out "^random +96x72 +$maker +composite +[0-9.]+ +[0-9.]+% "; done
out "frame under smooth over inria +random 96x72 +[0-9.]+ at most 1.5 times"
for part in look_up composite compare; do out "^demo +96x72 +run +$part +[0-9.]+ +[0-9.]+% "; done
for sink in nothing HDF5; do out "comparator to sink +$sink +[0-9.]+ at least [0-9]+ million events/s"; done
out "^random +96x72 +RAW +sink +[0-9.]+ "
missing made/throughput_events.raw
out "^targets: [0-9]+ of [0-9]+ measured are reached"
for file in throughput.json throughput.csv throughput.png; do exists made/$file; done
[ "$(grep -c '"stage":' made/throughput.json)" = $(($(wc -l <made/throughput.csv) - 1)) ] || fail "JSON and CSV differ in length"
for key in maker share calls items_per_s pairs_per_s bytes_per_s limit_s over_limit over_inria over_without_rates target reached; do
    grep -q "\"$key\":" made/throughput.json || fail "throughput.json lacks $key"
done
# A stage and its frame are timed one after the other: other work on the machine slows one of them, but not three times.
adds_up() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { of = $at["scene"] "," $at["maker"] } $at["stage"] == "processor" { next }
        $at["stage"] == "frame" || $at["stage"] == "compare to sink" { whole[of] = $at["share"]; next } { parts[of] += $at["share"] }
        END { for (of in whole) if (parts[of] < 0.5 || parts[of] > 1.5) { print of, parts[of]; exit 1 } }' made/throughput.csv
}
for turn in 1 2 3; do
    adds_up && break
    [ "$turn" -lt 3 ] || fail "stages don't add up to their frames"
    expect 0 own throughput --quick -o made
done
if grep -q "no limit:" err; then
    grep -q "^random,.*,limit," made/throughput.csv && fail "there is no limit, and it has rows"
else
    grep -q "^random,96,72,2000,inria,composite,.*,[0-9.e-]*,[0-9.]*," made/throughput.csv || fail "no limit of composite"
    out "^random +96x72 +limit +lists "
fi
refuse 2 "--scene guiter: neither a scene nor a file; did you mean guitar\?" own throughput --scene guiter

# Points cost more where there is more to do; the page has what is in the folder, pictures too.
expect 0 own scaling --quick --row pixels --row layers --row coplanar --row "moving share" --row start -o made --pictures pdf
head -c 5 made/scaling.pdf | grep -q %PDF- || fail "scaling.pdf is no PDF"
out "exponent of cost +pixels +[0-9.e-]+ at most 1.05"
out "renders of a dense plane, over a quarter of it +12 and 3 splats a pixel +[0-9.]+ at most 1.5"
out "start to the first event, kernels cached +2 000 Gaussians +[0-9.]+ at most 0.3 s"
for file in scaling.json scaling.csv scaling.png index.html; do exists made/$file; done
for key in axis x unit exponent exponent_at_end processor_time_s host_time_s peak_memory_mb target reached; do
    grep -q "\"$key\":" made/scaling.json || fail "scaling.json lacks $key"
done
point() { awk -F, -v axis="$1" -v x="$2" 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i } $1 == axis && $2 == x { print $at["pairs_evaluated"] }' made/scaling.csv; }
less "$(point pixels 4800)" "$(point pixels 19200)" "pairs of few pixels against many"
less "$(point layers 1)" "$(point layers 4)" "pairs of one layer against four"
grep -q "^in view," made/scaling.csv && fail "it wasn't asked for"
for name in image throughput scaling; do grep -q "<h2 id=\"$name\">" made/index.html || fail "the page lacks $name"; done
