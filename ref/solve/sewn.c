/* SPDX-License-Identifier: Apache-2.0 */
/* One V-cycle over all cloths that seams join: the grids are those of each
 * cloth, and the seams are on all of them. spec/solve/sewn.md */
#include "ref/solve/sewn.h"

#include "ref/base/threads.h"
#include "ref/solve/coarsen.h"
#include "ref/solve/jacobi.h"
#include "ref/solve/level.h"

/* One cloth in the cycle. */
struct sewn_cloth {
    struct multigrid grid;
    struct level l[LEVELS];
    bool awake;
};

size_t ref_sewn_bytes(void)
{
    return sizeof(struct sewn_cloth);
}

int32_t sewn_depth(const drape_def *def)
{
    int32_t depth = 0;
    bool grids = def->n_seams > 0 && def->precond == DRAPE_MULTIGRID;
    for (int k = 0; k < def->n_cloths && grids; k++) {
        int32_t m = def->cloths[k].m, n = def->cloths[k].n, last = 0;
        do {
            m = coarse_size(m);
            n = coarse_size(n);
            last++;
        } while (m > 2 || n > 2);
        depth = last > depth ? last : depth;
    }
    return depth;
}

void ref_sewn_put(struct sewn *s, int k, const struct multigrid *grid,
                  bool awake)
{
    struct sewn_cloth *c = &s->cloth[k];
    c->grid = *grid;
    c->awake = awake;
    multigrid_lay_out(&c->grid, c->l);
}

/* What is done with grid k of all cloths that are awake. */
struct cloth_part {
    const struct sewn *s;
    int k;
    void (*part)(const struct multigrid *s, const struct level *l, int k);
};

static void run_cloth(void *user, int c)
{
    const struct cloth_part *p = user;
    const struct sewn_cloth *cloth = &p->s->cloth[c];
    if (cloth->awake)
        p->part(&cloth->grid, cloth->l, p->k);
}

/* Calls part(…) for all cloths that are awake. */
static void each_cloth(const struct sewn *s, int k,
                       void (*part)(const struct multigrid *s,
                                    const struct level *l, int k))
{
    struct cloth_part p = {s, k, part};
    int64_t most = 0, all = 0;
    for (int c = 0; c < s->cloths; c++) {
        int64_t n = s->cloth[c].awake ? s->cloth[c].l[k].count : 0;
        most = n > most ? n : most;
        all += n;
    }
    threads_each(s->cloths, threads_spread(most, all), run_cloth, &p);
}

/* §2: what the links of a row of grid k answer to x. */
static vec row_answer(const struct sewn *s, int k, const struct sewn_row *row)
{
    vec all = vec_make(0, 0, 0);
    for (int32_t e = row->first; e < row->end; e++) {
        const struct sewn_link *link = &s->link[s->of_row[e].at];
        vec sum = vec_make(0, 0, 0);
        for (int32_t j = link->first; j < link->end; j++) {
            const struct sewn_row *r = &s->row[s->of_link[j].at];
            vec x = s->cloth[r->cloth].l[k].x[r->particle];
            sum = vec_axpy(sum, s->of_link[j].c, x);
        }
        vec push = sym_apply(s->kappa[link->source], sum);
        all = vec_axpy(all, link->times * s->of_row[e].c, push);
    }
    return all;
}

/* §3.2: the diagonal block whose factors are f. */
static struct wide_sym unfactored(sym f)
{
    double x = 1 / (double)f.xx, y = 1 / (double)f.yy, z = 1 / (double)f.zz;
    double xy = (double)f.xy * x, xz = (double)f.xz * x;
    double yz = (double)f.yz * y;
    return (struct wide_sym){{x, xy, xz, y + (double)f.xy * xy,
                              yz + (double)f.xy * xz,
                              z + ((double)f.xz * xz + (double)f.yz * yz)}};
}

/* §3.2: the factors of a row's diagonal block with what its links add. */
static void ground_row(const struct sewn *s, int k, const struct sewn_row *row)
{
    struct sewn_cloth *c = &s->cloth[row->cloth];
    sym *f = (sym *)c->l[k].factor + row->particle;
    if (!c->awake || f->xx == 0)
        return; /* what is fixed has no factor */
    struct wide_sym d = unfactored(*f);
    real by = R(0.5625) * multigrid_damping(&c->grid, k); /* 1/h */
    for (int32_t e = row->first; e < row->end; e++) {
        const struct sewn_link *link = &s->link[s->of_row[e].at];
        sym q = s->kappa[link->source];
        real all = 0;
        for (int32_t j = link->first; j < link->end; j++)
            all += real_abs(s->of_link[j].c);
        real t = by * (link->times * all * real_abs(s->of_row[e].c));
        sym part = {t * q.xx, t * q.xy, t * q.xz, t * q.yy, t * q.yz, t * q.zz};
        d = wide_sym_add(d, part);
    }
    *f = ref_factor(d);
}

/* §4 */

static double component(sym b, int r, int c)
{
    const real a[3][3] = {
        {b.xx, b.xy, b.xz}, {b.xy, b.yy, b.yz}, {b.xz, b.yz, b.zz}};
    return (double)a[r][c];
}

/* The cloths' own part of the matrix of the last grids. */
static void fill_own(const struct sewn *s)
{
    double own[DENSE * DENSE];
    for (int k = 0; k < s->cloths; k++) {
        const struct sewn_cloth *c = &s->cloth[k];
        const struct sewn_place *at = &s->place[k];
        const struct sewn_group *g = &s->group[at->group];
        if (!c->awake)
            continue;
        struct coarsest l = multigrid_coarsest(&c->grid, &c->l[s->depth]);
        l.dense = own;
        coarsest_fill(&l);
        double *to = s->dense + g->dense + (int64_t)at->first * g->n;
        for (int i = 0; i < 3 * l.count; i++)
            for (int j = 0; j < 3 * l.count; j++)
                to[(int64_t)i * g->n + at->first + j] = own[i * DENSE + j];
    }
}

/* The unknown of a row's particle along x. */
static int32_t unknown_of(const struct sewn *s, const struct sewn_row *row)
{
    return s->place[row->cloth].first + 3 * row->particle;
}

/* Adds what a link couples. */
static void fill_link(const struct sewn *s, const struct sewn_link *link)
{
    sym q = s->kappa[link->source];
    for (int32_t i = link->first; i < link->end; i++)
        for (int32_t j = link->first; j < link->end; j++) {
            struct sewn_term x = s->of_link[i], y = s->of_link[j];
            const struct sewn_row *row = &s->row[x.at], *col = &s->row[y.at];
            const struct sewn_group *g = &s->group[s->place[row->cloth].group];
            double t = (double)link->times * ((double)x.c * (double)y.c);
            double *to = s->dense + g->dense + unknown_of(s, col);
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++)
                    to[(int64_t)(unknown_of(s, row) + r) * g->n + c] +=
                        t * component(q, r, c);
        }
}

/* Sweeps a symmetric matrix, of which only the lower triangle is read, as
 * coarsest_invert does. column [2 n]: scratch. */
static void invert_group(const struct sewn_group *g, double *a, double *column)
{
    int n = g->n;
    double *inverse = column + n, trace = 0;
    for (int k = 0; k < n; k++)
        trace += a[(int64_t)k * n + k];
    for (int k = 0; k < n; k++) {
        double d = a[(int64_t)k * n + k];
        double by = inverse[k] = d > 0x1p-40 * trace ? 1 / d : 0;
        if (by == 0)
            continue;
        for (int i = 0; i < n; i++)
            column[i] = i < k ? a[(int64_t)k * n + i] : a[(int64_t)i * n + k];
        EACH_MANY(n)
        for (int i = 0; i < n; i++) {
            double l = column[i] * by, *row = a + (int64_t)i * n;
            for (int j = 0; j <= i && i != k; j++)
                row[j] = j == k ? l : row[j] - l * column[j];
        }
        for (int j = 0; j < k; j++)
            a[(int64_t)k * n + j] = column[j] * by;
        a[(int64_t)k * n + k] = -by;
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) {
            double *e = &a[(int64_t)i * n + j];
            bool parked = inverse[i] == 0 || inverse[j] == 0;
            *e = a[(int64_t)j * n + i] = parked ? 0 : -*e;
        }
}

/* Whether the cloths of group k are awake: they fall asleep together. */
static bool is_awake(const struct sewn *s, int k)
{
    return s->cloth[s->group[k].cloth].awake;
}

void ref_sewn_set_up(struct sewn *s)
{
    for (int k = 0; k < s->depth; k++) {
        EACH_MANY(s->row_at[k + 1] - s->row_at[k])
        for (int64_t i = s->row_at[k]; i < s->row_at[k + 1]; i++)
            ground_row(s, k, &s->row[i]);
    }
    memset(s->dense, 0, (size_t)s->n_dense * sizeof *s->dense);
    fill_own(s);
    for (int64_t i = s->link_at[s->depth]; i < s->link_at[s->depth + 1]; i++)
        fill_link(s, &s->link[i]);
    for (int k = 0; k < s->groups; k++)
        if (is_awake(s, k))
            invert_group(&s->group[k], s->dense + s->group[k].dense, s->in);
}

/* §2: the residual of grid k gains what its seams push. */
static void answer_down(const struct sewn *s, int k)
{
    EACH_ITEM
    for (int64_t i = s->row_at[k]; i < s->row_at[k + 1]; i++) {
        const struct sewn_row *row = &s->row[i];
        const struct sewn_cloth *c = &s->cloth[row->cloth];
        const struct level *l = &c->l[k];
        if (!c->awake || (l->fixed && l->fixed[row->particle]))
            continue;
        vec *y = &l->y[row->particle];
        *y = vec_sub(*y, row_answer(s, k, row));
    }
}

/* The same of the smoothing on the way up. The answers are to x before it, so
 * they are found and kept before it. */
static void answer_up(const struct sewn *s, int k)
{
    EACH_ITEM
    for (int64_t i = s->row_at[k]; i < s->row_at[k + 1]; i++)
        s->answer[i - s->row_at[k]] = row_answer(s, k, &s->row[i]);
    each_cloth(s, k, multigrid_smooth);
    EACH_MANY(s->row_at[k + 1] - s->row_at[k])
    for (int64_t i = s->row_at[k]; i < s->row_at[k + 1]; i++) {
        const struct sewn_row *row = &s->row[i];
        const struct sewn_cloth *c = &s->cloth[row->cloth];
        const struct level *l = &c->l[k];
        if (!c->awake)
            continue;
        vec push = s->answer[i - s->row_at[k]], *x = &l->x[row->particle];
        push = factor_solve(l->factor[row->particle], push);
        *x = vec_axpy(*x, -multigrid_damping(&c->grid, k), push);
    }
}

/* §4: x of the last grid of all cloths. */
static void solve_last(const struct sewn *s)
{
    for (int c = 0; c < s->cloths; c++) {
        const struct level *l = &s->cloth[c].l[s->depth];
        double *to = s->in + s->group[s->place[c].group].first;
        for (int64_t p = 0; p < l->count; p++, to += 3) {
            to[s->place[c].first] = (double)l->b[p].x;
            to[s->place[c].first + 1] = (double)l->b[p].y;
            to[s->place[c].first + 2] = (double)l->b[p].z;
        }
    }
    for (int k = 0; k < s->groups; k++) {
        const struct sewn_group *g = &s->group[k];
        for (int i = 0; i < g->n && is_awake(s, k); i++) {
            double sum = 0;
            for (int j = 0; j < g->n; j++)
                sum += s->dense[g->dense + (int64_t)i * g->n + j] *
                       s->in[g->first + j];
            s->out[g->first + i] = sum;
        }
    }
    for (int c = 0; c < s->cloths; c++) {
        const struct level *l = &s->cloth[c].l[s->depth];
        const double *x = s->out + s->group[s->place[c].group].first;
        for (int64_t p = 0; p < l->count; p++, x += 3)
            l->x[p] = vec_make((real)x[s->place[c].first],
                               (real)x[s->place[c].first + 1],
                               (real)x[s->place[c].first + 2]);
    }
}

void ref_sewn_cycle(struct sewn *s)
{
    for (int k = 0; k < s->depth; k++) {
        each_cloth(s, k, multigrid_descend);
        answer_down(s, k);
        each_cloth(s, k, multigrid_restrict);
    }
    solve_last(s);
    for (int k = s->depth - 1; k >= 0; k--) {
        each_cloth(s, k, multigrid_prolong);
        answer_up(s, k);
    }
}
