# Camera paths that aren't valid: unsorted, doubled, too short, not a number.
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

# Views of a path file: one for a picture, some for a run; and a path from nerfstudio's viewer.
printf '0 0 0 0 0 0 0 1\n0.02 0.1 0 0 0 0 0 1\n0.04 0.4 0 0 0 0 0 1\n' >path.txt
expect 0 tides render run.json -qo first.exr --set camera.views=0
expect 0 tides render run.json -qo last.exr --set camera.views=-1
cmp -s first.exr last.exr && fail "camera.views should choose the pose"
expect 0 tides simulate run.json -qo all.h5 --set camera.views=:
expect 0 tides simulate run.json -qo some.h5 --set camera.views=0,2
cmp -s all.h5 some.h5 && fail "camera.views should choose the poses"
refuse 1 "path.txt: views \"3\": isn't a choice of its 3 poses" tides simulate run.json -o x.h5 --set camera.views=3
pose='"camera_to_world": [1,0,0,%s, 0,-1,0,0, 0,0,-1,0, 0,0,0,1], "fov": 60'
printf '{"render_width": 48, "render_height": 36, "seconds": 1, "camera_path": [{'"$pose"'}, {'"$pose"'}]}' 0 0.5 >nerf.json
expect 0 tides info nerf.json
out "^format +camera_path"
expect 0 tides simulate run.json -o nerf.h5 --set camera.file=nerf.json --set camera.width=null --set camera.height=null --set camera.fx=null

# A lens that no lens of TIDES equals: each command that would ignore it fails, and names the key to set.
cat >bent.json <<-JSON
	{ "camera_model": "OPENCV", "w": 48, "h": 36, "fl_x": 50, "fl_y": 50, "cx": 24, "cy": 18, "k1": 0.1, "k2": 0, "k3": 0.3, "k4": 0.2, "p1": 0, "p2": 0,
	  "frames": [ { "file_path": "a", "transform_matrix": [[1,0,0,0],[0,1,0,0],[0,0,1,0],[0,0,0,1]] },
	              { "file_path": "b", "transform_matrix": [[1,0,0,0.1],[0,1,0,0],[0,0,1,0],[0,0,0,1]] } ] }
	JSON
bent="--set camera.file=bent.json --set camera.fx=null --set time.stop=0.02"
refuse 1 "the lens of .*bent.json is no lens of TIDES.*camera.lens: none" tides simulate run.json -o bent.h5 $bent
refuse 1 "no lens of TIDES" tides render run.json -o bent.exr $bent
refuse 1 "no lens of TIDES" tides frames run.json -o bent $bent
refuse 1 "no lens of TIDES" tides dataset run.json -o bent --layout ecd $bent
expect 0 tides render run.json -qo bent.exr $bent --set camera.lens=none

# What a run's reader may not expect of a path is said once, a line each, and in info: order, times, units, leaps.
{
	printf '{ "w": 48, "h": 36, "fl_x": 50, "frames": ['
	for k in 1 10 11 2 3 4 5 6 7 8 9; do
		printf '%s{ "file_path": "%s.png", "transform_matrix": [[1,0,0,0.0%02d],[0,1,0,0],[0,0,1,0],[0,0,0,1]] }' "${comma-}" $k $k
		comma=,
	done
	printf ']}'
} >order.json
expect 0 tides simulate run.json -o order.h5 --set camera.file=order.json --set camera.fx=null
err "order.json: .*in the order of their pictures' names"
err "its 11 poses are spread evenly over 1 s; camera.duration_s"
expect 0 tides simulate run.json -o order.h5 --set camera.file=order.json --set camera.fx=null --set camera.duration_s=1
grep -q camera.duration_s err && fail "a duration that is given needs no line"
expect 0 tides info order.json --json
out '"notes":.*names'
out '"times":.*camera.duration_s'
printf '# timestamp[us] px py pz qx qy qz qw\n' >us.txt
for k in 0 1 2 3 4 5 6 7 8; do printf '%d0000 0.%d 0 0 0 0 0 1\n' $k $k; done >>us.txt
expect 0 tides info us.txt --json
out '"stop_s":[[:space:]]*0.08,'
printf '90000 3 0 0 0 0 0 1\n' >>us.txt
expect 0 tides simulate run.json -o us.h5 --set camera.file=us.txt
err "camera.file: .*us.txt: its poses leap 1 time, most from line 10 to line 11"
printf '0 0 0 0 0 0 0 1\n5 0 0 0 0 0 0 1\n9 0 0 0 0 0 0 1\n' >path.txt
refuse 1 "path.txt: its times are whole numbers.*camera.time_unit" tides simulate run.json -o e.h5
expect 0 tides simulate run.json -qo ms.h5 --set camera.time_unit=ms --set time.stop=0.009

# Cameras of several images, whose focal lengths or centres differ.
frame='"transform_matrix": [[1,0,0,%s],[0,1,0,0],[0,0,1,0],[0,0,0,1]]'
printf '{ "w": 48, "h": 36, "frames": [ { "fl_x": 50, "cx": 24, '"$frame"' }, { "fl_x": 51, "cx": 25, '"$frame"' } ] }' 0 0.1 >two.json
refuse 1 "two.json gives it differently from pose to pose.*camera.views" tides simulate run.json -o e.h5 --set camera.file=two.json --set camera.fx=null
expect 0 tides simulate run.json -o two.h5 --set camera.file=two.json
err "principal points differ from pose to pose"

# COLMAP's folders, with and without its 0.
mkdir -p flat/sparse
printf '1 PINHOLE 48 36 50 50 24 18\n' >flat/sparse/cameras.txt
printf '1 1 0 0 0 0 0 0 1 2.png\n\n2 1 0 0 0 0.1 0 0 1 10.png\n\n' >flat/sparse/images.txt
expect 0 tides info flat
out "^format +colmap"
