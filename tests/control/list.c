/* SPDX-License-Identifier: Apache-2.0 */
/* The list of contacts: its impulses are what contacts changed of the momentum,
 * and each pair's impulse pushes and rubs within its cone.
 * spec/control/control.md §8 */
#include <float.h>
#include <stdlib.h>

#include "gpu/run/gpu.h"
#include "ref/api/handle.h"
#include "ref/world/state.h"
#include "tests/world/scene.h"
#include "tests/world/slab.h"

enum { SIDE = SLAB_SMALL, COUNT = SIDE * SIDE, BOX = 8, NV = COUNT + BOX };

/* Masses of a full grid's particles, by the cells around them. */
static double mass_of(const drape_cloth *c, int p)
{
    int i = p % c->m, j = p / c->m;
    int cells = (i > 0 ? 1 : 0) + (i < c->m - 1 ? 1 : 0);
    cells *= (j > 0 ? 1 : 0) + (j < c->n - 1 ? 1 : 0);
    double cell =
        c->width / (c->m - 1) * c->height / (c->n - 1) * c->material.density;
    return 0.25 * cells * cell;
}

static void momentum(const drape_cloth *c, const double (*v)[3], double p[3])
{
    p[0] = p[1] = p[2] = 0;
    for (int k = 0; k < COUNT; k++)
        for (int i = 0; i < 3; i++)
            p[i] += mass_of(c, k) * v[k][i];
}

static double size(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* §8.1: what each contact says of its pair. */
static const char *check_contact(const drape_contact *c, int64_t nv)
{
    double n = size(c->normal), weight[2] = {0, 0};
    int first = c->kind ? 2 : 1;
    EXPECT(c->kind >> 1 == 0 && fabs(n - 1) < 1e-5 && c->unused == 0);
    for (int j = 0; j < 4; j++) {
        EXPECT(c->vertex[j] >= 0 && c->vertex[j] < nv);
        weight[j >= first] += c->weight[j];
    }
    EXPECT(fabs(weight[0] - 1) < 1e-5 && fabs(weight[1] + 1) < 1e-5);
    EXPECT(c->body[0] == (c->vertex[0] >= COUNT));
    EXPECT(c->body[1] == (c->vertex[3] >= COUNT));
    EXPECT(c->body[0] == 0 || c->body[1] == 0);
    return NULL;
}

/* The momentum of the sheet that an integrator keeps where nothing pushes: of
 * v, and for a slice with a past of 3/2 v - 1/2 of the velocity in the past, as
 * BDF2 has it (implicit.md §1). */
static int keeps(drape_world *world, const drape_cloth *c, bool past_too,
                 double p[3])
{
    static double v[NV][3], before[NV][3];
    static vec past[COUNT];
    const struct world *w = world->world;
    double q[3];
    int status = drape_read(world, NULL, v);
    momentum(c, (const double(*)[3])v, p);
    if (status != DRAPE_OK || !w->past_v || !past_too)
        return status;
    w->run->fetch(w->on, past, w->past_v, sizeof past);
    for (int k = 0; k < COUNT; k++) {
        before[k][0] = (double)past[k].x;
        before[k][1] = (double)past[k].y;
        before[k][2] = (double)past[k].z;
    }
    momentum(c, (const double(*)[3])before, q);
    for (int i = 0; i < 3; i++)
        p[i] = 1.5 * p[i] - 0.5 * q[i];
    return w->run->status(w->on);
}

/* How much momentum the residual r of the loop may be along `off`, N·s. Let e
 * be the unit vector along it at all particles, and B = A + bound. By
 * Cauchy–Schwarz |e·r| ≤ √(e·Be) √(r·B⁻¹r). Springs do not resist e, so that
 * e·Be is the sheet's mass and e·hold e. The second root is what the step
 * reports, relative to the scale of lagrange.md §3.4, but for the cycle that
 * stands for B⁻¹, which is less by some tenths. A slice with a past gets 3/2 of
 * it (dt / tau). */
static double left_over(drape_world *world, const drape_cloth *c,
                        double residual, const double off[3])
{
    static sym bound[COUNT];
    static vec force[COUNT];
    const struct world *w = world->world;
    const struct lagrange *a = &w->lagrange;
    double mass = c->width * c->height * c->material.density, sum = mass;
    double net = 0, d[3];
    for (int i = 0; i < 3; i++)
        d[i] = off[i] / fmax(size(off), DBL_MIN);
    w->run->fetch(w->on, bound, a->bound[a->held], sizeof bound);
    w->run->fetch(w->on, force, a->law.force, sizeof force);
    if (w->run->status(w->on) != DRAPE_OK)
        return 0;
    for (int k = 0; k < COUNT; k++) {
        vec h =
            sym_apply(bound[k], vec_make((real)d[0], (real)d[1], (real)d[2]));
        sum += d[0] * (double)h.x + d[1] * (double)h.y + d[2] * (double)h.z;
        net += (double)vec_dot(force[k], force[k]) / mass_of(c, k);
    }
    double least = sqrt(mass) * 9.81 * w->dt;
    return 1.5 * sqrt(sum) * residual * fmax(least, sqrt(net));
}

/* §8.3: the momentum that the sheet gained beside gravity's; the slab got the
 * opposite, which is the sum of the pairs. */
static const char *check_step(const struct slab *d, drape_world *world,
                              const double p[2][3], double residual,
                              double *most, int *pressed, int *sharp)
{
    drape_contact_list l;
    double pair[3] = {0, 0, 0}, off[3], on[3], both[3];
    EXPECT(drape_contacts(world, &l) == DRAPE_OK && l.dt == d->def.dt);
    for (int64_t k = 0; k < l.n; k++) {
        const drape_contact *c = &l.contact[k];
        const char *failed = check_contact(c, NV);
        if (failed)
            return failed;
        bool self = c->body[0] == c->body[1];
        for (int i = 0; i < 3 && !self; i++)
            pair[i] += c->body[0] ? -c->impulse[i] : c->impulse[i];
    }
    double weight = 0.2 * d->cloth.width * d->cloth.height;
    for (int i = 0; i < 3; i++) {
        double fell = weight * d->def.gravity[i] * d->def.dt;
        off[i] = p[1][i] - p[0][i] - fell - l.impulse[0][i];
        on[i] = l.impulse[1][i] + pair[i];
        both[i] = l.impulse[0][i] + l.impulse[1][i];
    }
    double scale = weight * 9.81 * d->def.dt;
    double may = left_over(world, &d->cloth, residual, off);
    EXPECT(size(off) <= may + 1e-5 * (scale + size(l.impulse[0])));
    *sharp += may < 0.05 * scale;
    EXPECT(size(on) <= 1e-5 * (scale + size(l.impulse[0])));
    EXPECT(size(both) <= 1e-5 * (scale + size(l.impulse[0])));
    *pressed += l.n > 0;
    *most = l.impulse[0][1] / scale > *most ? l.impulse[0][1] / scale : *most;
    ran(1);
    return NULL;
}

/* A sheet falls on the slab, thrown sideways so that friction acts; the slab
 * may deform meanwhile. Steps that are cut are not compared, as the list has
 * their last slice only. */
static const char *check_fall(int integrator, int backend, int newton,
                              bool deforms)
{
    static double frame[2][BOX][3];
    static double throw[COUNT][3];
    struct slab d;
    double p[2][3], most = 0;
    int pressed = 0, sharp = 0;
    slab_small(&d, integrator, 0.1025);
    for (int k = 0; k < COUNT; k++) {
        throw[k][0] = 0.3;
        throw[k][1] = -0.2;
    }
    d.cloth.velocity = (const double(*)[3]) throw;
    d.def.backend = backend;
    d.def.newton = newton;
    d.def.tolerance = 1e-6;
    d.def.max_slices = 1;
    d.obstacle.motion = -1;
    for (int k = 0; k < 2 * BOX && deforms; k++)
        for (int i = 0; i < 3; i++) /* it rises at one end, and grows */
            frame[k / BOX][k % BOX][i] =
                d.obstacle.x[k % BOX][i] *
                (1 + (k / BOX) * (0.1 + 0.5 * d.obstacle.x[k % BOX][0]));
    d.obstacle.frames = deforms ? 2 : 0;
    d.obstacle.frame_dt = 0.5;
    d.obstacle.frame = (const double(*)[3])frame;
    drape_world *world = slab_world(&d);
    EXPECT(world);
    const char *failed = NULL;
    int steps = backend ? 4 : 16; /* an emulated device is slow */
    for (int k = 0; k < steps && !failed; k++) {
        drape_step_report r;
        EXPECT(keeps(world, &d.cloth, k > 0, p[0]) == DRAPE_OK);
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(keeps(world, &d.cloth, k > 0, p[1]) == DRAPE_OK);
        if (r.outcome || r.slices > 1)
            continue;
        failed = check_step(&d, world, (const double(*)[3])p, r.residual, &most,
                            &pressed, &sharp);
    }
    drape_destroy(world);
    EXPECT(failed || (sharp > steps / 2 && pressed > 0 && most > 1));
    return failed;
}

const char *test_list_momentum(void)
{
    static const int some[] = {DRAPE_BW, DRAPE_BW, DRAPE_CK, DRAPE_BDF2};
    const char *failed = NULL;
    /* as many solves as BDF2's motion needs: what Newton's method leaves is
     * momentum, too */
    for (int k = 0; k < 8 && !failed; k++)
        if (!scene_left_out(some[k / 2], k % 2))
            failed = check_fall(some[k / 2], k % 2, (int[]){0, 3, 0, 16}[k / 2],
                                false);
    for (int k = 0; k < 2 && !failed; k++)
        failed = check_fall(DRAPE_BW, k, 0, true);
    return failed;
}

/* The parts of a contact's impulse along its normal and across it, N·s. */
static double parts(const drape_contact *c, double *along)
{
    double across[3];
    *along = 0;
    for (int i = 0; i < 3; i++)
        *along += c->impulse[i] * c->normal[i];
    for (int i = 0; i < 3; i++)
        across[i] = c->impulse[i] - *along * c->normal[i];
    return size(across);
}

/* §8.2: friction is within the cone of the load that the loop knew, and in the
 * rounds within that of their own impulse, but for rounding of numbers that are
 * `most` at most. */
static const char *check_loads(drape_world *world, const drape_contact_list *l,
                               double most)
{
    static struct contact solved[1 << 13], pushed[1 << 13];
    const struct world *w = world->world;
    const struct response *r = &w->response;
    int64_t n = w->lagrange.solved ? r->n_solved : 0;
    int64_t n_pushed = r->contacts_solved ? r->active : 0;
    double span = (double)w->lagrange.law.dt / (double)w->lagrange.law.tau;
    double rounding = 1e-5 * most;
    if (l->n == 0)
        return NULL;
    EXPECT(n <= l->n && n <= 1 << 13 && n_pushed <= 1 << 13);
    w->run->fetch(w->on, solved, r->contact[r->solved].data,
                  (size_t)n * sizeof *solved);
    w->run->fetch(w->on, pushed, r->contact[r->side].data,
                  (size_t)n_pushed * sizeof *pushed);
    EXPECT(w->run->status(w->on) == DRAPE_OK);
    for (int64_t k = 0; k < n && n_pushed == 0; k++) {
        double along, across = parts(&l->contact[k], &along);
        double load = (double)solved[k].friction * (double)solved[k].load;
        EXPECT(across <= span * load + rounding && along >= -rounding);
    }
    for (int64_t k = 0; k < n_pushed; k++) {
        const struct contact *c = &pushed[k];
        double load = (double)c->friction * (double)c->impulse;
        EXPECT((double)vec_length(c->tangent) <= load + rounding);
    }
    return NULL;
}

/* What a scene's lists have shown. */
struct cones {
    int steps;       /* in balance, and without impulses of rounds */
    double steepest; /* quotient of friction and load, of contacts that bear
                        a part of the whole */
};

/* §8.2: in a step that ends in balance the loads are what contacts bear, as far
 * as the residual tells. Let y be the directions of friction at the particles
 * that slide. What friction exceeds its cones by is at most y times what the
 * outer residual has and the inner one has not (coulomb.md §2.2), so by
 * Cauchy–Schwarz as in left_over √(y·By) times both residuals. Neighbours slide
 * alike, so that springs resist y little, and hold is some hundred masses at
 * most: κ is 30 in the mass that a contact moves, more under a load, and a
 * particle has a contact or two. So the excess is within 2 √100 residuals of
 * the sheet's weight, or of what presses. */
static const char *check_excess(const drape_contact_list *l, double weight,
                                double residual, struct cones *s)
{
    double excess = 0, all = 0;
    const double friction = 0.2;
    for (int64_t k = 0; k < l->n; k++) {
        double along, across = parts(&l->contact[k], &along);
        excess += fmax(across - friction * along, 0);
        all += along;
    }
    for (int64_t k = 0; k < l->n; k++) {
        double along, across = parts(&l->contact[k], &along);
        if (along > 1e-3 * all)
            s->steepest = fmax(s->steepest, across / along);
    }
    s->steps++;
    EXPECT(excess <= 20 * residual * fmax(weight, all));
    return NULL;
}

/* A sheet falls and folds over the edge of a slab, and may slide off. However
 * low it comes, all of its energy is at most what it starts with. Backward
 * Euler loses more than slices gain. Choi–Ko does not: there the springs may
 * hold for a step what its slice left undone, four times the kinetic energy of
 * the step's start at most (lagrange.md §4). */
static const char *check_cone(int integrator, int backend, int steps,
                              struct cones *s)
{
    struct slab d;
    const char *failed = NULL;
    slab_make(&d, integrator);
    d.cloth.u[0] = 0.28;
    d.cloth.u[1] = 0.96;
    d.cloth.origin[0] = 0;
    d.cloth.material.friction = d.obstacle.friction = 0.2;
    d.obstacle.motion = -1;
    d.def.backend = backend;
    drape_world *world = slab_world(&d);
    EXPECT(world);
    double weight = 0.46 * 0.46 * d.cloth.material.density * 9.81 * d.def.dt;
    double centre = d.cloth.origin[1] + d.cloth.u[1] * 0.46 / 2;
    double start = weight / d.def.dt * centre; /* J, at rest */
    double before = 0;                         /* J, kinetic */
    int64_t listed = 0;
    for (int k = 0; k < steps && !failed; k++) {
        drape_contact_list l;
        drape_step_report r;
        double most = weight;
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(drape_contacts(world, &l) == DRAPE_OK);
        for (int64_t j = 0; j < l.n; j++)
            most = fmax(most, size(l.contact[j].impulse));
        listed += l.n;
        double above = r.kinetic + r.elastic + r.potential - start;
        EXPECT(above <= (integrator == DRAPE_BW ? 0 : 4 * before));
        before = r.kinetic;
        failed = check_loads(world, &l, most);
        if (!failed && l.n > 0 && r.rounds <= 1 &&
            r.residual <= d.def.tolerance)
            failed = check_excess(&l, weight, r.residual, s);
        ran(1);
    }
    drape_destroy(world);
    EXPECT(failed || listed > 0);
    return failed;
}

const char *test_list_cone(void)
{
    struct cones s = {0};
    /* on a device what is read is elsewhere: the first contacts show that */
    const char *failed = check_cone(DRAPE_BW, DRAPE_REF, 90, &s);
    failed = failed ? failed : check_cone(DRAPE_BW, DRAPE_GPU, 8, &s);
    failed = failed ? failed : check_cone(DRAPE_CK, DRAPE_REF, 60, &s);
    EXPECT(failed || (s.steps > 20 && s.steepest > 0.99 * 0.2));
    return failed;
}

/* §8: at rest the contacts carry the weight; the list is the same on both
 * backends, here and there; nothing is listed before a step and after the state
 * was set. */
const char *test_list_lent(void)
{
    static drape_contact kept[1 << 12];
    static double x[NV][3];
    int64_t n = 0;
    for (int backend = 0; backend < 2; backend++) {
        struct slab d;
        drape_contact_list l, there;
        slab_small(&d, DRAPE_BW, 0.1025);
        d.def.backend = backend;
        d.obstacle.motion = -1;
        drape_world *world = slab_world(&d);
        EXPECT(world && drape_contacts(world, &l) == DRAPE_OK && l.n == 0);
        EXPECT(l.impulse[0][1] == 0 && l.impulse[1][1] == 0);
        for (int k = 0; k < 12; k++)
            EXPECT(drape_step(world, NULL) == DRAPE_OK);
        EXPECT(drape_contacts(world, &l) == DRAPE_OK && l.n > 10);
        EXPECT(l.n <= 1 << 12 && (backend == 0 || l.n == n));
        EXPECT(backend == 0 ||
               !memcmp(kept, l.contact, (size_t)n * sizeof *kept));
        n = l.n;
        memcpy(kept, l.contact, (size_t)n * sizeof *kept);
        EXPECT(drape_contacts_device(world, &there) == DRAPE_OK);
        EXPECT(there.n == n);
        drape_read(world, x, NULL);
        EXPECT(drape_set_positions(world, 0, 1, (const double(*)[3])x, NULL) ==
               DRAPE_OK);
        EXPECT(drape_contacts(world, &l) == DRAPE_OK && l.n == 0);
        drape_destroy(world);
        ran(1);
    }
    return NULL;
}
