# Devices are listed; a name that matches none is an error that lists them.
unset TIDES_DEVICE
make_scene
expect 0 tides devices --device reference
out "^\* -     reference"
expect 0 tides devices --device reference --json
out '"kind":[[:space:]]*"reference"'
out '"vector_bits":[[:space:]]*[1-9]'
expect 0 tides devices --device reference
case $(uname -m) in
    x86_64) out "reference .*, vectors of (128 bits \(SSE\)|256 bits \(AVX\)|512 bits \(AVX-512\))" ;;
    aarch64) out "reference .*, vectors of 128 bits \(NEON\)" ;;
esac
refuse 1 "nosuchdevice.*reference" tides simulate run.json -o e.h5 --device nosuchdevice
refuse 1 "nosuchdevice.*reference" tides simulate run.json -o e.h5 --set device=nosuchdevice
TIDES_DEVICE=nosuchdevice refuse 1 "nosuchdevice.*reference" tides simulate run.json -o e.h5
expect 1 tides devices --device 77
err "77"
# The option wins over the environment.
export TIDES_DEVICE=nosuchdevice
expect 0 tides simulate run.json -qo e.h5 --device reference
