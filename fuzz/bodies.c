/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes the calls that add bodies to a world and remove them. The definition
 * of the play follows, so that all other calls and checks see the bodies that
 * the world has. */
#include <math.h>
#include <stdlib.h>

#include "fuzz/play.h"

/* The state of all bodies but `but`: hash of their vertices and velocities. */
static uint64_t others(const struct play *p, int but, uint64_t seed)
{
    const drape_world *w = p->world[0];
    size_t n = (size_t)drape_vertices(w);
    int64_t from = drape_first_vertex(w, but < 0 ? 0 : but);
    int64_t end = but < 0 ? from : drape_first_vertex(w, but + 1);
    double(*x)[3] = malloc(2 * n * sizeof *x);
    uint64_t hash = seed;
    if (!x || drape_read(w, x, x + n) != DRAPE_OK)
        abort();
    for (size_t k = 0; k < 2 * n; k++) {
        int64_t at = (int64_t)(k % n);
        if (at < from || at >= end)
            hash = hash_bytes(hash, x[k], sizeof x[k]);
    }
    free(x);
    return hash;
}

/* Ends a change of bodies, of which `body` was added or is gone (-1) and the
 * others had the hash `kept`: they keep their bits, the counts are those of the
 * definition, and what belonged to the old bodies is void. */
static const char *changed(struct play *p, int body, uint64_t kept)
{
    int cloths = -1;
    int bodies = p->s.def.n_cloths + p->s.def.n_obstacles;
    p->kept.size = 0;
    p->pairs = -1;
    EXPECT(drape_bodies(p->world[0], &cloths) == bodies);
    EXPECT(cloths == p->s.def.n_cloths);
    EXPECT(drape_bodies(p->world[0], NULL) == bodies);
    EXPECT(others(p, body, HASH_START) == kept);
    drape_memory m;
    EXPECT(drape_count(p->world[0], &m) == DRAPE_OK);
    EXPECT(p->world[1] || m.device_bytes == p->s.device.held);
    return small_state(&p->s, p->world[0]);
}

/* Ends a call that adds a body: as play_judge, but a call that succeeds returns
 * the number of the body. */
static const char *added(struct play *p, const int status[2], int number,
                         bool wrong, const drape_error *error)
{
    int is[2] = {status[0] >= 0 ? 0 : status[0],
                 status[1] >= 0 ? 0 : status[1]};
    EXPECT(status[0] < 0 || status[0] == number);
    EXPECT(!p->world[1] || status[0] == status[1]);
    EXPECT(status[0] >= 0 || status[0] == DRAPE_ENOMEM || error->text[0]);
    return play_judge(p, is, wrong);
}

const char *play_add_cloth(struct play *p)
{
    int n = p->s.def.n_cloths, status[2] = {0, 0};
    drape_error error = {""};
    drape_cloth c;
    if (p->s.drawn == SMALL_CLOTHS)
        return NULL;
    small_cloth(&p->s, &p->b, &c);
    uint32_t fault = pick(&p->b, 8) == 7 ? 1 + pick(&p->b, 4) : 0;
    bool wrong = fault > 0;
    if (fault == 1)
        c.m = -(int)pick(&p->b, 3);
    if (fault == 2)
        c.material.density = NAN;
    if (fault == 3)
        c.width = -c.width;
    if (fault == 4)
        c.n_pins = -1;
    uint64_t kept = others(p, -1, HASH_START);
    play_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_add_cloth(p->world[k], &c, &error);
    const char *failed = added(p, status, n, wrong, &error);
    if (failed || status[0] < 0)
        return failed;
    p->s.cloth[n] = c;
    p->s.def.n_cloths++;
    return changed(p, n, kept);
}

const char *play_add_obstacle(struct play *p)
{
    int n = p->s.def.n_obstacles, status[2] = {0, 0};
    drape_error error = {""};
    drape_obstacle o = p->s.kind[pick(&p->b, 3)];
    if (n == SMALL_OBSTACLES)
        return NULL;
    uint32_t fault = pick(&p->b, 8) == 7 ? 1 + pick(&p->b, 3) : 0;
    bool wrong = fault > 0;
    if (fault == 1)
        o.n_vertices = draw_int(&p->b) | INT32_MIN;
    if (fault == 2)
        o.friction = -1;
    if (fault == 3)
        o.motion = 1;
    uint64_t kept = others(p, -1, HASH_START);
    play_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_add_obstacle(p->world[k], &o, &error);
    const char *failed = added(p, status, n, wrong, &error);
    if (failed || status[0] < 0)
        return failed;
    p->s.obstacle[n] = o;
    p->s.def.n_obstacles++;
    return changed(p, p->s.def.n_cloths + n, kept);
}

const char *play_remove(struct play *p)
{
    int nc = p->s.def.n_cloths, no = p->s.def.n_obstacles, status[2] = {0, 0};
    bool any = pick(&p->b, 8) == 7;
    int body = any ? draw_int(&p->b) : (int)pick(&p->b, (uint32_t)(nc + no));
    bool wrong = body < 0 || body >= nc + no || (body == 0 && nc == 1);
    uint64_t kept = wrong ? 0 : others(p, body, HASH_START);
    play_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_remove(p->world[k], body);
    const char *failed = play_judge(p, status, wrong);
    if (failed || status[0] != DRAPE_OK)
        return failed;
    if (body < nc) {
        drape_seam *seam = &p->s.seam;
        if (body == seam->cloth[0] || body == seam->cloth[1])
            p->s.def.n_seams = 0;
        for (int i = 0; i < 2; i++)
            seam->cloth[i] -= seam->cloth[i] > body;
        p->s.def.n_cloths--;
        memmove(&p->s.cloth[body], &p->s.cloth[body + 1],
                (size_t)(nc - 1 - body) * sizeof *p->s.cloth);
    } else {
        p->s.def.n_obstacles--;
        memmove(&p->s.obstacle[body - nc], &p->s.obstacle[body - nc + 1],
                (size_t)(nc + no - 1 - body) * sizeof *p->s.obstacle);
    }
    return changed(p, -1, kept);
}
