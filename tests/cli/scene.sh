# Scenes that the tool makes: listed, made, described, and simulated from their run files.
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

# Tags of how a scene is drawn: shown, gone by, kept, and said where they are lost.
make_scene
sed 's/^format ascii 1.0/&\ncomment SplatRenderMode: mip\ncomment Vertical axis: 0 0 1/' scene.ply >tagged.ply
expect 0 tides info tagged.ply
out "^trained +antialiased"
out "^up +0  0  1"
for antialias in file true false; do
    expect 0 tides simulate run.json -qo tag.h5 --stats $antialias.json --set scene.file=tagged.ply --set image.antialias=$antialias
done
expect 0 tides simulate run.json -qo tag.h5 --stats plain.json
[ "$(value file.json events)" = "$(value true.json events)" ] || fail "the file's tag isn't gone by"
[ "$(value file.json events)" != "$(value false.json events)" ] || fail "the key is stronger than the tag"
[ "$(value plain.json events)" = "$(value false.json events)" ] || fail "a scene without a tag is drawn plainly"
expect 0 tides convert tagged.ply tagged.spz
err "a .spz has no place for where up is"
expect 0 tides info tagged.spz
out "^trained +antialiased"
expect 0 tides convert tagged.ply tagged.glb
err "a .glb has no place for how the scene was trained: image.antialias must say it"
# What colours are of light: shown, gone by, kept, and said where it is lost; what says nothing is sRGB.
sed 's/^format ascii 1.0/&\ncomment ColourTransfer: linear/' scene.ply >light.ply
expect 0 tides info light.ply
out "^colour_transfer +linear"
expect 0 tides info scene.ply
out "^colour_transfer +srgb"
for transfer in file linear srgb; do
    expect 0 tides simulate run.json -vo light.h5 --stats $transfer.json --set scene.file=light.ply --set image.transfer=$transfer
done
err "colours are sRGB and decoded to light, as image.transfer says"
[ "$(value file.json events)" = "$(value linear.json events)" ] || fail "the file's transfer isn't gone by"
[ "$(value plain.json events)" = "$(value srgb.json events)" ] || fail "a scene without a transfer is sRGB"
[ "$(value linear.json events)" != "$(value srgb.json events)" ] || fail "sRGB should be decoded"
expect 0 tides convert light.ply light.glb
expect 0 tides convert light.glb again.ply
expect 0 tides info again.ply
out "^colour_transfer +linear"
expect 0 tides convert light.ply light.splat
err "a .splat has no place for colours that aren't srgb: image.transfer must say it"
refuse 1 "'again' are linear, those of 'tagged' srgb.*image.transfer" tides simulate run.json -o no.h5 \
    --set scene.file=again.ply --set 'scene.objects=[{"file": "tagged.ply"}]'
sed 's/scale_2/flat/; s/^format ascii 1.0/&\ncomment SplatRenderMode: 2dgs/' scene.ply >discs.ply
refuse 1 "discs.ply: holds discs, 2-D Gaussians as 2DGS.*train the scene with 3-D Gaussians" tides info discs.ply

# Broken Gaussians: refused with the way on, or left out, counted and said.
awk 'past && ++n == 5 { $1 = "nan" } past && n == 9 { $7 = "inf" } /end_header/ { past = 1 } { print }' scene.ply >broken.ply
refuse 1 "broken.ply: .*Gaussian 4: mean\[0\] is nan.*scene.invalid = drop" tides simulate run.json -o no.h5 --set scene.file=broken.ply
expect 0 tides simulate run.json -o drop.h5 --stats drop.json --set scene.file=broken.ply --set scene.invalid=drop
err "broken.ply: 2 of 108 Gaussians are left out \(scene.invalid = drop\), such as this: Gaussian 4: mean\[0\] is nan"
[ "$(value drop.json gaussians_dropped)" = 2 ] || fail "two are dropped"
[ "$(value drop.json gaussians_total)" = 106 ] || fail "106 are left"
refuse 1 "broken.ply: .*scene.invalid = drop" tides convert broken.ply whole.ply
expect 0 tides convert --drop-invalid broken.ply whole.ply
err "2 of 108 Gaussians are left out"
expect 0 tides info whole.ply
out "^gaussians +106"

# A part of a file that holds several.
expect 0 tides scene balls -n 3 --gaussians 20 -q -o three.h5
expect 0 tides convert --part 1 three.h5 one.h5
expect 0 tides info one.h5 --json
[ "$(grep -c '"sh_degree"' out)" = 2 ] || fail "one object is left" # the scene's, and its
refuse 1 "scene.part = \"7\" is none of its" tides convert --part 7 three.h5 no.h5

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
