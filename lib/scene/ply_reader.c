/* Reads 3D Gaussian splatting scenes from PLY files: assigns each property to an array.
 *
 * Element vertex holds one Gaussian per row, its properties found by name:
 *     x y z                 mean
 *     f_dc_0 .. f_dc_2      sh, coefficient 0 of red, green, blue
 *     f_rest_0 ..           sh, the others, channel by channel: f_rest_[c (K - 1) + k - 1] is coefficient k of channel c;
 *                           0, 9, 24, 45 or 72 of them for degrees 0 to 4
 *     opacity               logit
 *     scale_0 .. scale_2    natural logarithms
 *     rot_0 .. rot_3        quaternion w x y z
 *     filter_3D             optional: size of mip-splatting's smoothing filter, which is applied to scales and opacity
 * Comments of the header say how the splats were trained and where up is. filter_3D implies training with compensated
 * opacities. Everything else (normals, colours, other elements) is skipped. Writers: INRIA, gsplat, nerfstudio, SuperSplat
 * and others. Compressed files have another reader. */
#include "td_base.h"
#include "td_ply.h"
#include "td_scene.h"
#include "td_splat.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* State of assigning properties to arrays. */
typedef struct binding {
    const td_ply_file *file;
    const td_ply_header *header;
    const td_ply_element *vertex;
    td_ply_column *columns; /* one per property of vertex */
    int32_t lenient;
    tides_error *error;
} binding;

/* Refuses other models in the same container: read as 3DGS they would be silently wrong. */
static tides_status check_kind(const binding *b) {
    static const struct {
        const char *property, *kind;
    } others[] = {{"trbf_center", "a SpacetimeGaussians model"},
                  {"scale_t", "a model of 4-D Gaussians"},
                  {"rot_r_0", "a model of 4-D Gaussians"},
                  {"motion_xyz_0_0", "an Ex4DGS dynamic model"},
                  {"xyz_disp_0", "an Ex4DGS static model"}};
    const char *kind = NULL;
    for (size_t i = 0; i < b->vertex->properties && !kind; i++)
        for (size_t k = 0; k < sizeof others / sizeof others[0]; k++)
            if (td_ply_word_is(b->header->properties[b->vertex->first_property + i].name, others[k].property))
                kind = others[k].kind;
    if (!kind) return TIDES_OK;
    return td_fail(b->error, TIDES_UNSUPPORTED, "%s: is %s, which this version can't read: convert it to a plain 3DGS .ply",
                   b->file->path, kind);
}

/* Index of a property of vertex; b->vertex->properties if it doesn't exist. */
static size_t find_property(const binding *b, const char *name) {
    size_t i = 0;
    while (i < b->vertex->properties && !td_ply_word_is(b->header->properties[b->vertex->first_property + i].name, name)) i++;
    return i;
}

/* Assigns a property to array[at], array[at + stride] ...; with a NULL array it only checks that the property exists. */
static tides_status bind(const binding *b, const char *name, float *array, size_t at, size_t stride) {
    size_t found = find_property(b, name);
    if (found == b->vertex->properties)
        return td_fail(b->error, TIDES_BAD_FILE,
                       "%s: line %zu: element vertex has no property %s among its %zu: this isn't a 3DGS scene", b->file->path,
                       b->vertex->line, name, b->vertex->properties);
    if (b->header->properties[b->vertex->first_property + found].count_type)
        return td_fail(b->error, TIDES_BAD_FILE, "%s: property %s of element vertex is a list: it should be one number",
                       b->file->path, name);
    for (size_t i = found + 1; i < b->vertex->properties; i++)
        if (td_ply_word_is(b->header->properties[b->vertex->first_property + i].name, name))
            return td_fail(b->error, TIDES_BAD_FILE, "%s: element vertex has two properties %s", b->file->path, name);
    if (array) b->columns[found].base = array + at;
    if (array) b->columns[found].stride = stride;
    return TIDES_OK;
}

/* Finds the SH degree from the number of f_rest_* properties. */
static tides_status find_sh_degree(const binding *b, int32_t *degree) {
    size_t count = 0;
    for (size_t i = 0; i < b->vertex->properties; i++) {
        td_ply_word name = b->header->properties[b->vertex->first_property + i].name;
        count += name.length > 7 && memcmp(name.text, "f_rest_", 7) == 0;
    }
    for (int32_t d = 0; d <= TIDES_SH_DEGREE_MAX; d++) {
        if (count != 3 * (td_sh_coefficients(d) - 1)) continue;
        *degree = d;
        return TIDES_OK;
    }
    return td_fail(b->error, TIDES_BAD_FILE,
                   "%s: element vertex has %zu f_rest properties: SH degrees 0 to 4 have 0, 9, 24, 45 or 72", b->file->path,
                   count);
}

static tides_status bind_sh(const binding *b, const td_gaussians *g) {
    size_t coefficients = td_sh_coefficients(g->sh_degree), rest = coefficients - 1;
    char name[32];
    tides_status status = TIDES_OK;
    for (size_t c = 0; c < 3 && !status; c++) {
        snprintf(name, sizeof name, "f_dc_%zu", c);
        status = bind(b, name, g->sh, c, 3 * coefficients);
        for (size_t k = 0; k < rest && !status; k++) {
            snprintf(name, sizeof name, "f_rest_%zu", c * rest + k);
            status = bind(b, name, g->sh, 3 * (k + 1) + c, 3 * coefficients);
        }
    }
    return status;
}

/* 1 if means have more than single precision in the file: numbers of eight bytes, or text. */
static int has_wide_means(const binding *b) {
    if (b->header->format == TD_PLY_ASCII) return 1;
    for (size_t axis = 0; axis < 3; axis++) {
        size_t found = find_property(b, (const char *const[]){"x", "y", "z"}[axis]);
        int type = b->header->properties[b->vertex->first_property + found].type;
        if (type == TD_PLY_FLOAT64 || type == TD_PLY_INT32 || type == TD_PLY_UINT32) return 1;
    }
    return 0;
}

static tides_status bind_wide_means(const binding *b, td_gaussians *g) {
    if (!has_wide_means(b)) return TIDES_OK;
    tides_status status = td_gaussians_widen(g, b->error);
    for (size_t axis = 0; axis < 3 && !status; axis++)
        b->columns[find_property(b, (const char *const[]){"x", "y", "z"}[axis])].wide = g->mean_double + axis;
    return status;
}

static int has_filter(const binding *b) { return find_property(b, "filter_3D") < b->vertex->properties; }

/* Assigns all properties. If `g` has a degree but no arrays yet, it only checks that all properties exist. */
static tides_status bind_all(const binding *b, const td_gaussians *g, float *filter) {
    const struct {
        const char *name;
        float *array;
        size_t at, stride;
    } single[] = {{"x", g->mean, 0, 3},
                  {"y", g->mean, 1, 3},
                  {"z", g->mean, 2, 3},
                  {"opacity", g->opacity_logit, 0, 1},
                  {"scale_0", g->log_scale, 0, 3},
                  {"scale_1", g->log_scale, 1, 3},
                  {"scale_2", g->log_scale, 2, 3},
                  {"rot_0", g->quaternion, 0, 4},
                  {"rot_1", g->quaternion, 1, 4},
                  {"rot_2", g->quaternion, 2, 4},
                  {"rot_3", g->quaternion, 3, 4}};
    tides_status status = TIDES_OK;
    for (size_t i = 0; i < sizeof single / sizeof single[0] && !status; i++)
        status = bind(b, single[i].name, single[i].array, single[i].at, single[i].stride);
    if (!status) status = bind_sh(b, g);
    if (!status && has_filter(b)) status = bind(b, "filter_3D", filter, 0, 1);
    return status;
}

/* Skips the elements before vertex and reads vertex. */
static tides_status read_rows(const binding *b) {
    td_ply_cursor cursor = {b->header->body, b->header->lines};
    tides_status status = TIDES_OK;
    for (const td_ply_element *e = b->header->elements; e <= b->vertex && !status; e++)
        status = td_ply_rows_read(b->file, b->header, e, e == b->vertex ? b->columns : NULL, &cursor, b->error);
    return status;
}

/* 1 for 2-D Gaussians (discs), which have two scales, and otherwise the properties of 3-D ones. */
static int has_discs(const binding *b) {
    static const char *const both[] = {"opacity", "rot_3", "scale_0", "scale_1"};
    int found = find_property(b, "scale_2") == b->vertex->properties;
    for (size_t i = 0; i < sizeof both / sizeof both[0]; i++) found &= find_property(b, both[i]) < b->vertex->properties;
    return found;
}

static tides_status check_discs(const binding *b) {
    return has_discs(b) ? td_splat_refuse_discs(b->file->path, b->error) : TIDES_OK;
}

/* Checks all that the header shows, before memory is allocated. */
static tides_status check_header(const binding *b, int32_t *degree) {
    tides_status status = check_kind(b);
    if (!status) status = check_discs(b);
    if (!status) status = find_sh_degree(b, degree);
    if (!status) status = bind_all(b, &(td_gaussians){.sh_degree = *degree}, NULL);
    if (status) return status;
    if (b->vertex->count == 0)
        return td_fail(b->error, TIDES_BAD_FILE, "%s: line %zu: element vertex has 0 rows: there is no Gaussian in this file",
                       b->file->path, b->vertex->line);
    td_ply_cursor start = {b->header->body, b->header->lines};
    return td_ply_rows_fit(b->file, b->header, b->vertex, &start, b->error);
}

static tides_status check_filter(const binding *b, float *filter, const td_gaussians *made) {
    for (uint64_t i = 0; filter && i < b->vertex->count; i++) {
        if (isfinite(filter[i])) continue;
        if (!b->lenient)
            return td_fail(b->error, TIDES_BAD_FILE,
                           "%s: Gaussian %llu: filter_3D is not finite; scene.invalid = drop (tides convert --drop-invalid) "
                           "leaves such Gaussians out",
                           b->file->path, (unsigned long long)i);
        filter[i] = 0;
        made->opacity_logit[i] = NAN;
    }
    return TIDES_OK;
}

static tides_status read_gaussians(binding *b, td_gaussians *gaussians) {
    td_gaussians made;
    memset(&made, 0, sizeof made);
    float *filter = NULL;
    int32_t degree = 0;
    tides_status status = check_header(b, &degree);
    if (status) return status;
    b->columns = td_alloc(b->vertex->properties, sizeof *b->columns, b->error);
    status = b->columns ? td_gaussians_create(&made, (int64_t)b->vertex->count, degree, b->error) : TIDES_NO_MEMORY;
    if (!status && has_filter(b) && !(filter = td_alloc((size_t)made.count, sizeof *filter, b->error)))
        status = TIDES_NO_MEMORY;
    if (!status) status = bind_all(b, &made, filter);
    if (!status) status = bind_wide_means(b, &made);
    if (!status) status = read_rows(b);
    if (!status) status = check_filter(b, filter, &made);
    if (!status && filter) td_gaussians_fold_filter(&made, filter);
    free(filter);
    free(b->columns);
    if (status)
        td_gaussians_free(&made);
    else
        *gaussians = made;
    return status;
}

/* 1 if all values lie from `least` to `most`, and differ (a hand-made scene may have equal ones). */
static int lie_within(const float *values, size_t count, float least, float most) {
    int within = 1, differ = 0;
    for (size_t i = 0; i < count && within; i++) {
        within = values[i] >= least && values[i] <= most;
        differ = differ || values[i] > values[0] || values[i] < values[0];
    }
    return within && differ;
}

/* Notes values that look like opacities and lengths, where 3DGS files have logits and logarithms. In no trained scene do all
 * logits lie from 0 to 1, nor do all splats measure 1 to 2.7 scene units. */
static tides_status note_activated(td_gaussians *g, tides_error *error) {
    enum { ENOUGH = 32 }; /* fewer Gaussians may have such values by chance */
    const size_t count = (size_t)g->count;
    tides_status status = TIDES_OK;
    if (count < ENOUGH) return TIDES_OK;
    if (lie_within(g->opacity_logit, count, 0, 1))
        status =
            td_note(&g->notes, error,
                    "its opacities all lie from 0 to 1, which is rare for logits: they are read as logits nevertheless, as "
                    "3DGS writes them");
    if (status == TIDES_OK && lie_within(g->log_scale, 3 * count, 0, 1))
        status =
            td_note(&g->notes, error,
                    "its scales all lie from 0 to 1, which is rare for logarithms: they are read as logarithms nevertheless, "
                    "as 3DGS writes them");
    return status;
}

/* Takes the training mode from the comments, or else from filter_3D. */
static tides_status take_mode(const binding *b, td_gaussians *gaussians) {
    const td_ply_word mode = b->header->mode;
    if (has_filter(b) || td_ply_word_reads(mode, "mip")) gaussians->trained = TIDES_TRAINED_ANTIALIASED;
    if (td_ply_word_reads(mode, "default")) gaussians->trained = TIDES_TRAINED_PLAIN;
    if (mode.length == 0 || gaussians->trained != TIDES_TRAINED_UNKNOWN) return TIDES_OK;
    return td_note(&gaussians->notes, b->error,
                   "its splats' mode '%s' isn't known: they are drawn as plain ones; image.antialias says otherwise",
                   TD_PLY_QUOTE(mode));
}

/* Takes the colour transfer from the comments. */
static tides_status take_transfer(const binding *b, td_gaussians *gaussians) {
    const td_ply_word kind = b->header->transfer, exponent = b->header->exponent;
    char text[TD_TRANSFER_TEXT], where[160];
    if (kind.length == 0) return TIDES_OK;
    snprintf(text, sizeof text, "%.*s%s%.*s", (int)(kind.length < 15 ? kind.length : 15), kind.text, exponent.length ? " " : "",
             (int)(exponent.length < 20 ? exponent.length : 20), exponent.length ? exponent.text : "");
    snprintf(where, sizeof where, "%.100s: its comment ColourTransfer", b->file->path);
    return td_transfer_read(where, text, gaussians, b->error);
}

static tides_status parse(const char *path, const void *data, size_t size, int32_t lenient, td_gaussians *gaussians,
                          tides_error *error) {
    td_ply_file file = {path, data, size};
    td_ply_header header;
    td_gaussians made = {0};
    tides_status status = td_ply_header_parse(&file, &header, error);
    if (status) return status;
    binding b = {.file = &file,
                 .header = &header,
                 .vertex = td_ply_find_element(&header, "vertex"),
                 .lenient = lenient,
                 .error = error};
    if (!b.vertex)
        status = td_fail(error, TIDES_BAD_FILE, "%s: has no element vertex: this isn't a 3DGS scene", path);
    else if (td_ply_word_reads(header.mode, "2dgs"))
        status = td_splat_refuse_discs(path, error);
    else if (td_ply_is_packed(&header))
        status = td_ply_packed_read(&file, &header, &made, error);
    else
        status = read_gaussians(&b, &made);
    if (!status) memcpy(made.up, header.up, sizeof made.up);
    if (!status) status = take_mode(&b, &made);
    if (!status) status = note_activated(&made, error);
    if (!status) status = take_transfer(&b, &made);
    if (status)
        td_gaussians_free(&made);
    else
        *gaussians = made;
    td_ply_header_free(&header);
    return status;
}

tides_status td_ply_parse(const char *path, const void *data, size_t size, td_gaussians *gaussians, tides_error *error) {
    return parse(path, data, size, 0, gaussians, error);
}

tides_status td_ply_parse_leniently(const char *path, const void *data, size_t size, td_gaussians *gaussians,
                                    tides_error *error) {
    return parse(path, data, size, 1, gaussians, error);
}
