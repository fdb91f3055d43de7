/* SPDX-License-Identifier: Apache-2.0 */
/* Chooses the triangle that represents each vertex and each edge, so that every
 * candidate is found once. spec/broad/tree.md §4 */
#include <stdlib.h>

#include "ref/broad/tree_plan.h"

/* An edge of a triangle, kept in the bucket of its smaller vertex: `other` is
 * its larger vertex, `at` is 3 t + k for edge k of triangle t. */
struct slot {
    int32_t other, at;
};

static int compare_edges(const void *a, const void *b)
{
    const struct slot *s = a, *t = b;
    if (s->other != t->other)
        return s->other < t->other ? -1 : 1;
    return s->at < t->at ? -1 : s->at > t->at;
}

/* Returns the ends of edge k, the smaller vertex first. */
static void edge_ends(const int32_t f[3], int k, int32_t *a, int32_t *b)
{
    int32_t p = f[k], q = f[(k + 1) % 3];
    *a = p < q ? p : q;
    *b = p < q ? q : p;
}

/* The first triangle with a vertex represents this vertex. */
static void own_vertices(const struct tree_scene *s, int32_t *seen,
                         uint8_t *own)
{
    for (int32_t v = 0; v < s->vertices; v++)
        seen[v] = 0;
    for (int32_t t = 0; t < s->tris; t++) {
        own[t] = 0;
        for (int k = 0; k < 3; k++) {
            int32_t v = s->tri[t][k];
            if (!seen[v])
                own[t] |= (uint8_t)(1 << k);
            seen[v] = 1;
        }
    }
}

/* The first triangle with an edge represents this edge. An edge from a vertex
 * to itself has no representative. */
static void own_edges(const struct tree_scene *s, int32_t *start,
                      struct slot *slot, uint8_t *own)
{
    int32_t a, b;
    for (int32_t v = 0; v <= s->vertices; v++)
        start[v] = 0;
    for (int32_t t = 0; t < s->tris; t++)
        for (int k = 0; k < 3; k++) {
            edge_ends(s->tri[t], k, &a, &b);
            start[a + 1]++;
        }
    for (int32_t v = 0; v < s->vertices; v++)
        start[v + 1] += start[v];
    for (int32_t t = 0; t < s->tris; t++)
        for (int k = 0; k < 3; k++) {
            edge_ends(s->tri[t], k, &a, &b);
            slot[start[a]].other = b;
            slot[start[a]++].at = 3 * t + k;
        }
    /* start[v] is now the end of bucket v. */
    for (int32_t v = 0, k = 0; v < s->vertices; v++) {
        int32_t end = start[v], begin = k;
        qsort(slot + k, (size_t)(end - k), sizeof *slot, compare_edges);
        for (; k < end; k++)
            if (slot[k].other != v &&
                (k == begin || slot[k].other != slot[k - 1].other))
                own[slot[k].at / 3] |= (uint8_t)(8 << slot[k].at % 3);
    }
}

int tree_own(const struct tree_scene *s, struct arena *arena, uint8_t *own)
{
    struct slot *slot =
        arena_take(arena, ARENA_TREE, 3 * (int64_t)s->tris, sizeof *slot);
    int32_t *start =
        arena_take(arena, ARENA_TREE, (int64_t)s->vertices + 2, sizeof *start);
    int status = slot && start ? DRAPE_OK : DRAPE_ENOMEM;
    if (status == DRAPE_OK) {
        own_vertices(s, start, own);
        own_edges(s, start, slot, own);
    }
    arena_give(arena, slot);
    arena_give(arena, start);
    return status;
}
