/* Internal: a table of the arrays that make up a run's state, from which checkpoints save and restore them.
 *
 * Each part of a run that has a state gives one function that adds its rows: an array's name in the file, its element type,
 * and its address. A new array of state is one row beside the code that owns it. State that isn't an array of numbers (the
 * readout's queues) packs itself. The table borrows: it is valid as long as the arrays stay where they are. */
#ifndef TD_STATE_H
#define TD_STATE_H

#include <stddef.h>
#include <stdint.h>

/* Element types of an array: double, uint32_t, or int64_t. */
typedef enum td_state_type { TD_STATE_REAL, TD_STATE_COUNT, TD_STATE_WHOLE } td_state_type;
static inline size_t td_state_size(td_state_type type) {
    return type == TD_STATE_COUNT ? sizeof(uint32_t) : type == TD_STATE_WHOLE ? sizeof(int64_t) : sizeof(double);
}

/* TD_STATE_PIXELS: one value per pixel, in memory tile by tile and row by row within a tile. The file has the image's
 * order, so that a run with other tiles can continue from it. TD_STATE_PLAIN: stored as it is in memory. */
typedef enum td_state_order { TD_STATE_PIXELS, TD_STATE_PLAIN } td_state_order;

typedef struct td_state_row {
    const char *name; /* static; distinct among all parts of a run */
    td_state_type type;
    td_state_order order;
    size_t count;
    void *values; /* (count), owned by the part */
} td_state_row;

/* Twice the 24 rows of a run with all blocks on, as room for new blocks. */
enum { TD_STATE_ROWS = 48 };

typedef struct td_state {
    td_state_row row[TD_STATE_ROWS];
    int rows;
    int lost; /* rows without room; a table with any is refused */
} td_state;

/* Adds a row. `values` NULL: the array doesn't exist in this run, and no row is added. */
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
