/* Internal: the state of a run's parts as a table, for whoever saves it and puts it back (lib/checkpoint).
 *
 * Each part that has a state gives one function that adds its rows: what the file calls an array, what it holds, and where it
 * stands in the part's own memory. A new array of state is one row beside the code that owns it. State that isn't an array of
 * numbers (the readout's queues) packs itself. The table borrows: it lasts as long as the arrays stay where they are. */
#ifndef TD_STATE_H
#define TD_STATE_H

#include <stddef.h>
#include <stdint.h>

/* Element types of an array: double, uint32_t, or int64_t. */
typedef enum td_state_type { TD_STATE_REAL, TD_STATE_COUNT, TD_STATE_WHOLE } td_state_type;
static inline size_t td_state_size(td_state_type type) {
    return type == TD_STATE_COUNT ? sizeof(uint32_t) : type == TD_STATE_WHOLE ? sizeof(int64_t) : sizeof(double);
}

/* One value per pixel in the simulator's order (tile by tile, each tile's pixels row by row), which the file has in the image's
 * order, so that other tiles can take it up; or as it stands. */
typedef enum td_state_order { TD_STATE_PIXELS, TD_STATE_PLAIN } td_state_order;

typedef struct td_state_row {
    const char *name; /* static; distinct among all parts of a run */
    td_state_type type;
    td_state_order order;
    size_t count;
    void *values; /* (count), the part's */
} td_state_row;

/* Twice what a run with every block has today (24 rows), so that a new block needs no thought. */
enum { TD_STATE_ROWS = 48 };

typedef struct td_state {
    td_state_row row[TD_STATE_ROWS];
    int rows;
    int lost; /* rows that found no room: whoever walks the table refuses it then */
} td_state;

/* Adds a row. `values` NULL: this run hasn't got the array, and the file doesn't name it. */
static inline void td_state_add(td_state *state, const char *name, td_state_type type, td_state_order order, size_t count,
                                void *values) {
    const td_state_row row = {name, type, order, count, values};
    if (!values) return;
    if (state->rows < TD_STATE_ROWS)
        state->row[state->rows++] = row;
    else
        state->lost++;
}

#endif
