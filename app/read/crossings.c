/* SPDX-License-Identifier: Apache-2.0 */
/* Where triangles intersect, by drape's exact audit. */
#include "app/read/crossings.h"
#include "app/base/app.h"

#include <stdlib.h>
#include <string.h>

int crossings_find(const drape_mesh *mesh, struct crossings *crossings)
{
    struct crossings *c = crossings;
    *c = (struct crossings){0};
    int status = drape_audit(mesh, 0, NULL, &c->found, &c->degenerate);
    if (status == DRAPE_OK && c->found) {
        c->pair = malloc((size_t)c->found * sizeof *c->pair);
        if (!c->pair)
            return no_memory();
        status =
            drape_audit(mesh, c->found, c->pair, &c->found, &c->degenerate);
    }
    return status == DRAPE_OK
               ? APP_OK
               : complain(APP_FAILED, "audit: %s", drape_status_text(status));
}

void crossings_part(struct crossings *crossings, const drape_world *world)
{
    int64_t kept = 0;
    for (int64_t k = 0; crossings->pair && k < crossings->found; k++) {
        const int32_t *pair = crossings->pair[k];
        if (drape_are_sewn(world, pair[0], pair[1]) != 1)
            memmove(crossings->pair[kept++], pair, sizeof *crossings->pair);
    }
    crossings->sewn = crossings->found - kept;
    crossings->found = kept;
}

void crossings_free(struct crossings *crossings)
{
    free(crossings->pair);
    crossings->pair = NULL;
}

/* An edge of a triangle, by its ends. */
struct half {
    int32_t end[2], triangle, edge;
};

static int compare_halves(const void *a, const void *b)
{
    const struct half *p = a, *q = b;
    for (int i = 0; i < 2; i++)
        if (p->end[i] != q->end[i])
            return p->end[i] < q->end[i] ? -1 : 1;
    return 0;
}

int crossings_adjacent(const drape_mesh *mesh, int32_t (*beyond)[3])
{
    int64_t n = 3 * mesh->nt;
    struct half *half = malloc(((size_t)n + 1) * sizeof *half);
    if (!half)
        return no_memory();
    for (int64_t k = 0; k < n; k++) {
        const int32_t *t = mesh->tri[k / 3];
        int32_t a = t[(k + 1) % 3], b = t[(k + 2) % 3];
        half[k] = (struct half){
            {a < b ? a : b, a < b ? b : a}, (int32_t)(k / 3), (int32_t)(k % 3)};
        beyond[k / 3][k % 3] = -1;
    }
    qsort(half, (size_t)n, sizeof *half, compare_halves);
    for (int64_t k = 1; k < n; k++) {
        const struct half *a = &half[k - 1], *b = &half[k];
        if (compare_halves(a, b) != 0)
            continue;
        beyond[a->triangle][a->edge] = b->triangle;
        beyond[b->triangle][b->edge] = a->triangle;
    }
    free(half);
    return APP_OK;
}

static int compare_pairs(const void *a, const void *b)
{
    const int32_t *p = a, *q = b;
    int first = (p[0] > q[0]) - (p[0] < q[0]);
    return first ? first : (p[1] > q[1]) - (p[1] < q[1]);
}

/* The number of a pair, -1: these triangles do not intersect. */
static int64_t find_pair(const struct crossings *c, int32_t a, int32_t b)
{
    int32_t key[2] = {a < b ? a : b, a < b ? b : a};
    const int32_t(*at)[2] = NULL;
    if (a >= 0 && b >= 0)
        at = bsearch(key, c->pair, (size_t)c->found, sizeof key, compare_pairs);
    return at ? at - (const int32_t(*)[2])c->pair : -1;
}

int crossings_group(struct pool *pool, const struct crossings *crossings,
                    const int32_t (*beyond)[3], struct regions *regions)
{
    const struct crossings *c = crossings;
    struct regions *r = regions;
    size_t n = (size_t)c->found + 1;
    int64_t *queue = pool_take(pool, n, sizeof *queue);
    *r = (struct regions){.of = pool_take(pool, n, sizeof *r->of),
                          .turned = pool_take(pool, n, sizeof *r->turned)};
    if (!queue || !r->of || !r->turned)
        return no_memory();
    for (int64_t k = 0; k < c->found; k++)
        r->of[k] = -1;
    for (int64_t root = 0; root < c->found; root++) {
        int64_t first = 0, last = 0;
        if (r->of[root] >= 0)
            continue;
        r->of[root] = r->count;
        queue[last++] = root;
        while (first < last) {
            int64_t k = queue[first++];
            const int32_t *pair = c->pair[k];
            for (int e = 0; e < 6; e++) {
                int32_t stays = pair[e / 3],
                        next = beyond[pair[1 - e / 3]][e % 3];
                int64_t to = find_pair(c, stays, next);
                if (to < 0 || r->of[to] >= 0)
                    continue;
                /* what stays is the same side's in both */
                bool second = c->pair[to][1] == stays;
                r->of[to] = r->count;
                r->turned[to] = r->turned[k] ^ (second != (e / 3 == 1));
                queue[last++] = to;
            }
        }
        r->count++;
    }
    return APP_OK;
}
