/* SPDX-License-Identifier: Apache-2.0 */
/* The exact tier of the narrow phase: spec/30_narrow.md §6. */
#include "ref/exact.h"

#include "ref/roots.h"

#include <stddef.h>

/* A vector linear in t: whole numbers at t = 0 and 1. */
struct line {
    struct big at[2][3];
};

/* The polynomials of §2. */
struct system {
    int count;             /* of forms and box forms */
    struct poly v;         /* V */
    struct poly q[4][3];   /* forms, by axis */
    struct poly box[4][3]; /* box forms, by axis */
};

/* The lowest exponent of a bit of all positions. */
static int common_exponent(double x[2][4][3])
{
    int least = 2000;
    for (int i = 0; i < 24; i++) {
        double a = x[i / 12][i / 3 % 4][i % 3];
        if (a != 0 && big_exponent(a) < least)
            least = big_exponent(a);
    }
    return least;
}

/* Vertex a minus vertex b. */
static struct line edge(struct room *m, struct line p[4], int a, int b)
{
    struct line r;
    for (int i = 0; i < 6; i++)
        r.at[i / 3][i % 3] =
            big_sub(m, p[a].at[i / 3][i % 3], p[b].at[i / 3][i % 3]);
    return r;
}

/* Axis k of f × g. */
static struct poly cross(struct room *m, const struct line *f,
                         const struct line *g, int k)
{
    struct poly p = {2, {{NULL, 0, 0}}};
    int i = k == 2 ? 0 : k + 1, j = 3 - k - i;
    for (int n = 0; n <= 2; n++) {
        int mark = m->used;
        for (int s = n > 1; s <= (n > 0); s++)
            p.c[n] = big_add(m, p.c[n],
                             big_det(m, f->at[s][i], g->at[n - s][j],
                                     f->at[s][j], g->at[n - s][i]));
        p.c[n] = big_keep(m, mark, p.c[n]);
    }
    return p;
}

/* a - b, of one degree. */
static struct poly minus(struct room *m, const struct poly *a,
                         const struct poly *b)
{
    struct poly p = {a->degree, {{NULL, 0, 0}}};
    for (int i = 0; i <= a->degree; i++)
        p.c[i] = big_sub(m, a->c[i], b->c[i]);
    return p;
}

/* f · w. */
static struct poly dot(struct room *m, const struct line *f,
                       const struct poly w[3])
{
    struct poly p = {3, {{NULL, 0, 0}}};
    for (int n = 0; n <= 3; n++) {
        int mark = m->used;
        for (int s = n > 2; s <= (n > 0); s++)
            for (int k = 0; k < 3; k++)
                p.c[n] =
                    big_add(m, p.c[n], big_mul(m, f->at[s][k], w[k].c[n - s]));
        p.c[n] = big_keep(m, mark, p.c[n]);
    }
    return p;
}

static void set_box(struct system *s, int j, const struct line *f)
{
    for (int k = 0; k < 3; k++) {
        struct poly p = {1, {f->at[0][k], f->at[1][k]}};
        s->box[j][k] = p;
    }
}

static void make_vf(struct room *m, struct line p[4], struct system *s)
{
    struct line f[3];
    s->count = 3;
    for (int j = 0; j < 3; j++) {
        f[j] = edge(m, p, j + 1, 0);
        set_box(s, j, &f[j]);
    }
    for (int k = 0; k < 3; k++) {
        for (int j = 0; j < 3; j++)
            s->q[j][k] = cross(m, &f[(j + 1) % 3], &f[(j + 2) % 3], k);
    }
    struct poly w[3] = {s->q[0][0], s->q[0][1], s->q[0][2]};
    s->v = dot(m, &f[0], w);
}

static void make_ee(struct room *m, struct line p[4], struct system *s)
{
    struct poly n[3];
    static const int ends[4][2] = {{2, 0}, {3, 0}, {2, 1}, {3, 1}};
    struct line f[3] = {edge(m, p, 2, 0), edge(m, p, 1, 0), edge(m, p, 3, 2)};
    s->count = 4;
    for (int j = 0; j < 4; j++) {
        struct line e = edge(m, p, ends[j][0], ends[j][1]);
        set_box(s, j, &e);
    }
    for (int k = 0; k < 3; k++) {
        n[k] = cross(m, &f[1], &f[2], k);
        s->q[0][k] = cross(m, &f[0], &f[2], k);
        s->q[1][k] = minus(m, &n[k], &s->q[0][k]);
        s->q[2][k] = cross(m, &f[0], &f[1], k);
        s->q[3][k] = minus(m, &n[k], &s->q[2][k]);
    }
    s->v = dot(m, &f[0], n);
}

/* All on one line or a point: whether the boxes meet (§3). */
static bool boxes_meet(struct room *m, const struct system *s,
                       const struct root *r)
{
    for (int k = 0; k < 3; k++) {
        int up = 0, down = 0;
        for (int j = 0; j < s->count; j++) {
            int sign = root_sign(m, &s->box[j][k], r);
            up += sign > 0;
            down += sign < 0;
        }
        if (up == s->count || down == s->count)
            return false;
    }
    return true;
}

/* Whether the primitives touch at a root of V by the forms of axis k (§3), or
 * ROOT_UNKNOWN: all are zero, or few words do not tell their signs. */
static int touching_on(struct room *m, const struct system *s,
                       const struct root *r, int k, bool few_words)
{
    int up = 0, down = 0, unknown = 0;
    for (int j = 0; j < s->count; j++) {
        const struct poly *q = &s->q[j][k];
        int sign = few_words ? root_quick(m, q, r) : root_sign(m, q, r);
        up += sign == 1;
        down += sign == -1;
        unknown += sign == ROOT_UNKNOWN;
        if (up && down)
            return false;
    }
    return unknown || !(up || down) ? ROOT_UNKNOWN : true;
}

/* Whether the primitives touch at a root of V (§3). */
static bool touching(struct room *m, const struct system *s,
                     const struct root *r)
{
    int touch = ROOT_UNKNOWN;
    for (int k = 0; k < 6 && touch == ROOT_UNKNOWN; k++)
        touch = touching_on(m, s, r, k % 3, k < 3);
    return touch == ROOT_UNKNOWN ? boxes_meet(m, s, r) : touch;
}

/* Whether they touch at t = 0 (cell 0) or t = 1 (cell ROOT_ONE). */
static bool touching_end(struct room *m, const struct system *s, uint32_t cell)
{
    struct root r = {NULL, NULL, 0, cell, true, 0};
    return s->v.c[cell ? 3 : 0].sign == 0 && touching(m, s, &r);
}

/* The lesser of toi and the first root of p with contact. */
static uint32_t first(struct room *m, const struct system *s,
                      const struct poly *p, uint32_t toi)
{
    struct chain c[2];
    struct root r = {.of = p};
    int mark = m->used, chains = chains_make(m, p, c);
    for (int i = 0; i < chains; i++)
        for (int j = 1; j <= c[i].roots; j++) {
            root_locate(m, &c[i], j, &r);
            if (r.cell >= toi)
                break;
            if (touching(m, s, &r))
                toi = r.cell;
        }
    m->used = mark;
    return toi;
}

static uint32_t solve(struct room *m, const struct system *s)
{
    uint32_t toi = UINT32_MAX;
    if (touching_end(m, s, 0))
        return 0;
    if (touching_end(m, s, ROOT_ONE))
        toi = ROOT_ONE;
    if (!poly_zero(&s->v))
        return first(m, s, &s->v, toi);
    for (int j = 0; j < s->count; j++)
        for (int k = 0; k < 3; k++) {
            toi = first(m, s, &s->box[j][k], toi);
            toi = first(m, s, &s->q[j][k], toi);
        }
    return toi;
}

int exact_first(double x[2][4][3], int kind, uint32_t *word, int n,
                uint32_t *toi)
{
    struct room m = {word, n, 0, 0, false, 0};
    struct line p[4];
    struct system s;
    int e = common_exponent(x);
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 6; i++)
            p[j].at[i / 3][i % 3] = big_make(&m, x[i / 3][j][i % 3], e);
    if (kind)
        make_ee(&m, p, &s);
    else
        make_vf(&m, p, &s);
    *toi = solve(&m, &s);
    return m.full ? -1 : m.most;
}
