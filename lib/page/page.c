/* Writes a page of events from beginning to end: selects and orders the events, and adds facts about them. */
#include "td_page.h"

#include "signal/td_event_sort.h"
#include "td_struct.h"
#include "tides/sensor.h"

#include <cjson/cJSON.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Default limit of events: a page of 90 MB, which browsers open in seconds. */
enum { MOST = 10000000 };

void tides_page_options_defaults(tides_page_options *options) {
    *options = (tides_page_options){.size = sizeof *options, .start_ns = INT64_MIN, .stop_ns = INT64_MAX, .most = MOST};
}

/* -- events ---------------------------------------------------------------------------------------------------------------- */

/* Writes the first `count` waiting events, after sorting if needed. */
static tides_status put_first(td_page *page, size_t count, tides_error *error) {
    tides_event *events = page->events;
    if (page->disorder) td_event_sort(events, page->scratch, page->count);
    page->disorder = 0;
    if (count == 0) return TIDES_OK;
    if (page->chunks > 0 && events[0].t < page->last_ns)
        return td_fail(error, TIDES_BAD_FILE,
                       "%s: an event at %" PRId64 " ns is more than %d places late: sort the events first", page->text.path,
                       events[0].t, TD_PAGE_CHUNK);
    if (page->chunks == 0) page->report.start_ns = events[0].t;
    page->last_ns = events[count - 1].t;
    tides_status status = td_page_put_chunks(page, count, error);
    page->count -= count;
    memmove(events, events + count, page->count * sizeof *events);
    if (page->truth) memmove(page->truth, page->truth + count, page->count * sizeof *page->truth);
    return status;
}

static void take(td_page *page, const tides_event *event, const tides_event_truth *truth) {
    page->disorder |= page->report.events > 0 && event->t < page->arrived_ns;
    page->arrived_ns = event->t;
    page->events[page->count] = *event;
    if (page->truth && truth) page->truth[page->count] = *truth;
    page->count++;
    page->report.events++;
    if (event->x >= page->report.width) page->report.width = event->x + 1;
    if (event->y >= page->report.height) page->report.height = event->y + 1;
}

tides_status td_page_append(td_page *page, const tides_event *events, const tides_event_truth *truth, size_t count,
                            tides_error *error) {
    const tides_page_options *o = &page->options;
    for (size_t i = 0; i < count && !page->report.ended; i++) {
        if (events[i].t < o->start_ns || events[i].t >= o->stop_ns) continue;
        if (page->report.events == o->most) {
            page->report.ended = 1;
            break;
        }
        take(page, &events[i], truth ? &truth[i] : NULL);
        if (page->truth && page->disorder)
            return td_fail(error, TIDES_BAD_FILE, "%s: events with ground truth that aren't in order of time", page->text.path);
        tides_status status = page->count == 2 * TD_PAGE_CHUNK ? put_first(page, TD_PAGE_CHUNK, error) : TIDES_OK;
        if (status != TIDES_OK) return status;
    }
    return TIDES_OK;
}

/* -- beginning ------------------------------------------------------------------------------------------------------------- */

static tides_status check(const tides_page_options *o, tides_error *error) {
    if (o->start_ns >= o->stop_ns)
        return td_fail(error, TIDES_BAD_ARGUMENT, "page: start_ns = %" PRId64 " isn't before stop_ns = %" PRId64, o->start_ns,
                       o->stop_ns);
    if (o->width < 0 || o->height < 0 || o->width > 65536 || o->height > 65536)
        return td_fail(error, TIDES_BAD_ARGUMENT, "page: a sensor of %d x %d px: should be 0 to 65536 px", o->width, o->height);
    if (o->window_ns < 0) return td_fail(error, TIDES_BAD_ARGUMENT, "page: window_ns = %" PRId64 " is below 0", o->window_ns);
    return TIDES_OK;
}

static tides_status reserve(td_page *page, int32_t with_truth, tides_error *error) {
    page->events = td_alloc(2 * TD_PAGE_CHUNK, sizeof *page->events, error);
    page->scratch = td_alloc(2 * TD_PAGE_CHUNK, sizeof *page->scratch, error);
    page->truth = with_truth ? td_alloc(2 * TD_PAGE_CHUNK, sizeof *page->truth, error) : NULL;
    page->planes = td_alloc(td_page_planes_room(with_truth), 1, error);
    page->packed = td_alloc(td_page_packed_room(with_truth), 1, error);
    page->base64 = td_alloc(td_page_base64_room(with_truth), 1, error);
    const int done = page->events && page->scratch && page->planes && page->packed && page->base64;
    return done && (page->truth || !with_truth) ? TIDES_OK : TIDES_NO_MEMORY;
}

tides_status td_page_begin(td_page *page, const char *path, const tides_page_options *options, int32_t with_truth,
                           tides_error *error) {
    memset(page, 0, sizeof *page);
    tides_page_options_defaults(&page->options);
    tides_status status = options ? TD_TAKE_STRUCT(tides_page_options, &page->options, options, error) : TIDES_OK;
    if (status == TIDES_OK) status = check(&page->options, error);
    if (status == TIDES_OK) status = reserve(page, with_truth, error);
    if (status == TIDES_OK) status = td_text_open(&page->text, path, error);
    if (status == TIDES_OK) td_page_put_head(&page->text);
    page->report.truth = with_truth;
    return status;
}

/* -- the end --------------------------------------------------------------------------------------------------------------- */

/* Finds the span of time to show: the requested one, limited to the recording's if that is known, otherwise to the events'. */
static void find_stretch(td_page *page) {
    const tides_page_options *o = &page->options;
    tides_page_report *r = &page->report;
    const int32_t known = page->known_start < page->known_stop;
    const int64_t stop = r->events ? page->last_ns + (page->last_ns < INT64_MAX) : 0;
    if (known && (r->events == 0 || page->known_start < r->start_ns)) r->start_ns = page->known_start;
    r->stop_ns = known && page->known_stop > stop ? page->known_stop : stop;
    if (o->start_ns > r->start_ns) r->start_ns = o->start_ns;
    if (o->stop_ns < r->stop_ns) r->stop_ns = o->stop_ns;
    if (r->ended) r->stop_ns = stop;
    if (r->stop_ns <= r->start_ns) r->stop_ns = r->start_ns + 1;
    if (r->width < o->width || r->width == 0) r->width = o->width ? o->width : 1;
    if (r->height < o->height || r->height == 0) r->height = o->height ? o->height : 1;
}

/* Adds 64 bits as text: numbers in JavaScript have 53. */
static int add_ns(cJSON *json, const char *name, int64_t ns) {
    char text[24];
    snprintf(text, sizeof text, "%" PRId64, ns);
    return cJSON_AddStringToObject(json, name, text) != NULL;
}

/* Adds the names of the causes, unless all events come from the signal. */
static int add_causes(cJSON *json, const td_page *page) {
    static const char *const causes[TIDES_CAUSES] = {"signal", "leak", "shot noise", "hot pixel"};
    cJSON *names = cJSON_AddArrayToObject(json, "causes");
    int ok = names != NULL;
    for (int c = 0; ok && c < TIDES_CAUSES && page->causes > 1; c++)
        ok = cJSON_AddItemToArray(names, cJSON_CreateString(causes[c]));
    return ok;
}

/* The facts as JSON text; NULL if memory is short. */
static char *facts_text(const td_page *page) {
    const tides_page_report *r = &page->report;
    const char *title = page->options.title ? page->options.title : "events";
    cJSON *json = cJSON_CreateObject();
    const int ok = cJSON_AddStringToObject(json, "title", title) &&
                   cJSON_AddNumberToObject(json, "events", (double)r->events) &&
                   cJSON_AddNumberToObject(json, "width", r->width) && cJSON_AddNumberToObject(json, "height", r->height) &&
                   add_ns(json, "start", r->start_ns) && add_ns(json, "stop", r->stop_ns) &&
                   add_ns(json, "window", page->options.window_ns) && cJSON_AddBoolToObject(json, "truth", r->truth) &&
                   cJSON_AddBoolToObject(json, "ended", r->ended) && add_causes(json, page) &&
                   cJSON_AddStringToObject(json, "version", tides_version());
    char *text = ok ? cJSON_PrintUnformatted(json) : NULL;
    cJSON_Delete(json);
    return text;
}

/* Writes the facts as JSON in a script element. Every < is written as its code, since "</script" would end the element. */
static tides_status put_facts(td_page *page, tides_error *error) {
    char *text = facts_text(page);
    if (!text) return td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", page->text.path);
    (void)td_text_put(&page->text, NULL, "<script type=\"application/json\" id=\"facts\">");
    for (const char *at = text; *at;) {
        const size_t plain = strcspn(at, "<");
        td_page_put(&page->text, at, plain);
        at += plain;
        if (*at == '<') td_page_put(&page->text, "\\u003c", 6), at++;
    }
    free(text);
    return td_text_put(&page->text, error, "</script>\n");
}

tides_status td_page_end(td_page *page, tides_status status, tides_error *error) {
    if (status == TIDES_OK) status = put_first(page, page->count, error);
    if (status == TIDES_OK) find_stretch(page);
    if (status == TIDES_OK) status = put_facts(page, error);
    if (status == TIDES_OK) td_page_put_tail(&page->text);
    status = td_text_close(&page->text, status, error);
    free(page->events);
    free(page->scratch);
    free(page->truth);
    free(page->planes);
    free(page->packed);
    free(page->base64);
    return status;
}

tides_status tides_page_write(const char *path, const tides_event *events, const tides_event_truth *truth, size_t count,
                              const tides_page_options *options, tides_page_report *report, tides_error *error) {
    if (!path || (!events && count > 0)) return td_fail(error, TIDES_BAD_ARGUMENT, "tides_page_write: an argument is NULL");
    for (size_t i = 1; i < count; i++)
        if (events[i].t < events[i - 1].t)
            return td_fail(error, TIDES_BAD_ARGUMENT, "tides_page_write: event %zu is before the one before it", i);
    td_page page;
    tides_status status = td_page_begin(&page, path, options, truth != NULL, error);
    if (status == TIDES_OK) status = td_page_append(&page, events, truth, count, error);
    status = td_page_end(&page, status, error);
    if (status == TIDES_OK && report) *report = page.report;
    return status;
}
