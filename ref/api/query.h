/* SPDX-License-Identifier: Apache-2.0 */
/* The check shared by the API's calls on a mesh. */
#ifndef REF_QUERY_H
#define REF_QUERY_H

#include "spec/drape.h"

/* DRAPE_EARG where the mesh is NULL, a count is negative or above `most`, an
 * array that is read is NULL, threads are out of range, or the allocator has
 * one function of its two. Else DRAPE_OK; coordinates are not checked here. */
int query_check(const drape_mesh *mesh, int64_t most);

#endif
