# A scene made only of objects, one of them moving. The error for a motion that is too short names the object.
make_scene
printf '0 0 0 0 0 0 0 1\n0.04 0.3 0 0 0 0 0 1\n' >motion.txt
printf '0 0 0 0 0 0 0 1\n' >still.txt
objects='scene.objects=[{"file": "scene.ply", "trajectory": "motion.txt", "scale": 0.9}]'
expect 0 tides simulate run.json -o e.h5 --json --set camera.file=still.txt --set scene.file=null --set "$objects"
[ "$(value out events)" -gt 100 ] || fail "a moving object under a camera at rest should fire"
printf '0 0 0 0 0 0 0 1\n0.03 0.3 0 0 0 0 0 1\n' >motion.txt
refuse 1 "scene.objects\[0\].trajectory: .*motion.txt covers \[0, 0.03\] s" tides simulate run.json -o e.h5 --set "$objects"

# Its trajectory's clock is told as the camera's is: the same events in milliseconds, on another clock, and without times.
expect 0 tides simulate run.json -qo e.h5 --set camera.file=still.txt --set scene.file=null --set time.stop=0.02 \
    --set 'scene.objects=[{"file": "scene.ply", "trajectory": "motion.txt", "scale": 0.9}]'
told() { # told ITEMS: these beside the trajectory clock.txt give the events of e.h5
    expect 0 tides simulate run.json -qo told.h5 --set camera.file=still.txt --set scene.file=null --set time.stop=0.02 \
        --set "scene.objects=[{\"file\": \"scene.ply\", \"trajectory\": \"clock.txt\", \"scale\": 0.9, $1}]"
    expect 0 tides metrics e.h5 told.h5 --only match --json
    out '"missing":[[:space:]]*0'
    out '"dt_max_us":[[:space:]]*0'
}
printf '0 0 0 0 0 0 0 1\n30 0.3 0 0 0 0 0 1\n' >clock.txt
told '"time_unit": "ms"'
printf '1700000000 0 0 0 0 0 0 1\n1700000000.03 0.3 0 0 0 0 0 1\n' >clock.txt
told '"start_s": 1700000000'
printf '1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.3 0 1 0 0 0 0 1 0\n' >clock.txt
told '"duration_s": 0.03'
refuse 1 "scene.file is missing" tides simulate run.json -o e.h5 --set scene.file=null
