/* Internal: clusters, which tell the part of a scene that is in view. Neighbours in the store make a cluster; one that nothing
 * can be seen of in an interval is neither swept nor listed, so that a camera within millions of Gaussians pays for what it
 * sees. Compiled in double. */
#ifndef TD_CLUSTERS_H
#define TD_CLUSTERS_H

#include "render/dynamic/td_stray.h"

enum { TD_CLUSTER = 16 * TD_PAD };

/* Up to TD_CLUSTER of an object's Gaussians, neighbours in the store, and what bounds them, in the object's coordinates. */
typedef struct td_cluster {
    int begin, end;   /* in the store; multiples of TD_PAD */
    double centre[3]; /* means are within `radius` of it; infinite: they can't be bounded, and are always taken for seen */
    double radius;
    double axis;    /* no standard deviation is larger */
    double opacity; /* the largest */
} td_cluster;

/* States of a cluster. SEEN: it may be in view. LEFT: it is out of view, and has boxes of when it was in view. GONE: it is out
 * of view, and has none. */
enum { TD_CLUSTER_SEEN, TD_CLUSTER_LEFT, TD_CLUSTER_GONE };

typedef struct td_clusters {
    int count;
    td_cluster *of;
    int *first;     /* (objects + 1) into `of` */
    uint8_t *state; /* (count) TD_CLUSTER_*, in the interval that was asked for last */
    int *group;     /* (groups of the store) of td_clusters_seen */
} td_clusters;

/* An object's way through an interval: how it is seen at both ends, `duration` seconds apart, and how far it strays from the
 * cubic between them. */
typedef struct td_cluster_path {
    const td_view *from, *to;
    const td_stray *stray;
    double duration; /* 0: an instant */
} td_cluster_path;

tides_status td_clusters_create(const td_store *store, td_clusters *clusters, tides_error *error);
void td_clusters_release(td_clusters *clusters);

/* Which of an object's clusters may be seen. */
void td_clusters_look(td_clusters *clusters, int object, const td_image *image, const td_cluster_path *path);

/* The groups of objects [first, end) that are in clusters seen, until they are asked for again. */
td_groups td_clusters_seen(td_clusters *clusters, int first, int end);

#endif
