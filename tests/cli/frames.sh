# Frames, inertial measurements and tracks of a run: what is written, that seeds decide noise, and what is refused.
make_scene
expect 0 tides frames run.json -o blurred --set exposure.frames_per_second=100 --set exposure.exposure_s=0.01
out '^frames +4$'
[ "$(ls blurred | tr '\n' ' ')" = "exposure_timestamps.txt frame_000000.png frame_000001.png frame_000002.png frame_000003.png timestamps.txt " ] ||
    fail "four frames and their times"
[ "$(cat blurred/timestamps.txt | tr '\n' ' ')" = "0.005000000 0.015000000 0.025000000 0.035000000 " ] || fail "times are mid-exposure"
grep -q '^0.010000000 0.020000000$' blurred/exposure_timestamps.txt || fail "the second exposure begins where the first ends"

# Into a folder of a longer run: it is replaced whole, and what isn't its own stays.
touch blurred/mine.png
expect 0 tides frames run.json -o blurred --set exposure.frames_per_second=50 --set exposure.exposure_s=0.01
[ "$(ls blurred | tr '\n' ' ')" = "exposure_timestamps.txt frame_000000.png frame_000001.png mine.png timestamps.txt " ] ||
    fail "two frames, no older ones: $(ls blurred)"
rm -r blurred
expect 0 tides frames run.json -o blurred --set exposure.frames_per_second=100 --set exposure.exposure_s=0.01
expect 0 tides simulate run.json -qo shown.h5
expect 0 tides view shown.h5 -o 'film%04d.png' --window 0.004
[ "$(ls film*.png | wc -l)" -ge 8 ] || fail "too few pictures to tell"
expect 0 tides view shown.h5 -o 'film%04d.png' --window 0.013
[ "$(ls film*.png | wc -l)" -le 4 ] || fail "older pictures follow: $(ls film*.png)"

# Noise is the seed's; what is recorded feeds a baseline again.
noisy="--set exposure.frames_per_second=100 --set exposure.exposure_s=0.01 --set exposure.full_well_e=1000 --set exposure.read_noise_e=5"
expect 0 tides frames run.json -o one $noisy
expect 0 tides frames run.json -o two $noisy
expect 0 tides frames run.json -o three $noisy --set seed=2
cmp -s one/frame_000001.png two/frame_000001.png || fail "the same seed, another picture"
! cmp -s one/frame_000001.png three/frame_000001.png || fail "another seed, the same noise"
! cmp -s one/frame_000001.png blurred/frame_000001.png || fail "no noise"
printf '{"frames": {"file": "blurred"}, "method": "esim", "time": {"start": 0.005, "stop": 0.035}}' >again.json
expect 0 tides simulate again.json -o again.h5

refuse 1 "exposure.exposure_s" tides frames run.json -o long --set exposure.exposure_s=0.05
refuse 1 "exposure.bits" tides frames run.json -o odd --set exposure.bits=12
refuse 1 "psf_sigma_px" tides frames run.json -o both --set exposure.shutter=rolling --set frontend.psf_sigma_px=1 \
    --set exposure.exposure_s=0.01
refuse 2 "-o DIR" tides frames run.json
refuse 2 "a folder is made, not a video: give -o my.film; .* ffmpeg -framerate HZ -i my.film/frame_%06d.png my.film.mp4; see" \
    tides frames run.json -o my.film.mp4
for name in one.PNG some/film.avi; do refuse 2 "-o $name: a folder is made, not a .*: give -o ${name%.*};" tides frames run.json -o $name; done
refuse 2 "-o set.bag: a folder is made, not a file: give -o set;" tides dataset run.json -o set.bag
refuse 2 "-o all.h5: a folder is made, not a file: give -o all;" tides batch run.json -o all.h5
missing my.film.mp4
mkdir there.mp4
expect 0 tides frames run.json -o there.mp4 --set exposure.frames_per_second=100 --set exposure.exposure_s=0.01
exists there.mp4/frame_000003.png

known="--set scene.metres_per_unit=0.001 --set imu.down=[0,1,0]"
expect 0 tides imu run.json -o imu.csv $known
exists imu_bias.csv
[ "$(wc -l <imu.csv)" = 10 ] || fail "nine samples in 0.04 s at 200 Hz, and a header"
grep -q '^5000000,' imu.csv || fail "EuRoC's nanoseconds"
expect 0 tides imu run.json -o imu.txt $known
awk 'NR == 3 { exit !($1 == "0.010000000" && $3 < -9 && $3 > -11) }' imu.txt || fail "at rest an accelerometer feels what holds it up"
refuse 1 "scene.metres_per_unit" tides imu run.json -o no.csv
refuse 1 "imu.down" tides imu run.json -o no.csv --set scene.metres_per_unit=1
refuse 1 "csv, .txt, .npz or .h5" tides imu run.json -o imu.bag $known

expect 0 tides tracks run.json -o tracks.csv --set tracks.count=16 --set tracks.rate_hz=50
out '^tracks +16$'
[ "$(wc -l <tracks.csv)" = 49 ] || fail "sixteen tracks at three times, and a header"
expect 0 tides tracks run.json -o again.csv --set tracks.count=16 --set tracks.rate_hz=50
cmp -s tracks.csv again.csv || fail "the same seed, other points"
refuse 1 "npz, .csv, or .npy" tides tracks run.json -o tracks.png

# Videos, from a file and from a pipe, to their end; a run file that says when ends there.
{ printf 'YUV4MPEG2 W8 H6 F20:1 Ip C420jpeg\n'
    for level in 40 80 120 160 200; do
        printf 'FRAME\n'
        head -c 48 /dev/zero | tr '\0' "\\$(printf '%03o' $level)"
        head -c 24 /dev/zero | tr '\0' '\200'
    done; } >video.y4m
expect 0 tides simulate video.y4m -o video.h5 --stats video.json
grep -q '"events":[[:space:]]*[1-9]' video.json || fail "a picture that gets brighter fires"
tides simulate - -o pipe.h5 --stats pipe.json <video.y4m >out 2>err || fail "a pipe should do as well"
for key in events events_on simulated_s; do
    [ "$(grep "\"$key\":" video.json)" = "$(grep "\"$key\":" pipe.json)" ] || fail "$key differs between file and pipe"
done
grep -q '"simulated_s":[[:space:]]*0.2[,}]*$' pipe.json || fail "five frames at 20 Hz last 0.2 s"
tides simulate --set frames.file=- -qo named.h5 <video.y4m >out 2>err || fail "--set frames.file=- alone should do"
cmp -s named.h5 pipe.h5 || fail "--set frames.file=- is another run than -"
expect 0 tides simulate --set frames.file=none.y4m --set frames.file=video.y4m -qo named.h5 --stats named.json
[ "$(grep '"events":' video.json)" = "$(grep '"events":' named.json)" ] || fail "--set frames.file=video.y4m is another run"
refuse 1 "frames: there is no such file or folder" tides simulate --set frames.file=frames -o no.h5
refuse 2 "too few arguments" tides simulate -o no.h5
# A file of another kind is named, with the line that gets further; an array or a folder of pictures is a run as a video is.
printf '\0\0\0\040ftypisom' >a.mp4
for named in 'info a.mp4' 'simulate a.mp4 -o no.h5' 'simulate --set frames.file=a.mp4 -o no.h5' 'view a.mp4 -o no.png' 'batch a.mp4 -o no'; do
    # shellcheck disable=SC2086 # several words
    refuse 1 "a.mp4: is an MP4 video, not .*ffmpeg -i a.mp4 -f yuv4mpegpipe - \| tides simulate - -o events.h5" tides $named
done
refuse 1 "a.mp4: is an MP4 video, not a scene of splats" tides simulate --set scene.file=a.mp4 -o no.h5
{ npy_header "3, 4, 6"; head -c 24 /dev/zero; head -c 24 /dev/zero | tr '\0' '\200'; head -c 24 /dev/zero; } >array.npy
refuse 1 "array.npy: its frames have no times: give frames.timestamps" tides simulate array.npy -o no.h5
for named in array.npy '--set frames.file=array.npy'; do
    # shellcheck disable=SC2086 # several words
    expect 0 tides simulate $named -qo array.h5 --set frames.frames_per_second=100
    exists array.h5
done
mkdir nothing
echo "0 1 2" >steps.txt
refuse 1 "nothing: is a folder, and neither a trained model" tides simulate nothing -o no.h5
refuse 1 "nothing: is a folder in which nothing is known" tides info nothing
refuse 1 "steps.txt: isn.t a run file, which is one JSON object.*begins with .0 1 2" tides simulate steps.txt -o no.h5
echo '{"frames": {"file": "-"}, "method": "v2e", "time": {"stop": 0.1}}' >pipe_run.json
tides simulate pipe_run.json -o pipe.h5 --stats pipe.json <video.y4m >out 2>err || fail "frames.file: - should do"
grep -q '"simulated_s":[[:space:]]*0.1[,}]*$' pipe.json || fail "time.stop is kept"
head -c 100 video.y4m >short.y4m
refuse 1 "short.y4m: ends within frame 0" tides simulate short.y4m -o no.h5
refuse 1 "standard input: is empty" tides simulate - -o no.h5 </dev/null
