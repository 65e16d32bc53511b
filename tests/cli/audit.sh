# Promises of every command: --json prints JSON alone, --quiet prints nothing, progress bars appear on terminals only, and a
# misspelt word is answered with the nearest valid one.
make_scene
expect 0 tides simulate run.json -qo events.h5
expect 0 tides render run.json -qo frame.exr
printf '{"base": "run.json", "set": {"time.stop": 0.02}, "grid": {"seed": ["1", "2"]}}' >grid.json

# What each command does here; each % is a name of its own for what it writes.
cat >table <<'END'
init -o %
devices
presets
info events.h5
info frame.exr
info scene.ply
info path.txt
camera orbit --from 0,0,-3 -o %.json
scene plane --size 16x12 --gaussians 500 --run %.json -o %.ply
scene --list
render run.json -o %.exr --png %.png
frames run.json -o % --set exposure.exposure_s=0.002
imu run.json -o %.csv --set scene.metres_per_unit=1 --set imu.gravity=0
tracks run.json -o %.npz --set tracks.count=5
simulate run.json -o %.h5 --stats %.json --preview %.png
simulate run.json -o %.raw
batch grid.json -o %
convert events.h5 %.es
convert scene.ply %.h5
cut events.h5 %.h5 --stop 0.01
view events.h5 -o %.png --kind xyt
view events.h5 -o %.png --animate
export events.h5 -o %.npy
metrics events.h5 events.h5
END
number=0
while read -r line; do
    number=$((number + 1))
    expect 0 tides ${line//%/silent$number} --quiet
    silent
    expect 0 tides ${line//%/facts$number} --json
    is_json
    expect 0 tides ${line//%/both$number} --json --quiet
    is_json
    [ ! -s err ] || fail "--quiet leaves stderr alone"
    expect 0 tides ${line//%/plain$number}
    [ -s out ] || fail "it should say what it did"
    ! grep -q $'\r' err || fail "a bar where there is no terminal"
done <table

# Those that take OpenCL, and minutes, are asked the same in their own cases.
for command in $(tides --help | sed -n 's/^  \([a-z]*\) .*/\1/p'); do
    grep -q "^$command\b" table && continue
    for option in json quiet; do
        grep -q "tides $command .*--$option" "$here/$command.sh" || fail "nothing tries tides $command --$option"
    done
done

# Long work: a line for each 10 %, with the time that is left and events per second; a bar on a terminal; nothing if quiet.
long="simulate run.json --set stepping.mode=fixed --set stepping.step_s=0.00002"
expect 0 tides $long -o long.h5
err '^tides: .*: [1-9]0 %, [0-9]+ s left, [0-9.]+( [kM])? events/s$'
[ "$(grep -c ' %' err)" -le 10 ] || fail "at most a line for each 10 %"
expect 0 tides $long -qo long.h5
silent
if command -v script >/dev/null; then
    expect 0 script -qefc "tides $long -o long.h5" /dev/null
    out '\[#+\.*\] +[0-9]+ %.* s left.*events/s'
    expect 0 script -qefc "tides $long -qo long.h5" /dev/null
    silent
fi

# Slips: the command line, and what its error suggests.
while IFS='|' read -r code line wanted; do
    refuse "$code" "$wanted" tides $line
done <<'END'
2|simlate run.json -o x.h5|did you mean simulate\?
2|help metric|did you mean metrics\?
2|help --man exprot|did you mean export\?
2|simulate run.json --ouptut x.h5|did you mean --output\?
1|simulate run.json -o x.h5 --set sensor.treshold_on=1|did you mean "sensor.threshold_on"\?
1|simulate run.json -o x.h5 --set image.rules=smoth|is none of smooth, .*; did you mean smooth\?
1|simulate run.json -o x.h5 --set stepping.mode=eror|did you mean error\?
1|simulate run.json -o x.h5 --set method=voltmeter|did you mean dvs-voltmeter\?
1|simulate run.json -o x.h5 --set sensor.preset=davs346|did you mean davis346\?
1|simulate run.json -o x.h5 --set sensor.preset=qqqqqqqq|is none of davis240, .* nor the path of a .json file$
1|simulate run.json -o x.h5 --device refrence|did you mean reference\?
1|simulate run.json -o x.hdf|did you mean .h5\?
1|convert events.h5 x.rw|did you mean .raw\?
1|convert events.h5 x.raw --to evt33|did you mean evt3\?
1|convert events.h5 x.raw --from hfd5|did you mean hdf5\?
1|scene crwd -o x.h5|did you mean 'crowd'\?
1|scene qqqq -o x.h5|must be fan, pendulum, balls
2|view events.h5 -o x.png --kind xty|did you mean xyt\?
2|view events.h5 -o x.png --kind qqqqq|should be frame, surface
2|export events.h5 -o x.npy --as voxle|did you mean voxel\?
2|export events.h5 -o x.npy --style desc|did you mean dsec\?
2|metrics events.h5 events.h5 --only isii|did you mean isi\?
2|metrics events.h5 events.h5 --only qqqqq|there are counts,isi,
2|bench acuracy|did you mean accuracy\?
2|bench accuracy --scene fann|did you mean fan\?
END
