/* Writes events as numpy arrays. A .npy has one structured array. A .npz has one array per column, written one after the
 * other, so its events wait in a temporary file, the spool, until the last event is known. */
#include "archive/td_npy.h"
#include "td_base.h"
#include "td_endian.h"
#include "td_event_npy.h"

#include <errno.h>
#include <stdlib.h>

/* RECORD: bytes of a packed row, 2 for x, 2 for y, 8 for t, 1 for p. ROWS: rows that are written at once. */
enum { RECORD = 13, ROWS = 4096 };

typedef struct npy_writer {
    td_npy_writer *file;
    FILE *spool; /* .npz: holds the events until their columns are written; NULL for a .npy */
    unsigned char rows[ROWS * 16];
} npy_writer;

void td_event_npy_discard(td_event_sink *sink) {
    npy_writer *w = sink->state;
    if (!w) return;
    td_npy_writer_discard(w->file);
    if (w->spool) fclose(w->spool);
    free(w);
}

/* Opens the array writer. It gets the sink's .part as its path: it writes to a .part of that one, and renames it to the
 * sink's .part when it is closed. The sink puts its .part in place after that. */
static tides_status create_writer(td_event_sink *sink, int zipped, tides_error *error) {
    npy_writer *w = td_alloc(1, sizeof *w, error);
    sink->state = w;
    return w ? td_npy_writer_open(sink->part, zipped, &w->file, error) : TIDES_NO_MEMORY;
}

/* Begins a .npy with the dtypes that tonic needs. Polarity is an int8, because tonic's voxel grids lose a polarity that is a
 * bool. Coordinates are int16, as from tonic's own readers. */
tides_status td_event_npy_create(td_event_sink *sink, tides_error *error) {
    tides_status status = create_writer(sink, 0, error);
    npy_writer *w = sink->state;
    return status == TIDES_OK
               ? td_npy_writer_begin(w->file,
                                     &(td_npy_form){"data", "[('x', '<i2'), ('y', '<i2'), ('t', '<i8'), ('p', '|i1')]", RECORD,
                                                    1, NULL},
                                     error)
               : status;
}

tides_status td_event_npy_write(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    npy_writer *w = sink->state;
    tides_status status = TIDES_OK;
    for (size_t done = 0; done < count && status == TIDES_OK;) {
        size_t some = count - done < ROWS ? count - done : ROWS;
        for (size_t i = 0; i < some; i++) {
            const tides_event *e = &events[done + i];
            unsigned char *p = w->rows + RECORD * i;
            td_put_le16(p, e->x);
            td_put_le16(p + 2, e->y);
            td_put_le64(p + 4, (uint64_t)(e->t / 1000));
            p[12] = e->polarity > 0;
        }
        status = td_npy_writer_append(w->file, w->rows, some, error);
        done += some;
    }
    return status;
}

tides_status td_event_npy_complete(td_event_sink *sink, int64_t stop_ns, tides_error *error) {
    (void)stop_ns;
    npy_writer *w = sink->state;
    td_npy_writer *file = w->file;
    w->file = NULL; /* td_npy_writer_close frees it, also if it fails */
    return td_npy_writer_close(file, error);
}

/* ---- writing .npz ---- */

tides_status td_event_npz_create(td_event_sink *sink, tides_error *error) {
    tides_status status = create_writer(sink, 1, error);
    npy_writer *w = sink->state;
    if (status != TIDES_OK) return status;
    char *name = td_format(error, "%s.spool", sink->part);
    if (!name) return TIDES_NO_MEMORY;
    w->spool = td_part_open(name, sink->path);
    if (!w->spool) status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be created: %s", name, strerror(errno));
    if (w->spool) remove(name); /* the name alone is gone: the spool's bytes exist until it is closed */
    free(name);
    return status;
}

tides_status td_event_npz_write(td_event_sink *sink, const tides_event *events, size_t count, tides_error *error) {
    npy_writer *w = sink->state;
    if (fwrite(events, sizeof *events, count, w->spool) == count) return TIDES_OK;
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: the space for its columns is full", sink->part);
}

static size_t put_field(unsigned char *out, const tides_event *e, int column) {
    switch (column) {
        case TD_NPY_T: td_put_le64(out, (uint64_t)e->t); return 8;
        case TD_NPY_X: td_put_le16(out, e->x); return 2;
        case TD_NPY_Y: td_put_le16(out, e->y); return 2;
        default: out[0] = (unsigned char)e->polarity; return 1;
    }
}

static tides_status write_column(npy_writer *w, const char *path, int column, tides_error *error) {
    tides_event events[256];
    tides_status status = TIDES_OK;
    rewind(w->spool);
    for (size_t got = 1; got && status == TIDES_OK;) {
        unsigned char *out = w->rows;
        got = fread(events, sizeof *events, sizeof events / sizeof *events, w->spool);
        for (size_t i = 0; i < got; i++) out += put_field(out, &events[i], column);
        if (got) status = td_npy_writer_append(w->file, w->rows, got, error);
    }
    if (status == TIDES_OK && ferror(w->spool))
        return td_fail(error, TIDES_WRITE_FAILED, "%s: its events can't be read back from their spool: %s", path,
                       strerror(errno));
    return status;
}

tides_status td_event_npz_complete(td_event_sink *sink, int64_t stop_ns, tides_error *error) {
    static const struct {
        const char *name, *dtype;
        size_t bytes;
    } arrays[TD_NPY_COLUMNS] = {{"t", "'<i8'", 8}, {"x", "'<u2'", 2}, {"y", "'<u2'", 2}, {"p", "'|i1'", 1}};
    npy_writer *w = sink->state;
    if (fflush(w->spool) != 0) return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: its disk is full", sink->part);
    for (int c = 0; c < TD_NPY_COLUMNS; c++) {
        tides_status status =
            td_npy_writer_begin(w->file, &(td_npy_form){arrays[c].name, arrays[c].dtype, arrays[c].bytes, 1, NULL}, error);
        if (status == TIDES_OK) status = write_column(w, sink->part, c, error);
        if (status != TIDES_OK) return status;
    }
    return td_event_npy_complete(sink, stop_ns, error);
}
