/* SPDX-License-Identifier: Apache-2.0 */
/* Starts that intersect: panels that begin within a body are moved out of it
 * (app/patterns/README.md §10), and meshes are parted (§13). */
#ifndef APP_READ_UNTANGLE_H
#define APP_READ_UNTANGLE_H

#include "app/base/pool.h"

#include <drape.h>
#include <stdbool.h>
#include <stdint.h>

/* Bodies of a mesh, some of which are panels that may move. */
struct clearing {
    int64_t nt;
    double (*x)[3];          /* [first[parts]] m; out: as they were moved */
    const int32_t (*tri)[3]; /* [nt] */
    int parts;               /* bodies */
    const int64_t *first;    /* [parts + 1] vertices of each */
    const bool *moves;       /* [parts] it is a panel that may move */
    int threads;
    /* out: */
    double (*way)[3]; /* [parts] m, of each */
    int *by;          /* [parts] the panel that was in a body and moved it, -1:
                         it stayed */
    int stuck;        /* a panel for which no way was found, -1: none */
    struct clear_place {
        int64_t pairs;      /* of triangles of the panel and of what stands */
        int body;           /* the first of these */
        double at[3], size; /* m, their middle; the longest side of their box */
        double tried;       /* m, the farthest that it was moved */
    } place;                /* of the panel that is stuck */
    struct pool *pool;      /* of what it takes */
};

/* Moves panels that intersect what stands, each as a whole: a flat one along
 * its normal, either way, one that is rolled in any of 26 directions by a
 * quarter of its extent at most. It goes by the least way found, in steps of 5
 * mm, on which neither it nor what it pushes intersects anything else. A panel
 * that it meets, or that lies parallel in front of it within 1 cm, is pushed.
 * Returns app_exit; what fails prints one line. */
int clear_panels(struct clearing *clearing);

/* A region where surfaces go through each other. */
struct tangle {
    int body[2];         /* of its sides; the same: a body and itself */
    int64_t pairs;       /* of triangles */
    double length;       /* m, of the line along which they intersect */
    double lo[3], hi[3]; /* m, around that line */
    bool parted;
};
struct tangles {
    struct tangle *row; /* [count] */
    int count;
};

/* Bodies of a mesh, to be parted. */
struct untangling {
    int64_t nt;
    double (*x)[3];           /* [first[parts]] m; out: as they were moved */
    const int32_t (*tri)[3];  /* [nt] */
    int parts;                /* bodies */
    const int64_t *first;     /* [parts + 1] vertices of each */
    const bool *fixed;        /* [parts] it is an obstacle */
    const drape_world *world; /* whose seams' pairs are passed over, or NULL */
    int threads, rounds;      /* rounds: at most */
    struct pool *pool;        /* of what it takes */
    /* out: */
    struct tangles found, left; /* at the start, at the end */
    int made;                   /* rounds */
    double *way;                /* [parts] m, the farthest that one was moved */
    int32_t *mark; /* [nt] the region at the start that a triangle is of, -1 */
};

/* Lists where bodies intersect themselves and each other, and parts them if
 * `rounds` is not 0. What it could not part is as it was. Coordinates
 * that were changed are those of binary32. Returns app_exit; what fails prints
 * one line.
 */
int untangle(struct untangling *untangling);

#endif
