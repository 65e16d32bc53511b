# Scenes converted there and back, and info on every kind of file.
make_scene
expect 0 tides info scene.ply
out "^kind +scene"
out "^gaussians +108"
expect 0 tides convert scene.ply scene.h5
out "scene.h5: 108 Gaussians"
expect 0 tides info scene.h5 --json
out '"gaussians":[[:space:]]*108'
expect 0 tides convert -q scene.h5 back.ply
silent
expect 0 tides convert -q back.ply again.ply
cmp -s back.ply again.ply || fail "writing what was read changes it"
expect 0 tides simulate run.json -q -o a.h5
expect 0 tides simulate run.json -q -o b.h5 --set scene.file=scene.h5
expect 0 tides info --json a.h5
value out events >a.count
expect 0 tides info --json b.h5
[ "$(value out events)" = "$(cat a.count)" ] || fail "the converted scene gives other events"
# A run file: what it reads.
expect 0 tides info run.json --json
out '"kind":[[:space:]]*"run"'
out '"path":[[:space:]]*"path.txt"'
echo '{"scene": {"file": "gone.ply"}, "camera": {"file": "path.txt"}}' >gone.json
expect 0 tides info gone.json --json
out '"missing":[[:space:]]*true'
# The same scene 4 194 304 further along x, camera and all: an origin, and the same events.
awk 'past { $1 = sprintf("%.6f", $1 + 4194304) } /end_header/ { past = 1 } { print }' scene.ply >far.ply
awk '{ $2 += 4194304; print $1, sprintf("%.6f", $2), $3, $4, $5, $6, $7, $8 }' path.txt >far.txt
expect 0 tides info far.ply --json
out '"origin":[[:space:]]*\[4194304, 0, 0\]'
out '"upper":[[:space:]]*\[419430[0-9.]+, 1.3999'
expect 0 tides convert -q far.ply far.h5
expect 0 tides convert -q far.h5 far_again.ply
for far in far.ply far.h5 far_again.ply; do
    expect 0 tides simulate run.json -q -o far_events.h5 --set scene.file=$far --set camera.file=far.txt
    expect 0 tides info --json far_events.h5
    [ "$(value out events)" = "$(cat a.count)" ] || fail "$far gives other events far away"
done
expect 0 tides info path.txt
out "^kind +path"
out "^format +tum"
out "^samples +3"
out "^stop_s +0.04"
# A packed splat file: two Gaussians of 32 bytes, colour 128, opacity 255, rotation (1 0 0 0).
splat='\0\0\200\077\0\0\0\100\0\0\100\100\0\0\200\077\0\0\200\077\0\0\200\077\200\200\200\377\377\200\200\200'
printf "$splat$splat" >two.splat
expect 0 tides info two.splat
out "^gaussians +2"
expect 0 tides convert two.splat two.ply
out "two.ply: 2 Gaussians"
expect 0 tides info two.ply --json
out '"upper":[[:space:]]*\[1, 2, 3\]'
printf "$splat\0" >odd.splat
refuse 1 "odd.splat.*32 bytes per Gaussian" tides convert odd.splat odd.ply
mkdir colmap
printf '1 OPENCV 640 480 500 500 320 240 0.1 0 0 0\n' >colmap/cameras.txt
printf '1 1 0 0 0 0 0 0 1 a.png\n\n2 1 0 0 0 1 0 0 1 b.png\n\n' >colmap/images.txt
expect 0 tides info colmap
out "^format +colmap"
out "^lens +radtan"
out "^k1 +0.1"
printf '1 FULL_OPENCV 640 480 500 500 320 240 0.1 0 0 0 0 0.2 0 0\n' >colmap/cameras.txt
expect 0 tides info colmap
out "^lens +unknown"
printf 'hello\n' >text
expect 1 tides info text
error_line "text"
printf '\211HDF\r\n\032\nrest' >broken.h5
refuse 1 "broken.h5" tides info broken.h5
printf 'ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nend_header\n' >lying.ply
refuse 1 "lying.ply" tides info lying.ply

# What people try: run files with a slip in them, arrays, pointers of Git LFS, glTF, streamed SOG.
printf '%s\n' '// a run' '{ "scene": { "file": "a.ply" }, "camera": { "fil": "p.txt" } }' >slip.json
refuse 1 "unknown key camera.fil|camera.fil.*camera.file" tides info slip.json
printf '{ "scene": { "file": "a.ply" }, "camera": { "file": "p.txt" }, "time": { "stop": -1 } }' >slip.json
refuse 1 "time.stop = -1 s is not after" tides info slip.json
printf "\223NUMPY\001\000\166\000{'descr': '<f4', 'fortran_order': False, 'shape': (5, 2, 3), }" >v.npy
printf '%*s\n' 57 '' >>v.npy
expect 0 tides info v.npy
out "kind +array"
out "shape +5, 2, 3"
printf 'version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 3\n' >lfs.ply
refuse 1 "lfs.ply: is a pointer of Git LFS" tides info lfs.ply
refuse 1 "lfs.ply: is a pointer of Git LFS" tides camera orbit --scene lfs.ply -o x.json
printf 'glTF\002\000\000\000' >a.glb
refuse 1 "a.glb: is a binary glTF that ends early" tides info a.glb
printf '{ "asset": { "version": "2.0", "generator": "Blender" }, "meshes": [{ "primitives": [{}] }] }' >mesh.gltf
for command in 'info mesh.gltf' 'render mesh.gltf -o x.png' 'simulate mesh.gltf -o x.h5' 'convert mesh.gltf x.ply'; do
    # shellcheck disable=SC2086 # several words
    refuse 1 "mesh.gltf: is a glTF without Gaussian splats: none of its 1 meshes \(by Blender\)" tides $command
done
printf '{ "lodLevels": 3, "filenames": [] }' >lod-meta.json
refuse 1 "lod-meta.json: is no streamed SOG's: it has no tree" tides info lod-meta.json
refuse 1 "lod-meta.json: is no streamed SOG's: it has no tree" tides render lod-meta.json -o x.png

# Scenes into the formats of viewers, and back.
make_scene
expect 0 tides convert scene.ply out.spz
out "out.spz: 108 Gaussians"
expect 0 tides convert scene.ply out.splat
[ ! -s err ] || fail "nothing is lost of a scene without SH"
expect 0 tides convert scene.ply out.glb
for made in out.spz out.splat out.glb; do
    expect 0 tides info $made
    out "^gaussians +108"
    expect 0 tides render run.json -qo $made.exr --set scene.file=$made
done
refuse 1 "x.foo: a scene is saved as .ply, .spz, .glb, .h5 or .splat" tides convert scene.ply x.foo
refuse 1 "lfs.ply: is a pointer of Git LFS" tides convert lfs.ply x.spz
