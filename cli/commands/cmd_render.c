/* tides render: writes one frame as EXR, and as a picture, with ground truth if asked for. */
#include "session.h"

#include <stdio.h>
#include <string.h>

/* The frame requested. */
typedef struct render_request {
    const char *run, *exr, *png, *time, *rectify;
    const char *truth;           /* names, separated by commas */
    const char *displacement_to; /* [s] */
    double to;
    int32_t rgb, depth, metres;
    int32_t truths; /* CLI_FRAME_TRUTH bits */
    cli_list sets;
} render_request;

#define TRUTH(name) (CLI_FRAME_TRUTH << TIDES_TRUTH_##name)

/* Names for --truth. */
static const struct truth_kind {
    const char *name;
    int32_t truths;
} truth_kinds[] = {
    {"flow", TRUTH(FLOW_U) | TRUTH(FLOW_V)},
    {"depth", TRUTH(DEPTH) | TRUTH(DEPTH_MEDIAN)},
    {"instance", TRUTH(INSTANCE)},
    {"normal", TRUTH(NORMAL_X) | TRUTH(NORMAL_Y) | TRUTH(NORMAL_Z)},
    {"all", (CLI_FRAME_TRUTH << TIDES_TRUTHS) - CLI_FRAME_TRUTH},
};
enum { TRUTH_KINDS = sizeof truth_kinds / sizeof *truth_kinds };

/* The planes that --truth names. */
static int parse_truth(const cli_command *command, render_request *request) {
    for (const char *at = request->truth; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL) {
        const size_t length = strcspn(at, ",");
        int kind = 0;
        while (kind < TRUTH_KINDS &&
               !(strlen(truth_kinds[kind].name) == length && strncmp(truth_kinds[kind].name, at, length) == 0))
            kind++;
        if (kind == TRUTH_KINDS)
            return cli_usage(command, "--truth %s: '%.*s' is none of flow, depth, instance, normal, all", request->truth,
                             (int)length, at);
        request->truths |= truth_kinds[kind].truths;
    }
    if (request->metres && !(request->truths & TRUTH(DEPTH)))
        return cli_usage(command, "--metres says what depths are in: --truth depth asks for them");
    return CLI_GO;
}

static cJSON *facts_of(const tides_session_facts *session, double time, const render_request *request) {
    cJSON *facts = cJSON_CreateObject();
    cJSON_AddNumberToObject(facts, "time_s", time);
    cJSON_AddNumberToObject(facts, "width", session->intrinsics.width);
    cJSON_AddNumberToObject(facts, "height", session->intrinsics.height);
    cJSON_AddStringToObject(facts, "device", session->info.name);
    if (request->exr) cJSON_AddStringToObject(facts, "exr", request->exr);
    if (request->png) cJSON_AddStringToObject(facts, "png", request->png);
    if (request->rectify) cJSON_AddStringToObject(facts, "rectify", request->rectify);
    return facts;
}

/* 1 where no pixel sees anything of the scene. */
static int32_t is_empty(const cli_frame *frame) {
    const size_t pixels = (size_t)frame->width * (size_t)frame->height;
    size_t i = 0;
    while (i < pixels && !(frame->plane[TIDES_COVERAGE][i] > 0)) i++;
    return i == pixels;
}

static tides_status render(tides_session *session, const tides_session_facts *facts, double time, const render_request *request,
                           const cli_common *common, tides_error *error) {
    cli_progress progress = {.quiet = common->quiet};
    cli_frame frame;
    if (request->rectify) {
        tides_intrinsics flat = facts->intrinsics;
        flat.lens = (tides_lens){.model = TIDES_LENS_NONE};
        const tides_status saved = tides_rectify_save(request->rectify, &facts->intrinsics, &flat, NULL, error);
        if (saved != TIDES_OK || (!request->exr && !request->png)) return saved;
    }
    const int32_t wanted = (request->rgb ? CLI_FRAME_RGB : 0) | (request->depth ? CLI_FRAME_DEPTH : 0) | request->truths |
                           (request->displacement_to ? CLI_FRAME_DISPLACEMENT : 0);
    frame.displacement_to = request->to;
    cli_catch_interrupt();
    tides_status status = cli_frame_render(session, time, wanted, &progress, &frame, error);
    cli_progress_end(&progress);
    if (status != TIDES_OK) return status;
    if (!common->quiet && is_empty(&frame))
        fprintf(stderr, "tides: nothing of the scene is in view at %.15g s: another --time, path or camera.up may show it\n",
                time);
    if (request->metres) cli_frame_to_metres(&frame, facts->values.metres_per_unit);
    if (request->exr) status = cli_frame_write_exr(&frame, request->exr, time, facts, error);
    if (status == TIDES_OK && request->png) status = cli_preview_write(request->png, &frame, NULL, error);
    cli_frame_free(&frame);
    return status;
}

/* Checks outputs by their names' endings; -o may name a picture too. */
static int check_outputs(const cli_command *command, render_request *request) {
    if (request->exr && !request->png && cli_ends_in(request->exr, ".png")) {
        request->png = request->exr;
        request->exr = NULL;
        request->rgb = 1;
    }
    if (!request->exr && !request->png && !request->rectify)
        return cli_usage(command, "the output is missing: -o OUT.exr, or --png OUT.png");
    if (request->rectify && !cli_ends_in(request->rectify, ".npy"))
        return cli_usage(command, "--rectify %s: should end in .npy, for it is an array of float32", request->rectify);
    if (request->exr && !cli_ends_in(request->exr, ".exr"))
        return cli_usage(command, "-o %s: should end in .exr, for it is written as OpenEXR, or in .png, for a picture",
                         request->exr);
    if (request->png && !cli_ends_in(request->png, ".png"))
        return cli_usage(command, "--png %s: should end in .png, for it is written as PNG; -o OUT.exr keeps floats",
                         request->png);
    return CLI_GO;
}

int cmd_render(const cli_command *command, int argc, char **argv) {
    cli_common common;
    render_request request = {.run = NULL};
    const cli_option options[] = {
        {"--time", 't', "T", "time of the frame [s]; time.start where not given", NULL, &request.time, NULL},
        {"--output", 'o', "OUT.exr", "float channels as OpenEXR; OUT.png: as --png", NULL, &request.exr, NULL},
        {"--png", 0, "OUT.png", "picture of Y and L_dot side by side", NULL, &request.png, NULL},
        {"--rgb", 0, NULL, "render colour too", &request.rgb, NULL, NULL},
        {"--depth", 0, NULL, "render depth too", &request.depth, NULL, NULL},
        {"--truth", 0, "NAMES", "ground truth too: flow, depth, instance, normal (separated by commas), or all", NULL,
         &request.truth, NULL},
        {"--displacement-to", 0, "T", "where what is seen will be at T, or was [s]: displacement [px], and whether it is seen",
         NULL, &request.displacement_to, NULL},
        {"--metres", 0, NULL, "its depths in metres, as scene.metres_per_unit says", &request.metres, NULL, NULL},
        {"--rectify", 0, "MAP.npy",
         "where each pixel would be without the lens: (height, width, 2) of float32, centres at whole px", NULL,
         &request.rectify, NULL},
        {"--set", 0, "KEY=VALUE", "override a key of the run file; may be repeated", NULL, NULL, &request.sets},
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &request.run);
    if (code != CLI_GO) return code;
    if ((code = check_outputs(command, &request)) != CLI_GO) return code;
    if ((code = parse_truth(command, &request)) != CLI_GO) return code;
    double time = 0;
    if (request.displacement_to &&
        (code = cli_number(command, "--displacement-to", request.displacement_to, &request.to)) != CLI_GO)
        return code;
    if (request.time && (code = cli_number(command, "--time", request.time, &time)) != CLI_GO) return code;

    tides_error error = {TIDES_OK, ""};
    tides_session *session = NULL;
    tides_session_facts facts;
    const cli_output written[] = {{request.exr, NULL}, {request.png, NULL}, {request.rectify, NULL}};
    if (cli_session_open(request.run, &request.sets, &common, written, 3, &session, &error) != TIDES_OK)
        return cli_fail(&error);
    tides_session_get(session, &facts);
    if (facts.frames) {
        tides_session_close(session);
        return cli_failed("%s: the run has frames.file and no scene to render", request.run);
    }
    if (!request.time) time = facts.values.start;
    if (request.metres && !(facts.values.metres_per_unit > 0))
        code = cli_failed("%s: --metres: how long a unit of the scene is isn't known: set scene.metres_per_unit", request.run);
    else if (render(session, &facts, time, &request, &common, &error) != TIDES_OK)
        code = cli_fail(&error);
    else
        code = cli_report_facts(facts_of(&facts, time, &request), &common);
    tides_session_close(session);
    return code;
}
