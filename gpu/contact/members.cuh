/* SPDX-License-Identifier: Apache-2.0 */
/* The members of each zone, on the device. spec/contact/zones.md §1 */
#ifndef GPU_MEMBERS_CUH
#define GPU_MEMBERS_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "ref/contact/zones.h"
}

/* Words that gpu_members writes. BAD: not 0 if a pair has a bad vertex; the
 * rest is then undefined. The others: members of all zones, zones, free
 * members. */
enum { MEMBERS_BAD, MEMBERS_ALL, MEMBERS_ZONES, MEMBERS_FREE, MEMBERS_WORDS };

/* Fills s->vertex and `first` of each zone. Returns the members by zone and
 * vertex, in s->key or s->spare. The words must be zero before. Uses scratch
 * slot 0. */
struct key *gpu_members(struct gpu *g, struct zones *s, int64_t *words);

#endif
