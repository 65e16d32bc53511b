/* Finds the stored value that means light 1. If the file's type tells it, that is used. Otherwise a range is assumed only if
 * no other one is possible, and a note reports it. */
#include "td_frames.h"

#include <math.h>
#include <stdlib.h>

/* Number of frames examined, spread over the sequence, so that a fade from black isn't taken for the whole. */
enum { LOOKS = 8 };

/* Floats up to BRIGHT have white at 1: scenes may be brighter than white, but hardly ever by more than 4 stops. Whole numbers
 * above BRIGHT, up to EIGHT_BITS, have white at 255. Only pictures darker than 6 % grey have all 8-bit values below BRIGHT. */
static const double BRIGHT = 16, EIGHT_BITS = 255;
/* Integers have white at their type's largest value if the largest stored one is at least this share of it. Values of 10, 12 or
 * 14 bits stored in 16 stay below; so do 16-bit pictures that are darker than half of sRGB's range. */
static const double FILLED = 0.25;

static tides_status fail_unknown(const tides_frames *frames, double largest, tides_error *error) {
    const char *kind = frames->most > 0 ? "its integers" : "its floats";
    char type[64] = "";
    if (frames->most > 0) snprintf(type, sizeof type, " of %.15g", frames->most);
    return td_fail(error, TIDES_BAD_CONFIG,
                   "%s: %s go up to %.9g%s, and which value is full scale isn't known: set frames.full_scale (1, 255, 1023, "
                   "4095, 65535 ...)",
                   frames->path, kind, frames->most > 0 ? rint(largest) : largest, type);
}

static tides_status look(tides_frames *frames, tides_error *error) {
    double *Y = td_alloc(td_frames_values(frames), sizeof *Y, error);
    if (!Y) return TIDES_NO_MEMORY;
    const size_t looks = frames->count < LOOKS ? frames->count : LOOKS;
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < looks && status == TIDES_OK; i++)
        status = frames->source->read(frames, looks > 1 ? i * (frames->count - 1) / (looks - 1) : 0, Y, error);
    free(Y);
    return status;
}

static tides_status decide_integers(tides_frames *frames, tides_error *error) {
    const double largest = frames->seen.largest;
    return largest > 0 && largest < FILLED * frames->most ? fail_unknown(frames, largest, error) : TIDES_OK;
}

/* Stores the note as one line, whatever characters the path has. */
static void note(tides_frames *frames, const char *kind) {
    snprintf(frames->note, sizeof frames->note,
             "%.200s: %s up to %.9g: full scale is taken to be %g (frames.full_scale says otherwise)", frames->path, kind,
             frames->seen.largest, frames->full > 0 ? frames->full : 1.0);
    for (char *c = frames->note; *c; c++)
        if ((unsigned char)*c < ' ') *c = '?';
}

static tides_status decide_floats(tides_frames *frames, tides_error *error) {
    const double largest = frames->seen.largest;
    const int whole = frames->seen.whole && largest > 1;
    frames->bound = BRIGHT;
    if (!(largest > 1)) return TIDES_OK;
    if (whole && largest > BRIGHT && largest <= EIGHT_BITS) {
        frames->full = frames->bound = EIGHT_BITS;
        note(frames, "floats, whole numbers");
        return TIDES_OK;
    }
    if (whole || largest > BRIGHT) return fail_unknown(frames, largest, error);
    note(frames, "floats");
    return TIDES_OK;
}

tides_status td_frames_range(tides_frames *frames, tides_error *error) {
    frames->full = frames->options.full_scale;
    frames->bound = INFINITY;
    if (frames->full > 0 && frames->most < 0)
        return td_fail(error, TIDES_BAD_CONFIG, "%s: a video says itself what its values are: leave out frames.full_scale",
                       frames->path);
    const int floats = !(frames->most < 0 || frames->most > 0), told = !floats && !(frames->most > EIGHT_BITS);
    if (frames->full > 0 || frames->options.planes > 1 || told) return TIDES_OK;
    frames->seen = (td_frame_seen){0, 1};
    const tides_status status = look(frames, error);
    if (status != TIDES_OK) return status;
    return frames->most > 0 ? decide_integers(frames, error) : decide_floats(frames, error);
}

tides_status td_frames_in_range(const tides_frames *frames, size_t index, tides_error *error) {
    if (!(frames->seen.largest > frames->bound)) return TIDES_OK;
    return td_fail(error, TIDES_BAD_CONFIG,
                   "%s: frame %zu has a value of %.9g, and others look as if %.9g were full scale: set frames.full_scale",
                   frames->path, index, frames->seen.largest, frames->full > 0 ? frames->full : 1.0);
}

const char *tides_frames_note(const tides_frames *frames) { return frames ? frames->note : ""; }
