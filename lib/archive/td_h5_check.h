/* Internal: parts of HDF5 files looked at before HDF5 (1.10.8) sees them, because it takes their numbers at their word: the
 * driver (td_h5_driver.h) asks for what it reads as a local heap, a tree or an object header. Everything else HDF5 checks
 * itself, or damage to it was never seen to matter (tests/property/test_hdf5_mutations.c). */
#ifndef TD_H5_CHECK_H
#define TD_H5_CHECK_H

#include <stddef.h>
#include <stdint.h>

/* A file on the disk. */
typedef struct td_h5_disk {
    int descriptor;
    uint64_t size, base; /* [bytes]; where addresses count from */
} td_h5_disk;

/* Finds the superblock, and with it `base`. 0: none, or its addresses or lengths don't have the 64 bits that all have. */
int td_h5_check_superblock(td_h5_disk *disk);

/* `bytes` were read at `at` as a local heap or as a node of a B-tree. 0: damaged. */
int td_h5_check_heap(const td_h5_disk *disk, const unsigned char *bytes, size_t count);
int td_h5_check_tree(const td_h5_disk *disk, const unsigned char *bytes, size_t count);
/* Checks bytes that were read as an object header, or as a part of one. 0: damaged. */
int td_h5_check_header(const unsigned char *bytes, size_t count);

#endif
