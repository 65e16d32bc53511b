# Pictures of events: sizes, known events on known pixels, animations, empty and single streams, refusals.

# plane_bytes FILE WIDTH HEIGHT X Y: "luma blue red " (Y, Cb, Cr) of a pixel of a video's first picture.
plane_bytes() {
    local head
    head=$(($(head -n 2 "$1" | wc -c)))
    for plane in 0 1 2; do
        od -An -tu1 -j $((head + plane * $2 * $3 + $5 * $2 + $4)) -N 1 "$1" | tr -d ' \n'
        printf ' '
    done
}
png_size() { # FILE: from IHDR
    echo $((0x$(od -An -tx1 -j 16 -N 4 "$1" | tr -d ' \n')))x$((0x$(od -An -tx1 -j 20 -N 4 "$1" | tr -d ' \n')))
}

# Three events: ON at (4, 1), OFF at (0, 2), and a third window later ON at (5, 0).
printf 't,x@6,y@3,on\n1000,4,1,1\n2000,0,2,0\n12000,5,0,1\n' >three.csv
printf 't,x@6,y@3,on\n' >empty.csv
printf 't,x@6,y@3,on\n1000,4,1,1\n' >one.csv

# Pixel for pixel, in a video of one picture: grey, ON reddish (Cr above 128), OFF bluish (Cb above 128).
expect 0 tides view three.csv -o three.y4m --plain --start 0 --stop 0.01 --window 0.01
out "three.y4m: 1 picture of 6 x 3 px, 2 events"
head -n 1 three.y4m | grep -q "^YUV4MPEG2 W6 H3 F25:1 " || fail "the video's size is wrong"
grey=$(plane_bytes three.y4m 6 3 1 1)
[ "$(echo "$grey" | cut -d' ' -f2,3)" = "128 128" ] || fail "pixels without events are grey, not $grey"
for place in "4 1 on" "0 2 off" "5 0 none" "3 1 none" "4 2 none"; do
    set -- $place
    x=$1 y=$2 what=$3
    set -- $(plane_bytes three.y4m 6 3 "$x" "$y")
    luma=$1 blue=$2 red=$3
    case $what in
        on) [ "$red" -gt 150 ] && [ "$blue" -lt 128 ] ;;
        off) [ "$blue" -gt 150 ] && [ "$red" -lt 128 ] ;;
        none) [ "$luma $blue $red " = "$grey" ] ;;
    esac || fail "pixel $x,$y should show $what: $luma $blue $red"
done

# A surface remembers: at 12.001 ms the event of 1 ms still shows, paler than the one of 12 ms.
expect 0 tides view three.csv -o s.y4m --kind surface --plain --start 0.012 --window 0.001 --decay 0.01
new=$(plane_bytes s.y4m 6 3 5 0 | cut -d' ' -f1) old=$(plane_bytes s.y4m 6 3 4 1 | cut -d' ' -f1)
never=$(plane_bytes s.y4m 6 3 2 2 | cut -d' ' -f1)
[ "$(plane_bytes s.y4m 6 3 0 2 | cut -d' ' -f2)" -gt 140 ] || fail "OFF is blue"
[ "$new" -lt "$old" ] && [ "$old" -lt "$never" ] || fail "a surface fades: $new, $old, $never"

# Sizes: plain, scaled, with axes; each kind with events, with one, and without.
expect 0 tides view three.csv -o p.png --plain -q
silent
[ "$(png_size p.png)" = 6x3 ] || fail "a plain picture has the sensor's size"
expect 0 tides view three.csv -o p.png --plain --scale 5 -q
[ "$(png_size p.png)" = 30x15 ] || fail "and five times that where asked for"
for kind in frame surface xyt rate isi; do
    for file in three one empty; do
        expect 0 tides view $file.csv -o $kind.$file.png --kind $kind --json
        [ "$(value out width)x$(value out height)" = "$(png_size $kind.$file.png)" ] || fail "the size that is told is wrong"
    done
    [ "$(png_size $kind.empty.png)" = "$(png_size $kind.three.png)" ] || fail "$kind: the size depends on the events"
    cmp -s $kind.empty.png $kind.three.png && fail "$kind: events don't show"
done
expect 0 tides view three.csv -o again.png --kind xyt -q
cmp -s again.png xyt.three.png || fail "the same command makes the same picture"

# A picture's stretch: a window at a time, or what is asked for.
expect 0 tides view three.csv -o p.png --time 0.003 --window 0.0015 --json
[ "$(value out events) $(value out start_ns) $(value out stop_ns)" = "1 1500000 3000000" ] || fail "the window is wrong"
expect 0 tides view three.csv -o p.png --kind rate --start 0.0015 --json
[ "$(value out events)" = 2 ] || fail "two events come after 1.5 ms"
refuse 1 "three.csv: lasts from 0.001 to 0.012000001 s, .*begins at 1 s" tides view three.csv -o p.png --start 1

# Animations: an animated PNG says so, numbered pictures are there, video goes down a pipe.
expect 0 tides view three.csv -o a.png --animate --window 0.001 --json
[ "$(value out pictures)" = 12 ] || fail "11 ms and a bit are 12 windows of 1 ms"
head -c 60 a.png | grep -q acTL || fail "a.png isn't animated"
expect 0 tides view three.csv -o 'f%03d.png' --window 0.004 -q
exists f000.png
exists f002.png
missing f003.png
tides view three.csv -o - --window 0.001 --plain >piped.y4m || fail "a video to a pipe"
expect 0 tides view three.csv -o filed.y4m --window 0.001 --plain
cmp -s piped.y4m filed.y4m || fail "the pipe got something else than a file"
[ "$(grep -ac '^FRAME' filed.y4m)" -ge 1 ] || fail "the video has no frames"
expect 0 tides view empty.csv -o e.png --animate

# Each kind as shapes, by light and by dark: valid, the same bytes again, and its words are words.
has() { command -v "$1" >/dev/null || { echo "no $1: a check is left out"; return 1; }; }
for kind in frame surface xyt rate isi; do
    for ending in svg pdf; do
        expect 0 tides view three.csv -o $kind.$ending --kind $kind -q
        silent
        expect 0 tides view three.csv -o dark.$ending --kind $kind --theme dark -q
        cmp -s $kind.$ending dark.$ending && fail "$kind.$ending: dark is as light"
        expect 0 tides view three.csv -o again.$ending --kind $kind -q
        cmp -s $kind.$ending again.$ending || fail "$kind.$ending differs the second time"
    done
    ! has xmllint || xmllint --noout $kind.svg || fail "$kind.svg isn't XML"
    ! has pdfinfo || { pdfinfo $kind.pdf >info && grep -q '^Pages: *1$' info; } || fail "$kind.pdf isn't one page"
    ! has pdfinfo || ! grep -q 'Date' info || fail "$kind.pdf has a date"
done
! has pdftotext || { pdftotext rate.pdf - | grep -q 'time \[ms\]'; } || fail "rate.pdf: the axis has no label"
refuse 2 "--theme drak: should be light or dark" tides view three.csv -o x.png --theme drak
# Without a font: the picture is there, and one line says why it looks as it does.
printf '<?xml version="1.0"?><!DOCTYPE fontconfig SYSTEM "fonts.dtd"><fontconfig></fontconfig>' >no_fonts.conf
expect 0 env FONTCONFIG_FILE="$PWD/no_fonts.conf" tides view three.csv -o plain_face.png -q
error_line "this machine has no font"
exists plain_face.png

# Refusals leave nothing.
refuse 2 "did you mean surface" tides view three.csv -o x.png --kind surfce
refuse 2 "say where the picture goes" tides view three.csv
refuse 2 "written as .png" tides view three.csv -o x.jpg
refuse 2 "doesn't move" tides view three.csv -o x.png --kind isi --animate
refuse 2 "for --animate" tides view three.csv -o x.png --fps 10
refuse 2 "for one picture" tides view three.csv -o x.apng --time 0.1
refuse 2 "--start and --stop" tides view three.csv -o x.png --time 0.1 --start 0
refuse 2 "isn't before" tides view three.csv -o x.png --start 1 --stop 0.5
refuse 2 "above 0" tides view three.csv -o x.png --window 0
refuse 2 "whole number" tides view three.csv -o x.png --scale 1.5
refuse 2 "for --kind frame and surface" tides view three.csv -o x.png --kind rate --plain
refuse 2 "should be 0.02 to 1000" tides view three.csv -o x.apng --fps 0
refuse 1 "No such file" tides view absent.h5 -o x.png
printf '0.002 1 2 1\n0.001 3 0 0\n' >late.txt
refuse 1 "earlier than the one before it" tides view late.txt -o x.png
refuse 1 "can't be created" tides view three.csv -o missing/x.png
missing x.png
missing x.apng
# An event is a dot of the shapes, and no more of them are drawn than was asked for.
awk 'BEGIN { print "t_us,x,y,on"; for (i = 0; i < 640; i++) print 50 * i "," i % 32 "," i * 7 % 24 "," i % 2 }' >many.csv
expect 0 tides view many.csv --kind xyt -o dots.svg --points 100
${PYTHON:-python3} -c 'import sys, xml.dom.minidom as m; m.parse(sys.argv[1])' dots.svg || fail "dots.svg isn't XML"
dots=$(grep -oE 'M [0-9]+ [0-9]+ Z' dots.svg | wc -l)
[ "$dots" -gt 50 ] && [ "$dots" -le 100 ] || fail "$dots dots, not 51 to 100"
refuse 2 "what moves is written as" tides view many.csv --kind xyt --animate -o a.svg
refuse 2 "--points is for --kind xyt" tides view many.csv --points 5 -o a.png
refuse 1 "none/dots.svg" tides view many.csv --kind xyt -o none/dots.svg

# Ground truth of files: a panel for each quantity that there is.
make_scene
expect 0 tides render run.json --time 0.02 -qo truth.exr --truth flow,depth,instance --displacement-to 0.03
expect 0 tides view truth.exr -o truth.png --json
out '"panels":[[:space:]]*4'
out '"width":[[:space:]]*48'
exists truth.png
expect 0 tides view truth.exr -o truth.pdf --theme dark -q
head -c 5 truth.pdf | grep -q %PDF- || fail "truth.pdf is no PDF"
expect 0 tides render run.json --time 0.02 -qo plain.exr
refuse 1 "no ground truth to draw" tides view plain.exr -o x.png
refuse 1 "isn't ground truth" tides view truth.png -o x.png
refuse 1 "read from .exr, .png and .npy" tides view three.csv --kind truth -o x.png
refuse 2 "as one picture" tides view truth.exr -o x.apng
missing x.png
