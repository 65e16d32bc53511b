# Noise of drawn runs: each has its own seed, equal whenever it is drawn again; a fixed seed only if one is written.
make_scene
printf '0 0 0 0 0 0 0 1\n0.2 0 0 0 0 0 0 1\n' >path.txt # at rest: all events are noise
noisy() {
    sed 's/"stop": 0.04/"stop": 0.2/; s/"stepping".*/"frontend": { "shot_noise_hz": 20, "hot_pixel_fraction": 0.01, "hot_pixel_rate_hz": 2000 } }/' \
        run.json >noisy.json
}
noisy
cat >draw.json <<-'JSON'
	{ "base": "noisy.json", "draw": { "count": 3, "seed": "7", "set": { "sensor.threshold_on": [0.2, 0.3] } } }
JSON
expect 0 tides batch draw.json -qo draw.d
seeds() { sed -n 's/.*"seed":[[:space:]]*"\([0-9]*\)".*/\1/p' "$1"/draw-0000?/result.json; }
[ "$(seeds draw.d | sort -u | wc -l)" = 3 ] || fail "three drawn runs should have three seeds: $(seeds draw.d)"
seeds draw.d >first.seeds

# Hot pixels: those with most events; with 1 % of 1728 pixels two runs share 0.2 of 17 by chance. Times: events of one pixel within
# 2 us in two runs; by chance, of some 700 shot events at 20 Hz, far below one.
for run in 0 1 2; do
    expect 0 tides convert draw.d/draw-0000$run/events.h5 $run.csv -q
    awk -F, '$1 + 0 == $1 { n[$2 "," $3]++ } END { for (p in n) if (n[p] > 100) print p }' $run.csv | sort >$run.hot
    awk -F, 'NR == FNR { hot[$1 "," $2]; next } $1 + 0 == $1 && !($2 "," $3 in hot) { print $2 "," $3 "," int($1 / 2) }' \
        $run.hot $run.csv | sort -u >$run.shot
    [ "$(wc -l <$run.hot)" -ge 5 ] && [ "$(wc -l <$run.shot)" -ge 1000 ] || fail "run $run has too little noise to tell"
done
for pair in "0 1" "0 2" "1 2"; do
    set -- $pair
    [ "$(comm -12 $1.hot $2.hot | wc -l)" -le 3 ] || fail "runs $pair have the same hot pixels"
    [ "$(comm -12 $1.shot $2.shot | wc -l)" -le 5 ] || fail "runs $pair have the same shot noise"
done

# Again, in another folder, with one run more: what there was is as it was, to the bit.
sed -i 's/"count": 3/"count": 4/' draw.json
expect 0 tides batch draw.json -qo again.d
seeds again.d | head -n 3 | cmp - first.seeds || fail "seeds changed"
expect 0 tides convert again.d/draw-00001/events.h5 again.csv -q
cmp 1.csv again.csv || fail "a drawn run should be the same when it is drawn again"

# What is finished isn't done again; another seed of the draw is another batch.
expect 0 tides batch draw.json -o draw.d
out "4 done \(3 of them before\)"
sed 's/"seed": "7"/"seed": "8"/' draw.json >eight.json
expect 0 tides batch eight.json -qo eight.d --only draw-00000
[ "$(seeds eight.d)" != "$(head -n 1 first.seeds)" ] || fail "the draw's seed should count"

# Written, it is fixed: in the run file, in what all runs set, in the draw.
fixed() {
    rm -rf fixed.d
    expect 0 tides batch fixed.json -qo fixed.d
    [ "$(seeds fixed.d | sort -u)" = "$1" ] || fail "the seed should be $1: $(seeds fixed.d)"
}
sed 's/"count": 4/"count": 2/' draw.json >fixed.json
sed -i 's/{ "scene"/{ "seed": "5", "scene"/' noisy.json
fixed 5
sed -i 's/"base"/"set": { "seed": "6" }, "base"/' fixed.json
fixed 6
sed -i 's/"set": { "seed": "6" }, //; s/"set": {/"set": { "seed": ["9"],/' fixed.json
fixed 9

# A command's options come last.
noisy
printf '{ "base": "noisy.json", "command": "render", "options": ["--set", "seed=3"], "draw": { "count": 1, "set": { "time.start": [0] } } }' >render.json
expect 0 tides batch render.json -qo render.d
exists render.d/draw-00000/render.exr

# A made scene's run file says no seed unless one was asked for.
expect 0 tides scene disc -qo disc.h5 --run disc.json --gaussians 100
! grep -q '"seed"' disc.json || fail "nobody asked for a seed"
expect 0 tides scene disc -qo disc.h5 --run disc.json --gaussians 100 --seed 4
grep -q '"seed":[[:space:]]*"4"' disc.json || fail "the seed should be written"
