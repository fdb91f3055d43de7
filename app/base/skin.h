/* SPDX-License-Identifier: Apache-2.0 */
/* A place beside a mesh that follows one of its triangles. */
#ifndef APP_BASE_SKIN_H
#define APP_BASE_SKIN_H

#include <stdint.h>

struct skin {
    int64_t tri;    /* the nearest triangle; -1: there is none */
    double part[3]; /* of its corners: the foot, its point that is nearest */
    double off[3];  /* m, from the foot, along the triangle's first side, across
                       it, and along its normal */
};

/* Finds the triangle of `tri`, from number `from` to before `to`, that is
 * nearest to a place. Of equals the first; one without area is none. */
void skin_find(struct skin *skin, const double place[3],
               const int32_t (*tri)[3], int64_t from, int64_t to,
               const double (*x)[3]);
/* Where the place is once the mesh has its vertices at x. */
void skin_follow(const struct skin *skin, const int32_t (*tri)[3],
                 const double (*x)[3], double place[3]);

#endif
