/* SPDX-License-Identifier: Apache-2.0 */
/* Many worlds that are advanced by one call. spec/drape.h, spec/gpu.md §11 */
#include "tests/api/guest.h"
#include "tests/base/choices.h"
#include "tests/panel/random.h"
#include "tests/world/scene.h"

enum {
    WORLDS = 9,
    PANEL = 7,
    SEWN = 8,
    ROWS = 32,
    STEPS = 6,
    CALLS = 2,
    EACH = STEPS / CALLS
};

/* Holds the sides of a sheet as far apart as they are. */
static void sew_sides(struct guest *s)
{
    static int32_t particle[ROWS], onto[ROWS][2];
    static double part[ROWS];
    static drape_seam seam;
    int m = s->cloth.m, n = s->cloth.n;
    for (int j = 0; j < n && j < ROWS; j++) {
        particle[j] = m - 1 + m * j;
        onto[j][0] = onto[j][1] = m * j;
    }
    seam = (drape_seam){.n = n,
                        .particle = particle,
                        .onto = (const int32_t(*)[2])onto,
                        .part = part};
    s->def.seams = &seam;
    s->def.n_seams = 1;
}

/* Makes a world for each k: a sheet of one of two sizes that falls on a plate,
 * elsewhere for each k; one of an explicit integrator, one with block-Jacobi,
 * one on the reference, one a panel, one sewn to itself. */
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
    if (k == PANEL) {
        static struct random_panel panel;
        struct bytes b = {.seed = 1, .size = -1};
        random_panel(&b, &s->cloth, &panel);
        choices_free(&b);
    }
    if (k == SEWN)
        sew_sides(s);
    return drape_create(&s->def, world, NULL);
}

/* Whether two reports are the same but for what the clock says. */
static bool same(drape_step_report a, drape_step_report b)
{
    memset(a.seconds, 0, sizeof a.seconds);
    memset(b.seconds, 0, sizeof b.seconds);
    return memcmp(&a, &b, sizeof a) == 0;
}

/* Steps all worlds with so many threads and compares them with what they are
 * alone; with 0 threads steps each alone, and keeps what it is. */
static const char *run(int threads, drape_step_report alone[WORLDS][STEPS],
                       uint64_t hash[WORLDS])
{
    static struct guest s[WORLDS];
    static drape_step_report r[WORLDS][EACH];
    drape_world *world[WORLDS];
    int status[WORLDS];
    for (int k = 0; k < WORLDS; k++)
        EXPECT(make(k, &s[k], &world[k]) == DRAPE_OK);
    for (int k = 0; k < WORLDS && !threads; k++)
        for (int t = 0; t < STEPS; t++)
            EXPECT(drape_step(world[k], &alone[k][t]) == DRAPE_OK);
    for (int c = 0; c < CALLS && threads; c++) {
        EXPECT(drape_step_many(world, WORLDS, EACH, threads, r[0], status) ==
               DRAPE_OK);
        for (int k = 0; k < WORLDS; k++)
            for (int t = 0; t < EACH; t++)
                EXPECT(status[k] == DRAPE_OK &&
                       same(r[k][t], alone[k][c * EACH + t]));
    }
    for (int k = 0; k < WORLDS; k++) {
        hash[k] = threads ? hash[k] : scene_hash(world[k]);
        EXPECT(hash[k] == scene_hash(world[k]));
        drape_destroy(world[k]);
        EXPECT(s[k].host.held == 0 && s[k].device.held == 0);
    }
    return NULL;
}

/* Every world has the bits and the reports that it has alone, with one thread
 * of the host and with several; the same source in binary32 decides for one. */
const char *test_together_bits(void)
{
    static drape_step_report alone[WORLDS][STEPS];
    uint64_t hash[WORLDS];
    static const int some[] = {0, 3, 1};
    for (int k = 0; k < (REAL_BITS == 64 ? 2 : 3); k++) {
        const char *failed = run(some[k], alone, hash);
        if (failed)
            return failed;
        ran(1);
    }
    EXPECT(alone[0][STEPS - 1].contacts > 0 && hash[0] != hash[1]);
    return NULL;
}

/* A world whose memory ends stops, and the others go on; with more memory it
 * goes on, too, and has the bits that it has alone. */
const char *test_together_short(void)
{
    enum { N = 4, SHORT = 1 };
    static struct guest s[N], t;
    drape_world *world[N], *one;
    drape_step_report r[N][STEPS];
    int status[N];
    for (int k = 0; k < N; k++)
        EXPECT(make(k, &s[k], &world[k]) == DRAPE_OK);
    s[SHORT].device.most = s[SHORT].device.calls + 2;
    EXPECT(drape_step_many(world, N, STEPS, 2, r[0], status) == DRAPE_ENOMEM);
    for (int k = 0; k < N; k++) {
        EXPECT(status[k] == (k == SHORT ? DRAPE_ENOMEM : DRAPE_OK));
        EXPECT((r[k][STEPS - 1].step == STEPS) == (k != SHORT));
    }
    int made = 0;
    while (made < STEPS && r[SHORT][made].step)
        made++;
    s[SHORT].device.most = INT64_MAX;
    EXPECT(drape_step_many(&world[SHORT], 1, STEPS - made, 0, NULL, NULL) ==
           DRAPE_OK);
    EXPECT(make(SHORT, &t, &one) == DRAPE_OK);
    EXPECT(drape_step_many(&one, 1, STEPS, 1, NULL, NULL) == DRAPE_OK);
    EXPECT(scene_hash(one) == scene_hash(world[SHORT]));
    drape_destroy(one);
    for (int k = 0; k < N; k++)
        drape_destroy(world[k]);
    ran(1);
    return NULL;
}

/* What is refused, and lists without worlds or steps. */
const char *test_together_refuses(void)
{
    static struct guest s[2];
    drape_world *world[3];
    for (int k = 0; k < 2; k++)
        EXPECT(make(k, &s[k], &world[k]) == DRAPE_OK);
    world[2] = world[0];
    uint64_t hash = scene_hash(world[0]);
    EXPECT(drape_step_many(world, 3, 1, 1, NULL, NULL) == DRAPE_EARG);
    EXPECT(drape_step_many(world, -1, 1, 1, NULL, NULL) == DRAPE_EARG);
    EXPECT(drape_step_many(world, 2, -1, 1, NULL, NULL) == DRAPE_EARG);
    EXPECT(drape_step_many(world, 2, 1, -1, NULL, NULL) == DRAPE_EARG);
    EXPECT(drape_step_many(NULL, 1, 1, 1, NULL, NULL) == DRAPE_EARG);
    EXPECT(drape_step_many(NULL, 0, 1, 1, NULL, NULL) == DRAPE_OK);
    EXPECT(drape_step_many(world, 2, 0, 0, NULL, NULL) == DRAPE_OK);
    EXPECT(hash == scene_hash(world[0]));
    world[2] = NULL;
    EXPECT(drape_step_many(world, 3, 1, 1, NULL, NULL) == DRAPE_EARG);
    EXPECT(drape_step_many(world, 2, 1, 0, NULL, NULL) == DRAPE_OK);
    EXPECT(hash != scene_hash(world[0]));
    drape_destroy(world[0]);
    drape_destroy(world[1]);
    ran(1);
    return NULL;
}
