#!/bin/bash
# The stages of scripts/lint.sh that check the whole repository find their faults, in a small tree made here.
set -u
house="${PYTHON:-python3} $PWD/scripts/house.py"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0 failed=0

# expect CODE WORDS CHECK WHAT: the check's exit code on the tree, and an extended regular expression in what it prints.
expect() {
    printed=$($house "$3" "$work" 2>&1)
    code=$?
    if [ $code = "$1" ] && echo "$printed" | grep -Eq -- "$2"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "$4: exit $code for $1, and not '$2' in: $printed"
    fi
}

mkdir -p "$work"/{include/tides,lib/base,lib/upper,lib/lower/part,cli,kernels,tests,scripts,python_ctypes,docs,.ci}
cat >"$work/scripts/arrows.txt" <<'END'
everyone: include lib/base
include:
lib/base:
lib/lower: # a comment
lib/upper: lib/lower
cli:
END
opening='/* A file of the test of lint, for nobody but that test; it leaves all else to others. */'
printf '%s\n#include "lower/td_lower.h"\n#include "td_base.h"\n' "$opening" >"$work/lib/upper/upper.c"
printf '%s\n#include "td_base.h"\n#include <math.h>\n' "$opening" >"$work/lib/lower/td_lower.h"
printf '%s\n#include "td_lower.h"\n' "$opening" >"$work/lib/lower/lower.c"
printf '%s\n#include "lower/td_lower.h"\n' "$opening" >"$work/lib/lower/part/part.c"
printf '%s\n' "$opening" >"$work/lib/base/td_base.h"
printf '/* See DESIGN 1.1. */\n' >"$work/include/tides/x.h"
printf '/* DESIGN 1 and 1.1; lib/upper/upper.c, td_lower.h, <no.h>, cmd_NAME.c, "\n * https://example.org/none.md. */\nchar a[] = "none.c";\n' >"$work/cli/a.c"
printf '# D\n\n## 1. One\n### 1.1 One of one\n\n```\nnone.md\n```\n' >"$work/docs/DESIGN.md"
expect 0 '^$' arrows "a right tree"
expect 0 '^$' cites "a right tree"
expect 0 '^$' openings "a right tree"

# -- arrows ------------------------------------------------------------------------------------------------------------
printf '%s\n\n#include "upper/td_upper.h"\n' "$opening" >"$work/lib/lower/part/wrong.c"
printf '%s\n' "$opening" >"$work/lib/upper/td_upper.h"
expect 1 '^lib/lower/part/wrong.c:3: "upper/td_upper.h": lib/lower may not include lib/upper$' arrows "an include that points up"
echo 'due: lib/lower lib/upper' >>"$work/scripts/arrows.txt"
expect 0 '^$' arrows "one that is due"
rm "$work/lib/lower/part/wrong.c"
expect 1 "take the 'due' line out" arrows "one that was due and is gone"
sed -i '/^due/d; s/^lib\/lower:.*/lib\/lower: lib\/upper/' "$work/scripts/arrows.txt"
expect 1 "arrows.txt:4: lib/lower may include lib/upper, which doesn't stand above it" arrows "a circle in the list"
sed -i 's/^lib\/lower:.*/lib\/lower:/' "$work/scripts/arrows.txt"
mkdir "$work/lib/new"
printf '%s\n' "$opening" >"$work/lib/new/new.c"
expect 1 '^lib/new/new.c: scripts/arrows.txt has no line for lib/new$' arrows "a folder that nobody placed"
rm -r "$work/lib/new"

# -- circles -----------------------------------------------------------------------------------------------------------
printf 'lib/lower/part: lib/lower\nlib/lower/late: lib/lower lib/lower/part\n' >"$work/order"
sed -i "/^lib\/lower:/r $work/order" "$work/scripts/arrows.txt"
mkdir "$work/lib/lower/late"
printf '%s\nint td_a(int x) {\n    return td_b(x);\n}\n' "$opening" >"$work/lib/lower/part/a.c"
printf '%s\nint td_b(int x) { return x; }\nstatic int td_a_of_its_own(void) { return 0; }\n' "$opening" >"$work/lib/lower/part/b.c"
printf '%s\nint td_late(void) { return td_a(1); }\n' "$opening" >"$work/lib/lower/late/late.c"
expect 0 '^$' circles "files that go one way"
printf '%s\nint td_b(int x) { return x ? td_c(x) : 0; } /* td_a( */\n' "$opening" >"$work/lib/lower/part/b.c"
printf '%s\nint td_c(int x) { return td_a(x - 1); }\n' "$opening" >"$work/lib/lower/part/c.c"
expect 1 'a circle: lib/lower/part/a.c -> lib/lower/part/b.c -> lib/lower/part/c.c -> lib/lower/part/a.c' circles "three files in a circle"
printf '%s\nint td_c(int x) { return td_late() - x; }\n' "$opening" >"$work/lib/lower/part/c.c"
expect 1 'lib/lower/part/c.c: uses lib/lower/late/late.c, which lib/lower/part may not' circles "a function of a folder above"
rm -r "$work/lib/lower/late" "$work/lib/lower/part/"[abc].c
sed -i '/^lib\/lower\/late/d; /^lib\/lower\/part/d' "$work/scripts/arrows.txt"
printf '%s\n#include "base/td_base.h"\n' "$opening" >"$work/cli/b.c"
sed -i 's/^everyone:.*/everyone: include/' "$work/scripts/arrows.txt"
expect 1 'cli may not include lib/base' arrows "the command line in a library's room"

# -- citations ---------------------------------------------------------------------------------------------------------
cites() { # WORDS WHAT TEXT
    printf '/* First line.\n * %s */\n' "$3" >"$work/cli/c.c"
    expect 1 "^cli/c.c:2: $1" cites "$2"
}
cites 'DESIGN 2: docs/DESIGN.md has no such section' "a section that isn't there" 'As DESIGN 1.1 and 2 have it.'
cites 'DESIGN 1.2: ' "a subsection that isn't there" 'As DESIGN 1.2.'
cites "DESIGN without a section's number" "no section" 'As DESIGN has it.'
cites "the simulators notes aren't" "notes of somebody" 'As the simulators notes, 1.4.'
cites "notes with sections" "more notes" 'As somebody (notes, sections 1.1 to 1.4).'
cites 'reference/none.md: no such file' "a page that isn't there" 'See reference/none.md.'
cites 'lib/upper/gone.c: no such file' "a file that has moved" 'See lib/upper/gone.c, and td_lower.h.'
cites 'gone.h: no such file' "a header by its name" 'See gone.h.'
rm "$work/cli/c.c"
printf '#!/bin/sh\n# See gone.sh.\n' >"$work/scripts/a.sh"
expect 1 '^scripts/a.sh:2: gone.sh: no such file' cites "a script"
rm "$work/scripts/a.sh"

printf '\nSee `td_gone`, `td_gone_*`.\n' >"$work/docs/PAGE.md"
expect 1 '^docs/PAGE.md:2: td_gone: no source has such a name' cites "a function that isn't there"
rm "$work/docs/PAGE.md"

# -- openings ----------------------------------------------------------------------------------------------------------
printf '/* Helpers. */\n' >"$work/lib/lower/vague.c"
expect 1 '^lib/lower/vague.c:1: an opening of 1 words' openings "an opening that says nothing"
printf 'int x;\n' >"$work/lib/lower/vague.c"
expect 1 '^lib/lower/vague.c:1: an opening of 0 words' openings "no opening"

# -- wide --------------------------------------------------------------------------------------------------------------
wide() { printf '%s\n/* A, b */\nint td_wide(int (*a)(int, int), int b%s) {\n    return b;\n}\n' "$opening" "$1" >"$work/lib/lower/wide.c"; }
wide ', int c, int d, int e, int f, int g, int h'
expect 0 '^$' wide "eight parameters"
wide ', int c, int d, int e, int f, int g, int h, int i'
expect 1 '^lib/lower/wide.c: td_wide has 9 parameters$' wide "nine"
printf '/* Wide. */\nint td_wide(int (*a)(int, int), int b);\n' >"$work/include/tides/wide.h"
expect 0 '^$' wide "nine of a public function"
rm "$work/include/tides/wide.h"
echo 'wide: td_wide # for a reason' >>"$work/scripts/arrows.txt"
expect 0 '^$' wide "nine with a line of their own"
{ printf '%s\nstruct td_many {\n' "$opening"; for i in $(seq 15); do echo "    int a$i, b$i[2]; /* one, two */"; done; echo '    union { int x; float y; } both; }; '; } >"$work/lib/lower/wide.c"
expect 1 '^lib/lower/wide.c: td_many has 31 fields$' wide "31 fields, an inner one counted once"
expect 1 '^arrows.txt: td_wide is wide no more: take its line out$' wide "a line without its function"
rm "$work/lib/lower/wide.c"
sed -i '/^wide/d' "$work/scripts/arrows.txt"

# -- guards ------------------------------------------------------------------------------------------------------------
printf '#ifndef TD_A_H\n#define TD_A_H\n#endif\n' >"$work/kernels/a.h"
printf '%s\n#ifndef TD_B_H\n#define TD_B_H\n#endif\n' "$opening" >"$work/lib/lower/td_b.h"
expect 0 '^$' guards "headers with guards of their own"
sed -i s/TD_B_H/TD_A_H/ "$work/lib/lower/td_b.h"
expect 1 "^kernels/a.h: TD_A_H is lib/lower/td_b.h's guard, too" guards "two headers with one guard"

# -- libm --------------------------------------------------------------------------------------------------------------
printf '%s\n/* exp(x) is e^x */\ndouble td_x(double x) { return td_exp(x) + sqrt(x) + at.exp(x); }\n' "$opening" >"$work/lib/lower/x.c"
expect 0 '^$' libm "our own functions, exact ones, and a comment"
printf '%s\n/* two\n * lines */\nfloat td_x(float x) { return 2 * (expf(x)); }\n' "$opening" >"$work/lib/lower/x.c"
expect 1 '^lib/lower/x.c:4: expf\(\): ' libm "a function of libm"
rm "$work/lib/lower/x.c"
printf 'x = pow(x, 2.0f);\n' >"$work/kernels/x.cl"
expect 1 '^kernels/x.cl:1: pow\(\): ' libm "one of the device's"
rm "$work/kernels/x.cl"
# -- mutants -----------------------------------------------------------------------------------------------------------
printf '%s\nint td_y(int x) { return x + 1; }\n' "$opening" >"$work/lib/lower/y.c"
printf '# mutants\nlib/lower/y.c\tx + 1\tx + 2\tunit/test_y\n' >"$work/tests/mutants.txt"
expect 0 '^$' cites "a mutant's text that is there"
sed -i s/'x + 1'/'1 + x'/ "$work/lib/lower/y.c"
expect 1 '^tests/mutants.txt:2: lib/lower/y.c has x \+ 1 0 times' cites "one that is gone"
rm "$work/lib/lower/y.c" "$work/tests/mutants.txt"

# -- prose -------------------------------------------------------------------------------------------------------------
prose() { # CODE WORDS WHAT
    house="${PYTHON:-python3} $PWD/scripts/prose.py"
    expect "$1" "$2" --check "$3"
}
printf '# R\n\nA short one. %s end.\n' "$(printf 'word %.0s' $(seq 29))" >"$work/README.md"
: >"$work/scripts/prose.txt"
prose 0 '^$' "a sentence of thirty words"
printf '# R\n\nA short one. %s end.\n' "$(printf 'word %.0s' $(seq 30))" >"$work/README.md"
prose 1 '^README.md: 1 of .long., 0 in' "a sentence of 31 words"
echo 'long README.md 1' >"$work/scripts/prose.txt"
prose 0 '^$' "a long sentence that is known"
printf '%s\n/* The same for what follows. */\n' "$opening" >"$work/lib/lower/lower.c"
prose 1 '^lib: 1 of .opening., 0 in' "a comment that points elsewhere"

echo "$passed passed, $failed failed, 0 skipped"
[ $failed = 0 ]
