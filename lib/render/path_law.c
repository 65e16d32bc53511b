/* Laws of what record paths do to what is looked up. */
#include "td_path_law.h"

#include <math.h>

/* -- counting -------------------------------------------------------------------------------------------------------------- */

static const int first_octave = -40; /* below a millionth of what paths may be off by */

static int bin_of(double off) {
    int octave;
    const double part = frexp(off, &octave); /* 0.5 to 1 */
    if (!(off > 0) || octave <= first_octave) return 0;
    const int bin = (octave - 1 - first_octave) * TD_TALLY_PARTS + (int)((2 * part - 1) * TD_TALLY_PARTS);
    return bin < TD_TALLY_BINS ? bin : TD_TALLY_BINS - 1;
}

static double end_of(int bin) {
    const int octave = bin / TD_TALLY_PARTS, part = bin % TD_TALLY_PARTS;
    return ldexp(1 + (part + 1.0) / TD_TALLY_PARTS, octave + first_octave);
}

void td_path_tally_add(td_path_tally *tally, double smooth, double off, double bent) {
    tally->splats++;
    tally->smooth[bin_of(smooth)]++;
    if (bent > 0) tally->bent[bin_of(off)] += bent;
}

/* -- the law --------------------------------------------------------------------------------------------------------------- */

/* What the share `most` of all are below. */
static double below(const double *count, double most) {
    double all = 0, passed = 0;
    for (int k = 0; k < TD_TALLY_BINS; k++) all += count[k];
    for (int k = 0; k < TD_TALLY_BINS && all > 0; k++) {
        passed += count[k];
        if (passed >= most * all) return end_of(k);
    }
    return 0;
}

/* Splats that decide what a pixel shows: with four the shares of events that see a kink come out as they are in the HexPlane
 * scenes of tests/property/test_solved_motions.c; half as many again, to be on the safe side. */
static const double splats_seen = 6;

/* A kink lies in one half of what is bent: the other half's cubic follows. */
static const double in_half = 0.5;

/* Laws add up in any order: shares are whole numbers of these. */
static const double unit = 1.0 / 1024;

/* What a splat is off by is told of where it changes pixels most, if it is as bright as what is seen there. A pixel sees
 * several, and one before black does more. Against the image itself at the times of the events of 55 scenes (grazing_world.h,
 * refine_world.h, test_solved_motions.c) p95 came out 2.4 to 3.9 times what it is in those where that is above 10 ns, but for
 * one of bright splats before black, of which it was 0.8; with 2.5 that one is honest, too, and sensors that hold are told 6.8
 * times what is true. */
static const double times[TD_PATH_SLICES] = {1.5, 1.75, 2}, times_kink = 2;

td_path_law td_path_tally_law(const td_path_tally *tally) {
    static const double slice_ends[TD_PATH_SLICES] = {0.5, 0.90625, 1}, kink_ends[TD_PATH_KINKS] = {0.75, 1};
    td_path_law law = {0};
    double bent = 0;
    if (!(tally->splats > 0)) return law;
    for (int k = 0; k < TD_TALLY_BINS; k++) bent += tally->bent[k];
    law.bent = ceil((1 - pow(1 - in_half * bent / tally->splats, splats_seen)) / unit) * unit;
    for (int k = 0; k < TD_PATH_SLICES; k++) law.smooth[k] = times[k] * below(tally->smooth, slice_ends[k]);
    for (int k = 0; k < TD_PATH_KINKS; k++) law.kink[k] = times_kink * below(tally->bent, kink_ends[k]);
    return law;
}

td_path_law td_path_law_worse(const td_path_law *a, const td_path_law *b) {
    td_path_law law = *a;
    law.bent = fmax(a->bent, b->bent);
    for (int k = 0; k < TD_PATH_SLICES; k++) law.smooth[k] = fmax(a->smooth[k], b->smooth[k]);
    for (int k = 0; k < TD_PATH_KINKS; k++) law.kink[k] = fmax(a->kink[k], b->kink[k]);
    return law;
}
