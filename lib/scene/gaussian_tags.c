/* Facts about an object's Gaussians: how they were trained, and how their composited colours code light. */
#include "td_base.h"
#include "td_scene.h"
#include "td_text.h"

#include <stdio.h>
#include <string.h>

int32_t td_trained_join(int32_t a, int32_t b) {
    if (a == TIDES_TRAINED_UNKNOWN || a == b) return b;
    return b == TIDES_TRAINED_UNKNOWN ? a : TIDES_TRAINED_MIXED;
}

/* Allowed exponents of gamma. The kernels need a convex decoding curve, so the least is 1. */
static const double least_gamma = 1, most_gamma = 5;

tides_status td_transfer_check(const char *what, int32_t transfer, double gamma, tides_error *error) {
    if (transfer < TIDES_TRANSFER_LINEAR || transfer > TIDES_TRANSFER_GAMMA)
        return td_fail(error, TIDES_BAD_ARGUMENT, "%stransfer: %d is none of TIDES_TRANSFER_*", what, (int)transfer);
    if (transfer == TIDES_TRANSFER_GAMMA && !(gamma >= least_gamma && gamma <= most_gamma))
        return td_fail(error, TIDES_BAD_ARGUMENT, "%sgamma: %g is out of range; it must lie in [%g, %g]", what, gamma,
                       least_gamma, most_gamma);
    return TIDES_OK;
}

/* Writes the transfer as text; the exponent has as few digits as give it exactly. */
void td_transfer_say(int32_t transfer, double gamma, char text[TD_TRANSFER_TEXT]) {
    if (transfer == TIDES_TRANSFER_GAMMA)
        snprintf(text, TD_TRANSFER_TEXT, "gamma %s", TD_SHORT(gamma));
    else
        snprintf(text, TD_TRANSFER_TEXT, "%s", tides_transfer_name(transfer));
}

tides_status td_transfer_read(const char *where, const char *text, td_gaussians *gaussians, tides_error *error) {
    char word[16] = "", rest[2];
    td_plain_numbers numbers;
    tides_status status = td_plain_begin(&numbers, where, error);
    if (status != TIDES_OK) return status;
    double gamma = 1;
    const int read = sscanf(text, "%15s %lf %1s", word, &gamma, rest);
    td_plain_end(&numbers);
    int32_t transfer = TIDES_TRANSFER_GAMMA;
    while (transfer >= 0 && strcmp(word, tides_transfer_name(transfer)) != 0) transfer--;
    const int wanted = transfer == TIDES_TRANSFER_GAMMA ? 2 : 1;
    if (transfer < 0 || read != wanted || td_transfer_check("", transfer, gamma, NULL) != TIDES_OK)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s is \"%.40s\": should be linear, srgb, or gamma and an exponent from %g to %g, as in \"gamma 2.2\"",
                       where, text, least_gamma, most_gamma);
    td_gaussians_tag(gaussians, transfer, gamma);
    return TIDES_OK;
}
