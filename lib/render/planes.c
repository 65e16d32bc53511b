/* Planes of images and of ground truth: their public names, and their indices in a backend's output. */
#include "td_renderer.h"
#include "tides/truth.h"

#include <string.h>

/* Each channel's name, and its index among a backend's planes. */
static const struct channel {
    const char *name;
    int plane;
} channels[TIDES_CHANNELS] = {{"Y", TD_OUT_Y},
                              {"L", TD_OUT_L},
                              {"L_dot", TD_OUT_L_DOT},
                              {"A", TD_OUT_ALPHA},
                              {"A_dot", TD_OUT_ALPHA_DOT},
                              {"coverage", TD_OUT_COVERAGE},
                              {"contributors", TD_OUT_CONTRIBUTORS},
                              {"R", TD_OUT_R},
                              {"G", TD_OUT_G},
                              {"B", TD_OUT_B},
                              {"R_dot", TD_OUT_R_DOT},
                              {"G_dot", TD_OUT_G_DOT},
                              {"B_dot", TD_OUT_B_DOT},
                              {"Z", TD_OUT_Z},
                              {"Z_dot", TD_OUT_Z_DOT}};

const char *tides_channel_name(int32_t channel) {
    return channel >= 0 && channel < TIDES_CHANNELS ? channels[channel].name : NULL;
}

int td_plane_of_channel(int channel) { return channels[channel].plane; }

const char *td_plane_name(int plane) {
    for (int c = 0; c < TIDES_CHANNELS; c++)
        if (channels[c].plane == plane) return channels[c].name;
    return NULL;
}

/* Each ground truth's name, and its index among a backend's planes. */
static const struct truth {
    const char *name;
    int plane;
} truths[TIDES_TRUTHS] = {{"flow_u", TD_TRUTH_U},    {"flow_v", TD_TRUTH_V},
                          {"depth", TD_TRUTH_DEPTH}, {"depth_median", TD_TRUTH_MEDIAN},
                          {"alpha", TD_TRUTH_ALPHA}, {"instance", TD_TRUTH_INSTANCE},
                          {"normal_x", TD_TRUTH_NX}, {"normal_y", TD_TRUTH_NY},
                          {"normal_z", TD_TRUTH_NZ}};

const char *tides_truth_name(int32_t truth) { return truth >= 0 && truth < TIDES_TRUTHS ? truths[truth].name : NULL; }

int td_plane_of_truth(int truth) { return truths[truth].plane; }

const char *td_truth_name(int plane) {
    for (int i = 0; i < TIDES_TRUTHS; i++)
        if (truths[i].plane == plane) return truths[i].name;
    return "splat";
}

void td_truth_of_nothing(double *planes) {
    memset(planes, 0, TD_OUT_TRUTH * sizeof *planes);
    planes[TD_TRUTH_INSTANCE] = planes[TD_TRUTH_SPLAT] = -1;
}
