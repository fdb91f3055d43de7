/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the binary PLY meshes that ci/data.sh fetches, for tests. */
#ifndef TESTS_PLY_H
#define TESTS_PLY_H

#include "ref/base/real.h"
#include "tests/base/names.h"

struct ply {
    int32_t nv, nt;
    vec *x;            /* [nv] */
    int32_t (*tri)[3]; /* [nt] */
};

/* True if the file is there, binary, and all triangles. The arrays are the
 * caller's to free, also where it is false. */
bool ply_read(const char *path, struct ply *p);
void ply_free(struct ply *p);

#endif
