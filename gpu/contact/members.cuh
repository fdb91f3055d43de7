/* SPDX-License-Identifier: Apache-2.0 */
/* Who is in which zone, on the device. spec/contact/zones.md §1 */
#ifndef GPU_MEMBERS_CUH
#define GPU_MEMBERS_CUH

#include "gpu/run/launch.cuh"

extern "C" {
#include "ref/contact/zones.h"
}

/* Words that gpu_members writes: whether a pair names no vertex, and then
 * nothing else is valid; members of all zones, zones, free members. */
enum { MEMBERS_BAD, MEMBERS_ALL, MEMBERS_ZONES, MEMBERS_FREE, MEMBERS_WORDS };

/* Fills s->vertex and `first` of each zone; returns the members by zone and
 * vertex, in s->key or s->spare. Words are zero before. Scratch slot 0. */
struct key *gpu_members(struct gpu *g, struct zones *s, int64_t *words);

#endif
