#!/bin/sh
# The manual as static HTML: the guide and the headers by Doxygen, the package by pdoc, the manual pages by mandoc. Fails where a
# symbol has no comment or a link leads nowhere.
# usage: make.sh OUT MANPAGES     environment: PYTHON the interpreter, TIDES_LIBRARY the built library, VERSION
set -eu
out=$1 pages=$2
python=${PYTHON:-/usr/bin/python3}
venv=$PWD/build/python/docs
log=$out.log

rm -rf "$out"
mkdir -p "$out/man"

echo "docs: headers and guide"
{
    cat scripts/docs/Doxyfile
    echo "PROJECT_NUMBER = $VERSION"
    echo "INPUT_FILTER =" && echo "FILTER_PATTERNS = \"*.h=$python scripts/docs/header.py\" \"*.md=$python scripts/docs/page.py\""
    echo "OUTPUT_DIRECTORY = $out" && echo "HTML_OUTPUT = ." && echo "WARN_LOGFILE = $log"
} | doxygen - >"$log.doxygen" 2>&1 || { cat "$log.doxygen"; exit 1; }
if [ -s "$log" ]; then
    cat "$log"
    echo "docs: say what these are, in their headers"
    exit 1
fi

echo "docs: manual pages"
for page in "$pages"/*.[0-9]; do
    mandoc -T html -O style=man.css,man=%N.%S.html "$page" >"$out/man/$(basename "$page").html"
done
cp scripts/docs/man.css "$out/man"

echo "docs: Python"
[ -x "$venv/bin/pdoc" ] || {
    "$python" -m venv --system-site-packages "$venv"
    "$venv/bin/pip" install -q --disable-pip-version-check -r scripts/docs/requirements.txt
}
PYTHONPATH=python_ctypes "$venv/bin/pdoc" --no-show-source -o "$out/python" tides '!tides._api' '!tides.__main__' '!tides.play.__main__' 2>"$log.pdoc" ||
    { cat "$log.pdoc"; exit 1; }

echo "docs: links"
"$python" scripts/docs/links.py "$out"
echo "docs: $out/index.html"
