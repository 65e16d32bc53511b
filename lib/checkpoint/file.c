/* The bytes of a checkpoint: an HDF5 file that is built in memory, followed by a line of text, the seal, with a checksum of
 * all before it. HDF5 finds the end of its file in the superblock, and ignores the seal.
 *
 * The seal is checked before HDF5 reads a byte, so any damage is reported as damage. The file is built in memory because HDF5
 * can neither close nor free a file if the disk fills up while it writes. */
#include "td_checkpoint.h"
#include "td_hash.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SEAL_FORMAT "\ntides-checkpoint %016" PRIx64 "\n"
enum { SEAL_BYTES = 1 + 16 + 1 + 16 + 1 };

enum { GROW_BY = 1 << 20 }; /* bytes by which the image grows in memory */

static hid_t core_access(void) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    if (access >= 0 && H5Pset_fapl_core(access, GROW_BY, 0) >= 0) return access;
    if (access >= 0) H5Pclose(access);
    return H5I_INVALID_HID;
}

/* Name of the image. HDF5 looks for such a file on the disk, but none can exist below a plain file. */
static const char *const image_name = "/dev/null/checkpoint";

hid_t td_checkpoint_image_create(void) {
    hid_t access = core_access();
    hid_t image = access < 0 ? access : H5Fcreate(image_name, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    if (access >= 0) H5Pclose(access);
    return image;
}

/* -- writing -- */

static tides_status take_bytes(hid_t image, const char *path, char **bytes, size_t *size, tides_error *error) {
    ssize_t needed = H5Fflush(image, H5F_SCOPE_LOCAL) >= 0 ? H5Fget_file_image(image, NULL, 0) : -1;
    char *copy = needed > 0 ? td_alloc((size_t)needed, 1, error) : NULL;
    if (copy && H5Fget_file_image(image, copy, (size_t)needed) == needed) {
        *bytes = copy;
        *size = (size_t)needed;
        return TIDES_OK;
    }
    free(copy);
    return td_fail(error, TIDES_NO_MEMORY, "%s: the checkpoint can't be put together: out of memory?", path);
}

static tides_status write_sealed(const char *part, const char *path, const char *bytes, size_t size, tides_error *error) {
    char seal[SEAL_BYTES + 1];
    snprintf(seal, sizeof seal, SEAL_FORMAT, td_hash_words(0, bytes, size));
    FILE *file = td_part_open(part, path);
    int written = file && fwrite(bytes, 1, size, file) == size && fwrite(seal, 1, SEAL_BYTES, file) == SEAL_BYTES;
    int reason = errno;
    if (file && fclose(file) != 0 && written) { /* with a full disk the error may come only here */
        written = 0;
        reason = errno;
    }
    if (written) return TIDES_OK;
    if (file) unlink(part);
    return td_fail(error, TIDES_WRITE_FAILED, "%s: can't be written: %s", part, strerror(reason));
}

tides_status td_checkpoint_image_write(hid_t image, const char *path, tides_error *error) {
    char *bytes = NULL, *part = NULL;
    size_t size = 0;
    tides_status status = td_part_name(path, 0, &part, error);
    if (status == TIDES_OK) status = take_bytes(image, path, &bytes, &size, error);
    if (status == TIDES_OK) status = write_sealed(part, path, bytes, size, error);
    if (status == TIDES_OK) status = td_commit_file(part, path, error);
    free(bytes);
    free(part);
    return status;
}

/* -- reading -- */

static tides_status check_seal(const char *path, const char *bytes, size_t size, tides_error *error) {
    char seal[SEAL_BYTES + 1];
    if (size > SEAL_BYTES) snprintf(seal, sizeof seal, SEAL_FORMAT, td_hash_words(0, bytes, size - SEAL_BYTES));
    if (size > SEAL_BYTES && memcmp(seal, bytes + size - SEAL_BYTES, SEAL_BYTES) == 0) return TIDES_OK;
    return td_fail(error, TIDES_BAD_FILE, "%s: isn't a checkpoint of TIDES, or is damaged or cut short: its seal doesn't fit",
                   path);
}

tides_status td_checkpoint_image_read(const char *path, hid_t *image, tides_error *error) {
    char *bytes = NULL;
    size_t size = 0;
    tides_status status = td_read_file(path, SIZE_MAX / 4, &bytes, &size, error);
    if (status == TIDES_OK) status = check_seal(path, bytes, size, error);
    if (status == TIDES_OK) {
        hid_t access = core_access();
        int ready = access >= 0 && H5Pset_file_image(access, bytes, size - SEAL_BYTES) >= 0;
        hid_t opened = ready ? H5Fopen(image_name, H5F_ACC_RDONLY, access) : H5I_INVALID_HID;
        if (access >= 0) H5Pclose(access);
        if (opened >= 0)
            *image = opened;
        else
            status = td_fail(error, TIDES_BAD_FILE, "%s: isn't HDF5, though its seal is whole", path);
    }
    free(bytes);
    return status;
}
