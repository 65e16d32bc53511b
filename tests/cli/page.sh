# The page of events (tides view -o OUT.html): the tool's messages and refusals. tests/python/package/test_page.py tests its
# content and its behaviour in a browser.

make_scene
expect 0 tides simulate run.json -o e.h5 --set sensor.truth=true -q
expect 0 tides info e.h5 --json
events=$(value out events)

expect 0 tides view e.h5 -o page.html
out "^page.html: .* events of 48 x 36 px, with depth, flow and instances: open it in a browser$"
grep -q '"title":"e.h5","events":'"$events"',"width":48,"height":36' page.html || fail "the page's facts are wrong"
[ "$(tail -n 1 page.html)" = "</html>" ] || fail "the page isn't whole"
grep -n '^@ ' page.html && fail "a part of the page is missing"

expect 0 tides view e.h5 -o page.html --json
is_json
[ "$(value out events)" = "$events" ] || fail "--json counts otherwise"

# A stretch, and what is too much, in one line.
expect 0 tides view e.h5 -o part.html --start 0.01 --stop 0.02 --window 0.001 -q
silent
grep -q '"start":"10000000","stop":"20000000","window":"1000000"' part.html || fail "the page shows another stretch"
expect 0 tides view e.h5 -o few.html --max-events 10
[ "$(wc -l <err)" = 1 ] || fail "what isn't shown is one line"
err "^tides: few.html: ends at 0\.0[0-9]+ s with 10 events, since there are more: --max-events N"
grep -q '"ended":true' few.html || fail "the page should say so too"

printf 't,x@6,y@3,on\n' >empty.csv
expect 0 tides view empty.csv -o empty.html
out "0 events of 6 x 3 px: open"

# Refusals leave nothing behind.
refuse 2 "a page takes --start" tides view e.h5 -o no.html --kind xyt
refuse 2 "a page takes --start" tides view e.h5 -o no.html --animate
refuse 2 "--max-events 0: should be a whole number" tides view e.h5 -o no.html --max-events 0
refuse 2 "--max-events is for a page" tides view e.h5 -o no.png --max-events 5
refuse 2 "isn't before" tides view e.h5 -o no.html --start 2 --stop 1
refuse 1 "none.h5" tides view none.h5 -o no.html
refuse 1 "nowhere/no.html: can't be written" tides view e.h5 -o nowhere/no.html
printf 't,x@6,y@3,on\n9,1,1,1\nnonsense\n' >bad.csv
refuse 1 "bad.csv" tides view bad.csv -o no.html
missing no.html
missing no.html.part
