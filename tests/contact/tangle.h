/* SPDX-License-Identifier: Apache-2.0 */
/* A small scene with a brute-force broad phase, for collision response. */
#ifndef TESTS_TANGLE_H
#define TESTS_TANGLE_H

#include "ref/contact/response.h"
#include "tests/base/harness.h"

struct tangle {
    struct response r;  /* its w, x0, x1 and v are the streams below */
    struct arena arena; /* of the response's pools */
    int64_t nv, nt, ne;
    int32_t (*tri)[3], (*edge)[2];
    real *w;
    vec *x0, *x1, *v;
    uint16_t *of;
    struct surface surface;
    int32_t *pair; /* result of the last broad phase */
    uint8_t *kind;
    int64_t n, cap;
    real reach; /* m, by which the boxes are fattened */
};

/* Allocates nv vertices and nt triangles, all zero. */
void tangle_make(struct tangle *t, int64_t nv, int64_t nt);
/* Finds the edges; call it when the triangles are set. */
void tangle_edges(struct tangle *t);
void tangle_free(struct tangle *t);
/* Fills the scene with triangles of a cell's size, one in each cell of a cubic
 * grid; thin: some are collapsed to needles or points. In
 * tests/contact/response.c. */
void tangle_soup(struct tangle *t, struct bytes *b, int side, bool packed);
/* Fills the scene with a sheet between two plates that move at lo and hi m/s
 * along y. In tests/contact/response.c. */
void tangle_press(struct tangle *t, struct bytes *b, real lo, real hi);
/* A broad phase for struct response: every pair whose swept boxes overlap. */
int tangle_broad(void *user, const uint8_t *touched, struct pairs *out);
/* Starts a step: v += dt a, a gravity in m/s²; x1 = x0 + dt v. */
void tangle_start(struct tangle *t, vec a);
/* Repulsion; or, where contacts take part in a solve, what finds them for it,
 * with a solve that moves nothing. Returns the status. */
int tangle_respond(struct response *r, const struct pairs *close);
/* Starts a step and runs collision response. Returns the status. */
int tangle_step(struct tangle *t, vec a);
/* Counts the pairs that touch between x0 and x1, among all pairs. */
int64_t tangle_touching(struct tangle *t);
/* Makes the end of this step the start of the next. */
void tangle_next(struct tangle *t);

#endif
