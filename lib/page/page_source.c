/* The template of the page, files of share/page that are embedded in the library. page.html includes other files by lines "@
 * FILE", and "@ events" is the place of the events. */
#include "device/td_kernel_source.h"
#include "td_page.h"

#include <errno.h>
#include <string.h>

extern const td_kernel_source td_page_sources[];

static const char mark[] = "@ ", place[] = "@ events\n";

static const char *const *lines_of(const char *name, size_t length) {
    static const char *const none[] = {NULL};
    for (const td_kernel_source *s = td_page_sources; s->name; s++)
        if (strncmp(s->name, name, length) == 0 && !s->name[length]) return s->lines;
    return none;
}

void td_page_put(td_text *text, const void *bytes, size_t size) {
    errno = 0;
    if (fwrite(bytes, 1, size, text->file) != size && !text->failed) text->failed = errno ? errno : EIO;
}

static void put_line(td_text *text, const char *line) {
    if (strncmp(line, mark, sizeof mark - 1) != 0) {
        td_page_put(text, line, strlen(line));
        return;
    }
    const char *name = line + sizeof mark - 1;
    for (const char *const *l = lines_of(name, strcspn(name, "\n")); *l; l++) td_page_put(text, *l, strlen(*l));
}

void td_page_put_head(td_text *text) {
    for (const char *const *l = lines_of("page.html", strlen("page.html")); *l && strcmp(*l, place) != 0; l++)
        put_line(text, *l);
}

void td_page_put_tail(td_text *text) {
    const char *const *l = lines_of("page.html", strlen("page.html"));
    while (*l && strcmp(*l, place) != 0) l++;
    for (l += *l != NULL; *l; l++) put_line(text, *l);
}
