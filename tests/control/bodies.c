/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies that are added to a world and removed, through the public API, on both
 * backends. spec/control/control.md §9 */
#include "tests/control/troupe.h"

/* Of the steps of same_steps: pairs in contact. */
static int64_t contacts;

static const char *same_steps(drape_world *a, drape_world *b, int n)
{
    for (int k = 0; k < n; k++) {
        drape_step_report r, s;
        EXPECT(drape_step(a, &r) == DRAPE_OK && drape_step(b, &s) == DRAPE_OK);
        EXPECT(r.outcome == s.outcome && r.contacts == s.contacts);
        EXPECT(r.iterations == s.iterations && r.slices == s.slices);
        EXPECT(scene_hash(a) == scene_hash(b));
        contacts += r.contacts;
        ran(1);
    }
    return NULL;
}

/* A fresh world of this definition takes the checkpoint of another, and both
 * have the same checkpoints, now and some steps later. */
static const char *same_as(const struct troupe *t, drape_world *a)
{
    static struct recall ra, rb;
    drape_world *b = troupe_world(t);
    EXPECT(b && recall_save(a, &ra));
    EXPECT(recall_load(b, &ra) == DRAPE_OK);
    EXPECT(recall_save(b, &rb) && recall_same(&ra, &rb));
    const char *what = same_steps(a, b, 4);
    EXPECT(what || (recall_save(a, &ra) && recall_save(b, &rb)));
    EXPECT(what || recall_same(&ra, &rb));
    drape_destroy(b);
    return what;
}

/* §9.1, §9.2: what stays has its bits after a body was removed, and the world
 * is that of the definition without the body. */
static const char *check_removed(int integrator, int backend, int body)
{
    static double x[2][TROUPE_NV][3], v[2][TROUPE_NV][3];
    struct troupe t;
    troupe_make(&t, integrator, backend);
    drape_world *a = troupe_world(&t);
    EXPECT(a && guest_go(a, 8) == DRAPE_OK);
    drape_read(a, x[0], v[0]);
    int64_t at = drape_first_vertex(a, body), all = drape_vertices(a);
    int64_t n = drape_first_vertex(a, body + 1) - at;
    EXPECT(drape_remove(a, body) == DRAPE_OK);
    EXPECT(drape_vertices(a) == all - n);
    drape_read(a, x[1], v[1]);
    for (int64_t k = 0; k < all - n; k++) {
        int64_t was = k < at ? k : k + n;
        EXPECT(!memcmp(x[1][k], x[0][was], sizeof *x[0]));
        EXPECT(!memcmp(v[1][k], v[0][was], sizeof *v[0]));
    }
    troupe_drop(&t, body);
    const char *what = same_as(&t, a);
    drape_destroy(a);
    return what;
}

const char *test_bodies_removed(void)
{
    const char *what = NULL;
    contacts = 0;
    for (int k = 0; k < TROUPE_INTEGRATORS; k++)
        for (int body = 0; body < 4 && !what; body++) {
            what = check_removed(troupe_integrators[k], DRAPE_REF, body);
            if (!what && body == k &&
                !scene_left_out(troupe_integrators[k], DRAPE_GPU))
                what = check_removed(troupe_integrators[k], DRAPE_GPU, body);
        }
    EXPECT(what || contacts > 0);
    return what;
}

/* §9.1: bodies that are added before the first step are those of a definition;
 * later the world is one of that definition in this state. */
static const char *check_added(int integrator, int backend, int body)
{
    struct troupe t, less;
    troupe_make(&t, integrator, backend);
    t.def.n_seams = 0; /* a body brings none */
    less = t;
    troupe_drop(&less, body);
    drape_world *a = troupe_world(&less), *b = troupe_world(&t);
    EXPECT(a && b);
    int cloths = less.def.n_cloths, obstacles = less.def.n_obstacles;
    bool cloth = body == 1;
    if (cloth)
        EXPECT(drape_add_cloth(a, &t.cloth[1], NULL) == cloths);
    else
        EXPECT(drape_add_obstacle(a, &t.obstacle[1], NULL) == obstacles);
    EXPECT(drape_vertices(a) == drape_vertices(b));
    const char *what = same_steps(a, b, 4);
    drape_destroy(a);
    drape_destroy(b);
    a = troupe_world(&less);
    EXPECT(what || (a && guest_go(a, 8) == DRAPE_OK));
    if (cloth)
        EXPECT(what || drape_add_cloth(a, &t.cloth[1], NULL) == cloths);
    else
        EXPECT(what ||
               drape_add_obstacle(a, &t.obstacle[1], NULL) == obstacles);
    what = what ? what : same_as(&t, a);
    drape_destroy(a);
    return what;
}

/* control.md §7: a log in which a panel is added ends as the world that it is
 * of, on the other backend. */
static const char *check_logged(int backend)
{
    static struct recall log, now, again;
    struct troupe t, less;
    troupe_make(&t, DRAPE_CK, backend);
    less = t;
    troupe_drop(&less, 1);
    drape_world *a = troupe_world(&less);
    less.def.backend = !backend;
    drape_world *b = troupe_world(&less);
    EXPECT(a && b && t.cloth[1].panel);
    log.size = log.at = 0;
    EXPECT(drape_record(a, recall_write, &log) == DRAPE_OK);
    EXPECT(guest_go(a, 2) == DRAPE_OK);
    EXPECT(drape_add_cloth(a, &t.cloth[1], NULL) == 1);
    EXPECT(guest_go(a, 2) == DRAPE_OK);
    EXPECT(drape_record(a, NULL, NULL) == DRAPE_OK);
    int status;
    while ((status = drape_replay(b, recall_read, &log, NULL)) == 1)
        continue;
    EXPECT(status == 0 && recall_save(a, &now) && recall_save(b, &again));
    EXPECT(recall_same(&now, &again));
    drape_destroy(a);
    drape_destroy(b);
    ran(1);
    return NULL;
}

const char *test_bodies_added(void)
{
    const char *what = check_logged(DRAPE_REF);
    what = what ? what : check_logged(DRAPE_GPU);
    contacts = 0;
    for (int k = 0; k < TROUPE_INTEGRATORS; k++)
        for (int body = 1; body < 4 && !what; body += 2) {
            what = check_added(troupe_integrators[k], DRAPE_REF, body);
            if (!what && body / 2 == k % 2 &&
                !scene_left_out(troupe_integrators[k], DRAPE_GPU))
                what = check_added(troupe_integrators[k], DRAPE_GPU, body);
        }
    EXPECT(what || contacts > 0);
    return what;
}

/* Changes everything that live control can, so that it must be handed over. */
static const char *change_all(const struct troupe *t, drape_world *a)
{
    static double x[TROUPE_NV][3];
    const double g[3] = {0.5, -9, 0}, up[3] = {0, 0.001, 0};
    const int32_t pins[2] = {3, 0};
    drape_material m = t->cloth[0].material;
    m.stretch = 800;
    drape_wind wind = t->def.wind;
    wind.velocity[0] = 0.7;
    EXPECT(drape_read(a, x, NULL) == DRAPE_OK);
    const double to[2][3] = {{x[3][0], x[3][1] + 0.001, x[3][2]},
                             {x[0][0] + 0.001, x[0][1], x[0][2]}};
    EXPECT(drape_set_gravity(a, g) == DRAPE_OK);
    EXPECT(drape_set_material(a, 0, &m) == DRAPE_OK);
    EXPECT(drape_set_wind(a, &wind) == DRAPE_OK);
    EXPECT(drape_set_pins(a, 0, 2, pins, to) == DRAPE_OK);
    EXPECT(drape_set_pose(a, 0, up, NULL, NULL) == DRAPE_OK);
    return NULL;
}

/* A body that is added and removed again leaves no trace. */
static const char *check_both(int integrator, int backend, bool changes)
{
    static struct recall before, after;
    struct troupe t, less;
    troupe_make(&t, integrator, backend);
    less = t;
    troupe_drop(&less, 3);
    troupe_drop(&less, 1);
    drape_world *a = troupe_world(&less);
    EXPECT(a && guest_go(a, 8) == DRAPE_OK);
    const char *what = changes ? change_all(&less, a) : NULL;
    EXPECT(what || guest_go(a, 3) == DRAPE_OK);
    if (changes && !what)
        what = change_all(&less, a);
    drape_wake(a);
    EXPECT(what || recall_save(a, &before));
    EXPECT(what || drape_add_cloth(a, &t.cloth[1], NULL) == 1);
    EXPECT(what || drape_add_obstacle(a, &t.obstacle[1], NULL) == 1);
    EXPECT(what || drape_remove(a, 1) == DRAPE_OK);
    EXPECT(what || drape_remove(a, 2) == DRAPE_OK);
    EXPECT(what || recall_save(a, &after));
    EXPECT(what || recall_same(&before, &after));
    what = what ? what : same_as(&less, a);
    drape_destroy(a);
    return what;
}

/* The same where a seam pulls and has a target; and where one cloth of it goes,
 * the seam goes, too. */
static const char *check_sewn(int backend)
{
    static struct recall before, after;
    double gap[3][3], pull[3][3];
    struct troupe t;
    troupe_make(&t, DRAPE_BDF2, backend);
    drape_world *a = troupe_world(&t);
    EXPECT(a && guest_go(a, 4) == DRAPE_OK);
    EXPECT(drape_seam_state(a, 0, gap, pull) == DRAPE_OK);
    EXPECT(fabs(pull[0][1]) > 0);
    gap[0][1] *= 0.5;
    EXPECT(drape_seam_target(a, 0, (const double(*)[3])gap) == DRAPE_OK);
    EXPECT(recall_save(a, &before));
    EXPECT(drape_add_cloth(a, &t.cloth[0], NULL) == DRAPE_ESTART);
    EXPECT(drape_remove(a, 3) == DRAPE_OK);
    EXPECT(drape_add_obstacle(a, &t.obstacle[1], NULL) == 1);
    EXPECT(recall_save(a, &after) && recall_same(&before, &after));
    EXPECT(drape_remove(a, 0) == DRAPE_OK);
    EXPECT(drape_seam_state(a, 0, gap, pull) == DRAPE_EARG);
    EXPECT(guest_go(a, 2) == DRAPE_OK);
    drape_destroy(a);
    ran(1);
    return NULL;
}

const char *test_bodies_both(void)
{
    const char *what = check_sewn(DRAPE_REF);
    what = what ? what : check_sewn(DRAPE_GPU);
    for (int k = 0; k < TROUPE_INTEGRATORS && !what; k++) {
        what = check_both(troupe_integrators[k], DRAPE_REF, false);
        what = what ? what : check_both(troupe_integrators[k], k % 2, true);
    }
    return what;
}

/* §9.2: what live control has changed is handed over to the bodies that stay,
 * with the targets of the next step. */
static const char *check_changed(int integrator, int backend)
{
    struct troupe t;
    troupe_make(&t, integrator, backend);
    drape_world *a = troupe_world(&t);
    EXPECT(a && guest_go(a, 5) == DRAPE_OK);
    const char *what = change_all(&t, a);
    EXPECT(what || drape_remove(a, 3) == DRAPE_OK);
    EXPECT(what || drape_remove(a, 1) == DRAPE_OK);
    troupe_drop(&t, 3);
    troupe_drop(&t, 1);
    what = what ? what : same_as(&t, a);
    EXPECT(what ||
           drape_remove(a, 1) == DRAPE_OK); /* the body that is prescribed */
    troupe_drop(&t, 1);
    what = what ? what : same_as(&t, a);
    drape_destroy(a);
    return what;
}

const char *test_bodies_changed(void)
{
    const char *what = NULL;
    for (int k = 0; k < TROUPE_INTEGRATORS && !what; k++)
        what = check_changed(troupe_integrators[k], !(k % 2));
    return what;
}

/* Where nothing meets anything each cloth moves by itself (lagrange.md §1), and
 * goes on with the same bits as if the others had never been there. Where
 * others meet something one solve takes all cloths together, so that this holds
 * no more. */
const char *test_bodies_alone(void)
{
    static double x[2][TROUPE_NV][3];
    for (int backend = 0; backend < 2; backend++) {
        struct troupe t, one;
        troupe_make(&t, DRAPE_BDF2, backend);
        t.def.n_seams = 0;
        t.cloth[0].origin[1] = 4;
        t.cloth[1].origin[1] = 6;
        t.cloth[1].x = NULL;
        one = t;
        for (int body = 3; body > 0; body--)
            troupe_drop(&one, body);
        drape_world *a = troupe_world(&t), *b = troupe_world(&one);
        EXPECT(a && b && guest_go(a, 5) == DRAPE_OK);
        EXPECT(guest_go(b, 5) == DRAPE_OK);
        for (int body = 3; body > 0; body--) {
            EXPECT(drape_remove(a, body) == DRAPE_OK);
            EXPECT(guest_go(a, 2) == DRAPE_OK && guest_go(b, 2) == DRAPE_OK);
            EXPECT(drape_read(a, x[0], NULL) == DRAPE_OK);
            EXPECT(drape_read(b, x[1], NULL) == DRAPE_OK);
            EXPECT(!memcmp(x[0], x[1], TROUPE_COUNT * sizeof *x[0]));
            ran(1);
        }
        drape_destroy(a);
        drape_destroy(b);
    }
    return NULL;
}

/* §9.3: an obstacle that moves is where it would be had it always been there.
 */
static const char *check_moving(int backend, bool frames)
{
    static double x[2][TROUPE_NV][3];
    struct troupe t, less;
    troupe_make(&t, DRAPE_BW, backend);
    troupe_move(&t, 1, frames);
    less = t;
    troupe_drop(&less, 3);
    drape_world *a = troupe_world(&less), *b = troupe_world(&t);
    EXPECT(a && b && guest_go(a, 3) == DRAPE_OK && guest_go(b, 3) == DRAPE_OK);
    EXPECT(drape_add_obstacle(a, &t.obstacle[1], NULL) == 1);
    for (int k = 0; k < 3; k++) {
        int64_t at = drape_first_vertex(a, 3), n = drape_vertices(a) - at;
        EXPECT(drape_read(a, x[0], NULL) == DRAPE_OK);
        EXPECT(drape_read(b, x[1], NULL) == DRAPE_OK);
        EXPECT(!memcmp(x[0][at], x[1][at], (size_t)n * sizeof *x[0]));
        EXPECT(memcmp(x[0][at], t.obstacle[1].x, sizeof *x[0]));
        EXPECT(guest_go(a, 1) == DRAPE_OK && guest_go(b, 1) == DRAPE_OK);
        ran(1);
    }
    const char *what = same_as(&t, a);
    drape_destroy(a);
    drape_destroy(b);
    return what;
}

const char *test_bodies_moving(void)
{
    const char *what = NULL;
    for (int k = 0; k < 4 && !what; k++)
        what = check_moving(k % 2, k / 2);
    return what;
}

/* §9.3: pins with a motion, which a new cloth brings. */
const char *test_bodies_pinned(void)
{
    const char *what = NULL;
    for (int backend = 0; backend < 2 && !what; backend++) {
        struct troupe t, less;
        troupe_make(&t, DRAPE_CK, backend);
        troupe_move(&t, 1, false);
        const drape_pin pins[3] = {{0, 0, 0}, {3, 2, -1}, {0, 0, -1}};
        t.cloth[1].pins = pins;
        t.cloth[1].n_pins = 3;
        less = t;
        troupe_drop(&less, 1);
        drape_world *a = troupe_world(&less);
        EXPECT(a && guest_go(a, 3) == DRAPE_OK);
        EXPECT(drape_add_cloth(a, &t.cloth[1], NULL) == 1);
        EXPECT(guest_go(a, 2) == DRAPE_OK);
        what = same_as(&t, a);
        EXPECT(what || drape_remove(a, 0) == DRAPE_OK);
        troupe_drop(&t, 0);
        what = what ? what : same_as(&t, a);
        drape_destroy(a);
    }
    return what;
}
