/* SPDX-License-Identifier: Apache-2.0 */
/* Finds all candidate pairs of the public frames by sorting and sweeping. See
 * tests/narrow/sweep.h. */
#include "tests/narrow/sweep.h"

#include <stdio.h>
#include <stdlib.h>

#include "tests/base/data.h"

enum { VERTEX, FACE, EDGE };

struct item {
    vec lo, hi;
    int32_t v[3];
    int what;
};

struct sweep {
    const struct frames *f;
    struct item *item;
    int64_t items;
    void (*pair)(void *user, int kind, const int32_t v[4]);
    void *user;
};

static int by_x(const void *a, const void *b)
{
    real p = ((const struct item *)a)->lo.x, q = ((const struct item *)b)->lo.x;
    return (p > q) - (p < q);
}

static void add_item(struct sweep *s, int what, int n, const int32_t *v)
{
    struct item *i = &s->item[s->items++];
    memset(i, 0, sizeof *i);
    i->what = what;
    i->lo = i->hi = s->f->at[0].x[v[0]];
    for (int k = 0; k < n; k++) {
        i->v[k] = v[k];
        for (int t = 0; t < 2; t++) {
            i->lo = vec_min(i->lo, s->f->at[t].x[v[k]]);
            i->hi = vec_max(i->hi, s->f->at[t].x[v[k]]);
        }
    }
}

static int by_ends(const void *a, const void *b)
{
    const int32_t *p = a, *q = b;
    return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0])
                        : (p[1] > q[1]) - (p[1] < q[1]);
}

static void add_edges(struct sweep *s)
{
    int64_t n = 0;
    const struct ply *p = &s->f->at[0];
    int32_t(*e)[2] = calloc(3 * (size_t)p->nt + 1, sizeof *e);
    for (int64_t k = 0; e && k < 3 * (int64_t)p->nt; k++) {
        int32_t a = p->tri[k / 3][k % 3], b = p->tri[k / 3][(k + 1) % 3];
        e[n][0] = a < b ? a : b;
        e[n++][1] = a < b ? b : a;
    }
    if (n)
        qsort(e, (size_t)n, sizeof *e, by_ends);
    for (int64_t k = 0; k < n; k++)
        if (k == 0 || by_ends(e[k], e[k - 1]))
            add_item(s, EDGE, 2, e[k]);
    free(e);
}

static bool overlap(const struct item *a, const struct item *b)
{
    return a->lo.y <= b->hi.y && b->lo.y <= a->hi.y && a->lo.z <= b->hi.z &&
           b->lo.z <= a->hi.z;
}

/* Writes the vertices of a pair in the narrow phase's order. Returns false if
 * the items are no pair or share a vertex. */
static bool join(const struct item *a, const struct item *b, int32_t v[4])
{
    if (a->what == EDGE && b->what == EDGE) {
        int32_t p[4] = {a->v[0], a->v[1], b->v[0], b->v[1]};
        memcpy(v, p, sizeof p);
        return p[0] != p[2] && p[0] != p[3] && p[1] != p[2] && p[1] != p[3];
    }
    if (a->what + b->what != VERTEX + FACE)
        return false;
    const struct item *f = a->what == FACE ? a : b;
    v[0] = a->what == VERTEX ? a->v[0] : b->v[0];
    memcpy(v + 1, f->v, sizeof f->v);
    return v[0] != v[1] && v[0] != v[2] && v[0] != v[3];
}

static void sweep(struct sweep *s)
{
    int32_t v[4];
    const struct item *first = s->item, *end = s->item + s->items;
    qsort(s->item, (size_t)s->items, sizeof *s->item, by_x);
    while (first < end && first->lo.x < s->f->from)
        first++;
    for (const struct item *a = s->item; a < end; a++) {
        const struct item *b = a < first ? first : a + 1;
        for (; b < end && b->lo.x <= a->hi.x && b->lo.x < s->f->to; b++)
            if (overlap(a, b) && join(a, b, v))
                s->pair(s->user, a->what == EDGE, v);
    }
}

/* Sweeps vertices with faces, then edges with edges. */
bool frames_sweep(const struct frames *f,
                  void (*pair)(void *user, int kind, const int32_t v[4]),
                  void *user)
{
    const struct ply *p = &f->at[0];
    struct sweep s = {.f = f, .pair = pair, .user = user};
    s.item = calloc((size_t)p->nv + 3 * (size_t)p->nt, sizeof *s.item);
    if (!s.item)
        return false;
    for (int32_t k = 0; k < p->nv; k++)
        add_item(&s, VERTEX, 1, &k);
    for (int32_t k = 0; k < p->nt; k++)
        add_item(&s, FACE, 3, p->tri[k]);
    sweep(&s);
    s.items = 0;
    add_edges(&s);
    sweep(&s);
    free(s.item);
    return true;
}

bool frames_read(const char *name, struct frames *f)
{
    char path[512];
    bool good = true;
    for (int t = 0; t < 2; t++) {
        snprintf(path, sizeof path, "%s/ccd/frames/%s/t%d.ply", data_home(),
                 name, t);
        good = ply_read(path, &f->at[t]) && good;
    }
    return good && f->at[0].nv == f->at[1].nv;
}

void frames_free(struct frames *f)
{
    ply_free(&f->at[0]);
    ply_free(&f->at[1]);
}

void frames_slab(struct frames *f, int parts)
{
    const struct ply *p = &f->at[0];
    double sum = 0;
    real most = p->x[0].x;
    for (int32_t k = 0; k < p->nv; k++) {
        sum += (double)p->x[k].x;
        most = real_max(most, p->x[k].x);
    }
    f->from = (real)(sum / p->nv);
    f->to = parts ? f->from + (most - f->from) / (real)parts : HUGE_VAL;
    f->from = parts ? f->from : -HUGE_VAL;
}

/* Returns the lower end, on x, of the box of n vertices. */
static real begin(const struct frames *f, const int32_t *v, int n)
{
    real lo = f->at[0].x[v[0]].x;
    for (int k = 0; k < 2 * n; k++)
        lo = real_min(lo, f->at[k / n].x[v[k % n]].x);
    return lo;
}

int64_t frames_hits(const struct frames *s, const char *name,
                    void (*pair)(void *user, int kind, const int32_t v[4]),
                    void *user, int64_t *lines)
{
    char path[512], kind[8];
    int32_t v[4];
    int64_t inside = 0;
    *lines = 0;
    snprintf(path, sizeof path, "%s/ccd/frames/%s/hits.txt", data_home(), name);
    FILE *f = fopen(path, "r");
    while (f && fscanf(f, "%7s%d%d%d%d", kind, v, v + 1, v + 2, v + 3) == 5) {
        int split = kind[0] == 'e' ? 2 : 1;
        real x = real_max(begin(s, v, split), begin(s, v + split, 4 - split));
        pair(user, split == 2, v);
        inside += s->from <= x && x < s->to;
        ++*lines;
    }
    if (f)
        fclose(f);
    return inside;
}
