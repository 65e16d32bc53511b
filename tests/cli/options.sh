# All ways to write an option mean the same.
make_scene
expect 0 tides simulate run.json -o a.h5 -q --seed 3 --set sensor.threshold_on=0.15
silent
expect 0 tides simulate -qoa2.h5 --seed=3 --set=sensor.threshold_on=0.15 run.json
silent
expect 0 tides simulate -q --output=a3.h5 --set seed=3 --set sensor.threshold_on=0.15 -- run.json
silent
expect 0 tides info a.h5 --json
cp out first
for file in a2 a3; do
    expect 0 tides info --json $file.h5
    sed "s/$file/a/" out | cmp -s first - || fail "$file.h5 differs"
done
# Later --set wins.
expect 0 tides simulate run.json -qo b.h5 --stats b.json --set seed=4 --set seed=5
grep -q '"seed":[[:space:]]*"5"' b.json || fail "the last --set should win"
