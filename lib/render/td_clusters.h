/* Internal: clusters of neighbouring Gaussians, which tell the part of a scene that is in view. A cluster out of view in
 * an interval is neither swept nor listed. So a camera within millions of Gaussians costs only what it sees. Compiled in
 * double. */
#ifndef TD_CLUSTERS_H
#define TD_CLUSTERS_H

#include "render/dynamic/td_stray.h"

enum { TD_CLUSTER = 16 * TD_PAD };

/* Up to TD_CLUSTER Gaussians of an object, neighbours in the store, with bounds in the object's coordinates. */
typedef struct td_cluster {
    int begin, end;   /* indices in the store; multiples of TD_PAD */
    double centre[3]; /* all means are within `radius` of it; infinite radius: no bound, always in view */
    double radius;
    double axis;    /* largest standard deviation */
    double opacity; /* largest opacity */
} td_cluster;

/* States of a cluster. SEEN: it may be in view. LEFT: it is out of view, but still has boxes. GONE: it is out of view, and
 * its boxes are empty. */
enum { TD_CLUSTER_SEEN, TD_CLUSTER_LEFT, TD_CLUSTER_GONE };

typedef struct td_clusters {
    int count;
    td_cluster *of;
    int *first;     /* (objects + 1) into `of` */
    uint8_t *state; /* (count) TD_CLUSTER_* in the interval asked for last */
    int *group;     /* (groups of the store) result of td_clusters_seen */
} td_clusters;

/* An object's path through an interval: its views at both ends, `duration` seconds apart, and how far it strays from the
 * cubic between them. */
typedef struct td_cluster_path {
    const td_view *from, *to;
    const td_stray *stray;
    double duration; /* 0: an instant */
} td_cluster_path;

tides_status td_clusters_create(const td_store *store, td_clusters *clusters, tides_error *error);
void td_clusters_release(td_clusters *clusters);

/* Sets which of an object's clusters may be in view. */
void td_clusters_look(td_clusters *clusters, int object, const td_image *image, const td_cluster_path *path);

/* The groups of objects [first, end) in clusters that are SEEN; valid until the next call. */
td_groups td_clusters_seen(td_clusters *clusters, int first, int end);

#endif
