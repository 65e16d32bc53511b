/* Internal: kernel files embedded in the library at build time, so that the library needs no files beside it. */
#ifndef TD_KERNEL_SOURCE_H
#define TD_KERNEL_SOURCE_H

typedef struct td_kernel_source {
    const char *name;         /* "project.cl"; NULL ends the table */
    const char *const *lines; /* each ends in a newline; NULL ends the list */
} td_kernel_source;

extern const td_kernel_source td_kernel_sources[];

#endif
