/* SPDX-License-Identifier: Apache-2.0 */
/* The list of contacts: its impulses are what contacts changed of the momentum,
 * and each pair's impulse pushes and rubs within its cone.
 * spec/control/control.md §8 */
#include <stdlib.h>

#include "gpu/run/gpu.h"
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

/* §8.3: the momentum that the sheet gained beside gravity's; the slab got the
 * opposite, which is the sum of the pairs where all normals are one. */
static const char *check_step(const struct slab *d, drape_world *world,
                              const double (*v0)[3], const double (*v1)[3],
                              double *most, int *flats)
{
    drape_contact_list l;
    double p[2][3], pair[3] = {0, 0, 0}, off[3], on[3], both[3];
    bool flat = true;
    EXPECT(drape_contacts(world, &l) == DRAPE_OK && l.dt == d->def.dt);
    momentum(&d->cloth, v0, p[0]);
    momentum(&d->cloth, v1, p[1]);
    for (int64_t k = 0; k < l.n; k++) {
        const drape_contact *c = &l.contact[k];
        const char *failed = check_contact(c, NV);
        if (failed)
            return failed;
        bool self = c->body[0] == c->body[1];
        flat = flat && fabs(c->normal[1]) > 1 - 1e-6;
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
    EXPECT(size(off) <= 2e-3 * scale + 1e-4 * size(l.impulse[0]));
    EXPECT(!flat || size(on) <= 1e-5 * (scale + size(l.impulse[0])));
    EXPECT(size(both) <= 1e-5 * (scale + size(l.impulse[0])));
    *flats += flat && l.n > 0;
    *most = l.impulse[0][1] / scale > *most ? l.impulse[0][1] / scale : *most;
    ran(1);
    return NULL;
}

/* A sheet falls on the slab, thrown sideways so that friction acts. Steps that
 * are cut are not compared, as the list has their last slice only. */
static const char *check_fall(int integrator, int backend, int newton)
{
    static double v[2][NV][3], throw[COUNT][3];
    struct slab d;
    double most = 0;
    int compared = 0, flats = 0;
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
    drape_world *world = slab_world(&d);
    EXPECT(world);
    const char *failed = NULL;
    for (int k = 0; k < 16 && !failed; k++) {
        drape_step_report r;
        drape_read(world, NULL, v[0]);
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        drape_read(world, NULL, v[1]);
        if (r.outcome || r.slices > 1)
            continue;
        compared++;
        failed = check_step(&d, world, (const double(*)[3])v[0],
                            (const double(*)[3])v[1], &most, &flats);
    }
    drape_destroy(world);
    EXPECT(failed || (compared > 8 && flats > 0 && most > 1));
    return failed;
}

const char *test_list_momentum(void)
{
    static const int some[] = {DRAPE_BW, DRAPE_BW, DRAPE_CK, DRAPE_BDF2};
    const char *failed = NULL;
    /* as many solves as BDF2's motion needs: what Newton's method leaves is
     * momentum, too */
    for (int k = 0; k < 8 && !failed; k++)
        failed = check_fall(some[k / 2], k % 2, (int[]){0, 3, 0, 16}[k / 2]);
    return failed;
}

/* The largest quotient of friction and normal force of a contact in the list,
 * among those that bear more than rounding. */
static double steepest(const drape_contact_list *l)
{
    double most = 0, all = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int64_t k = 0; k < l->n; k++) {
            const drape_contact *c = &l->contact[k];
            double across[3], along = 0;
            for (int i = 0; i < 3; i++)
                along += c->impulse[i] * c->normal[i];
            for (int i = 0; i < 3; i++)
                across[i] = c->impulse[i] - along * c->normal[i];
            all += pass ? 0 : fabs(along);
            if (pass && size(across) > 1e-6 * all)
                most = fmax(most, size(across) / fmax(along, 0));
        }
    return most;
}

/* §8.2: no contact's friction is beyond its cone, in steps with rounds, too: a
 * sheet folds over the edge of a slab. */
static const char *check_cone(int integrator, int backend)
{
    struct slab d;
    const double friction = 0.2;
    double most = 0;
    int rounds = 0;
    slab_make(&d, integrator);
    d.cloth.u[0] = 0.28;
    d.cloth.u[1] = 0.96;
    d.cloth.origin[0] = 0;
    d.cloth.material.friction = d.obstacle.friction = friction;
    d.obstacle.motion = -1;
    d.def.backend = backend;
    drape_world *world = slab_world(&d);
    EXPECT(world);
    for (int k = 0; k < 40; k++) {
        drape_contact_list l;
        drape_step_report r;
        EXPECT(drape_step(world, &r) == DRAPE_OK);
        EXPECT(drape_contacts(world, &l) == DRAPE_OK);
        rounds += r.rounds > 1 && l.n > 0;
        most = fmax(most, steepest(&l));
    }
    drape_destroy(world);
    EXPECT(rounds > 4 && most > 0.99 * friction);
    EXPECT(most <= friction * (1 + 1e-3));
    ran(1);
    return NULL;
}

const char *test_list_cone(void)
{
    const char *failed = check_cone(DRAPE_BW, DRAPE_REF);
    failed = failed ? failed : check_cone(DRAPE_BW, DRAPE_GPU);
    return failed ? failed : check_cone(DRAPE_BDF2, DRAPE_REF);
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
