/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the binary PLY meshes that ci/data.sh fetches, for tests. */
#ifndef TESTS_PLY_H
#define TESTS_PLY_H

#include "names/tests.h"
#include "ref/base/real.h"

struct ply {
    int32_t nv, nt;
    vec *x;            /* [nv] positions */
    int32_t (*tri)[3]; /* [nt] vertices of a triangle */
};

/* Returns true if the file exists, is binary and has only triangles. The caller
 * frees the arrays with ply_free, also after false. */
bool ply_read(const char *path, struct ply *p);
void ply_free(struct ply *p);

#endif
