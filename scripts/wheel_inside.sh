# What check_wheel.sh does inside a chroot, as a user who has python3 and pip.     usage: sh -eu wheel_inside.sh WHEEL
cd
echo "packages of ours here: $(dpkg-query -W -f='${Package}\n' | grep -cE 'hdf5|openexr|cjson|libpng|ocl-icd|pocl|cairo' || true)"
started=$(date +%s)
python3 -m pip install -q --user --break-system-packages "./$1[cpu]"
installed=$(date +%s)
echo "pip install: $((installed - started)) s"
tides devices
tides devices | grep -q '^\* 0 *cpu' || { echo "no CPU device was found"; exit 1; }
python3 example.py
[ -s events.raw ] || { echo "README's example wrote no events.raw"; exit 1; }
tides demo -o demo -q
[ -s demo/events.h5 ] && [ -s demo/preview.png ] || { echo "the demo is incomplete"; exit 1; }
tides view demo/events.h5 -o view.svg -q 2>said
[ ! -s said ] || { echo "tides view says:" && cat said; exit 1; } # that there is no font, for one
taken=$(($(date +%s) - installed))
echo "devices, README's example, the demo and a view: $taken s"
times >used; echo "processor time of all so far, pip's too: $(tail -n 1 used)"
[ "$taken" -lt "${SECONDS_ALLOWED:-120}" ] || { echo "that is too long (SECONDS_ALLOWED, where others use the machine)"; exit 1; }

# Without the driver: what to do, in one line, and the reference device.
env OCL_ICD_VENDORS=/nonexistent tides render demo/run.json -o x.png 2>said && { echo "rendered without a device"; exit 1; }
cat said
grep -q 'apt install pocl-opencl-icd' said && [ "$(wc -l <said)" = 1 ]
env OCL_ICD_VENDORS=/nonexistent tides render demo/run.json --device reference --set camera.scale=0.1 -o x.png -q
man=.local/share/man/man1/tides.1
[ -s $man ] || { echo "no $man"; exit 1; }
python3 -m pip uninstall -q -y --break-system-packages tides
left=$(find .local -name '*tides*' | grep -v '\.cache' || true)
[ -z "$left" ] || { echo "uninstall left: $left"; exit 1; }
echo "ok"
