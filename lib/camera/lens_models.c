/* The table of lens models: names and coefficients, for readers and writers of cameras, run files and messages. */
#include "camera/td_lens_models.h"
#include "td_base.h"

#include <string.h>

const char *const td_lens_key[TD_COEFFICIENTS_MAX] = {"k1", "k2", "k3", "k4", "p1", "p2"};

double *td_lens_at(tides_lens *lens, int number) {
    double *const places[TD_COEFFICIENTS_MAX] = {&lens->k1, &lens->k2, &lens->k3, &lens->k4, &lens->p1, &lens->p2};
    return places[number];
}

/* In the order of the TIDES_LENS_* values. */
static const td_lens_model models[] = {
    {"none", "plumb_bob", 0, {NULL}},
    {"radtan", "plumb_bob", 5, {"k1", "k2", "p1", "p2", "k3"}},
    {"equidistant", "equidistant", 4, {"k1", "k2", "k3", "k4"}},
};
enum { MODELS = sizeof models / sizeof models[0] };

const td_lens_model *td_lens_model_of(int32_t model) { return model >= 0 && model < MODELS ? &models[model] : NULL; }

const char *tides_lens_name(int32_t model) { return model >= 0 && model < MODELS ? models[model].name : NULL; }

int32_t td_lens_named(const char *name) {
    for (int32_t i = 0; i < MODELS; i++)
        if (strcmp(name, models[i].name) == 0) return i;
    return -1;
}

int td_lens_list(const tides_lens *lens, double numbers[TD_COEFFICIENTS_MAX]) {
    const td_lens_model *model = td_lens_model_of(lens->model);
    tides_lens copy = *lens;
    memset(numbers, 0, TD_COEFFICIENTS_MAX * sizeof *numbers);
    for (int i = 0; model && i < model->count; i++)
        for (int k = 0; k < TD_COEFFICIENTS_MAX; k++)
            if (strcmp(td_lens_key[k], model->key[i]) == 0) numbers[i] = *td_lens_at(&copy, k);
    return model ? model->count : 0;
}

int td_lens_has(int32_t model, const char *key) {
    for (int i = 0; i < models[model].count; i++)
        if (strcmp(models[model].key[i], key) == 0) return 1;
    return 0;
}

/* Between words of a list: `last` stands before the last one. */
static const char *between(int i, int count, const char *last) { return i == 0 ? "" : i + 1 == count ? last : ", "; }

static size_t add_word(char text[TD_LENS_WORDS], size_t used, const char *word, const char *before) {
    return used + (size_t)snprintf(text + used, TD_LENS_WORDS - used, "%s%s", before, word);
}

const char *td_lens_keys(int32_t model, char text[TD_LENS_WORDS]) {
    const td_lens_model *m = &models[model];
    size_t used = 0;
    snprintf(text, TD_LENS_WORDS, "no coefficients: set camera.lens");
    for (int i = 0; i < m->count; i++) used = add_word(text, used, m->key[i], between(i, m->count, " and "));
    return text;
}

const char *td_lens_choices(char text[TD_LENS_WORDS]) {
    size_t used = 0;
    for (int i = 1; i < MODELS; i++) used = add_word(text, used, models[i].name, between(i - 1, MODELS - 1, " or "));
    return text;
}
