# Errors about missing files name them.
make_scene
refuse 1 "none.json: can't be opened" tides simulate none.json -o e.h5
refuse 1 "none.json: can't be opened" tides render none.json -o f.exr
refuse 1 "none.ply.*open" tides simulate run.json -o e.h5 --set scene.file=none.ply
refuse 1 "none.txt.*open" tides simulate run.json -o e.h5 --set camera.file=none.txt
refuse 1 "none.h5: can't be opened" tides info none.h5
refuse 1 "none.ply.*open" tides convert none.ply out.h5
missing e.h5.part
: >empty
refuse 1 "empty: is empty" tides info empty
