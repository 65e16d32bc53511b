# No output takes the place of an input or of another output: refused before anything is opened, by whatever name; every command.
make_scene
cp run.json keep.json
expect 0 tides simulate run.json -qo e.h5
expect 0 tides simulate run.json -qo e.csv
mkdir here sums && cp e.h5 e.csv run.json scene.ply path.txt here/ && mkdir here/d && cp path.txt here/d/timestamps.txt
for name in e.png compare.json; do cp "$here/../../share/presets/ideal.json" here/$name; done
(cd here && sha256sum $(find . -type f) >../sums/all)
same() { (cd here && sha256sum --quiet -c ../sums/all && [ "$(find . -type f | wc -l)" = 8 ]) || fail "$* changed what was there"; }
refused() { # PATTERN COMMAND... in the folder `here`, which stays as it is
    local pattern=$1
    shift
    echo "\$ $*"
    (cd here && "$@" >../out 2>../err </dev/null) && fail "it should be refused"
    error_line "$pattern"
    same "$*"
}
read='is read, and would be replaced'

# The run file, and what it names.
refused "$read" tides simulate run.json -o x.h5 --stats run.json
refused "$read" tides simulate run.json -o x.h5 --stats ./run.json
refused "$read" tides simulate run.json -o path.txt
refused "$read" tides simulate run.json -o ../here/path.txt
refused "$read" tides simulate run.json -o x.h5 --stats "$PWD/here/run.json"
refused "$read" tides simulate scene.ply -o x.h5 --stats scene.ply
refused "$read" tides tracks run.json -o e.csv --set camera.file=e.csv
refused "$read" tides imu run.json -o path.txt
refused "$read" tides render run.json --png e.png --rectify m.npy --set sensor.preset=./e.png
refused "$read" tides compare run.json -o . --set sensor.preset=./compare.json
refused "$read" tides frames run.json -o d --set camera.file=d/timestamps.txt
refused "$read" tides dataset run.json -o d --layout ecd --set camera.file=d
mkdir d && echo '{ "base": "../here/run.json", "runs": [ { "name": "a" } ] }' >d/summary.json && cp d/summary.json d/before
refuse 1 "$read" tides batch d/summary.json -o d
cmp d/summary.json d/before || fail "the manifest changed"
mkdir -p d/a && cp run.json scene.ply path.txt e.h5 d/a/ && sed 's|../here|d/a|' d/before >batch.json
refuse 1 "is read, and lies in d/a, which the run writes" tides batch batch.json -o d
exists d/a/e.h5

# Event files, pictures, scenes.
refused "$read" tides export e.h5 -o e.h5
refused "$read" tides cut e.h5 e.h5 --start 0
refused "$read" tides convert e.h5 ./e.h5
refused "$read" tides convert e.csv e.csv
refused "$read" tides convert scene.ply scene.ply
refused "$read" tides camera orbit -o scene.ply --scene scene.ply
refused "$read" tides init -o run.json --camera run.json --force
ln here/e.h5 hard.h5; ln -s here/e.h5 soft.h5; ln -s soft.h5 softer.h5; ln -s here there
for name in hard soft softer there/e; do
    refuse 1 "$read" tides export here/e.h5 -o $name.h5
    refuse 1 "$read" tides convert $name.h5 here/e.h5
done
for name in v.png v.html v.y4m; do
    ln -s here/e.h5 $name
    refuse 1 "$read" tides view here/e.h5 -o $name
done
same links
cp e.h5 y.h5.part # what a stopped run left
refuse 1 "while it is written, in .part, y.h5.part $read" tides convert y.h5.part y.h5
cmp e.h5 y.h5.part || fail "the .part changed"
cp -r here folder
refuse 1 "the folder folder $read" tides convert folder folder/e.h5
cmp folder/e.h5 e.h5 || fail "a file of the folder changed"

# Two outputs of one name, there yet or not.
mkdir -p new && ln -s new link
twice='is written there, too'
refuse 1 "$twice" tides simulate run.json -o a.h5 --stats b.json --preview ./b.json
refuse 1 "$twice" tides simulate run.json -o new/a --stats link/a
refuse 1 "$twice" tides simulate run.json -o a.h5 --stats a.h5.part
refuse 1 "$twice" tides simulate run.json -o a --stats new/../a
refuse 1 "$twice" tides scene disc -o m.json --run m.json
refuse 1 "$twice" tides scene disc -o new/m-camera.json --run link/m.json
ln -s m.exr.part m.npy
refuse 1 "$twice" tides render run.json -o m.exr --rectify m.npy
missing a.h5; missing a; missing m.json; missing new/a

# Names that say another thing than what is written.
refuse 1 "isn't .h5 but .json" tides simulate run.json -o a.h5 --stats b.h5
refuse 1 "isn't .json but .png" tides simulate run.json -o a.h5 --preview b.json
refuse 1 "isn't .jpg but .png" tides simulate run.json -o a.h5 --preview b.jpg
refuse 1 "isn't .h5 but .json" tides init -o b.h5
refuse 1 "isn't .csv but .json" tides camera orbit -o b.csv --from 1,0,0
refuse 1 "isn't .ply but .json" tides scene disc -o b.h5 --run b.ply
missing a.h5; missing b.h5

# "-" is no file.
for command in "simulate run.json -o -" "simulate run.json -o a.h5 --stats -" "simulate run.json -o a.h5 --preview -" "init -o -" \
    "camera orbit --from 1,0,0 -o -" "convert e.h5 -" "cut e.h5 - --start 0" "frames run.json -o -" "dataset run.json -o - --layout tum" \
    "compare run.json -o -" "demo -o -" "export e.h5 -o -" "tracks run.json -o -" "imu run.json -o -" "scene disc -o -" "bench blocks -o -" "batch batch.json -o -"; do
    refuse 1 "standard output isn't" tides $command
    missing ./-
done

# What is meant still works: again over what an earlier run left, to devices, beside inputs.
expect 0 tides simulate run.json -qo e.h5 --stats s.json --preview p.png
expect 0 tides simulate run.json -qo e.h5 --stats s.json --preview p.png
expect 0 tides simulate run.json -qo e.h5 --stats /dev/null --preview /dev/null
expect 0 tides simulate run.json -qo e.h5 --stats stats
expect 0 tides convert e.h5 ./-.csv
cmp run.json keep.json || fail "the run file changed"
