# Every command explains itself, and so does the tool.
expect 0 tides --help
for command in demo init devices info scene render frames imu tracks simulate batch convert cut view export metrics compare bench; do
    out "^  $command "
done
for command in demo init devices info scene render frames imu tracks simulate batch convert cut view export metrics compare bench; do
    expect 0 tides $command --help
    out "^usage: tides $command"
    out "--device SPEC"
    out "--json"
    [ ! -s err ] || fail "help belongs on stdout"
    cp out first
    expect 0 tides $command -h
    cmp -s first out || fail "-h isn't --help"
    expect 0 tides help $command
    cmp -s first out || fail "help $command isn't --help"
done
expect 0 tides simulate --help
[ "$(grep -cE '^  [a-z_0-9]+(\.[a-z_0-9]+)* \[' out)" -le 20 ] || fail "--help lists more keys than a person reads"
grep -q "iebcs.tau" out && fail "--help lists what few set"
expect 0 tides simulate --help-all
out "^  iebcs.tau "
out "sensor.threshold_on \[0.2\].*\[log units\]"
out "image.rules .*smooth\|inria\|gsplat"
[ -n "$(tail -n 1 out)" ] && [[ $(tail -n 1 out) != *: ]] || fail "help ends with an empty heading"
expect 0 tides --version
out "^tides [0-9]+\.[0-9]+\.[0-9]+$"
# README names every format of the tables, by its ending or, of events, by the words before it.
readme=$(dirname "${BASH_SOURCE[0]}")/../../README.md
expect 0 tides convert --help
out "^  .ply +3DGS"
out "^  .sog .*read only"
sed -n '/^formats of scenes/,/^$/p' out | awk '/^  [.lm]/ { for (i = 1; $i ~ /^[.]|json$/; i++) print $i }' >endings
[ "$(wc -l <endings)" -ge 10 ] || fail "help should list the endings of scenes"
while read -r ending; do grep -qF -- "$ending" "$readme" || fail "README doesn't name $ending of scenes"; done <endings
sed -n '/^formats of event files/,/^$/p' out | sed -n 's/^  [^ ]* *.*: \(\..*\)$/\1/p' | tr ' ' '\n' >endings
[ "$(wc -l <endings)" -ge 9 ] || fail "help should list the endings of events"
while read -r ending; do grep -qF -- "$ending" "$readme" || fail "README doesn't name $ending of events"; done <endings
