/* Internal: checks parts of an HDF5 file before HDF5 (1.10.8) reads them, because HDF5 trusts the numbers in them. HDF5
 * reads every byte through our file driver (h5_driver.c). The driver calls the functions below for each local heap, node of a
 * B-tree and object header. Damage to other parts is found by HDF5, or did no harm in tests/property/test_hdf5_mutations.c. */
#ifndef TD_H5_CHECK_H
#define TD_H5_CHECK_H

#include <stddef.h>
#include <stdint.h>

/* A file on the disk. */
typedef struct td_h5_disk {
    int descriptor;
    uint64_t size, base; /* [bytes]; address 0 is at byte `base` */
} td_h5_disk;

/* Finds the superblock, and `base`. 0: there is none, or its addresses or lengths don't have 64 bits. */
int td_h5_check_superblock(td_h5_disk *disk);

/* td_h5_check_heap checks bytes that were read as a local heap, td_h5_check_tree those of a node of a B-tree. 0: damaged. */
int td_h5_check_heap(const td_h5_disk *disk, const unsigned char *bytes, size_t count);
int td_h5_check_tree(const td_h5_disk *disk, const unsigned char *bytes, size_t count);
/* Checks bytes that were read as an object header, or as a part of one. 0: damaged. */
int td_h5_check_header(const unsigned char *bytes, size_t count);

#endif
