/* Words for man pages and completions: the kinds of options' values, and names from the library's tables. */
#include "describe.h"

#include <stdio.h>
#include <string.h>

int32_t describe_argument(const char *argument) {
    if (!argument) return DESCRIBE_NOTHING;
    if (strcmp(argument, "DIR") == 0) return DESCRIBE_FOLDER;
    if (strcmp(argument, "KEY=VALUE") == 0) return DESCRIBE_KEY;
    if (strcmp(argument, "SPEC") == 0) return DESCRIBE_DEVICE;
    if (strcmp(argument, "FORMAT") == 0) return DESCRIBE_FORMAT;
    if (strcmp(argument, "LIST") == 0) return DESCRIBE_LIST;
    if (strchr(argument, '|') || strcmp(argument, "LAYOUT") == 0) return DESCRIBE_WORDS;
    return strstr(argument, "FILE") || strchr(argument, '.') ? DESCRIBE_FILE : DESCRIBE_NOTHING;
}

/* Prints `words` up to its end or one of `stops`, with `between` in place of `divider`. */
static void put_words(const char *words, const char *stops, char divider, const char *between) {
    for (size_t i = 0, length = strcspn(words, stops); i < length; i++)
        words[i] == divider ? (void)fputs(between, stdout) : (void)putchar(words[i]);
}

void describe_words(const cli_option *option, const char *between) {
    if (describe_argument(option->argument) == DESCRIBE_LIST) {
        put_words(option->help, ": ", ',', between);
    } else if (strchr(option->argument, '|')) {
        put_words(option->argument, "", '|', between);
    } else {
        tides_dataset_layout layout;
        for (size_t i = 0; tides_dataset_layout_at(i, &layout); i++) printf("%s%s", i ? between : "", layout.name);
    }
}

void describe_presets(const char *between) {
    char name[TIDES_PRESET_NAME];
    for (size_t i = 0; tides_preset_at(i, name); i++) printf("%s%s", i ? between : "", name);
}

void describe_kinds(const char *between) {
    size_t count;
    const tides_generator *kinds = tides_generators(&count);
    for (size_t i = 0; i < count; i++) printf("%s%s", i ? between : "", kinds[i].name);
}

int describe_choice(const cli_command *command) {
    const int length = (int)strcspn(command->arguments, " ");
    return memchr(command->arguments, '|', (size_t)length) ? length : 0;
}

void describe_devices(const char *between) { printf("auto%scpu%sgpu%sreference", between, between, between); }

void describe_formats(const char *between) {
    tides_event_format format;
    for (size_t i = 0; tides_event_format_at(i, &format); i++) printf("%s%s", i ? between : "", format.name);
}

void describe_keys(const char *after, const char *between) {
    size_t count;
    const tides_param *rows = tides_params(&count);
    for (size_t i = 0; i < count; i++) printf("%s%s%s", i ? between : "", rows[i].key, after);
}
