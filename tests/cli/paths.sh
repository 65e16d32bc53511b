# Camera paths that can't serve: unsorted, doubled, too short, not a number.
make_scene
path() { printf "$2" >path.txt; refuse 1 "$1" tides simulate run.json -o e.h5; }
path "path.txt" '0 0 0 0 0 0 0 1\n0.04 0 0 0 0 0 0 1\n0.02 0 0 0 0 0 0 1\n'
path "path.txt" '0 0 0 0 0 0 0 1\n0.04 0 0 0 0 0 0 1\n0.04 0 0 0 0 0 0 1\n'
path "path.txt" '0 0 0 nan 0 0 0 1\n0.04 0 0 0 0 0 0 1\n'
path "path.txt" '0 0 0 0 0 0 0 0\n0.04 0 0 0 0 0 0 1\n'
path "camera.file.*path.txt covers \[0, 0.03\] s.*needs \[0, 0.04\] s" '0 0 0 0 0 0 0 1\n0.03 0 0 0 0 0 0 1\n'
path "camera.file.*covers \[5, 6\] s.*camera.rebase" '5 0 0 0 0 0 0 1\n6 0 0 0 0 0 0 1\n'
expect 0 tides simulate run.json -qo e.h5 --set camera.rebase=true
# The lens has to come from somewhere.
refuse 1 "camera.fx is missing" tides simulate run.json -o e.h5 --set camera.rebase=true --set camera.fx=null
