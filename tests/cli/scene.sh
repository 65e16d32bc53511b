# Scenes that the tool makes: listed, made, described, and simulated from the run file that comes with them.
expect 0 tides scene --list
for kind in fan pendulum balls plane crowd disc; do out "^  $kind +[a-z]"; done
expect 0 tides scene --list --json
out '"name":[[:space:]]*"crowd"'
expect 0 tides scene --help
out "^  crowd +"

expect 0 tides scene disc -o disc.h5 --run disc.json --gaussians 300 --size 48x36 --duration 0.02
out "disc.h5: .* Gaussians, 2 objects, 0.02 s"
exists disc-camera.json
expect 0 tides simulate disc.json -q -o disc-events.h5 --stats disc-stats.json
[ "$(value disc-stats.json events)" -gt 100 ] || fail "a turning disc fires more than that"
expect 0 tides scene disc -q -o again.h5 --gaussians 300 --size 48x36 --duration 0.02
silent
cmp -s disc.h5 again.h5 || fail "the same options give another file"
expect 0 tides scene disc -q -o other.h5 --gaussians 300 --size 48x36 --duration 0.02 --seed 7
cmp -s disc.h5 other.h5 && fail "the seed makes no difference"

# Run files name their scene from where they are.
mkdir sub
expect 0 tides scene disc -q -o disc.h5 --run sub/run.json --gaussians 100 --size 16x12 --duration 0.01
expect 0 tides simulate sub/run.json -q -o sub-events.h5
expect 0 tides scene disc -q -o sub/disc.h5 --run sub/disc.json --gaussians 100 --size 16x12 --duration 0.01
grep -q '"disc.h5"' sub/disc.json || fail "a neighbour needs no folder"
expect 0 tides simulate sub/disc.json -q -o sub-events.h5
expect 0 tides scene disc -q -o sub/disc.h5 --run run.json --gaussians 100 --size 16x12 --duration 0.01
expect 0 tides simulate run.json -q -o run-events.h5

# Scenes with motions: what info says of them.
expect 0 tides scene crowd -n 30 --gaussians 24 -o crowd.h5
expect 0 tides info crowd.h5
out "^moving_percent +[1-9]"
out "^stop_s +0.5"
out "^swept_upper +"
out "motion polynomial .*own_stop 1 .*knots 0"
out "motion keyframes "
expect 0 tides info crowd.h5 --json
[ "$(value out gaussians_moving)" -gt 500 ] || fail "all things of a crowd move"

# At rest: any format.
expect 0 tides scene plane --gaussians 500 -o plane.ply
expect 0 tides info plane.ply
out "^gaussians_moving +0"
refuse 1 "balls.ply" tides scene balls --gaussians 50 -o balls.ply
missing balls.ply

refuse 2 "tides scene" tides scene
refuse 2 "-o SCENE" tides scene fan
refuse 2 "unknown option --cuont.*--count" tides scene balls -o a.h5 --cuont 3
refuse 2 "count 0" tides scene balls -o a.h5 --count 0
refuse 2 "seed -1" tides scene balls -o a.h5 --seed -1
refuse 2 "WIDTHxHEIGHT" tides scene balls -o a.h5 --size 640
refuse 2 "duration 0" tides scene balls -o a.h5 --duration 0
refuse 1 "'bals'.*'balls'" tides scene bals -o a.h5
refuse 1 "fan: count is 2" tides scene fan -o a.h5 --count 2
refuse 1 "none/a.h5" tides scene fan -o none/a.h5
missing a.h5
