/* Writes a small HDF5 file as PATH.part and renames it. On failure the error has the reason from HDF5 or the system. */
#include "td_base.h"
#include "td_h5.h"
#include "td_h5_driver.h"

#include <stdlib.h>
#include <string.h>

static herr_t fill(const char *part, td_h5_put put, const void *user, int *failed) {
    const hid_t access = td_h5_write_access(failed);
    const hid_t file = access < 0 ? -1 : H5Fcreate(part, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    herr_t done = file < 0 ? -1 : put(file, user);
    td_h5_close(access);
    if (file >= 0 && H5Fclose(file) < 0) done = -1;
    return done;
}

tides_status td_h5_save(const char *path, td_h5_put put, const void *user, tides_error *error) {
    char *part = NULL;
    int failed = 0;
    td_h5_quiet quiet;
    td_h5_reason reason;
    tides_status status = td_part_name(path, 0, &part, error);
    if (status != TIDES_OK) return status;
    td_h5_quiet_begin(&quiet);
    if (fill(part, put, user, &failed) < 0 || failed)
        status = td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", path,
                         failed ? strerror(failed) : td_h5_reason_text(&reason));
    td_h5_quiet_end(&quiet);
    if (status == TIDES_OK)
        status = td_commit_file(part, path, error);
    else
        td_remove_part(part, path);
    free(part);
    return status;
}
