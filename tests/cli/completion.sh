#!/bin/bash
# Completions and man pages, made from the tables: they contain every command and option, and are valid.
expect 0 tides help --bash
[ ! -s err ] || fail "it should print the completion only"
cp out tides.bash
bash -n tides.bash || fail "not a bash script"
compopt() { :; } # only while readline completes
source ./tides.bash
# complete WORD...: what is offered for the last word
complete_words() {
    COMP_WORDS=("$@")
    COMP_CWORD=$(($# - 1))
    _tides
    printf '%s\n' "${COMPREPLY[@]}" | LC_ALL=C sort | tr '\n' ' '
}
offers() {
    local wanted=$1 given
    shift
    given=$(complete_words "$@")
    [ "$given" = "$wanted " ] || fail "\"$*\" offers \"$given\", not \"$wanted \""
}
offers "batch bench" tides b
offers "simulate" tides sim
offers "--checkpoint" tides simulate run.json --ch
offers "--json" tides info --js
offers "accuracy" tides bench acc
offers "cpu" tides devices --device c
offers "sensor.threshold_min= sensor.threshold_off= sensor.threshold_on= sensor.threshold_parity= sensor.threshold_sigma=" tides simulate --set sensor.thr
offers "smooth" tides simulate --set image.rules = sm
offers "gsplat inria smooth" tides simulate --set image.rules =
offers "metrics" tides help met
offers "balls" tides scene ba
offers "dsec" tides dataset run.json --layout ds
offers "surface" tides view e.h5 --kind s
offers "timelens" tides export e.h5 --style t
offers "voxel" tides export e.h5 --as v
offers "fano" tides metrics a.h5 b.h5 --only fa
offers "isi,fano" tides metrics a.h5 b.h5 --only isi,fa
offers "esim esim-fixed" tides compare run.json --methods es
offers "davis240 davis240-frames davis346 davis346-frames" tides simulate --set sensor.preset = dav
offers "esim" tides simulate --set method = es
touch events.h5 other.txt
mkdir folder
offers "events.h5" tides info ev
offers "folder" tides batch m.json -o f
for command in $(tides --help | sed -n 's/^  \([a-z]*\) .*/\1/p'); do
    for option in $(tides $command --help | grep -oE '^  (-[a-z], |    )--[a-z-]+' | grep -oE -- '--[a-z-]+'); do
        [[ " $(complete_words tides $command $option)" == *" $option "* ]] || fail "tides $command doesn't offer $option"
    done
done

expect 0 tides help --zsh
cp out _tides
head -n 1 _tides | grep -q '^#compdef tides$' || fail "no #compdef line"
if command -v zsh >/dev/null; then
    zsh -n _tides || fail "not a zsh script"
    # What is handed to zsh's own _arguments.
    expect 0 zsh -fc 'compdef() { :; }; _arguments() { print -rl -- "$@"; }; source ./_tides; words=(tides simulate -); CURRENT=3; _tides'
    out '^\*--set\[.*\]:KEY=VALUE:_tides_keys$'
    out '^--output\[.*\]:EVENTS.h5:_files$'
    out '^1:file:_files$'
    [ ! -s err ] || fail "zsh complains"
fi

# roff CHECK FILE: groff's warnings, and mandoc's errors where it is there.
sound() {
    if command -v groff >/dev/null; then
        groff -man -Tutf8 -ww -z "$1" >out 2>err || fail "groff failed"
        silent
    fi
    if command -v mandoc >/dev/null; then
        mandoc -Tlint -W error "$1" >out 2>err || fail "mandoc found errors"
    fi
}
expect 0 tides help --man
cp out page
out "^\.TH TIDES 1 "
sound page
for command in $(tides --help | sed -n 's/^  \([a-z]*\) .*/\1/p'); do
    grep -q "^.BR tides.-$command (1)" page || fail "tides.1 lacks $command"
    expect 0 tides help --man $command
    cp out $command.1
    for option in $(tides $command --help | grep -oE '^  (-[a-z], |    )--[a-z]+' | grep -oE '[a-z]+$'); do
        grep -q "fB..-..-\{0,1\}$option\|-$option" $command.1 || fail "tides-$command.1 lacks --$option"
    done
    sound $command.1
done
expect 0 tides help --man run
cp out run.5
sound run.5
for key in $(tides simulate --help-all | grep -oE '^  [a-z_]+(\.[a-z_0-9]+)* \[' | tr -d ' ['); do
    grep -qF "$key" run.5 || fail "tides-run.5 lacks $key"
done

refuse 2 "there is no page on simulat; did you mean simulate\?" tides help --man simulat
refuse 2 "help takes a command's name, or --man" tides help --fish
refuse 2 "--help=fish: give man, bash or zsh" tides simulate --help=fish

# Every type of a key has its words.
expect 0 tides help --man run
out 'center_surround.* \(list of two numbers'
