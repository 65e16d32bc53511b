/* Memory for rows of Gaussians that a backend has moved. */
#include "td_backend.h"

#include <stdlib.h>

void td_moved_rows_release(td_moved_rows *rows) {
    free(rows->geometry);
    free(rows->rates);
    free(rows->sh);
    free(rows->sh_rates);
    free(rows->owners);
    *rows = (td_moved_rows){0};
}

tides_status td_moved_rows_reserve(size_t count, size_t sh_stride, td_moved_rows *rows, tides_error *error) {
    const size_t sh = count * sh_stride + 1;
    td_moved_rows made = {0};
    made.geometry = td_alloc(count * TD_GEOMETRY_STRIDE, sizeof *made.geometry, error);
    made.rates = td_alloc(count * TD_GEOMETRY_STRIDE, sizeof *made.rates, error);
    made.sh = td_alloc(sh, sizeof *made.sh, error);
    made.sh_rates = td_alloc(sh, sizeof *made.sh_rates, error);
    made.owners = td_alloc(2 * count, sizeof *made.owners, error);
    if (!made.geometry || !made.rates || !made.sh || !made.sh_rates || !made.owners) {
        td_moved_rows_release(&made);
        return TIDES_NO_MEMORY;
    }
    td_moved_rows_release(rows);
    *rows = made;
    return TIDES_OK;
}
