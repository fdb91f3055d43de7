/* SPDX-License-Identifier: Apache-2.0 */
/* Definitions of seams that are refused, and worlds with seams that stop, go on
 * from a checkpoint, are replayed, and run on both backends.
 * spec/seam/seam.md */
#include "tests/base/choices.h"
#include "tests/seam/sewn.h"
#include "tests/world/recall.h"
#include "tests/world/scene.h"

#include <stdio.h>
#include <stdlib.h>

static const int side[2] = {9, 12};
static const double size[2] = {0.2, 0.4};

/* Whether the definition is refused, with this text in the error. */
static bool is_refused(const struct sewn *s, const char *text)
{
    drape_world *world = NULL;
    drape_error error;
    int status = drape_create(&s->def, &world, &error);
    drape_destroy(world);
    return status == DRAPE_EARG && !world && strstr(error.text, text);
}

/* §1 */
const char *test_seam_refused(void)
{
    static struct sewn s;
    static uint8_t hole[4 * SEWN_SIDE * SEWN_SIDE];
#define REFUSES(change, text)                                                  \
    do {                                                                       \
        sewn_make(&s, side, size, false, 0);                                   \
        change;                                                                \
        EXPECT(is_refused(&s, text));                                          \
    } while (0)
    REFUSES(s.def.integrator = DRAPE_RK4, "seams need an implicit");
    REFUSES(s.def.response = DRAPE_IMPULSES, "seams need contacts");
    REFUSES(s.def.n_seams = -1, "n_seams is -1");
    REFUSES(s.def.seams = NULL, "seams is NULL");
    REFUSES(s.seam.n = 0, "seam 0: n is 0");
    REFUSES(s.seam.n = 1 << 20, "seam 0: n is");
    REFUSES(s.seam.cloth[0] = 2, "seam 0: cloth[0] is 2");
    REFUSES(s.seam.cloth[1] = -1, "seam 0: cloth[1] is -1");
    REFUSES(s.seam.particle = NULL, "seam 0: particle is NULL");
    REFUSES(s.seam.onto = NULL, "seam 0: onto is NULL");
    REFUSES(s.seam.part = NULL, "seam 0: part is NULL");
    REFUSES(s.particle[3] = -1, "seam 0: point 3 has particle -1");
    REFUSES(s.onto[2][1] = 1 << 20, "seam 0: point 2 is onto");
    REFUSES(s.part[1] = 1.5, "seam 0: point 1 has part 1.5");
    REFUSES(s.particle[3] = s.particle[2], "seam 0: point 3: particle");
    REFUSES(s.seam.cloth[1] = s.seam.cloth[0];
            s.onto[5][1] = s.particle[5], "seam 0: point 5 holds");
    REFUSES(hole[s.particle[0] + 4] = 1;
            s.cloth[s.seam.cloth[0]].hole = hole, "seam 0: point 4: particle");
#undef REFUSES
    drape_world *world;
    drape_error error;
    double gap[SEWN_SIDE][3] = {{0}};
    sewn_make(&s, side, size, false, 0);
    s.part[1] = (double)NAN;
    EXPECT(drape_create(&s.def, &world, &error) == DRAPE_EDATA);
    sewn_make(&s, side, size, false, 0);
    EXPECT(drape_create(&s.def, &world, &error) == DRAPE_OK);
    EXPECT(drape_seam_target(NULL, 0, NULL) == DRAPE_EARG);
    EXPECT(drape_seam_target(world, 1, NULL) == DRAPE_EARG);
    EXPECT(drape_seam_state(world, -1, NULL, NULL) == DRAPE_EARG);
    gap[3][1] = (double)INFINITY;
    EXPECT(drape_seam_target(world, 0, (const double(*)[3])gap) == DRAPE_EDATA);
    EXPECT(drape_are_sewn(world, -1, 0) == DRAPE_EARG);
    EXPECT(drape_are_sewn(world, 0, drape_triangles(world)) == DRAPE_EARG);
    drape_destroy(world);
    ran(1);
    return NULL;
}

/* §5, where both edges have the same particles: triangles are sewn together
 * that have particles of the seam at most two apart. */
const char *test_seam_joins(void)
{
    enum { M = 9 };
    static const int same[2] = {M, M};
    static struct sewn s;
    static int32_t tri[4 * M * M][3];
    drape_world *world;
    int64_t joined = 0;
    sewn_make(&s, same, size, false, 0);
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    EXPECT(drape_read_triangles(world, tri) == DRAPE_OK);
    int64_t nt = drape_triangles(world);
    int first = M * (s.cloth[0].n - 1);
    for (int64_t a = 0; a < nt; a++)
        for (int64_t b = 0; b < nt; b++) {
            bool near = false;
            for (int k = 0; k < 9; k++) {
                int i = tri[a][k / 3] - first, j = tri[b][k % 3] - first;
                bool both = i >= 0 && i < 2 * M && j >= 0 && j < 2 * M;
                near |= both && i != j && abs(i % M - j % M) <= 2;
            }
            EXPECT(drape_are_sewn(world, a, b) == near);
            joined += near;
        }
    EXPECT(joined > 100);
    drape_destroy(world);
    ran(joined);
    return NULL;
}

/* The calls before step k: the gap is halved, and closed at last; the material
 * is another one, of which κ follows. */
static int call(drape_world *world, const struct sewn *s, int k)
{
    double gap[SEWN_SIDE][3];
    int status = DRAPE_OK;
    drape_material softer = s->cloth[1].material;
    softer.stretch *= 0.7;
    if (k == 6)
        return drape_set_material(world, 1, &softer);
    if (k % 3 == 0 || k > 10)
        return status;
    status = drape_seam_state(world, 0, gap, NULL);
    for (int64_t i = 0; i < s->seam.n; i++)
        for (int a = 0; a < 3; a++)
            gap[i][a] /= 2;
    return status == DRAPE_OK
               ? drape_seam_target(world, 0,
                                   k < 10 ? (const double(*)[3])gap : NULL)
               : status;
}

static void set_scene(struct sewn *s, int how)
{
    sewn_make(s, side, size, false, 0.02);
    s->def.integrator = how;
    sewn_add_ball(s, 0.1);
    for (int c = 0; c < 2; c++) {
        s->cloth[c].material.bend = 1e-4; /* does not crumple on the ball */
        s->cloth[c].origin[0] -= 0.1;
        s->cloth[c].origin[1] = 0.104;
        s->cloth[c].origin[2] += 0.19;
    }
}

/* A world that stops before each step and goes on from its checkpoint, and one
 * that repeats its log, have the bits of one that never stops. */
const char *test_seam_resumed(void)
{
    static struct sewn s;
    static struct recall now, other, log;
    for (int how = DRAPE_BW; how <= DRAPE_BDF2; how++) {
        drape_world *on, *to[2], *again;
        drape_step_report r[2];
        set_scene(&s, how);
        EXPECT(drape_create(&s.def, &on, NULL) == DRAPE_OK &&
               drape_create(&s.def, &again, NULL) == DRAPE_OK);
        for (int k = 0; k < 2; k++)
            EXPECT(drape_create(&s.def, &to[k], NULL) == DRAPE_OK);
        log.size = log.at = 0;
        EXPECT(drape_record(on, recall_write, &log) == DRAPE_OK);
        for (int k = 0; k < 20; k++) {
            drape_world *from = to[k % 2], *next = to[!(k % 2)];
            EXPECT(call(on, &s, k) == DRAPE_OK &&
                   call(from, &s, k) == DRAPE_OK);
            EXPECT(recall_save(from, &now) && !recall_load(next, &now));
            memset(r, 0, sizeof r);
            EXPECT(drape_step(on, &r[0]) == DRAPE_OK &&
                   drape_step(next, &r[1]) == DRAPE_OK);
            memset(r[0].seconds, 0, sizeof r[0].seconds);
            memset(r[1].seconds, 0, sizeof r[1].seconds);
            EXPECT(!memcmp(&r[0], &r[1], sizeof r[0]));
            EXPECT(recall_save(on, &now) && recall_save(next, &other));
            EXPECT(recall_same(&now, &other));
        }
        EXPECT(drape_record(on, NULL, NULL) == DRAPE_OK);
        for (int k = 0; k < 20; k++)
            EXPECT(drape_replay(again, recall_read, &log, NULL) == 1);
        EXPECT(drape_replay(again, recall_read, &log, NULL) == 0);
        EXPECT(recall_save(again, &other) && recall_same(&now, &other));
        EXPECT(sewn_gap(&s, on, NULL) < 1e-2);
        drape_destroy(on);
        drape_destroy(again);
        for (int k = 0; k < 2; k++)
            drape_destroy(to[k]);
        ran(1);
    }
    return NULL;
}

/* Both backends have the same bits, with targets, and the same state to read.
 */
const char *test_seam_backends(void)
{
    static struct sewn s;
    static struct recall now[2];
    for (int how = DRAPE_BW; how <= DRAPE_BDF2; how++) {
        drape_world *world[2];
        double state[2][2][SEWN_SIDE][3];
        if (scene_left_out(how, DRAPE_GPU))
            continue;
        set_scene(&s, how);
        for (int k = 0; k < 2; k++) {
            s.def.backend = k ? DRAPE_GPU : DRAPE_REF;
            EXPECT(drape_create(&s.def, &world[k], NULL) == DRAPE_OK);
        }
        memset(state, 0, sizeof state);
        for (int step = 0; step < 8; step++) {
            for (int k = 0; k < 2; k++) {
                EXPECT(call(world[k], &s, step) == DRAPE_OK);
                EXPECT(drape_step(world[k], NULL) == DRAPE_OK);
                EXPECT(recall_save(world[k], &now[k]));
                EXPECT(drape_seam_state(world[k], 0, state[k][0],
                                        state[k][1]) == DRAPE_OK);
            }
            EXPECT(recall_same(&now[0], &now[1]));
            EXPECT(!memcmp(state[0], state[1], sizeof state[0]));
        }
        for (int k = 0; k < 2; k++)
            drape_destroy(world[k]);
        ran(1);
    }
    return NULL;
}

/* Random scenes with seams have the same bits on both backends, stage by stage.
 */
const char *test_seam_device(void)
{
    int64_t all = 0;
    for (uint64_t seed = 1; seed <= 10; seed += SCENE_EVERY) {
        struct bytes b = {.seed = seed, .size = -1};
        int64_t steps = 0;
        const char *failed = scene_seams(&b, &steps);
        choices_free(&b);
        if (failed) {
            printf("seed %d\n", (int)seed);
            return failed;
        }
        all += steps;
    }
    EXPECT(all >= (SCENE_EVERY == 1 ? 18 : 6));
    ran(all);
    return NULL;
}
