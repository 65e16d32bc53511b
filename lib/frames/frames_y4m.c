/* Frames of a YUV4MPEG2 video (mjpegtools), which `ffmpeg -f yuv4mpegpipe` writes: from a .y4m file, a pipe or the standard
 * input. A pipe is copied to an unnamed temporary file, since the number of frames is known only at its end.
 *
 * Y', Cb, Cr become R', G', B' by BT.601, the format's only matrix. Subsampled chroma is taken from the nearest sample.
 * frames.transfer tells how R', G', B' code light: "srgb" for videos of cameras and ffmpeg. */
#include "td_frames.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { LINE_MAX_BYTES = 1024, COPY_BYTES = 1 << 16 };
static const char magic[] = "YUV4MPEG2";

typedef struct video {
    FILE *file;
    int32_t is_own; /* 0: the standard input */
    int32_t width, height, depth;
    int32_t across, down; /* log2 of luma samples per chroma sample */
    int32_t is_mono, is_full;
    uint64_t rate, scale; /* rate frames in scale seconds */
    off_t *at;            /* (count) byte offset of each frame's samples */
    size_t count, capacity, bytes;
    unsigned char *samples; /* (bytes) a frame as stored */
    float *values;          /* (height x width x channels) the frame in R', G', B', or in grey */
} video;

static void close_video(void *state) {
    video *v = state;
    if (v->file && v->is_own) fclose(v->file);
    free(v->at);
    free(v->samples);
    free(v->values);
    free(v);
}

static const char *name_of(const tides_frames *frames) { return strcmp(frames->path, "-") ? frames->path : "standard input"; }

/* -- the header ----------------------------------------------------------------------------------------------------- */

/* Reads a line without its end: 1; 0 if the file ends; 2 if the line is too long or has no end. */
static int read_text(FILE *file, char line[LINE_MAX_BYTES]) {
    size_t length = 0;
    for (int c = getc(file); c != '\n'; c = getc(file)) {
        if (c == EOF) return length ? 2 : 0;
        if (length + 1 == LINE_MAX_BYTES) return 2;
        line[length++] = (char)c;
    }
    line[length] = '\0';
    return 1;
}

static int read_whole(const char *text, uint64_t most, uint64_t *value, const char **rest) {
    char *end;
    if (!isdigit((unsigned char)*text)) return 0;
    *value = strtoull(text, &end, 10);
    *rest = end;
    return *value >= 1 && *value <= most;
}

/* Parses the sampling of chroma and the bits: "420jpeg", "422p10", "mono12". */
static int read_sampling(const char *text, video *v) {
    static const struct {
        const char *name;
        int32_t across, down, mono;
    } known[] = {{"420jpeg", 1, 1, 0}, {"420mpeg2", 1, 1, 0}, {"420paldv", 1, 1, 0}, {"420", 1, 1, 0},
                 {"422", 1, 0, 0},     {"444", 0, 0, 0},      {"411", 2, 0, 0},      {"mono", 0, 0, 1}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        const size_t length = strlen(known[i].name);
        if (strncmp(text, known[i].name, length) != 0) continue;
        const char *bits = text + length, *rest = bits;
        uint64_t depth = 8;
        if (*bits == 'p' && !known[i].mono) bits++;
        if (*bits && (!read_whole(bits, 16, &depth, &rest) || depth < 8)) continue;
        if (*rest) continue;
        v->across = known[i].across;
        v->down = known[i].down;
        v->is_mono = known[i].mono;
        v->depth = (int32_t)depth;
        return 1;
    }
    return 0;
}

/* Parses a header field such as "W640". Unknown fields are skipped, as they don't affect the samples. */
static const char *read_field(const char *field, video *v) {
    const char *rest = "";
    uint64_t value = 0;
    switch (field[0]) {
        case 'W':
        case 'H':
            if (!read_whole(field + 1, TD_FRAME_SIDE_MAX, &value, &rest) || *rest) return "its size isn't from 1 to 16384 px";
            *(field[0] == 'W' ? &v->width : &v->height) = (int32_t)value;
            return NULL;
        case 'F':
            if (!read_whole(field + 1, UINT32_MAX, &v->rate, &rest) || *rest != ':' ||
                !read_whole(rest + 1, UINT32_MAX, &v->scale, &rest) || *rest)
                return "its frame rate isn't two numbers above 0, as in F30:1; give ffmpeg -r";
            return NULL;
        case 'I':
            return strchr("p?", field[1]) ? NULL : "it is interlaced; have ffmpeg make whole frames of it, with -vf yadif";
        case 'C':
            return read_sampling(field + 1, v)
                       ? NULL
                       : "its samples are of a kind that isn't known here; give ffmpeg -pix_fmt yuv420p";
        case 'X':
            if (strcmp(field, "XCOLORRANGE=FULL") == 0) v->is_full = 1;
            return NULL;
        default: return NULL;
    }
}

static tides_status read_header(const tides_frames *frames, video *v, tides_error *error) {
    char line[LINE_MAX_BYTES] = "", *rest = NULL;
    const int got = read_text(v->file, line);
    if (got != 1 || strncmp(line, magic, sizeof magic - 1) != 0 || (line[sizeof magic - 1] != ' ' && line[sizeof magic - 1]))
        return td_fail(error, TIDES_BAD_FILE, "%s: %s, where a YUV4MPEG2 video is expected: ffmpeg -i VIDEO -f yuv4mpegpipe -",
                       name_of(frames), got == 0 ? "is empty" : "begins otherwise");
    v->depth = 8;
    v->across = v->down = 1;
    for (char *field = strtok_r(line + sizeof magic - 1, " ", &rest); field; field = strtok_r(NULL, " ", &rest)) {
        const char *wrong = read_field(field, v);
        /* so that the error is one line */
        for (char *c = field; wrong && *c; c++) *c = (unsigned char)*c < ' ' || *c == 127 ? '?' : *c;
        if (wrong) return td_fail(error, TIDES_BAD_FILE, "%s: '%.40s' in its header: %s", name_of(frames), field, wrong);
    }
    if (v->width && v->height && v->rate) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: its header says no %s", name_of(frames),
                   v->rate ? "width or height" : "frame rate");
}

/* -- frames --------------------------------------------------------------------------------------------------------- */

static size_t chroma_side(int32_t side, int32_t shift) { return ((size_t)side + ((size_t)1 << shift) - 1) >> shift; }

static tides_status fail_short(const tides_frames *frames, const video *v, tides_error *error) {
    return td_fail(error, TIDES_BAD_FILE, "%s: ends within frame %zu", name_of(frames), v->count);
}

/* Finds the frames, from behind the header to the file's end at `size`. */
static tides_status find_frames(tides_frames *frames, video *v, off_t size, tides_error *error) {
    const size_t luma = (size_t)v->width * (size_t)v->height,
                 chroma = v->is_mono ? 0 : chroma_side(v->width, v->across) * chroma_side(v->height, v->down);
    char line[LINE_MAX_BYTES] = "";
    v->bytes = (luma + 2 * chroma) * (v->depth > 8 ? 2 : 1);
    for (int got = read_text(v->file, line); got != 0; got = read_text(v->file, line)) {
        if (got == 2 && feof(v->file)) return fail_short(frames, v, error);
        if (got == 2 || strncmp(line, "FRAME", 5) != 0 || (line[5] && line[5] != ' '))
            return td_fail(error, TIDES_BAD_FILE, "%s: there is no frame where frame %zu should be", name_of(frames), v->count);
        tides_status status = td_reserve((void **)&v->at, &v->capacity, v->count + 1, sizeof *v->at, error);
        if (status != TIDES_OK) return status;
        v->at[v->count] = ftello(v->file);
        if (v->at[v->count] < 0 || v->at[v->count] + (off_t)v->bytes > size) return fail_short(frames, v, error);
        if (fseeko(v->file, v->at[v->count] + (off_t)v->bytes, SEEK_SET) != 0) return fail_short(frames, v, error);
        v->count++;
    }
    if (v->count == 0) return td_fail(error, TIDES_BAD_FILE, "%s: has a header, but no frame", name_of(frames));
    return td_frames_take_shape(frames, name_of(frames), v->count, (size_t)v->height, (size_t)v->width, error);
}

static double sample_of(const video *v, size_t at) {
    return v->depth > 8 ? v->samples[2 * at] + 256.0 * v->samples[2 * at + 1] : (double)v->samples[at];
}

static float within_one(double value) { return value > 0 ? value < 1 ? (float)value : 1.0F : 0.0F; }

/* Converts samples to R', G', B', or to grey. Studio range has 219 steps of luma from 16, and 224 of chroma around 128 (for 8
 * bits). */
static void to_values(const video *v) {
    const size_t width = (size_t)v->width, height = (size_t)v->height, blue = width * height;
    const size_t row = chroma_side(v->width, v->across), red = blue + row * chroma_side(v->height, v->down);
    const double unit = (double)(1 << (v->depth - 8)), top = (double)((1 << v->depth) - 1);
    const double black = v->is_full ? 0 : 16 * unit, luma = v->is_full ? top : 219 * unit;
    const double middle = 128 * unit, chroma = v->is_full ? top : 224 * unit;
    for (size_t y = 0; y < height; y++)
        for (size_t x = 0; x < width; x++) {
            const size_t i = y * width + x, c = (y >> v->down) * row + (x >> v->across);
            const double Y = (sample_of(v, i) - black) / luma;
            if (v->is_mono) {
                v->values[i] = within_one(Y);
                continue;
            }
            const double Cb = (sample_of(v, blue + c) - middle) / chroma, Cr = (sample_of(v, red + c) - middle) / chroma;
            v->values[3 * i] = within_one(Y + 1.402 * Cr);
            v->values[3 * i + 1] = within_one(Y - (0.114 * 1.772 * Cb + 0.299 * 1.402 * Cr) / 0.587);
            v->values[3 * i + 2] = within_one(Y + 1.772 * Cb);
        }
}

static tides_status read_frame(tides_frames *frames, size_t index, double *Y, tides_error *error) {
    video *v = frames->state;
    if (fseeko(v->file, v->at[index], SEEK_SET) != 0 || fread(v->samples, 1, v->bytes, v->file) != v->bytes)
        return td_fail(error, TIDES_BAD_FILE, "%s: frame %zu can't be read", name_of(frames), index);
    to_values(v);
    td_frame_luminance(frames, v->values, 1, v->is_mono ? 1 : 3, (size_t)v->width * (size_t)v->height, Y);
    return TIDES_OK;
}

/* -- opening -------------------------------------------------------------------------------------------------------- */

/* Copies a pipe to an unnamed file, which vanishes when it is closed. */
static tides_status keep_pipe(const tides_frames *frames, video *v, tides_error *error) {
    static const char gone[] = "can't be kept in a temporary file; is the disk full?";
    FILE *kept = tmpfile();
    char *bytes = td_alloc(COPY_BYTES, 1, error);
    int broken = !kept;
    for (size_t got = 1; bytes && !broken && got > 0;) {
        got = fread(bytes, 1, COPY_BYTES, v->file);
        broken = fwrite(bytes, 1, got, kept) != got;
    }
    const int unread = ferror(v->file), memory = bytes != NULL;
    free(bytes);
    if (v->is_own) fclose(v->file);
    v->file = kept;
    v->is_own = 1;
    if (!memory) return TIDES_NO_MEMORY;
    if (unread) return td_fail(error, TIDES_BAD_FILE, "%s: can't be read", name_of(frames));
    if (broken || fflush(kept) != 0) return td_fail(error, TIDES_WRITE_FAILED, "%s: %s", name_of(frames), gone);
    rewind(kept);
    return TIDES_OK;
}

static tides_status fill_times(tides_frames *frames, const video *v, tides_error *error) {
    frames->times = td_alloc(v->count, sizeof *frames->times, error);
    if (!frames->times) return TIDES_NO_MEMORY;
    for (size_t k = 0; k < v->count; k++) frames->times[k] = (double)k * (double)v->scale / (double)v->rate;
    return TIDES_OK;
}

tides_status td_frames_y4m(tides_frames *frames, tides_error *error) {
    static const td_frame_source source = {read_frame, close_video};
    struct stat facts;
    video *v = td_alloc(1, sizeof *v, error);
    if (!v) return TIDES_NO_MEMORY;
    frames->most = -1; /* bits and range are in the header */
    frames->source = &source;
    frames->state = v;
    v->is_own = strcmp(frames->path, "-") != 0;
    v->file = v->is_own ? fopen(frames->path, "rb") : stdin;
    if (!v->file) return td_fail(error, TIDES_FILE_NOT_FOUND, "%s: can't be opened", frames->path);
    tides_status status = TIDES_OK;
    if (!v->is_own || fstat(fileno(v->file), &facts) != 0 || !S_ISREG(facts.st_mode)) status = keep_pipe(frames, v, error);
    if (status == TIDES_OK && fstat(fileno(v->file), &facts) != 0)
        status = td_fail(error, TIDES_BAD_FILE, "%s: can't be read", name_of(frames));
    if (status == TIDES_OK) status = read_header(frames, v, error);
    if (status == TIDES_OK) status = find_frames(frames, v, facts.st_size, error);
    if (status == TIDES_OK) status = fill_times(frames, v, error);
    if (status != TIDES_OK) return status;
    v->samples = td_alloc(v->bytes, 1, error);
    v->values = td_alloc((size_t)v->width * (size_t)v->height * (v->is_mono ? 1 : 3), sizeof *v->values, error);
    return v->samples && v->values ? TIDES_OK : TIDES_NO_MEMORY;
}
