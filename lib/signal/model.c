/* The local model: parts of its cubic, for the sensor's filters, which follow a step piece by piece. What is read of it all the
 * time is inline in td_model.h. */
#include "td_model.h"

static double between(double a, double b, double t) { return (1 - t) * a + t * b; }

/* The polar form of the cubic: its value where all three places are one. */
static double blossom(const double b[4], double x, double y, double z) {
    double one[3] = {between(b[0], b[1], x), between(b[1], b[2], x), between(b[2], b[3], x)};
    return between(between(one[0], one[1], y), between(one[1], one[2], y), z);
}

td_model td_model_part(const td_model *model, double from, double to) {
    const double *b = model->control;
    return (td_model){
        {blossom(b, from, from, from), blossom(b, from, from, to), blossom(b, from, to, to), blossom(b, to, to, to)}};
}
