/* SPDX-License-Identifier: Apache-2.0 */
/* Many worlds that are advanced by one call. spec/drape.h, spec/gpu.md §11 */
#include <stdio.h>
#include "tests/api/guest.h"
#include "tests/world/scene.h"

enum { WORLDS = 9, STEPS = 10, TWICE = 2 };

/* A scene for each k: sheets of two sizes that fall on a ball from elsewhere,
 * one of an explicit integrator, one of block-Jacobi, one on the reference. */
static int make(int k, struct guest *s, drape_world **world)
{
    guest_make(s, k == 4 ? DRAPE_REF : DRAPE_GPU);
    s->cloth.origin[0] += 0.01 * k;
    s->cloth.m = k % 3 == 2 ? 9 : s->cloth.m;
    if (k == 5) {
        s->def.integrator = DRAPE_VERLET;
        s->def.dt = 1e-3;
    }
    s->def.precond = k == 6 ? DRAPE_JACOBI : s->def.precond;
    drape_error e; int st = drape_create(&s->def, world, &e); if (st) printf("%d %d %s\n", k, st, e.text); return st;
}

static void end(drape_world *world[WORLDS])
{
    for (int k = 0; k < WORLDS; k++) {
        drape_destroy(world[k]);
        world[k] = NULL;
    }
}

static bool plain(const drape_step_report *a, const drape_step_report *b)
{
    return a->step == b->step && a->outcome == b->outcome &&
           a->iterations == b->iterations && a->contacts == b->contacts &&
           a->slices == b->slices && a->kinetic == b->kinetic;
}

/* Every world has the bits and the reports that it has alone, with one thread of
 * the host and with several. */
const char *test_together_bits(void)
{
    static struct guest s[WORLDS];
    static drape_step_report alone[WORLDS][STEPS], with[WORLDS][STEPS];
    drape_world *world[WORLDS] = {NULL};
    uint64_t hash[WORLDS];
    int status[WORLDS];
    for (int threads = 0; threads <= 3; threads++) {
        for (int k = 0; k < WORLDS; k++) {
            int made = make(k, &s[k], &world[k]);
            if (made == DRAPE_EDEVICE)
                return skip("there is no device");
            EXPECT(made == DRAPE_OK);
        }
        if (threads) {
            for (int t = 0; t < TWICE; t++)
                EXPECT(drape_step_many(world, WORLDS, STEPS / TWICE, threads,
                                       &with[0][0], status) == DRAPE_OK);
        } else
            for (int k = 0; k < WORLDS; k++)
                for (int t = 0; t < STEPS; t++)
                    EXPECT(drape_step(world[k], &alone[k][t]) == DRAPE_OK);
        if (threads==1) for (int k = 0; k < WORLDS; k++) for (int t=0;t<5;t++) printf("%d %d: step %d out %x it %d c %d kin %g | %x %d %d %g\n",k,t,(int)(&with[0][0]+5*k)[t].step,(&with[0][0]+5*k)[t].outcome,(int)(&with[0][0]+5*k)[t].iterations,(int)(&with[0][0]+5*k)[t].contacts,(&with[0][0]+5*k)[t].kinetic,alone[k][t+5].outcome,(int)alone[k][t+5].iterations,(int)alone[k][t+5].contacts,alone[k][t+5].kinetic);
        for (int k = 0; k < WORLDS; k++) {
            const drape_step_report *last =
                &with[0][0] + (k + 1) * (STEPS / TWICE) - 1;
            hash[k] = threads ? hash[k] : scene_hash(world[k]);
            if (hash[k] != scene_hash(world[k])) printf("threads %d world %d differs; status %d step %d\n", threads, k, status[k], (int)last->step);
            EXPECT(!threads || (status[k] == DRAPE_OK &&
                                plain(last, &alone[k][STEPS - 1])));
        }
        EXPECT(alone[0][STEPS - 1].contacts > 0);
        end(world);
        ran(1);
    }
    return NULL;
}
