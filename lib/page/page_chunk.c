/* Writes the events of a page in chunks of up to TD_PAGE_CHUNK. Each chunk is a line
 *
 *   <script type="text/plain" class="events" data-count="N" data-first="T">BASE64</script>
 *
 * with zlib's deflate of the columns below, one after the other. A column is stored in planes of bytes, the lowest byte
 * first:
 *
 *   u4  time since the previous event, 0 for the first [ns]; the first is at T [ns]
 *   u2  x, u2 y
 *   u1  polarity (1: ON) + 2 cause
 *   f4  depth, flow_u, flow_v; u2 instance (65535: none)    where the page has ground truth
 *
 * A chunk also ends before it would span 2^32 ns. share/page/decode.js reads this. */
#include "td_base.h"
#include "td_page.h"

#include <inttypes.h>
#include <libdeflate.h>
#include <string.h>

/* Bytes of an event, those of its ground truth, and zlib's level. With level 6 an event of a demo takes 26.6 bits before
 * base64; with level 1 29.5, and with level 9 26.3 in twice the time. */
enum { PLAIN_BYTES = 9, TRUTH_BYTES = 14, LEVEL = 6, NO_INSTANCE = 65535 };

size_t td_page_planes_room(int32_t with_truth) {
    return (size_t)TD_PAGE_CHUNK * (PLAIN_BYTES + (with_truth ? TRUTH_BYTES : 0));
}
size_t td_page_packed_room(int32_t with_truth) { return libdeflate_zlib_compress_bound(NULL, td_page_planes_room(with_truth)); }
size_t td_page_base64_room(int32_t with_truth) { return td_page_packed_room(with_truth) / 3 * 4 + 8; }

static void put4(unsigned char *plane, size_t count, size_t i, uint32_t value) {
    for (int k = 0; k < 4; k++, value >>= 8) plane[k * count + i] = (unsigned char)value;
}

static void put2(unsigned char *plane, size_t count, size_t i, uint32_t value) {
    plane[i] = (unsigned char)value;
    plane[count + i] = (unsigned char)(value >> 8);
}

static uint32_t float_bits(double value) {
    const float rounded = (float)value;
    uint32_t bits;
    memcpy(&bits, &rounded, sizeof bits);
    return bits;
}

static size_t put_planes(td_page *page, const tides_event *e, const tides_event_truth *truth, size_t n) {
    unsigned char *at = page->planes, *const t = at, *const x = t + 4 * n, *const y = x + 2 * n, *const label = y + 2 * n;
    unsigned char *const depth = label + n, *const u = depth + 4 * n, *const v = u + 4 * n, *const instance = v + 4 * n;
    for (size_t i = 0; i < n; i++) {
        put4(t, n, i, i ? (uint32_t)(e[i].t - e[i - 1].t) : 0);
        put2(x, n, i, e[i].x);
        put2(y, n, i, e[i].y);
        label[i] = (unsigned char)((e[i].polarity > 0) | e[i].cause << 1);
        page->causes |= UINT32_C(1) << (e[i].cause & 31);
    }
    if (!truth) return PLAIN_BYTES * n;
    for (size_t i = 0; i < n; i++) {
        put4(depth, n, i, float_bits(truth[i].depth));
        put4(u, n, i, float_bits(truth[i].flow_u));
        put4(v, n, i, float_bits(truth[i].flow_v));
        const int32_t k = truth[i].instance;
        put2(instance, n, i, k < 0 || k > NO_INSTANCE ? NO_INSTANCE : (uint32_t)k);
    }
    return (PLAIN_BYTES + TRUTH_BYTES) * n;
}

/* Encodes base64 (RFC 4648); returns the number of characters. */
static size_t to_base64(const unsigned char *bytes, size_t size, char *to) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *at = to;
    for (size_t i = 0; i < size; i += 3, at += 4) {
        const size_t left = size - i;
        const uint32_t three =
            (uint32_t)bytes[i] << 16 | (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0) | (left > 2 ? bytes[i + 2] : 0u);
        for (int k = 0; k < 4; k++) at[k] = digits[three >> (18 - 6 * k) & 63];
        if (left < 3) at[3] = '=';
        if (left < 2) at[2] = '=';
    }
    return (size_t)(at - to);
}

static tides_status put_chunk(td_page *page, const tides_event *events, const tides_event_truth *truth, size_t count,
                              tides_error *error) {
    const size_t bytes = put_planes(page, events, truth, count);
    struct libdeflate_compressor *coder = libdeflate_alloc_compressor(LEVEL);
    const size_t room = td_page_packed_room(truth != NULL);
    const size_t packed = coder ? libdeflate_zlib_compress(coder, page->planes, bytes, page->packed, room) : 0;
    libdeflate_free_compressor(coder);
    if (packed == 0) return td_fail(error, TIDES_NO_MEMORY, "%s: out of memory", page->text.path);
    const size_t characters = to_base64(page->packed, packed, page->base64);
    (void)td_text_put(&page->text, NULL,
                      "<script type=\"text/plain\" class=\"events\" data-count=\"%zu\" data-first=\"%" PRId64 "\">", count,
                      events[0].t);
    td_page_put(&page->text, page->base64, characters);
    page->chunks++;
    return td_text_put(&page->text, error, "</script>\n");
}

/* Number of events within 2^32 ns of the first. */
static size_t within_reach(const tides_event *events, size_t count) {
    size_t low = 1, high = count;
    while (low < high) {
        const size_t middle = low + (high - low + 1) / 2;
        if ((uint64_t)events[middle - 1].t - (uint64_t)events[0].t <= UINT32_MAX)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

tides_status td_page_put_chunks(td_page *page, size_t count, tides_error *error) {
    tides_status status = TIDES_OK;
    for (size_t first = 0, n; first < count && status == TIDES_OK; first += n) {
        n = count - first < TD_PAGE_CHUNK ? count - first : TD_PAGE_CHUNK;
        n = within_reach(page->events + first, n);
        status = put_chunk(page, page->events + first, page->truth ? page->truth + first : NULL, n, error);
    }
    return status;
}
