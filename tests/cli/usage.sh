# Wrong command lines: exit 2, one line, with a suggestion for likely misspellings.
expect 2 tides
err "^tides: a command is missing; see tides --help$"
for line in "demo -o demo" "simulate scene.ply -o events.h5" "view events.h5 -o events.png"; do out "^    tides $line  "; done
[ "$(wc -l <out)" = 3 ] || fail "three lines are enough"
cp out first
expect 0 tides --help
[ "$(grep -c -x -F -f first out)" = 3 ] || fail "help should begin with the same"
refuse 2 "unknown command simulat; did you mean simulate\?" tides simulat
refuse 2 "unknown command rednr; did you mean render\?" tides rednr
refuse 2 "unknown command xyzzy" tides xyzzy
refuse 2 "unknown option --versoin" tides --versoin
refuse 2 "unknown option --outptu; did you mean --output\?" tides simulate run.json --outptu x
refuse 2 "unknown option --state; did you mean --stats\?" tides simulate run.json --state=x
refuse 2 "unknown option -x" tides simulate -x
refuse 2 "too few arguments: tides simulate RUN.json" tides simulate -o x.h5
refuse 2 "the output is missing: -o EVENTS.h5" tides simulate run.json
refuse 2 "the output is missing" tides render run.json
refuse 2 "\"b\" is one argument too many" tides info a b
refuse 2 "--output needs a value" tides simulate run.json -o
refuse 2 "--output is given twice" tides simulate run.json -o a -o b
refuse 2 "--json takes no value" tides devices --json=yes
refuse 2 "--truth flow,dept: 'dept' is none of flow, depth, instance, normal, all" tides render run.json -o x.exr --truth flow,dept
refuse 2 "--metres says what depths are in" tides render run.json -o x.exr --truth flow --metres
refuse 2 "--time abc: not a number" tides render run.json -o x.exr --time abc
refuse 2 "--time nan: not a number" tides render run.json -o x.exr --time nan
refuse 2 "--time 1s: not a number" tides render run.json -o x.exr --time 1s
