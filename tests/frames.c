/* SPDX-License-Identifier: Apache-2.0 */
/* Narrow phase: the shared frames, whose touching pairs are all known. */
#include "ref/narrow.h"

#include <stdio.h>
#include <stdlib.h>

#include "tests/soak.h"
/* its names need the harness's */
#include "tests/ply.h"

#define FRAMES "../shared/ccd/frames"

/* ---- A sweep of all swept boxes, to share nothing with ref/broad.c ---- */

enum { VERTEX, FACE, EDGE };

struct item {
    vec lo, hi;
    int32_t v[3];
    int what;
};

struct scene {
    struct ply at[2];
    struct item *item;
    int64_t items;
    real from, to;          /* looks at pairs whose second box begins between */
    int64_t lines, sampled; /* of hits.txt; of these within */
    struct soak row;        /* of the candidates */
};

static int by_x(const void *a, const void *b)
{
    real p = ((const struct item *)a)->lo.x, q = ((const struct item *)b)->lo.x;
    return (p > q) - (p < q);
}

static void add_item(struct scene *s, int what, int n, const int32_t *v)
{
    struct item *i = &s->item[s->items++];
    memset(i, 0, sizeof *i);
    i->what = what;
    i->lo = i->hi = s->at[0].x[v[0]];
    for (int k = 0; k < n; k++) {
        i->v[k] = v[k];
        for (int t = 0; t < 2; t++) {
            i->lo = vec_min(i->lo, s->at[t].x[v[k]]);
            i->hi = vec_max(i->hi, s->at[t].x[v[k]]);
        }
    }
}

static int by_ends(const void *a, const void *b)
{
    const int32_t *p = a, *q = b;
    return p[0] != q[0] ? (p[0] > q[0]) - (p[0] < q[0])
                        : (p[1] > q[1]) - (p[1] < q[1]);
}

static void add_edges(struct scene *s)
{
    int64_t n = 0;
    const struct ply *p = &s->at[0];
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

/* The vertices of a pair in the narrow phase's order; false where it is no
 * pair, or one vertex is in both. */
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

static bool touch(const struct scene *s, struct soak *row, int kind,
                  const int32_t v[4])
{
    struct query q = {.kind = kind};
    for (int k = 0; k < 8; k++)
        q.x[k / 4][k % 4] = s->at[k / 4].x[v[k % 4]];
    return soak_decide(row, &q) != NARROW_MISS;
}

static void sweep(struct scene *s)
{
    int32_t v[4];
    const struct item *first = s->item, *end = s->item + s->items;
    qsort(s->item, (size_t)s->items, sizeof *s->item, by_x);
    while (first < end && first->lo.x < s->from)
        first++;
    for (const struct item *a = s->item; a < end; a++) {
        const struct item *b = a < first ? first : a + 1;
        for (; b < end && b->lo.x <= a->hi.x && b->lo.x < s->to; b++)
            if (overlap(a, b) && join(a, b, v))
                touch(s, &s->row, a->what == EDGE, v);
    }
}

/* Vertices with faces, then edges with edges. */
static bool sweep_all(struct scene *s)
{
    const struct ply *p = &s->at[0];
    s->item = calloc((size_t)p->nv + 3 * (size_t)p->nt, sizeof *s->item);
    if (!s->item)
        return false;
    for (int32_t k = 0; k < p->nv; k++)
        add_item(s, VERTEX, 1, &k);
    for (int32_t k = 0; k < p->nt; k++)
        add_item(s, FACE, 3, p->tri[k]);
    sweep(s);
    s->items = 0;
    add_edges(s);
    sweep(s);
    free(s->item);
    return true;
}

/* ---- Both ways ---- */

static bool read_scene(struct scene *s, const char *name)
{
    char path[160];
    bool good = true;
    for (int t = 0; t < 2; t++) {
        snprintf(path, sizeof path, FRAMES "/%s/t%d.ply", name, t);
        good = ply_read(path, &s->at[t]) && good;
    }
    return good && s->at[0].nv == s->at[1].nv;
}

static bool in_slab(const struct scene *s, real x)
{
    return s->from <= x && x < s->to;
}

/* Where the box of n vertices begins. */
static real begin(const struct scene *s, const int32_t *v, int n)
{
    real lo = s->at[0].x[v[0]].x;
    for (int k = 0; k < 2 * n; k++)
        lo = real_min(lo, s->at[k / n].x[v[k % n]].x);
    return lo;
}

/* From the mean on, a part of what lies beyond it; all for no part. */
static void choose_slab(struct scene *s, int parts)
{
    const struct ply *p = &s->at[0];
    double sum = 0;
    real most = p->x[0].x;
    for (int32_t k = 0; k < p->nv; k++) {
        sum += (double)p->x[k].x;
        most = real_max(most, p->x[k].x);
    }
    s->from = (real)(sum / p->nv);
    s->to = parts ? s->from + (most - s->from) / (real)parts : HUGE_VAL;
    s->from = parts ? s->from : -HUGE_VAL;
}

/* How many lines of hits.txt touch; s->lines counts all, s->sampled those
 * that the sweep should find. */
static int64_t count_found(struct scene *s, const char *name)
{
    char path[160], kind[8];
    int32_t v[4];
    struct soak row = {0};
    int64_t found = 0;
    snprintf(path, sizeof path, FRAMES "/%s/hits.txt", name);
    FILE *f = fopen(path, "r");
    while (f && fscanf(f, "%7s%d%d%d%d", kind, v, v + 1, v + 2, v + 3) == 5) {
        int split = kind[0] == 'e' ? 2 : 1;
        found += touch(s, &row, split == 2, v);
        s->lines++;
        s->sampled += in_slab(
            s, real_max(begin(s, v, split), begin(s, v + split, 4 - split)));
    }
    if (f)
        fclose(f);
    return found;
}

/* No pair of hits.txt is missed; as many candidates touch as there are lines
 * for them, so none is invented. */
static const char *check_scene(const char *name, int parts)
{
    struct scene s = {.items = 0};
    if (!read_scene(&s, name))
        return "a frame cannot be read";
    choose_slab(&s, parts);
    int64_t found = count_found(&s, name);
    bool swept = sweep_all(&s);
    ply_free(&s.at[0]);
    ply_free(&s.at[1]);
    EXPECT(swept && s.lines > 0 && found == s.lines);
    EXPECT(s.sampled > 0 && s.row.queries > s.sampled);
    s.row.invented = s.row.touching - s.sampled; /* as none is missed */
    if (getenv("DRAPE_SOAK"))
        soak_print(name, &s.row);
    EXPECT(s.row.invented == 0);
    ran(s.row.queries);
    return NULL;
}

/* cloth-funnel is in binary64 and would move if it were rounded; the others
 * are in binary32. A slab of the large ones; all 38 million candidates where
 * DRAPE_SOAK is set. */
const char *test_narrow_frames(void)
{
    bool all = getenv("DRAPE_SOAK");
    FILE *f = fopen(FRAMES "/cloth-ball/hits.txt", "r");
    if (!f)
        return skip("no ../shared/ccd/frames here");
    fclose(f);
    if (all) {
        printf("\n### All candidates of the shared frames, binary%d\n\n",
               REAL_BITS);
        soak_head();
    }
    if (REAL_BITS == 64)
        return check_scene("cloth-funnel", 0);
    const char *failed = check_scene("cloth-ball", all ? 0 : 8);
    return failed ? failed : check_scene("n-body-simulation", all ? 0 : 64);
}
