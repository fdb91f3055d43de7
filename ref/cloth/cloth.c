/* SPDX-License-Identifier: Apache-2.0 */
/* Builds the cloth model: masks, triangles, masses and force laws.
 * spec/cloth/cloth.md */
#include "ref/cloth/cloth.h"

#include "ref/base/cells.h"
#include "ref/cloth/law.h"
#include "ref/cloth/measured.h"
#include "ref/cloth/triple.h"

/* Whether cell (i, j) has springs: those of odd cells are not of the grid. */
static bool has_cell(const drape_cloth *d, int64_t i, int64_t j)
{
    return cell_kind(d, i, j) == DRAPE_CELL_REGULAR;
}

/* §4: the shares of the springs along u, v and each diagonal in the stiffness
 * per width, N/m, or in the bending stiffness, N·m. */
struct moduli {
    double u, v, diagonal;
};

/* cos² and sin² of the angle between a cell's diagonal and u. */
struct angle {
    double c2, s2;
};

static struct moduli membrane_moduli(const drape_material *a, struct angle t)
{
    struct moduli s;
    s.diagonal = a->shear / (2 * t.c2 * t.s2);
    s.u = a->stretch - a->shear * t.c2 / t.s2;
    s.v = a->stretch - a->shear * t.s2 / t.c2;
    return s;
}

static struct moduli bending_moduli(const drape_material *a, struct angle t)
{
    double least = 6 * t.c2 * t.s2;
    if (2 * t.c2 * t.c2 > least)
        least = 2 * t.c2 * t.c2;
    if (2 * t.s2 * t.s2 > least)
        least = 2 * t.s2 * t.s2;
    struct moduli s;
    s.diagonal = a->bend / least;
    s.u = a->bend - 2 * s.diagonal * t.c2 * t.c2;
    s.v = a->bend - 2 * s.diagonal * t.s2 * t.s2;
    return s;
}

/* §4: sets the law of direction o. With triples the single springs have all of
 * the stiffness; else half of it goes to double springs, which also get the
 * bending. length: of a single spring, m; limit: of its strain (§8), 0: none.
 */
static void set_law(struct cloth *c, int o, double length, double stretch,
                    double bend, double limit)
{
    struct law *a = &c->law[o];
    double area = (double)c->hu * (double)c->hv;
    bool two = o >= SPRINGS_SINGLE;
    double rest = two ? 2 * length : length;
    double fraction = c->triples ? !two : 0.5;
    double k = fraction * stretch * area / (rest * rest);
    double compression = two ? 4 * k : k; /* of the single springs along it */
    double b = two && !c->triples ? bend * area / (rest * rest * rest) : 0;
    double slope = LAW_STEEPEST * b / rest;
    *a = (struct law){.k = (real)k, .compression = (real)compression};
    a->rest = (real)rest;
    a->bend = (real)b;
    a->damp = (real)((double)c->beta * k);
    a->stiff = (real)(slope > compression ? slope : compression);
    law_set_knee(a, two && !c->triples);
    law_set_limit(a, two ? 0 : limit);
}

/* §7: sets the constants of the triples of direction o. length: of a single
 * spring, m; moment: of the direction; bend: of the material, for borders
 * that no diagonal triple has its middle on. N·m both. */
static void set_triples(struct cloth *c, int o, double length, double moment,
                        double bend)
{
    double area = (double)c->hu * (double)c->hv;
    double square = length * length, unit = area / (square * square);
    for (unsigned b = 0; b < CELL_MASKS; b++) {
        double cells = (b & 1) + (b >> 1 & 1) + (b >> 2 & 1) + (b >> 3 & 1);
        bool alone = !has_triple(2, b) && !has_triple(3, b);
        double k = (alone ? bend : moment) * unit * (cells / 4);
        c->triple[CELL_MASKS * o + (int)b] = has_triple(o, b) ? (real)k : 0;
    }
}

int ref_cloth_laws(const drape_cloth *d, struct cloth *c)
{
    c->hu = (real)(d->width / (d->m - 1));
    c->hv = (real)(d->height / (d->n - 1));
    c->beta = (real)d->material.damping;
    c->triples = d->bending == DRAPE_TRIPLES ? TRIPLES : 0;
    double hu = (double)c->hu, hv = (double)c->hv;
    c->cell_mass = (real)(d->material.density * hu * hv);

    double square = hu * hu + hv * hv, diagonal = sqrt(square);
    struct angle t = {hu * hu / square, hv * hv / square};
    struct moduli s = membrane_moduli(&d->material, t);
    struct moduli b = bending_moduli(&d->material, t);
    c->misfit = (struct misfit){.kind = MISFIT_OBLONG};
    if (!(s.u > 0 && s.v > 0))
        return DRAPE_EARG;
    const double *limit = d->material.limit;
    double leaning = limit[2] * sqrt(t.c2 * t.s2); /* of diagonals, §8 */
    for (int two = 0; two < SPRINGS; two += SPRINGS_SINGLE) {
        set_law(c, two + 0, hu, s.u, b.u, limit[0]);
        set_law(c, two + 1, hv, s.v, b.v, limit[1]);
        set_law(c, two + 2, diagonal, s.diagonal, b.diagonal, leaning);
        set_law(c, two + 3, diagonal, s.diagonal, b.diagonal, leaning);
    }
    double bend = d->material.bend;
    set_triples(c, 0, hu, b.u, bend);
    set_triples(c, 1, hv, b.v, bend);
    set_triples(c, 2, diagonal, b.diagonal, bend);
    set_triples(c, 3, diagonal, b.diagonal, bend);
    return measured_laws(&d->material, c);
}

int ref_cloth_size(const drape_cloth *d, struct cloth *c)
{
    *c = (struct cloth){.m = d->m, .n = d->n};
    c->count = (int64_t)d->m * d->n;
    for (int64_t j = 0; j < d->n; j++)
        for (int64_t i = 0; i < d->m; i++)
            c->n_triangles +=
                cell_triangles(cell_kind(d, i, j), 0, d->m, (int64_t[2][3]){0});
    return ref_cloth_laws(d, c);
}

/* §2: the mask of the single springs that start at particle (i, j). A spring is
 * present iff a cell beside it is. */
static uint8_t single_springs(const drape_cloth *d, int64_t i, int64_t j)
{
    bool here = has_cell(d, i, j);
    bool left = has_cell(d, i - 1, j), below = has_cell(d, i, j - 1);
    return (uint8_t)((here || below) | (here || left) << 1 | here << 2 |
                     left << 3);
}

/* §2: the mask of all springs. A double spring is present iff the two single
 * springs along it are. */
static uint8_t all_springs(const drape_cloth *d, int64_t i, int64_t j)
{
    uint8_t one = single_springs(d, i, j), mask = one;
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        uint8_t next = single_springs(d, i + spring_di[o], j + spring_dj[o]);
        mask = (uint8_t)(mask | ((one & next) >> o & 1) << (o + 4));
    }
    return mask;
}

static void fill_particle(const drape_cloth *d, struct cloth *c, int64_t p)
{
    int64_t i = p % d->m, j = p / d->m;
    int beside = 0;
    bool there = false;
    for (int k = 0; k < 4; k++) {
        int kind = cell_kind(d, i - k % 2, j - k / 2);
        int64_t at[4];
        int corners = cell_corners(kind, p - k % 2 - d->m * (k / 2), d->m, at);
        beside |= (kind == DRAPE_CELL_REGULAR) << k;
        for (int q = 0; q < corners; q++)
            there |= at[q] == p;
    }
    c->beside[p] = (uint8_t)beside;
    c->cell[p] = has_cell(d, i, j);
    c->springs[p] = all_springs(d, i, j);
    c->fixed[p] = there ? 0 : CLOTH_ABSENT;
}

/* §3: writes the triangles, cell by cell. */
static void fill_triangles(const drape_cloth *d, struct cloth *c, int64_t base)
{
    int64_t t = 0, tri[2][3];
    for (int64_t j = 0; j < d->n - 1; j++)
        for (int64_t i = 0; i < d->m - 1; i++) {
            int kind = cell_kind(d, i, j);
            int count = cell_triangles(kind, i + d->m * j, d->m, tri);
            for (int k = 0; k < count; k++, t++)
                for (int q = 0; q < 3; q++)
                    c->tri[t][q] = (int32_t)(base + tri[k][q]);
        }
}

/* The constant of the triple of direction o with its middle at (i, j). */
static double triple_constant_at(const struct cloth *c, int o, int64_t i,
                                 int64_t j)
{
    if (!c->triples || i < 0 || j < 0 || i >= c->m || j >= c->n)
        return 0;
    return (double)triple_constant(c->triple, o, c->beside[i + c->m * j]);
}

/* The bound on the slope of the springs of direction o; limited: with what a
 * limit or a measured tension adds to it, which is not damped (§8, §9). */
static double steepest_slope(const struct cloth *c, int o, bool limited)
{
    const struct law *a = &c->law[o];
    return (double)(limited || o >= SPRINGS_SINGLE ? a->stiff : a->compression);
}

/* §6: half of p's row sum of the stiffness bounds, N/m, of all springs and
 * triples at p. */
static double stiffness_bound(const struct cloth *c, int64_t p, bool limited)
{
    int64_t j = p / c->m, i = p % c->m;
    double k = 0;
    for (int o = 0; o < SPRINGS_SINGLE; o++) {
        int64_t di = spring_di[o], dj = spring_dj[o];
        k += 4 * triple_constant_at(c, o, i, j) +
             2 * (triple_constant_at(c, o, i + di, j + dj) +
                  triple_constant_at(c, o, i - di, j - dj));
    }
    for (int o = 0; o < SPRINGS; o++) {
        int64_t di = spring_di[o], dj = spring_dj[o];
        if (c->springs[p] >> o & 1)
            k += steepest_slope(c, o, limited);
        if (i - di < 0 || i - di >= c->m || j < dj)
            continue;
        if (c->springs[p - di - dj * c->m] >> o & 1)
            k += steepest_slope(c, o, limited);
    }
    return k;
}

/* §6: the bound of Gershgorin on the eigenvalues of M⁻¹K: the maximum over the
 * free particles of twice the stiffness by the mass. */
static double gershgorin_bound(const struct cloth *c, bool limited)
{
    double bound = 0;
    for (int64_t p = 0; p < c->count; p++) {
        if (c->fixed[p])
            continue;
        double row = 2 * stiffness_bound(c, p, limited) / (double)c->mass[p];
        bound = row > bound ? row : bound;
    }
    return bound;
}

void ref_cloth_weigh(struct cloth *c)
{
    EACH_ITEM
    for (int64_t p = 0; p < c->count; p++) {
        unsigned b = c->beside[p];
        if (b & BESIDE_STARS)
            continue; /* panel_set_material weighs it */
        int cells = (int)((b & 1) + (b >> 1 & 1) + (b >> 2 & 1) + (b >> 3 & 1));
        c->mass[p] = (real)cells * (R(0.25) * c->cell_mass);
    }
    c->bound = gershgorin_bound(c, true);
    c->damped = gershgorin_bound(c, false);
}

int ref_cloth_fill(const drape_cloth *d, struct cloth *c, int64_t base)
{
    EACH_ITEM
    for (int64_t p = 0; p < c->count; p++)
        fill_particle(d, c, p);

    fill_triangles(d, c, base);
    for (int k = 0; k < d->n_pins; k++) {
        int64_t p = d->pins[k].i + (int64_t)d->m * d->pins[k].j;
        if (c->fixed[p] == CLOTH_ABSENT)
            return DRAPE_EARG;
        c->n_pinned += c->fixed[p] != CLOTH_PINNED;
        c->fixed[p] = CLOTH_PINNED;
    }
    ref_cloth_weigh(c);
    return DRAPE_OK;
}

static vec round_vector(const double a[3])
{
    return vec_make((real)a[0], (real)a[1], (real)a[2]);
}

int ref_cloth_start(const drape_cloth *d, vec *x, vec *v)
{
    double hu = d->width / (d->m - 1), hv = d->height / (d->n - 1);
    for (int64_t p = 0; p < (int64_t)d->m * d->n; p++) {
        double s = hu * (double)(p % d->m), t = hv * (double)(p / d->m), a[3];
        if (d->panel) {
            s = d->panel->rest[p][0];
            t = d->panel->rest[p][1];
        }
        for (int k = 0; k < 3; k++)
            a[k] = d->x ? d->x[p][k] : d->origin[k] + s * d->u[k] + t * d->v[k];
        x[p] = round_vector(a);
        v[p] = d->velocity ? round_vector(d->velocity[p]) : vec_make(0, 0, 0);
        if (!vec_sane(x[p]) || !vec_sane(v[p]))
            return DRAPE_EDATA;
    }
    return DRAPE_OK;
}
