/* SPDX-License-Identifier: Apache-2.0 */
/* A triangle mesh in memory, as the tool's readers, writers and shapes share
 * it. */
#ifndef APP_TRIANGLES_H
#define APP_TRIANGLES_H

#include <stdint.h>

struct mesh {
    int64_t nv, nt;
    double (*x)[3];    /* [nv] */
    int32_t (*tri)[3]; /* [nt] each 0 … nv-1 */
};

#endif
