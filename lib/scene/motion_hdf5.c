/* Reads and writes an object's motion in a scene file: the model's name, settings and arrays. The code is the same for all
 * models; each model checks its own arrays and settings. */
#include "td_base.h"
#include "motion/td_motion.h"
#include "archive/td_h5_place.h"
#include "td_scene_hdf5.h"

#include <stdlib.h>

/* -- writing ------------------------------------------------------------------------------------------------------- */

static tides_status write_arrays(const td_place *motion, const tides_motion *from) {
    td_place fields;
    tides_status status = td_place_create(motion, "fields", &fields);
    if (status) return status;
    for (int i = 0; i < from->fields && !status; i++) {
        const td_field *field = &from->field[i];
        status =
            td_place_write(&fields, field->name, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, field->rank, field->shape, field->value);
    }
    H5Gclose(fields.id);
    return status;
}

static tides_status write_settings(const td_place *motion, const tides_motion *from) {
    td_place settings;
    tides_status status = td_place_create(motion, "settings", &settings);
    if (status) return status;
    for (int i = 0; i < from->settings && !status; i++)
        status = td_place_write_double(&settings, from->setting[i].name, from->setting[i].value);
    H5Gclose(settings.id);
    return status;
}

tides_status td_motion_hdf5_write(const td_place *object, const tides_motion *motion, double duration_s) {
    td_place place;
    if (motion->type->code == TD_MOTION_HOST)
        return td_fail(object->error, TIDES_UNSUPPORTED,
                       "%s: the motion of %s is a callback of the running program: it can't be written", object->file,
                       object->where);
    tides_status status = td_place_create(object, "motion", &place);
    if (status) return status;
    status = td_place_write_text(&place, "model", motion->type->name);
    if (!status) status = td_place_write_double(&place, "start", motion->start);
    if (!status) status = td_place_write_double(&place, "stop", motion->stop);
    if (!status) status = td_place_write_double(&place, "duration_s", duration_s);
    if (!status) status = write_settings(&place, motion);
    if (!status) status = write_arrays(&place, motion);
    H5Gclose(place.id);
    return status;
}

/* -- reading ------------------------------------------------------------------------------------------------------- */

static tides_status read_array(const td_place *fields, const char *name, tides_motion *motion) {
    uint64_t shape[TD_PLACE_RANK_MAX];
    int rank = 0;
    size_t count = 1;
    tides_status status = td_place_rank(fields, name, &rank);
    if (!status) status = td_place_shape(fields, name, rank, shape); /* limits the numbers to what the file can hold */
    if (status) return status;
    for (int i = 0; i < rank; i++) count *= (size_t)shape[i];
    float *values = td_alloc(count ? count : 1, sizeof *values, fields->error);
    if (!values) return TIDES_NO_MEMORY;
    status = td_place_read(fields, name, H5T_NATIVE_FLOAT, values);
    if (!status) return td_motion_take_field(motion, name, rank, shape, values, fields->error);
    free(values);
    return status;
}

static tides_status read_arrays(const td_place *place, tides_motion *motion) {
    td_place fields;
    char name[sizeof motion->field[0].name];
    tides_status status = td_place_open(place, "fields", &fields);
    if (status) return status;
    for (size_t i = 0; i < td_place_links(&fields) && !status; i++) {
        status = td_place_link_name(&fields, i, name, sizeof name);
        if (!status) status = read_array(&fields, name, motion);
    }
    H5Gclose(fields.id);
    return status;
}

static tides_status read_settings(const td_place *place, tides_motion *motion) {
    td_place settings;
    char name[sizeof motion->setting[0].name];
    tides_status status = td_place_open(place, "settings", &settings);
    if (status) return status;
    for (size_t i = 0; i < td_place_attributes(&settings) && !status; i++) {
        double value = 0;
        status = td_place_attribute_name(&settings, i, name, sizeof name);
        if (!status) status = td_place_read_double(&settings, name, &value);
        if (!status) status = td_motion_set(motion, name, value, settings.error);
    }
    H5Gclose(settings.id);
    return status;
}

static tides_status read_motion(const td_place *place, tides_motion **motion, double *duration_s) {
    char *model = NULL;
    double start = 0, stop = 0;
    tides_status status = td_place_read_text(place, "model", &model);
    const td_motion_class *type = status ? NULL : td_motion_class_find(model);
    if (!status && (!type || type->code == TD_MOTION_HOST))
        status =
            td_fail(place->error, TIDES_UNSUPPORTED, "%s: %s is of model '%.40s', which TIDES %s doesn't know: update TIDES",
                    place->file, place->where, model, tides_version());
    free(model);
    if (!status) status = td_place_read_double(place, "start", &start);
    if (!status) status = td_place_read_double(place, "stop", &stop);
    if (!status) status = td_place_read_double(place, "duration_s", duration_s);
    if (!status && !(*duration_s > 0 && *duration_s <= TD_FURTHEST_TIME))
        status = td_fail(place->error, TIDES_BAD_FILE, "%s: duration_s of %s is %g: should be a number of seconds above 0",
                         place->file, place->where, *duration_s);
    if (!status) status = td_motion_create(type, start, stop, motion, place->error);
    if (!status) status = read_settings(place, *motion);
    if (!status) status = read_arrays(place, *motion);
    return status;
}

tides_status td_motion_hdf5_read(const td_place *object, tides_motion **motion, double *duration_s) {
    td_place place;
    *motion = NULL;
    if (!td_place_has(object, "motion")) return TIDES_OK;
    tides_status status = td_place_open(object, "motion", &place);
    if (status) return status;
    status = read_motion(&place, motion, duration_s);
    if (status == TIDES_BAD_ARGUMENT) status = TIDES_BAD_FILE; /* the file caused it */
    if (status && place.error) place.error->status = status;
    if (status) {
        td_fail_within(place.error, status, "%s: %s", place.file, place.where);
        tides_motion_destroy(*motion);
        *motion = NULL;
    }
    H5Gclose(place.id);
    return status;
}
