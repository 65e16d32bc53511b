# An IMU measures at the place that its calibration gives: Kalibr's T_cam_imu and EuRoC's T_BS. Measurements equal those of the
# body's path.
make_scene
orbit='"orbit": { "target": [0, 0, 4], "up": [0, -1, 0], "radius": 4, "angular_speed": 2, "stop": 0.2 }'
printf '{ "format": "tides-path", "version": 1, %s }' "$orbit" >body.json
keys="--set scene.metres_per_unit=1 --set imu.down=[0,1,0] --set time.stop=0.04"
same() { # as many numbers, which differ by $3 at most: EuRoC's camera has a spline of its own
    paste -d, $1 $2 | awk -F, -v most=${3:-1e-5} \
        '!/#/ { for (i = 2; i <= 7; i++) { d = $i - $(i + 7); if (d * d > most * most) bad = 1 } n++ } END { exit bad || n < 5 }' ||
        fail "$1 and $2 should be one IMU's"
}
expect 0 tides imu run.json -o body.csv $keys --set camera.file=body.json --json
out '"place":[[:space:]]*"the camera"'
cat >chain.yaml <<-YAML
	cam0:
	  T_cam_imu:
	  - [0.0, -1.0, 0.0, 0.2]
	  - [1.0, 0.0, 0.0, -0.1]
	  - [0.0, 0.0, 1.0, 0.3]
	  - [0.0, 0.0, 0.0, 1.0]
	  distortion_coeffs: []
	  distortion_model: none
	  intrinsics: [50, 50, 23.5, 17.5]
	  resolution: [48, 36]
	YAML
expect 0 tides imu run.json -o rig.csv $keys --set camera.file=body.json --set rig.file=chain.yaml --json
out '"place":[[:space:]]*"the calibration.s IMU"'
same rig.csv body.csv

# EuRoC's folder: the camera is put on the body, the IMU is where the body is, or where imu0 says.
mkdir -p mav0/cam0 mav0/imu0 mav0/state_groundtruth_estimate0 plain
awk 'BEGIN {
    print "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []"
    for (k = 0; k <= 20; k++) { t = k * 0.005; a = 0.9 * t + 2 * t * t
        printf "%d,%.9f,%.9f,0,%.12f,0,0,%.12f\n", k * 5000000, t * t, sin(3 * t), cos(a), sin(a) }
}' >mav0/state_groundtruth_estimate0/data.csv
cp mav0/state_groundtruth_estimate0/data.csv plain/data.csv
t_bs() { printf 'T_BS:\n  cols: 4\n  rows: 4\n  data: [%s]\n' "$1"; }
{
	t_bs '0, 0, 1, 0.1,  -1, 0, 0, 0,  0, -1, 0, 0.2,  0, 0, 0, 1'
	printf 'resolution: [48, 36]\nintrinsics: [50, 50, 23.5, 17.5]\n'
} >mav0/cam0/sensor.yaml
expect 0 tides imu run.json -o plain.csv $keys --set camera.file=plain --set imu.gravity=0
expect 0 tides imu run.json -o mav0.csv $keys --set camera.file=mav0 --set imu.gravity=0 --json
out '"place":[[:space:]]*"the calibration.s IMU"'
same mav0.csv plain.csv 0.02
t_bs '1, 0, 0, 0.5,  0, 1, 0, 0,  0, 0, 1, 0,  0, 0, 0, 1' >mav0/imu0/sensor.yaml
expect 0 tides imu run.json -o moved.csv $keys --set camera.file=mav0 --set imu.gravity=0
(same moved.csv plain.csv 0.02) >/dev/null 2>&1 && fail "imu0's T_BS should move the IMU"
# A rig's cameras are put on the body, and not on EuRoC's camera.
sed -i '/T_cam_imu/,/0.0, 1.0\]$/d' chain.yaml
sed 's/^cam0:/cam0:\n  T_imu_cam: [[0, 0, 1, 0.1], [-1, 0, 0, 0], [0, -1, 0, 0.2], [0, 0, 0, 1]]/' chain.yaml >same.yaml
rm mav0/imu0/sensor.yaml
expect 0 tides imu run.json -o twice.csv $keys --set camera.file=mav0 --set imu.gravity=0 --set rig.file=same.yaml
same twice.csv plain.csv
expect 0 tides render run.json -qo one.exr $keys --set camera.file=mav0
expect 0 tides render run.json -qo rig.exr $keys --set camera.file=mav0 --set rig.file=same.yaml
