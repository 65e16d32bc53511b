/* Reads camera path files: detects the format from the content, calls the format's reader, and builds a trajectory of its
 * samples. */
#include "tides/camera.h"

#include "camera/td_colmap.h"
#include "camera/td_path_reader.h"
#include "td_folder.h"
#include "td_kinds.h"
#include "td_struct.h"
#include "td_text.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void tides_path_options_defaults(tides_path_options *options) {
    memset(options, 0, sizeof *options);
    options->size = sizeof *options;
    options->duration = 1.0;
}

static void spread(td_path_reader *reader) {
    reader->path.untimed = reader->count > 1;
    double steps = reader->count > 1 ? (double)(reader->count - 1) : 1.0;
    for (size_t i = 0; i < reader->count; i++) reader->samples[i].time = reader->options->duration * ((double)i / steps);
}

/* Larger times can't be in seconds: this is the year 5138. */
#define TD_LAST_SECOND 1e11

/* Checks that times strictly increase; the error names the line or entry where they don't. */
static tides_status check_order(const td_path_reader *reader) {
    for (size_t i = 0; i < reader->count; i++)
        if (!(fabs(reader->samples[i].time) < TD_LAST_SECOND))
            return td_fail(reader->error, TIDES_BAD_FILE,
                           "%s: its times go to %.15g, which are no seconds: set camera.time_unit (an object's: time_unit) to "
                           "ms, us or ns",
                           reader->file, reader->samples[i].time);
    for (size_t i = 1; i < reader->count; i++) {
        const td_path_sample *before = reader->samples + i - 1, *here = before + 1;
        double step = td_path_since(here, before);
        if (step > 0.0) continue;
        char place[512];
        td_path_name_place(reader, reader->file, here->place, place, sizeof place);
        const char *word = reader->list ? "entry" : "line";
        if (step == 0.0)
            return td_fail(reader->error, TIDES_BAD_FILE, "%s: its time, %.15g s, is also that of %s %zu; drop one of the two",
                           place, here->time, word, before->place);
        return td_fail(reader->error, TIDES_BAD_FILE,
                       "%s: its time, %.15g s, comes before that of %s %zu, %.15g s; sort the file by time", place, here->time,
                       word, before->place, before->time);
    }
    return TIDES_OK;
}

/* The trajectory through the reader's samples, with `start` or `rebase` applied. */
static tides_status make_trajectory(td_path_reader *reader) {
    if (reader->count == 0) return td_fail(reader->error, TIDES_BAD_FILE, "%s: holds no poses", reader->file);
    tides_status status = check_order(reader);
    if (status != TIDES_OK) return status;
    tides_pose_sample *samples = td_alloc(reader->count, sizeof *samples, reader->error);
    if (!samples) return TIDES_NO_MEMORY;
    td_path_sample origin = td_path_origin(reader, reader->samples);
    for (size_t i = 0; i < reader->count; i++) {
        samples[i] = reader->samples[i].pose;
        samples[i].time = td_path_since(reader->samples + i, &origin);
    }
    status = reader->is_open ? tides_trajectory_create_open(samples, reader->count, &reader->path.trajectory, reader->error)
                             : tides_trajectory_create(samples, reader->count, &reader->path.trajectory, reader->error);
    if (status == TIDES_BAD_ARGUMENT) status = TIDES_BAD_FILE; /* the bad argument came from the file */
    if (status != TIDES_OK) td_fail_within(reader->error, status, "%s", reader->file);
    if (status != TIDES_OK && reader->error) reader->error->status = status;
    free(samples);
    return status;
}

/* Detects which JSON format it is, from the keys of the root. */
static tides_status read_json(td_path_reader *reader) {
    cJSON *root = td_json_parse(reader);
    if (!root) return TIDES_BAD_FILE;
    const cJSON *format = cJSON_GetObjectItemCaseSensitive(root, "format");
    tides_status status;
    if (cJSON_IsArray(root))
        status = td_path_read_cameras(reader, root);
    else if (cJSON_IsString(format) && strcmp(format->valuestring, "tides-path") == 0)
        status = td_path_read_tides(reader, root);
    else if (td_json_has(root, "camera_path"))
        status = td_path_read_nerfstudio(reader, root);
    else if (td_json_has(root, "frames"))
        status = td_path_read_transforms(reader, root);
    else if (td_json_has(root, "orientation"))
        status = td_path_read_nerfies(reader, root);
    else
        status = td_fail(reader->error, TIDES_BAD_FILE,
                         "%s: is JSON but no path: expected \"format\": \"tides-path\", a transforms.json with \"frames\", "
                         "nerfstudio's \"camera_path\", a nerfies camera with \"orientation\", or the list of a cameras.json",
                         reader->file);
    cJSON_Delete(root);
    return status;
}

static tides_status check_options(const tides_path_options *options, tides_error *error) {
    if (!isfinite(options->duration) || !(options->duration > 0.0))
        return td_fail(error, TIDES_BAD_ARGUMENT, "path options: duration is %g s; it must be above 0", options->duration);
    if (options->time_unit < TIDES_TIME_AUTO || options->time_unit > TIDES_TIME_INDEX)
        return td_fail(error, TIDES_BAD_ARGUMENT, "path options: time_unit %d isn't one of TIDES_TIME_*",
                       (int)options->time_unit);
    if (!isfinite(options->start)) return td_fail(error, TIDES_BAD_ARGUMENT, "path options: start must be finite");
    return TIDES_OK;
}

/* The first line of a text that holds data: number of columns (separated by commas or blanks), and the first column that is
 * no number. */
typedef struct text_shape {
    int columns, commas, first_word; /* if all columns are numbers, first_word is `columns` */
} text_shape;

static text_shape shape_of(const char *text) {
    text_shape shape = {0, 0, 0};
    const char *c = td_text_skip(text);
    while (*c && td_text_ends(c)) {
        c += strcspn(c, "\n");
        c = td_text_skip(c + (*c == '\n'));
    }
    shape.commas = memchr(c, ',', strcspn(c, "\n")) != NULL;
    for (int numbers = 1; !td_text_ends(c); shape.columns++) {
        double value;
        const char *end = td_text_number(c, &value);
        numbers = numbers && end != c && strchr(", \t\r\n", *end); /* strchr also finds the NUL at the text's end */
        shape.first_word += numbers;
        c += strcspn(c, shape.commas ? ",\n" : " \t\r\n");
        c = td_text_skip(c + (*c == ','));
    }
    return shape;
}

/* Detects which text format it is: from the names of the columns, otherwise from the first line with data. */
static tides_status read_text(td_path_reader *reader) {
    td_path_table table;
    const text_shape shape = shape_of(reader->text);
    const tides_status status = td_path_find_table(reader, &table);
    if (status != TIDES_OK) return status;
    if (table.named || shape.commas) return td_path_read_table(reader, &table);
    const int all = shape.first_word == shape.columns; /* the row has only numbers */
    if (all && td_path_is_kitti(shape.columns)) return td_path_read_kitti(reader, shape.columns);
    if (shape.columns >= 10 && (shape.first_word == 9 || shape.first_word == 10)) return td_path_read_colmap(reader, 0);
    if (shape.columns >= 7 && shape.first_word == 1) return td_path_refuse_cameras(reader, 0);
    return td_path_read_table(reader, &table);
}

/* Copies a text whose line breaks are CRs (old spreadsheets) with LFs instead. `*copy` is NULL if nothing has to change. */
static tides_status break_lines(const td_path_reader *reader, char **copy) {
    const char *at = memchr(reader->text, '\r', reader->bytes), *end = reader->text + reader->bytes;
    *copy = NULL;
    while (at && at + 1 < end && at[1] == '\n') at = memchr(at + 1, '\r', (size_t)(end - at - 1));
    if (!at) return TIDES_OK;
    *copy = td_alloc(reader->bytes + 1, 1, reader->error);
    if (!*copy) return TIDES_NO_MEMORY;
    memcpy(*copy, reader->text, reader->bytes);
    (*copy)[reader->bytes] = '\0';
    td_break_lines(*copy);
    return TIDES_OK;
}

static tides_status read_text_file(td_path_reader *reader) {
    const char *text = reader->text;
    char *copy;
    tides_status status = break_lines(reader, &copy);
    if (copy) reader->text = copy;
    if (status == TIDES_OK) status = read_text(reader);
    for (size_t i = 0; copy && i < reader->count; i++) reader->samples[i].word = NULL;
    reader->text = text;
    free(copy);
    return status;
}

/* Detects the format and reads the file. The C locale is set. */
static tides_status read_path(td_path_reader *reader, const char *folder) {
    if (folder) return td_path_read_nerfies_folder(reader, folder);
    /* COLMAP's binary files have no magic number: their names say what they are. */
    if (td_colmap_is_named(reader->file, "images.bin")) return td_path_read_colmap(reader, 1);
    if (td_colmap_is_named(reader->file, "cameras.bin")) return td_path_refuse_cameras(reader, 1);
    if (reader->bytes >= 3 && memcmp(reader->text, "\xEF\xBB\xBF", 3) == 0) { /* UTF-8 byte order mark, from Windows editors */
        reader->text += 3;
        reader->bytes -= 3;
    }
    if (reader->bytes >= 6 && memcmp(reader->text, "\x93NUMPY", 6) == 0) return td_path_read_llff(reader);
    const char *nul = memchr(reader->text, 0, reader->bytes);
    if (nul && reader->bytes >= 2 && (memcmp(reader->text, "\xFF\xFE", 2) == 0 || memcmp(reader->text, "\xFE\xFF", 2) == 0))
        return td_fail(reader->error, TIDES_BAD_FILE, "%s: is UTF-16 text: save it as UTF-8", reader->file);
    if (nul)
        return td_fail(reader->error, TIDES_BAD_FILE,
                       "%s: has a zero byte at %zu: a path file is text or JSON, or poses_bounds.npy, or COLMAP's images.bin",
                       reader->file, (size_t)(nul - reader->text));
    size_t blank = strspn(reader->text, " \t\r\n");
    char first = reader->text[blank];
    return first == '{' || first == '[' ? read_json(reader) : read_text_file(reader);
}

/* Reads the reader's text; or, if `folder` isn't NULL, a folder of nerfies' cameras. */
static tides_status parse(td_path_reader *reader, const char *folder, tides_path *path) {
    td_plain_numbers numbers;
    tides_status status = td_plain_begin(&numbers, reader->file, reader->error);
    if (status != TIDES_OK) return status;
    status = read_path(reader, folder);
    if (status == TIDES_OK) status = td_path_choose(reader);
    if (status == TIDES_OK && reader->spread) spread(reader);
    if (status == TIDES_OK && !reader->path.trajectory) status = make_trajectory(reader);
    if (status == TIDES_OK) status = td_path_note_leaps(reader);
    if (status != TIDES_OK) tides_trajectory_destroy(reader->path.trajectory);
    td_plain_end(&numbers);
    free(reader->samples);
    free(reader->views);
    if (status == TIDES_OK) *path = reader->path;
    return status;
}

tides_status td_path_parse(const char *file, const char *text, size_t bytes, const tides_path_options *options,
                           tides_path *path, tides_error *error) {
    td_path_reader reader = {.file = file, .text = text, .bytes = bytes, .options = options, .error = error};
    return parse(&reader, NULL, path);
}

static tides_status load_file(const char *file, const tides_path_options *options, tides_path *path, tides_error *error) {
    char *text = NULL;
    size_t bytes = 0;
    tides_status status = td_read_file(file, TD_LARGEST_PATH, &text, &bytes, error);
    if (status == TIDES_OK) status = td_path_parse(file, text, bytes, options, path, error);
    free(text);
    return td_kind_judge(file, TD_WANTS_POSES, status, error);
}

/* Reads a folder: one of the files of known names in it, or nerfies' cameras. */
static tides_status load_folder(const char *folder, const tides_path_options *options, tides_path *path, tides_error *error) {
    char *file = NULL;
    tides_status status = td_path_find(folder, &file, error);
    if (!status && file && !td_is_folder(file)) {
        status = load_file(file, options, path, error);
    } else if (!status) {
        td_path_reader reader = {.file = folder, .text = "", .options = options, .error = error};
        status = parse(&reader, file ? file : folder, path);
    }
    free(file);
    return status;
}

tides_status tides_path_load(const char *file, const tides_path_options *options, tides_path *path, tides_error *error) {
    if (!file || !path) return td_fail(error, TIDES_BAD_ARGUMENT, "a path needs a file name and a place for the result");
    tides_path_options own;
    tides_path_options_defaults(&own);
    tides_status status = options ? TD_TAKE_STRUCT(tides_path_options, &own, options, error) : TIDES_OK;
    if (status == TIDES_OK) status = check_options(&own, error);
    if (status != TIDES_OK) return status;
    return td_is_folder(file) ? load_folder(file, &own, path, error) : load_file(file, &own, path, error);
}
