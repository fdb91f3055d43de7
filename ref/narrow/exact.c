/* SPDX-License-Identifier: Apache-2.0 */
/* Tier 3 of the narrow phase: finds the first contact in exact integer
 * arithmetic. spec/narrow/narrow.md §6 */
#include "ref/narrow/exact.h"

#include "ref/narrow/roots.h"
#include "ref/narrow/system.h"

#include <stddef.h>

/* Whether the boxes meet at root r (§3c). Called where all four vertices are on
 * one line or in one point, so that meeting boxes mean contact. */
static bool boxes_meet(struct big_arena *m, const struct system *s,
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

/* Decides by the forms of axis k (§3b) whether the primitives touch at root r.
 * Returns ROOT_UNKNOWN where all forms are zero, or where `few_words` is set
 * and few words do not determine a sign. */
static int touching_on(struct big_arena *m, const struct system *s,
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

/* Whether the primitives touch at root r (§3). Each axis is tried with few
 * words first, then exactly. */
static bool touches_at(struct big_arena *m, const struct system *s,
                       const struct root *r)
{
    int touch = ROOT_UNKNOWN;
    for (int k = 0; k < 6 && touch == ROOT_UNKNOWN; k++)
        touch = touching_on(m, s, r, k % 3, k < 3);
    return touch == ROOT_UNKNOWN ? boxes_meet(m, s, r) : touch;
}

/* Whether the primitives touch at root r of form j on axis k, where N_k is not
 * 0 there: contact is that a point lies in the box of one side or edge (§6.5).
 * The table names the two box forms of that test. */
static bool touching_form(struct big_arena *m, const struct system *s,
                          const struct root *r, int j)
{
    static const int of[2][4][2] = {{{1, 2}, {2, 0}, {0, 1}, {0, 0}},
                                    {{0, 1}, {2, 3}, {0, 2}, {1, 3}}};
    const int *b = of[s->count == 4][j];
    for (int k = 0; k < 3; k++) {
        int sign = root_sign(m, &s->box[b[0]][k], r);
        if (sign && sign == root_sign(m, &s->box[b[1]][k], r))
            return false;
    }
    return true;
}

/* Whether the primitives touch at t = 0 (cell 0) or t = 1 (cell ROOT_ONE). */
static bool touching_end(struct big_arena *m, const struct system *s,
                         uint32_t cell)
{
    struct root r = {.cell = cell, .on_grid = true};
    return s->v.c[cell ? 3 : 0].sign == 0 && touches_at(m, s, &r);
}

/* The polynomials at whose roots a contact may begin (§6.5). */
struct list {
    int n;
    const struct poly *p[12];
    int axis; /* p[j] is form j on this axis; else -1 */
};

/* Whether one of the first n polynomials, if not identically zero, is zero at
 * r. Then r was tried before. */
static bool was_tried(struct big_arena *m, const struct list *l, int n,
                      const struct root *r)
{
    for (int k = 0; k < n; k++)
        if (!poly_zero(l->p[k]) && !root_avoids(m, l->p[k], r) &&
            root_sign(m, l->p[k], r) == 0)
            return true;
    return false;
}

/* Whether the primitives touch at root r of polynomial k. Returns false for a
 * root that was tried as a root of an earlier polynomial. */
static bool begins_contact(struct big_arena *m, const struct system *s,
                           const struct list *l, int k, const struct root *r)
{
    if (l->axis >= 0 && root_avoids(m, &s->n[l->axis], r))
        return touching_form(m, s, r, k);
    return !was_tried(m, l, k, r) && touches_at(m, s, r);
}

/* Returns the lesser of toi and the first root of polynomial k with contact.
 * Polynomials 0 … k-1 must have been tried. */
static uint32_t first_contact(struct big_arena *m, const struct system *s,
                              const struct list *l, int k, uint32_t toi)
{
    struct chain c[2];
    struct root r = {.of = l->p[k]};
    int mark = m->used, chains = chains_make(m, l->p[k], c);
    for (int i = 0; i < chains; i++)
        for (int j = 1; j <= c[i].roots; j++) {
            root_locate(m, &c[i], j, &r);
            if (r.cell >= toi)
                break;
            if (begins_contact(m, s, l, k, &r))
                toi = r.cell;
        }
    m->used = mark;
    return toi;
}

/* Returns the number of words in the coefficients of all forms of axis k. */
static int words_of(const struct system *s, int k)
{
    int words = 0;
    for (int j = 0; j < s->count; j++)
        for (int i = 0; i <= s->q[j][k].degree; i++)
            words += s->q[j][k].c[i].n;
    return words;
}

/* Returns the axis whose forms have the fewest words, without axes on which all
 * forms are identically zero; -1 if all three axes are such. */
static int short_axis(const struct system *s)
{
    int axis = -1, least = INT32_MAX;
    for (int k = 0; k < 3; k++) {
        int words = words_of(s, k);
        if (words && words < least) {
            least = words;
            axis = k;
        }
    }
    return axis;
}

/* Chooses the polynomials to try (§6.5): V, or where V is identically zero the
 * forms of one axis, or without such an axis the box forms. */
static struct list to_try(const struct system *s)
{
    struct list l = {.n = 1, .p = {&s->v}, .axis = -1};
    if (!poly_zero(&s->v))
        return l;
    int axis = short_axis(s);
    l.axis = axis;
    l.n = 0;
    for (int j = 0; j < s->count; j++)
        for (int k = 0; k < 3; k++)
            if (axis < 0 || k == axis)
                l.p[l.n++] = axis < 0 ? &s->box[j][k] : &s->q[j][k];
    return l;
}

static uint32_t solve_pair(struct big_arena *m, const struct system *s)
{
    uint32_t toi = UINT32_MAX;
    if (touching_end(m, s, 0))
        return 0;
    if (touching_end(m, s, ROOT_ONE))
        toi = ROOT_ONE;
    struct list l = to_try(s);
    for (int k = 0; k < l.n; k++)
        toi = first_contact(m, s, &l, k, toi);
    return toi;
}

int exact_first(double x[2][4][3], int kind, uint32_t *word, int n,
                uint32_t *toi)
{
    struct big_arena m = {.word = word, .size = n};
    struct system s;
    system_make(&m, x, kind, &s);
    *toi = solve_pair(&m, &s);
    return m.full ? -1 : m.most;
}
