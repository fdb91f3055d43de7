/* SPDX-License-Identifier: Apache-2.0 */
/* Decides whether whole meshes are apart, so that a query can skip the tree.
 * spec/broad/extent.md §2 */
#include "ref/broad/apart.h"

#include "ref/broad/box.h"
#include "ref/broad/cones.h"
#include "ref/broad/extent.h"

/* Returns the box around all triangles of a mesh that never moves. */
static struct box still_box(const struct tree_scene *s,
                            const struct tree_mesh *m)
{
    const int32_t(*tri)[3] = s->tri + m->first_tri;
    struct box b = box_face(s->x, s->x, tri[0]);
    for (int32_t k = 1; k < m->tris; k++)
        b = box_join(b, box_face(s->x, s->x, tri[k]));
    return b;
}

/* Whether the test of §2 applies to root pair (a, b): for a cloth with itself
 * the grid must be full; for two meshes neither may be of class TREE_MOVING,
 * because no box is kept for such a mesh. */
static bool is_covered(const struct tree_scene *s, const struct tree *t,
                       const struct tree_map *map, int32_t a, int32_t b)
{
    const struct tree_mesh *m = &s->mesh[t->mesh[a]], *o = &s->mesh[t->mesh[b]];
    if (a == b)
        return m->kind == TREE_CLOTH && map->full[a];
    return m->kind != TREE_MOVING && o->kind != TREE_MOVING;
}

int apart_make(struct apart *a, const struct tree_scene *scene,
               const struct tree *tree, const struct tree_map *map,
               int64_t roots, const int32_t (*root)[2], struct arena *arena)
{
    a->n = roots;
    a->able = true;
    a->pair = arena_take(arena, ARENA_TREE, roots, sizeof *a->pair);
    a->bounds = arena_take(arena, ARENA_TREE, scene->meshes, sizeof *a->bounds);
    if (arena->failed)
        return DRAPE_ENOMEM;
    for (int64_t k = 0; k < roots; k++) {
        a->pair[k][0] = tree->mesh[root[k][0]];
        a->pair[k][1] = tree->mesh[root[k][1]];
        a->able &= is_covered(scene, tree, map, root[k][0], root[k][1]);
    }
    for (int32_t k = 0; k < scene->meshes; k++)
        if (scene->mesh[k].kind == TREE_STATIC && scene->mesh[k].tris)
            a->bounds[k].box = still_box(scene, &scene->mesh[k]);
    return DRAPE_OK;
}

bool apart_all(const struct apart *a, real r)
{
    for (int64_t k = 0; k < a->n; k++) {
        const struct mesh_bounds *m = &a->bounds[a->pair[k][0]];
        const struct mesh_bounds *o = &a->bounds[a->pair[k][1]];
        if (m == o ? !cones_apart(&m->tangents, r)
                   : box_meets(&m->box, &o->box, box_reach(r)))
            return false;
    }
    return true;
}
