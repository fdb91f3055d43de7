/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes live control: the calls that change a world between two steps, its log
 * and its list of contacts. */
#include <math.h>
#include <stdlib.h>

#include "fuzz/play.h"

static const char *unchanged(struct play *p)
{
    EXPECT(play_note(p, p->after));
    EXPECT(tape_same(&p->before[0], &p->after[0]));
    return NULL;
}

/* Makes allocations fail in one call of eight. */
static void be_short(struct play *p)
{
    struct bank *bank = pick(&p->b, 2) ? &p->s.device : &p->s.host;
    if (p->world[1] || pick(&p->b, 8) != 7)
        return;
    bank->from = bank->calls + pick(&p->b, 12);
    bank->times = pick(&p->b, 2) ? 1 : INT64_MAX;
}

/* Ends a call with the statuses of both worlds: both are the same, and a
 * refused call has changed nothing. wrong: whether it had to be refused. */
static const char *judge(struct play *p, const int status[2], bool wrong)
{
    p->s.host.from = p->s.device.from = INT64_MAX;
    EXPECT(!p->world[1] || status[0] == status[1]);
    EXPECT(!wrong || status[0] != DRAPE_OK);
    if (status[0] != DRAPE_OK)
        return unchanged(p);
    p->pairs = -1;
    EXPECT(play_note(p, p->after));
    return NULL;
}

const char *play_gravity(struct play *p)
{
    double g[3] = {0, -9.81, draw_in(&p->b, -3, 3)};
    int status[2] = {0, 0};
    if (pick(&p->b, 2))
        g[pick(&p->b, 3)] = draw_any(&p->b);
    bool wrong = false;
    for (int i = 0; i < 3; i++)
        wrong = wrong || !(fabs(g[i]) <= 0x1p60);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_set_gravity(p->world[k], g);
    EXPECT(wrong || status[0] == DRAPE_OK);
    const char *failed = judge(p, status, wrong);
    const double mild[3] = {0, -9.81, 0};
    bool huge = false;
    for (int i = 0; i < 3; i++)
        huge = huge || !(fabs(g[i]) <= 1e3);
    for (int k = 0; k < 2 && p->world[k] && huge && !failed; k++)
        drape_set_gravity(p->world[k], mild); /* so that steps mean something */
    return failed;
}

const char *play_material(struct play *p)
{
    int cloth = (int)pick(&p->b, (uint32_t)p->s.def.n_cloths);
    drape_material m = p->s.cloth[cloth].material;
    double *number[] = {&m.density,   &m.stretch,  &m.shear,    &m.bend,
                        &m.damping,   &m.friction, &m.limit[0], &m.limit[2],
                        &m.thickness, &m.shear};
    int status[2] = {0, 0};
    m.stretch *= 0.5 + 0.25 * pick(&p->b, 4);
    m.shear = m.stretch * 0.1 * pick(&p->b, 5);
    m.thickness *= 0.5 + 0.25 * pick(&p->b, 4);
    bool any = pick(&p->b, 4) == 3;
    if (any)
        *number[pick(&p->b, 8)] = draw_any(&p->b);
    bool wrong = !(m.density > 0 && m.stretch > 0 && m.bend >= 0);
    be_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_set_material(p->world[k], cloth, &m);
    const char *failed = judge(p, status, wrong);
    if (failed || status[0] != DRAPE_OK || !any)
        return failed;
    for (int k = 0; k < 2 && p->world[k]; k++)
        drape_set_material(p->world[k], cloth, &p->s.cloth[cloth].material);
    return NULL;
}

/* Takes a copy of the first world's positions or velocities. */
static double (*state_of(const struct play *p, bool velocities))[3]
{
    size_t n = (size_t)drape_vertices(p->world[0]);
    double(*x)[3] = malloc(n * sizeof *x);
    if (!x || drape_read(p->world[0], velocities ? NULL : x,
                         velocities ? x : NULL) != DRAPE_OK)
        abort();
    return x;
}

static int set_state(drape_world *world, bool velocities, const int64_t at[2],
                     const double (*x)[3])
{
    if (velocities)
        return drape_set_velocities(world, at[0], at[1], x);
    drape_error error;
    int status = drape_set_positions(world, at[0], at[1], x, &error);
    return status == DRAPE_ESTART && !error.text[0] ? 1 : status;
}

/* Moves some vertices of cloth by a little, or by anything. */
static const char *set(struct play *p, bool velocities)
{
    int64_t nc = drape_first_vertex(p->world[0], p->s.def.n_cloths);
    int64_t from = pick(&p->b, (uint32_t)nc);
    int64_t n = pick(&p->b, (uint32_t)(nc - from) + 1);
    const int64_t at[2] = {pick(&p->b, 8) == 7 ? draw_int(&p->b) : from, n};
    bool out = at[0] < 0 || at[0] > nc - n, far = false;
    double(*x)[3] = state_of(p, velocities);
    double by = 0.01 * ((int)pick(&p->b, 5) - 2);
    for (int64_t k = from; k < from + n; k++)
        x[k][1] += by;
    if (n > 0 && pick(&p->b, 8) == 7) {
        double any = draw_any(&p->b);
        x[from + pick(&p->b, (uint32_t)n)][pick(&p->b, 3)] =
            fabs(any) <= 0x1p60 ? by : any;
        far = !(fabs(any) <= 0x1p60);
    }
    int status[2] = {0, 0};
    const double(*is)[3] = (const double(*)[3])x;
    be_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = set_state(p->world[k], velocities, at, is + from);
    free(x);
    EXPECT(status[0] <= DRAPE_OK);
    return judge(p, status, out || far);
}

const char *play_positions(struct play *p)
{
    return set(p, false);
}

const char *play_velocities(struct play *p)
{
    return set(p, true);
}

const char *play_pins(struct play *p)
{
    enum { MOST = 4 };
    int cloth = (int)pick(&p->b, (uint32_t)p->s.def.n_cloths);
    int64_t first = drape_first_vertex(p->world[0], cloth);
    int64_t count = drape_first_vertex(p->world[0], cloth + 1) - first;
    int64_t n = pick(&p->b, MOST + 1);
    int32_t list[MOST];
    double at[MOST][3];
    int status[2] = {0, 0};
    double(*x)[3] = state_of(p, false);
    bool out = false;
    for (int64_t k = 0; k < n; k++) {
        list[k] = (int32_t)pick(&p->b, (uint32_t)count);
        for (int i = 0; i < 3; i++)
            at[k][i] = x[first + list[k]][i] + 0.002 * pick(&p->b, 4);
        if (pick(&p->b, 16) == 15)
            list[k] = draw_int(&p->b);
        out = out || list[k] < 0 || list[k] >= count;
    }
    free(x);
    bool told = pick(&p->b, 4) > 0;
    be_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_set_pins(p->world[k], cloth, n, list,
                                   told ? (const double(*)[3])at : NULL);
    p->s.led = p->s.led || status[0] == DRAPE_OK;
    return judge(p, status, out);
}

const char *play_obstacle(struct play *p)
{
    int n = p->s.def.n_obstacles;
    int which = n && pick(&p->b, 8) < 7 ? (int)pick(&p->b, (uint32_t)n)
                                        : draw_int(&p->b);
    bool out = which < 0 || which >= n, pose = pick(&p->b, 3) == 2;
    int status[2] = {0, 0};
    double(*x)[3] = state_of(p, false);
    int body = p->s.def.n_cloths + (out ? 0 : which);
    int64_t first = drape_first_vertex(p->world[0], body);
    int64_t end = out ? first : drape_first_vertex(p->world[0], body + 1);
    double by = 0.005 * ((int)pick(&p->b, 5) - 2);
    const double shift[3] = {by, 0, by}, turn[4] = {0.6, 0, 0.8, 0};
    for (int64_t k = first; k < end; k++)
        x[k][pick(&p->b, 3)] += by;
    const double(*to)[3] = (const double(*)[3])x;
    bool turned = pick(&p->b, 2);
    be_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = pose ? drape_set_pose(p->world[k], which, shift,
                                          turned ? turn : NULL, NULL)
                         : drape_set_obstacle(p->world[k], which, to + first);
    free(x);
    p->s.led = p->s.led || status[0] == DRAPE_OK;
    return judge(p, status, out);
}

const char *play_contacts(struct play *p)
{
    drape_contact_list l[2] = {{0}, {0}};
    int status[2] = {0, 0};
    int64_t nv = drape_vertices(p->world[0]);
    int bodies = p->s.def.n_cloths + p->s.def.n_obstacles;
    be_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_contacts(p->world[k], &l[k]);
    p->s.host.from = p->s.device.from = INT64_MAX;
    EXPECT(!p->world[1] || status[0] == status[1]);
    if (status[0] == DRAPE_OK) {
        for (int64_t k = 0; k < l[0].n; k++)
            for (int j = 0; j < 4; j++)
                EXPECT(l[0].contact[k].vertex[j] >= 0 &&
                       l[0].contact[k].vertex[j] < nv &&
                       l[0].contact[k].body[j / 2] < bodies &&
                       isfinite(l[0].contact[k].impulse[j % 3]));
        for (int k = 0; k < bodies; k++)
            EXPECT(l[0].impulse && isfinite(l[0].impulse[k][1]));
    }
    if (p->world[1] && status[0] == DRAPE_OK) {
        EXPECT(l[0].n == l[1].n);
        EXPECT(l[0].n == 0 || !memcmp(l[0].contact, l[1].contact,
                                      (size_t)l[0].n * sizeof *l[0].contact));
    }
    return unchanged(p);
}

/* Plays the log on a fresh world, which ends as this one. */
static const char *play_back(struct play *p)
{
    drape_world *fresh;
    int status;
    drape_def def = p->s.def;
    def.threads = 3 - def.threads;
    p->log.at = 0;
    EXPECT(drape_create(&def, &fresh, NULL) == DRAPE_OK);
    while ((status = drape_replay(fresh, tape_read, &p->log, NULL)) == 1)
        continue;
    bool same = status == 0 && tape_save(&p->after[0], fresh) &&
                tape_same(&p->before[0], &p->after[0]);
    drape_destroy(fresh);
    EXPECT(same);
    return NULL;
}

/* Begins to record the calls, or ends that and makes them again. A log that
 * memory was too short for is not complete. */
const char *play_log(struct play *p)
{
    if (!p->recording) {
        p->log.size = 0;
        p->log.left = -1;
        p->recording =
            drape_record(p->world[0], tape_write, &p->log) == DRAPE_OK;
        EXPECT(p->recording);
        return unchanged(p);
    }
    p->recording = false;
    if (drape_record(p->world[0], NULL, NULL) != DRAPE_OK)
        return NULL;
    return play_back(p);
}
