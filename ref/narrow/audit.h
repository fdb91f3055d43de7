/* SPDX-License-Identifier: Apache-2.0 */
/* Stage audit: finds every intersecting pair of triangles of a mesh. The stage
 * judges the simulator's results, so in the reference it shares no code with
 * the simulator's collision detection. spec/narrow/audit.md */
#ifndef REF_AUDIT_H
#define REF_AUDIT_H

#include "ref/base/stage.h"

struct face;

/* The boxes of four children. An absent child has an empty box: lo > hi. */
struct audit_quad {
    real lo[3][4], hi[3][4];
};

struct audit {
    int64_t nv, nt;          /* vertices, triangles; < 2^31 each */
    const vec *x;            /* [nv] m, |x| ≤ 2^60 */
    const int32_t (*tri)[3]; /* [nt] vertices of a triangle */
    const int32_t *group;    /* [nt] or NULL: all 1. Two triangles of group 0
                                (obstacles) are not compared */
    int across;              /* 1: two triangles of groups other than 0 are
                                not compared either, so only pairs of cloth
                                and obstacle are */

    int64_t n_nodes;         /* ref_audit_nodes(nt) */
    uint64_t *key[2];        /* scratch: [nt] */
    int32_t *order[2];       /* scratch: [nt] */
    struct audit_quad *node; /* scratch: [n_nodes] */
    int64_t *count;          /* scratch: [n_nodes] */

    int64_t cap;          /* capacity for pairs */
    int32_t (*pair)[2];   /* out: [found] triangles a < b, ascending */
    uint8_t *degenerate;  /* out: [nt] 1: the corners lie on one line */
    int64_t found;        /* out: pairs */
    int64_t n_degenerate; /* out: degenerate triangles; they are in no pair */
};

/* Returns the number of nodes of the tree over nt triangles. */
int64_t ref_audit_nodes(int64_t nt);

/* DRAPE_OK; DRAPE_EDATA if a position is NaN or out of range; DRAPE_EARG if a
 * triangle has a vertex number out of range; DRAPE_EFULL if found > cap, and
 * then no pair is written. */
int ref_audit(struct audit *s);

/* Returns the corners of triangle t (struct face is in ref/narrow/tritri.h). */
struct face ref_audit_face(const struct audit *s, int32_t t);
/* Calls `ask` for every other triangle whose box meets the box of t, until
 * `ask` returns true. ref_audit must have run before. The order of the calls
 * depends only on the mesh. Returns whether some call returned true. */
bool ref_audit_any(const struct audit *s, int32_t t,
                   bool ask(void *user, int32_t other), void *user);

#endif
