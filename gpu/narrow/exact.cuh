/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 3 of the narrow phase on the device: finds the first contact in exact
 * integer arithmetic. spec/narrow/narrow.md §6 */
#ifndef GPU_EXACT_CUH
#define GPU_EXACT_CUH

#include "gpu/narrow/system.cuh"

extern "C" {
#include "ref/narrow/narrow.h"
}

/* Whether the boxes meet at root r (§3c). Called where all four vertices are on
 * one line or in one point, so that meeting boxes mean contact. */
static __device__ inline bool
boxes_meet(struct big_arena *m, const struct workspace *s, const struct root *r)
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

static __device__ __noinline__ bool touching_at(struct big_arena *m,
                                                const struct workspace *s,
                                                const struct root *r)
{
    for (int k = 0; k < 3; k++) {
        int n = root_sign(m, &s->n[k], r);
        if (n == 0)
            continue;
        for (int j = 0; j < s->count; j++)
            if (root_sign(m, &s->q[j][k], r) == -n)
                return false;
        return true;
    }
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < s->count; j++)
            if (root_sign(m, &s->q[j][k], r))
                return false;
    return boxes_meet(m, s, r);
}

/* Whether the primitives touch at root r of form j, on an axis where N is not 0
 * there: contact is that a point lies in the box of one side or edge (§6.5). */
static __device__ __noinline__ bool touching_form(struct big_arena *m,
                                                  const struct workspace *s,
                                                  const struct root *r, int j)
{
    /* the two box forms of that test */
    int a = s->count == 3 ? (j + 1) % 3 : j == 1 ? 2 : j == 3;
    int b = s->count == 3 ? (j + 2) % 3 : j == 0 ? 1 : j == 2 ? 2 : 3;
    for (int k = 0; k < 3; k++) {
        int sign = root_sign(m, &s->box[a][k], r);
        if (sign && sign == root_sign(m, &s->box[b][k], r))
            return false;
    }
    return true;
}

/* Whether the primitives touch at t = 0 (cell 0) or t = 1 (cell POINT_ONE). */
static __device__ inline bool
touching_end(struct big_arena *m, const struct workspace *s, uint32_t cell)
{
    struct root r = {NULL, 0, cell, true};
    return s->v.c[cell ? 3 : 0].n == 0 && touching_at(m, s, &r);
}

/* A polynomial at whose roots a contact may begin (§6.5). */
struct candidate {
    const struct poly *p;
    int form, axis; /* form and its axis, where V is identically zero; else
                       axis -1 */
};

static __device__ __noinline__ bool begins(struct big_arena *m,
                                           const struct workspace *s,
                                           const struct candidate *c,
                                           const struct root *r)
{
    if (c->axis >= 0 && root_avoids(m, &s->n[c->axis], r))
        return touching_form(m, s, r, c->form);
    return touching_at(m, s, r);
}

/* Returns the lesser of toi and the first root of c with contact. */
static __device__ __noinline__ uint32_t first_of(struct big_arena *m,
                                                 struct workspace *s,
                                                 const struct candidate *c,
                                                 uint32_t toi)
{
    struct root r;
    int mark = m->used, chains = chains_make(m, c->p, s->chain);
    for (int i = 0; i < chains; i++)
        for (int j = 1; j <= s->chain[i].roots && !m->full; j++) {
            root_locate(m, &s->chain[i], j, &r);
            if (r.cell >= toi)
                break;
            if (begins(m, s, c, &r))
                toi = r.cell;
        }
    m->used = mark;
    return toi;
}

/* Returns the axis whose forms have the fewest words, without axes on which all
 * forms are identically zero; -1 if all three axes are such. */
static __device__ inline int short_axis(const struct workspace *s)
{
    int axis = -1, fewest = INT32_MAX;
    for (int k = 0; k < 3; k++) {
        int words = 0;
        for (int j = 0; j < s->count; j++)
            for (int i = 0; i <= 2; i++)
                words += big_words(s->q[j][k].c[i]);
        if (words && words < fewest) {
            fewest = words;
            axis = k;
        }
    }
    return axis;
}

static __device__ inline uint32_t first_contact(struct big_arena *m,
                                                struct workspace *s)
{
    uint32_t toi = NARROW_MISS;
    struct candidate c = {&s->v, 0, -1};
    if (touching_end(m, s, 0))
        return 0;
    if (touching_end(m, s, POINT_ONE))
        toi = NARROW_ONE;
    if (!poly_zero(&s->v))
        return first_of(m, s, &c, toi);
    c.axis = short_axis(s);
    for (int j = 0; j < s->count; j++)
        for (int k = 0; k < 3 && !m->full; k++) {
            if (c.axis >= 0 && k != c.axis)
                continue;
            c.p = c.axis >= 0 ? &s->q[j][k] : &s->box[j][k];
            c.form = j;
            toi = first_of(m, s, &c, toi);
        }
    return toi;
}

/* Writes the first contact of p, or NARROW_MISS, to *toi. Uses s and the
 * scratch word[n], n ≥ 2048, the length of the longest number. Returns false
 * where n words are too few, and then *toi is void. */
static __device__ inline bool exact_contact(const struct quad *p,
                                            struct workspace *s, uint32_t *word,
                                            int n, uint32_t *toi)
{
    struct big_arena m = {word, n, 0, false};
    set_workspace(&m, p, s);
    if (m.full)
        return false;
    *toi = first_contact(&m, s);
    return !m.full;
}

#endif
