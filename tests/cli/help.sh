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
out "sensor.threshold_on \[0.2\].*\[log units\]"
out "image.rules .*smooth\|inria\|gsplat"
out "later versions.*"
expect 0 tides --version
out "^tides [0-9]+\.[0-9]+\.[0-9]+$"
