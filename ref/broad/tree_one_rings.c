/* SPDX-License-Identifier: Apache-2.0 */
/* Lists the triangles around each vertex. spec/broad/tree.md §4 */
#include "ref/broad/tree_plan.h"

int tree_one_rings(const struct tree_scene *s, struct arena *arena,
                   struct one_rings *one_rings)
{
    int32_t *start =
        arena_take(arena, ARENA_TREE, (int64_t)s->vertices + 1, sizeof *start);
    int32_t(*opposite)[2] =
        arena_take(arena, ARENA_TREE, 3 * (int64_t)s->tris, sizeof *opposite);
    if (!start || !opposite)
        return DRAPE_ENOMEM;
    for (int32_t v = 0; v <= s->vertices; v++)
        start[v] = 0;
    for (int32_t t = 0; t < s->tris; t++)
        for (int k = 0; k < 3; k++)
            start[s->tri[t][k]]++;
    int32_t sum = 0;
    for (int32_t v = 0; v <= s->vertices; v++)
        start[v] = sum += start[v];
    /* start[v] is the end of list v, filled backwards. */
    for (int32_t t = s->tris - 1; t >= 0; t--)
        for (int k = 2; k >= 0; k--) {
            int32_t at = --start[s->tri[t][k]];
            opposite[at][0] = s->tri[t][(k + 1) % 3];
            opposite[at][1] = s->tri[t][(k + 2) % 3];
        }
    *one_rings =
        (struct one_rings){s->vertices + (int64_t)1, 3 * (int64_t)s->tris,
                           start, (const int32_t(*)[2])opposite};
    return DRAPE_OK;
}
