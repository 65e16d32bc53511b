/* An HDF5 file driver that hides write failures from HDF5, which would crash on them, and keeps them for the caller. Its
 * files are equal to those of HDF5's own driver. */
#include "td_base.h"
#include "td_h5_check.h"
#include "td_h5_driver.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

/* An open file. HDF5's functions for the handle expect a pointer to the descriptor, as its own driver returns. */
typedef struct disk_file {
    H5FD_t head; /* HDF5's */
    int descriptor;
    int *failed;            /* NULL: the file is only read */
    haddr_t allocated, end; /* ends of the space that HDF5 has allocated, and of the bytes that it believes written */
    dev_t device;
    ino_t inode;
    td_h5_disk disk; /* of a file opened for reading: for the checks of damage */
    int written;     /* 1: bytes were written since it was opened */
} disk_file;

typedef struct disk_access {
    int *failed;
} disk_access;

static void fail(const disk_file *f, int reason) {
    if (f->failed && !*f->failed) *f->failed = reason ? reason : EIO;
}

/* Opens and locks the file. HDF5 itself locks it only after it has truncated it, and another run's data would be lost. */
static int open_descriptor(const char *name, unsigned flags) {
    if (flags & H5F_ACC_TRUNC) return td_claim_file(name);
    return flags & H5F_ACC_RDWR ? td_open_own(name, 0) : open(name, O_RDONLY);
}

static H5FD_t *open_file(const char *name, unsigned flags, hid_t access, haddr_t most) {
    const disk_access *given = H5Pget_driver_info(access);
    struct stat facts;
    disk_file *f = given ? calloc(1, sizeof *f) : NULL;
    (void)most;
    if (!f) return NULL;
    f->failed = given->failed;
    f->descriptor = open_descriptor(name, flags);
    if (f->descriptor >= 0 && fstat(f->descriptor, &facts) == 0) {
        f->end = (haddr_t)facts.st_size;
        f->device = facts.st_dev;
        f->inode = facts.st_ino;
        f->disk = (td_h5_disk){f->descriptor, f->end, 0};
        errno = EINVAL;
        if (flags & H5F_ACC_TRUNC || td_h5_check_superblock(&f->disk)) return &f->head;
    }
    if (flags & H5F_ACC_CREAT) fail(f, errno); /* HDF5 first tries to open without creating: that isn't a failure */
    if (f->descriptor >= 0) close(f->descriptor);
    free(f);
    return NULL;
}

static herr_t close_file(H5FD_t *file) {
    disk_file *f = (disk_file *)file;
    if (close(f->descriptor) != 0) fail(f, errno);
    free(f);
    return 0;
}

static int compare_files(const H5FD_t *one, const H5FD_t *two) {
    const disk_file *a = (const disk_file *)one, *b = (const disk_file *)two;
    if (a->device != b->device) return a->device < b->device ? -1 : 1;
    if (a->inode != b->inode) return a->inode < b->inode ? -1 : 1;
    return 0;
}

/* Features of HDF5's own driver, so that files are equal, but not its metadata accumulator (H5FD_FEAT_ACCUMULATE_METADATA).
 * The accumulator only gathers reads and writes, and it overruns its buffer if a size is damaged. */
static herr_t query(const H5FD_t *file, unsigned long *flags) {
    (void)file;
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA |
             H5FD_FEAT_POSIX_COMPAT_HANDLE | H5FD_FEAT_SUPPORTS_SWMR_IO | H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
    return 0;
}

static haddr_t get_allocated(const H5FD_t *file, H5FD_mem_t type) {
    (void)type;
    return ((const disk_file *)file)->allocated;
}

static herr_t set_allocated(H5FD_t *file, H5FD_mem_t type, haddr_t end) {
    (void)type;
    ((disk_file *)file)->allocated = end;
    return 0;
}

static haddr_t get_end(const H5FD_t *file, H5FD_mem_t type) {
    (void)type;
    return ((const disk_file *)file)->end;
}

static herr_t get_handle(H5FD_t *file, hid_t access, void **handle) {
    (void)access;
    *handle = &((disk_file *)file)->descriptor;
    return 0;
}

/* Checks bytes before HDF5 reads them. Heaps and trees are checked only until something is written. Later they may lie in
 * HDF5's cache, and are our own. Headers are always checked: that needs no other bytes, and a resumed run writes before it
 * opens its columns. */
static int is_sound(const disk_file *f, H5FD_mem_t type, const unsigned char *bytes, size_t count) {
    if (type == H5FD_MEM_OHDR) return td_h5_check_header(bytes, count);
    if (f->written) return 1;
    if (type == H5FD_MEM_LHEAP) return td_h5_check_heap(&f->disk, bytes, count);
    return type != H5FD_MEM_BTREE || td_h5_check_tree(&f->disk, bytes, count);
}

/* Reads bytes. Beyond the end, a file that is written gives zeros, as HDF5 expects. */
static herr_t read_bytes(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t at, size_t size, void *out) {
    const disk_file *f = (const disk_file *)file;
    unsigned char *to = out;
    const size_t asked = size;
    (void)transfer;
    if (at > (haddr_t)INT64_MAX - size || (!f->failed && (at > f->end || size > f->end - at))) return -1;
    while (size > 0) {
        ssize_t got = pread(f->descriptor, to, size, (off_t)at);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return -1;
        if (got == 0) break;
        to += got, at += (haddr_t)got, size -= (size_t)got;
    }
    memset(to, 0, size);
    return is_sound(f, type, out, asked) ? 0 : -1;
}

static herr_t write_bytes(H5FD_t *file, H5FD_mem_t type, hid_t transfer, haddr_t at, size_t size, const void *from) {
    disk_file *f = (disk_file *)file;
    const unsigned char *next = from;
    (void)type, (void)transfer;
    if (!f->failed || at > (haddr_t)INT64_MAX - size) return -1;
    f->written = 1;
    if (at + size > f->end) f->end = at + size;
    while (size > 0 && !*f->failed) {
        ssize_t put = pwrite(f->descriptor, next, size, (off_t)at);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) {
            fail(f, put < 0 ? errno : ENOSPC);
            break;
        }
        next += put, at += (haddr_t)put, size -= (size_t)put;
    }
    return 0;
}

static herr_t cut(H5FD_t *file, hid_t transfer, hbool_t closing) {
    disk_file *f = (disk_file *)file;
    (void)transfer, (void)closing;
    if (f->allocated == f->end || !f->failed) return 0;
    if (!*f->failed && ftruncate(f->descriptor, (off_t)f->allocated) != 0) fail(f, errno);
    f->end = f->allocated;
    return 0;
}

static herr_t lock(H5FD_t *file, hbool_t alone) {
    const disk_file *f = (const disk_file *)file;
    return flock(f->descriptor, (alone ? LOCK_EX : LOCK_SH) | LOCK_NB) == 0 || errno == ENOSYS ? 0 : -1;
}

/* Does nothing: closing the file unlocks it, once all duplicates of the descriptor are closed. td_keep_claim holds one. */
static herr_t unlock(H5FD_t *file) {
    (void)file;
    return 0;
}

static const H5FD_class_t disk_class = {
#ifdef H5FD_CLASS_VERSION /* HDF5 1.14 */
    .version = H5FD_CLASS_VERSION,
    .value = 0x7d1,
#endif
    .name = "tides-disk",
    .maxaddr = (haddr_t)INT64_MAX,
    .fc_degree = H5F_CLOSE_WEAK,
    .fapl_size = sizeof(disk_access),
    .open = open_file,
    .close = close_file,
    .cmp = compare_files,
    .query = query,
    .get_eoa = get_allocated,
    .set_eoa = set_allocated,
    .get_eof = get_end,
    .get_handle = get_handle,
    .read = read_bytes,
    .write = write_bytes,
    .truncate = cut,
    .lock = lock,
    .unlock = unlock,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

/* Registers the driver once, and again if the program around us has closed HDF5. With a registration for each file, closing
 * the last file would free the driver before HDF5 1.10 has finished with it (H5FD_close). */
static hid_t get_driver(void) {
    static hid_t driver = H5I_INVALID_HID;
    if (driver < 0 || H5Iget_type(driver) != H5I_VFL) driver = H5FDregister(&disk_class);
    return driver;
}

static herr_t set_driver(hid_t access, int *failed) { /* NOLINT(readability-non-const-parameter): writing goes through it */
    const disk_access given = {failed};
    const hid_t driver = get_driver();
    return driver < 0 ? -1 : H5Pset_driver(access, driver, &given);
}

static hid_t make_access(int *failed) {
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    herr_t done = access < 0 ? -1 : set_driver(access, failed);
    if (done >= 0) done = H5Pset_libver_bounds(access, H5F_LIBVER_EARLIEST, H5F_LIBVER_LATEST);
#if H5_VERSION_GE(1, 10, 7)
    if (done >= 0) done = H5Pset_file_locking(access, 1, 1); /* some file systems have no locks */
#endif
    if (done >= 0) return access;
    if (access >= 0) H5Pclose(access);
    return H5I_INVALID_HID;
}

hid_t td_h5_write_access(int *failed) {
    *failed = 0;
    return make_access(failed);
}

hid_t td_h5_read_access(void) { return make_access(NULL); }

hid_t td_h5_open_disk(const char *path) {
    hid_t access = td_h5_read_access(), file = access < 0 ? -1 : H5Fopen(path, H5F_ACC_RDONLY, access);
    if (access >= 0) H5Pclose(access);
    return file;
}

int td_h5_descriptor(hid_t file) {
    void *handle = NULL;
    return H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) >= 0 && handle ? *(int *)handle : -1;
}
