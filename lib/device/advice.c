/* Advice on which package to install if there is no OpenCL device, for this operating system. */
#include "td_advice.h"

#include <stdio.h>
#include <string.h>

/* Systems with a CPU driver in their packages (PoCL, by its package name). Derived systems name these in ID_LIKE. */
static const struct {
    const char *id, *command;
} SYSTEMS[] = {
    {"debian", "apt install pocl-opencl-icd"},
    {"ubuntu", "apt install pocl-opencl-icd"},
    {"fedora", "dnf install pocl"},
    {"arch", "pacman -S pocl"},
    {"suse", "zypper install pocl"},
    {"gentoo", "emerge dev-libs/pocl"},
};

/* 1 if the value of a line NAME=value, quoted or not, has the word `id`. */
static int has_word(const char *value, const char *id) {
    static const char *const apart = " \"'\n";
    for (size_t length; *value; value += length) {
        value += strspn(value, apart);
        length = strcspn(value, apart);
        if (length == strlen(id) && strncmp(value, id, length) == 0) return 1;
    }
    return 0;
}

static const char *command_of(const char *line) {
    const char *value = strncmp(line, "ID=", 3) == 0 ? line + 3 : strncmp(line, "ID_LIKE=", 8) == 0 ? line + 8 : "";
    for (size_t i = 0; i < sizeof SYSTEMS / sizeof *SYSTEMS; i++)
        if (has_word(value, SYSTEMS[i].id)) return SYSTEMS[i].command;
    return NULL;
}

const char *td_device_advice(const char *os_release) {
    char line[256];
    const char *command = NULL;
    FILE *file = fopen(os_release, "r");
    while (file && !command && fgets(line, sizeof line, file)) command = command_of(line);
    if (file) fclose(file);
    return command ? command : "PoCL, or your GPU's driver";
}
