/* Output of the tool: error lines, facts as text or JSON, small files. */
#include "cli.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

int cli_fail(const tides_error *error) {
    fprintf(stderr, "tides: %s\n", error->text[0] ? error->text : tides_status_text(error->status));
    return CLI_FAILED;
}

void cli_say(const char *format, va_list arguments, const char *end) {
    fputs("tides: ", stderr);
    vfprintf(stderr, format, arguments);
    fputs(end, stderr);
}

int cli_failed(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    cli_say(format, arguments, "\n");
    va_end(arguments);
    return CLI_FAILED;
}

int cli_usage(const cli_command *command, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    cli_say(format, arguments, "; see tides ");
    va_end(arguments);
    fprintf(stderr, "%s%s--help\n", command ? command->name : "", command ? " " : "");
    return CLI_USAGE;
}

void cli_note(const cli_common *common, const char *format, ...) {
    if (!common->verbose || common->quiet) return;
    va_list arguments;
    va_start(arguments, format);
    cli_say(format, arguments, "\n");
    va_end(arguments);
}

void cli_tell_lines(const cli_common *common, const char *lines) {
    for (size_t length; *lines && !common->quiet; lines += length + (lines[length] == '\n')) {
        length = strcspn(lines, "\n");
        fprintf(stderr, "tides: %.*s\n", (int)length, lines);
    }
}

void cli_add_notes(cJSON *facts, const char *lines) {
    cJSON *notes = *lines ? cJSON_AddArrayToObject(facts, "notes") : NULL;
    for (size_t length; *lines; lines += length + (lines[length] == '\n')) {
        char line[1024];
        length = strcspn(lines, "\n");
        snprintf(line, sizeof line, "%.*s", (int)length, lines);
        cJSON_AddItemToArray(notes, cJSON_CreateString(line));
    }
}

tides_status(cli_error)(tides_error *error, tides_status status, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    error->status = status;
    vsnprintf(error->text, sizeof error->text, format, arguments);
    va_end(arguments);
    for (char *at = error->text; *at; at++) /* names from outside may hold line ends */
        if ((unsigned char)*at < 0x20 || *at == 0x7f) *at = '?';
    return status;
}

const char *cli_count(double number, char text[24]) {
    static const char *const suffixes[] = {"", " k", " M", " G", " T"};
    size_t i = 0;
    while (i + 1 < sizeof suffixes / sizeof suffixes[0] && fabs(number) >= 999.5) {
        number /= 1000.0;
        i++;
    }
    snprintf(text, 24, "%.3g%s", number, suffixes[i]);
    return text;
}

/* -- facts ---------------------------------------------------------------------------------------------------------- */

/* A format for a number: seconds near 1e9 keep their decimals. */
static const char *number_format(const cJSON *value) {
    const size_t length = value->string ? strlen(value->string) : 0;
    const int32_t seconds = length > 2 && strcmp(value->string + length - 2, "_s") == 0;
    if (value->valuedouble == floor(value->valuedouble)) return "%.0f";
    return seconds && fabs(value->valuedouble) >= 1e6 ? "%.16g" : "%.7g";
}

static void print_scalar(const cJSON *value) {
    if (cJSON_IsString(value) || cJSON_IsRaw(value))
        printf("%s", value->valuestring);
    else if (cJSON_IsBool(value))
        printf("%s", cJSON_IsTrue(value) ? "yes" : "no");
    else if (cJSON_IsNumber(value))
        printf(number_format(value), value->valuedouble);
    else
        printf("-");
}

static int32_t is_scalar(const cJSON *value) { return !cJSON_IsObject(value) && !cJSON_IsArray(value); }

/* Prints an object's fields one per line, with names padded to the longest; an object in a list takes one line. */
static void print_fields(const cJSON *object, int indent) {
    size_t widest = 0;
    for (const cJSON *field = object->child; field; field = field->next)
        if (strlen(field->string) > widest) widest = strlen(field->string);
    for (const cJSON *field = object->child; field; field = field->next) {
        printf("%*s%-*s", indent, "", (int)widest + 2, field->string);
        if (is_scalar(field)) {
            print_scalar(field);
            putchar('\n');
        } else if (cJSON_IsArray(field) && (!field->child || is_scalar(field->child))) {
            for (const cJSON *item = field->child; item; item = item->next) {
                print_scalar(item);
                if (item->next) fputs("  ", stdout);
            }
            putchar('\n');
        } else if (cJSON_IsArray(field)) {
            putchar('\n');
            for (const cJSON *item = field->child; item; item = item->next) {
                printf("%*s", indent + 2, "");
                for (const cJSON *part = item->child; part; part = part->next) {
                    printf("%s ", part->string);
                    print_scalar(part);
                    if (part->next) fputs("  ", stdout);
                }
                putchar('\n');
            }
        } else {
            putchar('\n');
            print_fields(field, indent + 2);
        }
    }
}

int cli_print_facts(cJSON *facts, int32_t json) {
    if (!facts) return cli_failed("out of memory");
    char *text = json ? cJSON_Print(facts) : NULL;
    if (text)
        puts(text);
    else if (!json)
        print_fields(facts, 0);
    int code = json && !text ? cli_failed("out of memory") : CLI_OK;
    cJSON_free(text);
    cJSON_Delete(facts);
    return code;
}

int cli_report_facts(cJSON *facts, const cli_common *common) {
    if (common->json || !common->quiet || !facts) return cli_print_facts(facts, common->json);
    cJSON_Delete(facts);
    return CLI_OK;
}

/* -- CSV ------------------------------------------------------------------------------------------------------------ */

void cli_csv_text(FILE *file, const char *text) {
    putc('"', file);
    for (; *text; text++) {
        if (*text == '"') putc('"', file);
        putc(*text, file);
    }
    putc('"', file);
}

void cli_csv_value(FILE *file, const cJSON *value) {
    putc(',', file);
    if (cJSON_IsString(value)) cli_csv_text(file, value->valuestring);
    if (cJSON_IsNumber(value)) fprintf(file, "%.15g", value->valuedouble);
}

/* -- files ---------------------------------------------------------------------------------------------------------- */

tides_status cli_make_directory(const char *directory, tides_error *error) {
    struct stat found;
    if (strcmp(directory, "-") == 0)
        return cli_error(error, TIDES_WRITE_FAILED, "-o -: standard output isn't a folder: name one; ./- is one of that name");
    if (mkdir(directory, 0777) == 0) return TIDES_OK;
    if (errno == EEXIST && stat(directory, &found) == 0 && S_ISDIR(found.st_mode)) return TIDES_OK;
    return cli_error(error, TIDES_WRITE_FAILED, "%s: can't be made: %s", directory, strerror(errno));
}

int cli_ends_in(const char *path, const char *ending) {
    const size_t length = strlen(path), tail = strlen(ending);
    return length > tail && strcasecmp(path + length - tail, ending) == 0;
}

tides_status cli_write_file(const char *path, cli_writer put, const void *what, tides_error *error) {
    char *bytes = NULL;
    size_t size = 0;
    FILE *memory = open_memstream(&bytes, &size);
    if (memory) put(memory, what);
    int32_t made = memory && !ferror(memory);
    if (memory && fclose(memory) != 0) made = 0;
    if (!bytes) made = 0; /* glibc's fclose doesn't report that memory ran out */
    tides_status status =
        made ? tides_file_write(path, bytes, size, error) : cli_error(error, TIDES_NO_MEMORY, "out of memory: %s", path);
    free(bytes);
    return status;
}

static void put_line(FILE *file, const void *text) { fprintf(file, "%s\n", (const char *)text); }

char *cli_read_file(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    char *bytes = NULL;
    const long end = fseek(file, 0, SEEK_END) == 0 ? ftell(file) : -1;
    if (end >= 0 && fseek(file, 0, SEEK_SET) == 0 && (bytes = malloc((size_t)end + 1)) != NULL) {
        *size = fread(bytes, 1, (size_t)end, file);
        bytes[*size] = 0;
    }
    fclose(file);
    return bytes;
}

tides_status cli_write_text(const char *path, const char *text, tides_error *error) {
    return cli_write_file(path, put_line, text, error);
}
