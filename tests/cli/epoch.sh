# Runs from a TUM path at epoch times: every length works, events equal those of the same run near 0, --resume works, and so
# does every command on its files.
make_scene
epoch=1305031102
path() { # path ZERO FILE
    awk -v zero="$1" 'BEGIN {
        print "# timestamp tx ty tz qx qy qz qw"
        for (i = 0; i < 64; i++) printf "%d.%06d %g 0 0 0 0 0 1\n", zero, i * 15625, 0.4 * sin(i * 0.3)
    }' >"$2"
}
path $epoch late.txt
path 0 early.txt
small="--set sensor.threshold_on=0.05 --set sensor.threshold_off=0.05"

# Multiples of 2^-6 s, which are exact at both places.
late="--set camera.file=late.txt --set time.start=$epoch.25 --set time.stop=$epoch.5"
early="--set camera.file=early.txt --set time.start=0.25 --set time.stop=0.5"
for mode in "--set stepping.mode=fixed --set stepping.step_s=0.001" "--set stepping.step_s=0.01"; do
    expect 0 tides simulate run.json -qo late.h5 $small $mode $late
    expect 0 tides simulate run.json -qo early.h5 $small $mode $early
    expect 0 tides convert late.h5 late.csv-ns --to csv-ns -q
    expect 0 tides convert early.h5 early.csv-ns --to csv-ns -q
    [ "$(wc -l <early.csv-ns)" -gt 1000 ] || fail "there should be events"
    awk -F, -v zero=$epoch 'NR == 1 { print; next } { ns = sprintf("%09d", $1); n = length(ns)
        printf "%d%s,%s,%s,%s\n", zero + (n > 9 ? substr(ns, 1, n - 9) : 0), substr(ns, n - 8), $2, $3, $4 }' \
        early.csv-ns >moved
    cmp -s moved late.csv-ns || fail "the events should be the same, later ($mode)"
done

# Any length ends: of 12 in 40 the last step had none.
for ms in 1 7 13 20 33 41 57 60 64 71 83 90 99; do
    expect 0 tides simulate run.json -qo some.h5 $late $small --set stepping.mode=fixed --set stepping.step_s=0.001 \
        --set time.stop=$(awk -v e=$epoch -v ms=$ms 'BEGIN { printf "%d.%03d", e, 250 + ms }')
done

# What a user sees of it.
expect 0 tides info late.txt
out "^start_s +$epoch\$"
out "^duration_s +0.984375\$"
expect 0 tides info late.h5
out "^first_s +$epoch\.2[0-9]{8}\$"
expect 0 tides info late.h5 --json
is_json
out "\"first_ns\":[[:space:]]*${epoch}2[0-9]{8},"
expect 0 tides view late.h5 -qo view.png --start $epoch.3 --stop $epoch.31
expect 0 tides view late.h5 -qo view.png --kind xyt
expect 0 tides metrics late.h5 late.h5 --only match --json
out '"matched":[[:space:]]*[1-9]'
out '"dt_max_us":[[:space:]]*0'
expect 0 tides export late.h5 -qo late.npy --window 0.01 --start $epoch.25 --stop $epoch.5
expect 0 tides export early.h5 -qo early.npy --window 0.01 --start 0.25 --stop 0.5
cmp -s late.npy early.npy || fail "the voxel grids should be the same"
expect 0 tides cut late.h5 part.h5 --start $epoch.300000001 --stop $epoch.31
expect 0 tides info part.h5
out "^first_s +$epoch\.30"
expect 0 tides convert late.h5 rebased.raw --rebase -q
exists rebased.raw
expect 0 tides render run.json --time $epoch.3 -o late.exr $late
exists late.exr
for method in esim v2e; do
    expect 0 tides simulate run.json -qo base.h5 $late --set method=$method --set frames_per_second=500
    expect 0 tides info base.h5
    out "^first_s +$epoch\."
done

# Formats that can't hold the run say so before it begins.
for file in e.raw e.dat e.es; do
    refuse 1 "$file: can't hold a run from $epoch.25 to $epoch.5 s: .*HDF5 \(.h5\)" tides simulate run.json -qo $file $late
    missing $file
    missing $file.part
done
printf '0 0 0 0 0 0 0 1\n5000 0.4 0 0 0 0 0 1\n' >long.txt
refuse 1 "e.h5: can't hold a run from 0 to 5000 s: .*several files" tides simulate run.json -qo e.h5 \
    --set camera.file=long.txt --set camera.time_unit=s --set time.stop=5000 # one step of 5000 s is taken for one of 5 ms
expect 0 tides simulate run.json -qo e.csv $late $small
exists e.csv

# Before time 0, in the format that has such times.
awk 'BEGIN { for (i = 0; i <= 64; i++) printf "%.6f %g 0 0 0 0 0 1\n", -5 + i / 64, 0.4 * sin(i * 0.3) }' >before.txt
before="--set camera.file=before.txt --set time.start=-4.75 --set time.stop=-4.5"
expect 0 tides simulate run.json -qo before.h5 $small --set stepping.step_s=0.01 $before
expect 0 tides convert before.h5 before.csv-ns --to csv-ns --rebase -q
expect 0 tides convert early.h5 early.csv-ns --to csv-ns --rebase -q
cmp -s before.csv-ns early.csv-ns || fail "the events should be the same, before 0"
refuse 1 "before.csv: .* has no times before 0" tides simulate run.json -qo before.csv $before

# Killed and resumed.
set -m
long="$late $small --set time.stop=$epoch.984375 --set stepping.step_s=0.0005 --set stepping.mode=fixed"
expect 0 tides simulate run.json -qo whole.h5 $long
signal_at_checkpoint KILL tides simulate run.json -qo cut.h5 --checkpoint 0.005 $long
exists cut.h5.checkpoint
missing cut.h5
expect 0 tides simulate run.json -qo cut.h5 --resume $long
for file in whole cut; do expect 0 tides convert $file.h5 $file.csv-ns --to csv-ns -q; done
cmp -s whole.csv-ns cut.csv-ns || fail "the resumed run should have the same events"
