/* `tides view` shows events as a picture, as an animation of pictures, or as a page (view_page.c). It shows ground truth, too
 * (view_truth.c). */
#include "recording.h"
#include "view.h"
#include "view_page.h"
#include "view_truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const struct kind {
    const char *name;
    view_drawer draw;
    int32_t windows; /* what a picture shows by default, 1: a short window, 0: all events */
    int32_t animates;
} kinds[] = {{"frame", view_frame, 1, 1},
             {"surface", view_surface, 1, 1},
             {"xyt", view_xyt, 0, 1},
             {"rate", view_rate, 0, 0},
             {"isi", view_isi, 0, 0}};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

/* Defaults of --window and --fps. In 10 ms, most recordings have many events and their edges are still sharp. Windows of 10
 * ms at 25 pictures a second play at a quarter of real time. */
#define WINDOW_S 0.01
#define PICTURES_PER_SECOND 25.0

/* Texts of options on the command line; NULL for an option that isn't given. */
typedef struct arguments {
    const char *kind, *time, *decay, *bin, *scale, *azimuth, *elevation, *fps, *points, *theme, *most;
} arguments;

typedef struct job {
    const cli_common *common;
    const struct kind *kind;
    view view;
    cli_stretch stretch;
    const char *out;
    int32_t animate, to_stdout;
    double pictures_per_second;
    int64_t time_ns;
    int32_t has_time;

    cli_window recording;
    uint64_t pictures, events; /* pictures drawn so far; events in the stretch that they show */
    int32_t width, height;
} job;

/* ---- the command line ---- */

static int parse_kind(const cli_command *command, const char *name, job *j) {
    const char *names[KINDS + 2] = {NULL};
    names[KINDS] = "truth"; /* names of kinds; the last is for files of ground truth */
    for (size_t i = 0; i < KINDS; i++) {
        names[i] = kinds[i].name;
        if (strcmp(name ? name : "frame", kinds[i].name) != 0) continue;
        j->kind = &kinds[i];
        return CLI_GO;
    }
    const char *nearest = tides_nearest_name(name, names);
    if (nearest) return cli_usage(command, "--kind %s: did you mean %s?", name, nearest);
    return cli_usage(command, "--kind %s: should be frame, surface, xyt, rate, isi or truth", name);
}

/* Parses an option's number, which must be in [low, high]. If the option isn't given (`text` is NULL), `number` keeps its
 * value. */
static int number_in(const cli_command *command, const char *option, const char *text, double low, double high,
                     double *number) {
    if (!text) return CLI_GO;
    const int code = cli_number(command, option, text, number);
    if (code != CLI_GO || (*number >= low && *number <= high)) return code;
    return cli_usage(command, "%s %s: should be %g to %g", option, text, low, high);
}

/* Finds out from the output's name whether it is an animation (a video, or numbered pictures) or a single picture, and rejects
 * options that don't fit. A .png is a single picture unless --animate is given. */
static int parse_output(const cli_command *command, const char *fps, const char *most, job *j) {
    if (!j->out) return cli_usage(command, "say where the picture goes: -o OUT.png");
    j->to_stdout = strcmp(j->out, "-") == 0;
    if (j->to_stdout && isatty(STDOUT_FILENO))
        return cli_usage(command, "-o - writes video to standard output: pipe it, e.g. into ffmpeg -i - OUT.mp4");
    if (j->to_stdout || cli_ends_in(j->out, ".y4m") || cli_ends_in(j->out, ".apng") || strchr(j->out, '%')) j->animate = 1;
    if (!j->animate && !j->view.style.shapes && !cli_ends_in(j->out, ".png"))
        return cli_usage(command,
                         "-o %s: pictures are written as .png, .svg or .pdf, pages as .html, videos as .y4m or - (for ffmpeg), "
                         "or frame%%04d.png",
                         j->out);
    if (j->animate && j->view.style.shapes)
        return cli_usage(command, "-o %s: what moves is written as .png, .apng, .y4m or - (for ffmpeg)", j->out);
    if (j->animate && !j->kind->animates) return cli_usage(command, "a picture of --kind %s doesn't move", j->kind->name);
    if (j->animate && j->has_time) return cli_usage(command, "--time is for one picture: give --start and --stop");
    if (most) return cli_usage(command, "--max-events is for a page: -o OUT.html");
    if (!j->animate && (fps || j->stretch.step_text)) return cli_usage(command, "--fps and --step are for --animate");
    return CLI_GO;
}

static int parse_look(const cli_command *command, const arguments *given, job *j) {
    view *v = &j->view;
    double scale = 0, points = 0;
    int code = number_in(command, "--decay", given->decay, 1e-9, 1e6, &v->decay_s);
    if (code == CLI_GO) code = number_in(command, "--bin", given->bin, 1e-9, 1e6, &v->bin_s);
    if (code == CLI_GO) code = number_in(command, "--scale", given->scale, 1, 32, &scale);
    if (code == CLI_GO) code = number_in(command, "--azimuth", given->azimuth, -180, 180, &v->azimuth_deg);
    if (code == CLI_GO) code = number_in(command, "--elevation", given->elevation, -89, 89, &v->elevation_deg);
    if (code == CLI_GO) code = number_in(command, "--points", given->points, 1, 1e8, &points);
    if (code == CLI_GO) code = number_in(command, "--fps", given->fps, 0.02, 1000, &j->pictures_per_second);
    if (code != CLI_GO) return code;
    if (scale != floor(scale)) return cli_usage(command, "--scale %s: should be a whole number", given->scale);
    v->scale = (int32_t)scale;
    v->points = (size_t)points;
    if (v->points && j->kind->draw != view_xyt) return cli_usage(command, "--points is for --kind xyt");
    if ((v->plain || v->scale) && j->kind->draw != view_frame && j->kind->draw != view_surface)
        return cli_usage(command, "--plain and --scale are for --kind frame and surface");
    return CLI_GO;
}

static int parse(const cli_command *command, const arguments *given, job *j) {
    double time_s = 0;
    int code = parse_kind(command, given->kind, j);
    if (code == CLI_GO) code = number_in(command, "--time", given->time, -2e9, 2e9, &time_s);
    if (code == CLI_GO && given->time) code = cli_time(command, "--time", given->time, &j->time_ns);
    j->has_time = given->time != NULL;
    if (code == CLI_GO) code = parse_look(command, given, j);
    if (code == CLI_GO) code = cli_stretch_parse(command, &j->stretch);
    if (code == CLI_GO) code = parse_output(command, given->fps, given->most, j);
    if (j->kind && j->kind->draw == view_surface) j->stretch.before_ns = view_surface_memory(&j->view);
    if (code == CLI_GO && j->has_time && (j->stretch.start_text || j->stretch.stop_text))
        code = cli_usage(command, "give --time and --window, or --start and --stop");
    return code;
}

/* Parses the options of a page. Options for the looks of a picture are rejected: a page has controls for them. */
static int parse_page(const cli_command *command, const arguments *given, job *j) {
    const arguments *g = given;
    if (g->kind || g->time || g->decay || g->bin || g->scale || g->azimuth || g->elevation || g->fps || g->points || g->theme ||
        j->stretch.step_text || j->animate || j->view.plain)
        return cli_usage(command,
                         "-o %s: a page takes --start, --stop, --window, --max-events and how the file is read; its looks are "
                         "chosen in it",
                         j->out);
    return cli_stretch_parse(command, &j->stretch);
}

/* ---- the pictures ---- */

static int64_t window_of(const job *j) {
    return j->stretch.window_ns ? j->stretch.window_ns : (int64_t)llround(1e9 * WINDOW_S);
}

/* The events of a single picture. With --time, these are the window that ends there. Otherwise the stretch is from --start
 * to --stop, by default the whole recording. The picture has all of it or one window: at --start, else before --stop, else
 * in the middle. */
static cli_window shown_once(const job *j) {
    const cli_stretch *s = &j->stretch;
    int64_t first = s->start_ns, stop = s->stop_ns;
    const int64_t window = window_of(j), spare = stop - first - window;
    if (j->has_time) {
        first = j->time_ns - window;
        stop = j->time_ns;
    } else if (spare > 0 && (s->window_ns || (j->kind->windows && !(s->start_text && s->stop_text)))) {
        first += s->start_text ? 0 : s->stop_text ? spare : spare / 2;
        stop = first + window;
    }
    return cli_window_slice(&j->recording, first, stop);
}

static tides_status draw(job *j, const cli_window *shown, cli_canvas *canvas, tides_error *error) {
    const int32_t drawn = j->kind->draw(&j->view, &j->recording, shown, canvas);
    j->width = canvas->width;
    j->height = canvas->height;
    j->pictures++;
    return drawn ? TIDES_OK : cli_error(error, TIDES_NO_MEMORY, "out of memory: a picture for %s", j->out);
}

static tides_status make_picture(job *j, tides_error *error) {
    const cli_window shown = shown_once(j);
    cli_canvas canvas = {.cairo = NULL};
    j->stretch.start_ns = shown.first_ns;
    j->stretch.stop_ns = shown.stop_ns;
    j->events = shown.count;
    tides_status status = draw(j, &shown, &canvas, error);
    if (status == TIDES_OK) status = canvas_write(&canvas, j->out, error);
    canvas_free(&canvas);
    return status;
}

/* Draws picture number j->pictures and appends it to the animation. The first picture opens the animation, because its size is
 * that of all pictures. */
static tides_status add_picture(job *j, const cli_window *shown, tides_animation **animation, tides_error *error) {
    cli_canvas canvas = {.cairo = NULL};
    tides_status status = draw(j, shown, &canvas, error);
    uint8_t *rgb = status == TIDES_OK ? canvas_pixels(&canvas, error) : NULL;
    canvas_free(&canvas);
    if (!rgb) return error->status;
    if (!*animation && j->to_stdout)
        status = tides_animation_stream(STDOUT_FILENO, canvas.width, canvas.height, j->pictures_per_second, animation, error);
    else if (!*animation)
        status = tides_animation_open(j->out, canvas.width, canvas.height, j->pictures_per_second, animation, error);
    if (status == TIDES_OK) status = tides_animation_append(*animation, rgb, error);
    free(rgb);
    return status;
}

/* Appends one picture for each window; windows begin a step apart. A recording without events gets one picture. */
static tides_status add_pictures(job *j, tides_animation **animation, tides_error *error) {
    const cli_stretch *s = &j->stretch;
    const int64_t window = window_of(j), step = s->step_ns;
    cli_progress progress = {.quiet = j->common->quiet};
    tides_status status = TIDES_OK;
    for (int64_t first = s->start_ns; status == TIDES_OK && (first == s->start_ns || first < s->stop_ns); first += step) {
        const cli_window shown = cli_window_slice(&j->recording, first, first + window);
        status = add_picture(j, &shown, animation, error);
        const double done = (double)(first + step - s->start_ns) / ((double)(s->stop_ns - s->start_ns) + 1);
        if (status == TIDES_OK && cli_progress_step(&progress, done, "drawing") != 0)
            status = cli_error(error, TIDES_CANCELLED, "%s: interrupted", j->out);
    }
    cli_progress_end(&progress);
    return status;
}

static tides_status make_animation(job *j, tides_error *error) {
    tides_animation *animation = NULL;
    const tides_status status = add_pictures(j, &animation, error);
    j->events = cli_window_slice(&j->recording, j->stretch.start_ns, j->stretch.stop_ns).count;
    if (status == TIDES_OK) return tides_animation_finish(animation, error);
    tides_animation_abandon(animation);
    return status;
}

/* ---- the command ---- */

/* Reads the events and draws them. With --time the whole recording is read, because --start and --stop can't be given then. The
 * window that --time ends must overlap the recording. */
static tides_status run(job *j, tides_error *error) {
    const cli_output written = {j->to_stdout ? NULL : j->out, NULL};
    tides_status status = cli_check_outputs(j->stretch.file, &written, 1, error);
    if (j->animate) j->stretch.windows_most = CLI_WINDOWS_MOST;
    if (j->animate && !j->stretch.step_ns) j->stretch.step_ns = window_of(j);
    if (status == TIDES_OK) status = cli_stretch_read(&j->stretch, &j->recording, error);
    if (status == TIDES_OK && j->has_time)
        status = cli_window_check(j->stretch.file, &j->recording, j->time_ns - window_of(j), j->time_ns, error);
    if (status != TIDES_OK) return status;
    cli_reading_tell(j->common, j->stretch.file, &j->recording.facts, j->stretch.how.rebase);
    return j->animate ? make_animation(j, error) : make_picture(j, error);
}

static int report(const job *j) {
    if (j->to_stdout || (j->common->quiet && !j->common->json)) return CLI_OK;
    if (!j->common->json) {
        char events[24];
        printf("%s: %llu picture%s of %d x %d px, %s events\n", j->out, (unsigned long long)j->pictures,
               j->pictures == 1 ? "" : "s", j->width, j->height, cli_count((double)j->events, events));
        return CLI_OK;
    }
    cJSON *facts = cJSON_CreateObject();
    cJSON_AddStringToObject(facts, "file", j->out);
    cJSON_AddStringToObject(facts, "kind", j->kind->name);
    cJSON_AddNumberToObject(facts, "pictures", (double)j->pictures);
    cJSON_AddNumberToObject(facts, "width", j->width);
    cJSON_AddNumberToObject(facts, "height", j->height);
    cJSON_AddNumberToObject(facts, "events", (double)j->events);
    cli_add_ns(facts, "start_ns", j->stretch.start_ns);
    cli_add_ns(facts, "stop_ns", j->stretch.stop_ns);
    return cli_print_facts(facts, 1);
}

int cmd_view(const cli_command *command, int argc, char **argv) {
    cli_common common;
    arguments given = {.kind = NULL};
    /* A surface fades to exp(-1) within decay_s; 30 ms is the value of HOTS. The eye of --kind xyt is where all three axes
     * show. */
    job j = {.common = &common,
             .view = {.decay_s = 0.03, .azimuth_deg = VIEW_AZIMUTH_DEG, .elevation_deg = VIEW_ELEVATION_DEG},
             .pictures_per_second = PICTURES_PER_SECOND};
    const cli_option options[] = {
        {"--output", 'o', "FILE",
         "OUT.png, .svg, .pdf; moving: .apng, .y4m, frame%04d.png, - (video to a pipe); a page: OUT.html", NULL, &j.out, NULL},
        {"--kind", 0, "frame|surface|xyt|rate|isi|truth", "what to show (frame; truth is of .exr and .png)", NULL, &given.kind,
         NULL},
        {"--time", 0, "SECONDS", "one picture: its window ends here (the window in the middle)", NULL, &given.time, NULL},
        {"--window", 0, "SECONDS", "how much a picture shows (frame, moving: 0.01; others all), a page at first", NULL,
         &j.stretch.window_text, NULL},
        {"--start", 0, "SECONDS", "show events from here on (the first)", NULL, &j.stretch.start_text, NULL},
        {"--stop", 0, "SECONDS", "show events before this time (the last)", NULL, &j.stretch.stop_text, NULL},
        {"--animate", 0, NULL, "OUT.png moves: a picture for each window", &j.animate, NULL, NULL},
        {"--step", 0, "SECONDS", "moving: from the start of a window to that of the next (the window)", NULL,
         &j.stretch.step_text, NULL},
        {"--fps", 0, "N", "moving: pictures a second (25)", NULL, &given.fps, NULL},
        {"--decay", 0, "SECONDS", "surface: time constant (0.03)", NULL, &given.decay, NULL},
        {"--bin", 0, "SECONDS", "rate: length of a bin (about a 200th of what is shown)", NULL, &given.bin, NULL},
        {"--plain", 0, NULL, "frame, surface: pixels alone, without axes", &j.view.plain, NULL, NULL},
        {"--scale", 0, "N", "frame, surface: enlarge N times (to a comfortable size; plain 1)", NULL, &given.scale, NULL},
        {"--azimuth", 0, "DEGREES", "xyt: the eye's angle from the axis of time (58)", NULL, &given.azimuth, NULL},
        {"--elevation", 0, "DEGREES", "xyt: and above it (18)", NULL, &given.elevation, NULL},
        {"--points", 0, "N", "xyt: at most so many events are drawn (400000; .svg, .pdf 8000)", NULL, &given.points, NULL},
        {"--theme", 0, "THEME", CANVAS_THEME_HELP, NULL, &given.theme, NULL},
        {"--max-events", 0, "N", "page: the recording's first so many (1e7)", NULL, &given.most, NULL},
        CLI_READING_FILE(j.stretch.reading),
        CLI_READING_CLOCK(j.stretch.reading),
        {NULL, 0, NULL, NULL, NULL, NULL, NULL},
    };
    int code = cli_parse(command, options, argc, argv, &common, &j.stretch.file);
    if (code == CLI_GO) code = canvas_parse_theme(command, given.theme, &j.view.style);
    j.view.style.shapes = j.out && canvas_wants_shapes(j.out);
    if (code == CLI_GO && view_is_truth(given.kind, j.stretch.file))
        return view_truth(command, j.stretch.file, &j.view.style, j.out, &common);
    const int page = j.out && cli_ends_in(j.out, ".html");
    if (code == CLI_GO) code = page ? parse_page(command, &given, &j) : parse(command, &given, &j);
    if (code != CLI_GO) return code;
    tides_error error = {TIDES_OK, ""};
    cli_catch_interrupt();
    if (page) return view_page(command, &j.stretch, given.most, j.out, &common);
    code = run(&j, &error) == TIDES_OK ? report(&j) : cli_fail(&error);
    free(j.recording.events);
    return code;
}
