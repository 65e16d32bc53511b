# A scene made of objects only, one of them moving; a motion that is too short is named.
make_scene
printf '0 0 0 0 0 0 0 1\n0.04 0.3 0 0 0 0 0 1\n' >motion.txt
printf '0 0 0 0 0 0 0 1\n' >still.txt
objects='scene.objects=[{"file": "scene.ply", "trajectory": "motion.txt", "scale": 0.9}]'
expect 0 tides simulate run.json -o e.h5 --json --set camera.file=still.txt --set scene.file=null --set "$objects"
[ "$(value out events)" -gt 100 ] || fail "a moving object under a camera at rest should fire"
printf '0 0 0 0 0 0 0 1\n0.03 0.3 0 0 0 0 0 1\n' >motion.txt
refuse 1 "scene.objects\[0\].trajectory: .*motion.txt covers \[0, 0.03\] s" tides simulate run.json -o e.h5 --set "$objects"
refuse 1 "scene.file is missing" tides simulate run.json -o e.h5 --set scene.file=null
