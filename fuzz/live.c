/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes live control: the calls that change a world between two steps, its log
 * and its list of contacts. */
#include <math.h>
#include <stdlib.h>

#include "fuzz/play.h"

void play_short(struct play *p)
{
    struct bank *bank = pick(&p->b, 2) ? &p->s.device : &p->s.host;
    if (p->world[1] || pick(&p->b, 8) != 7)
        return;
    bank->from = bank->calls + pick(&p->b, 12);
    bank->times = pick(&p->b, 2) ? 1 : INT64_MAX;
}

const char *play_judge(struct play *p, const int status[2], bool wrong)
{
    p->s.host.from = p->s.device.from = INT64_MAX;
    EXPECT(!p->world[1] || status[0] == status[1]);
    EXPECT(!wrong || status[0] != DRAPE_OK);
    if (status[0] != DRAPE_OK)
        return play_unchanged(p);
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
    const char *failed = play_judge(p, status, wrong);
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
    play_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_set_material(p->world[k], cloth, &m);
    const char *failed = play_judge(p, status, wrong);
    for (int k = 0; k < 2 && p->world[k] && status[k] == DRAPE_OK; k++) {
        drape_material now;
        EXPECT(drape_read_material(p->world[k], cloth, &now) == DRAPE_OK);
        EXPECT(!memcmp(&now, &m, sizeof now));
    }
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

/* Vectors in the world's precision, as the forms `_device` read them: an
 * emulated device's memory is the host's. For those that the caller frees. */
static void *there(const struct play *p, const double (*x)[3], int64_t n)
{
    bool single = p->s.def.precision == 32;
    size_t numbers = 3 * (size_t)n;
    void *copy = malloc((numbers + 1) * sizeof(double));
    if (!copy)
        abort();
    for (size_t k = 0; k < numbers; k++)
        if (single)
            ((float *)copy)[k] = (float)x[k / 3][k % 3];
        else
            ((double *)copy)[k] = x[k / 3][k % 3];
    return copy;
}

/* near: x is [n] of binary64; else `far` is it as there() has made it. */
static int set_state(drape_world *world, bool velocities, const int64_t at[2],
                     const double (*near)[3], const void *far)
{
    drape_error error = {""};
    if (velocities)
        return near ? drape_set_velocities(world, at[0], at[1], near)
                    : drape_set_velocities_device(world, at[0], at[1], far);
    int status =
        near ? drape_set_positions(world, at[0], at[1], near, &error)
             : drape_set_positions_device(world, at[0], at[1], far, &error);
    return status == DRAPE_ESTART && !error.text[0] ? 1 : status;
}

/* Moves some vertices of cloth by a little, or by anything. device: by the form
 * of this name. */
static const char *set(struct play *p, bool velocities, bool device)
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
        if (device && p->s.def.precision == 32)
            any = (float)any; /* the form's own numbers */
        far = !(fabs(any) <= 0x1p60);
    }
    int status[2] = {0, 0};
    const double(*is)[3] = (const double(*)[3])x;
    void *copy = there(p, is + from, n);
    play_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = set_state(p->world[k], velocities, at,
                              device ? NULL : is + from, copy);
    free(x);
    const char *failed = play_judge(p, status, out || far);
    free(copy);
    EXPECT(status[0] <= DRAPE_OK);
    return failed;
}

const char *play_positions(struct play *p)
{
    return set(p, false, false);
}

const char *play_positions_device(struct play *p)
{
    return set(p, false, true);
}

const char *play_velocities(struct play *p)
{
    return set(p, true, false);
}

const char *play_velocities_device(struct play *p)
{
    return set(p, true, true);
}

static const char *set_pins(struct play *p, bool device)
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
    const double(*to)[3] = told ? (const double(*)[3])at : NULL;
    void *copy = there(p, (const double(*)[3])at, n);
    play_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = device ? drape_set_pins_device(p->world[k], cloth, n, list,
                                                   told ? copy : NULL)
                           : drape_set_pins(p->world[k], cloth, n, list, to);
    p->s.prescribed = p->s.prescribed || status[0] == DRAPE_OK;
    const char *failed = play_judge(p, status, out);
    free(copy);
    return failed;
}

const char *play_pins(struct play *p)
{
    return set_pins(p, false);
}

const char *play_pins_device(struct play *p)
{
    return set_pins(p, true);
}

static const char *set_obstacle(struct play *p, bool device)
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
    void *copy = there(p, to + first, end - first);
    play_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = pose ? drape_set_pose(p->world[k], which, shift,
                                          turned ? turn : NULL, NULL)
                    : device
                        ? drape_set_obstacle_device(p->world[k], which, copy)
                        : drape_set_obstacle(p->world[k], which, to + first);
    free(x);
    p->s.prescribed = p->s.prescribed || status[0] == DRAPE_OK;
    const char *failed = play_judge(p, status, out);
    free(copy);
    return failed;
}

const char *play_obstacle(struct play *p)
{
    return set_obstacle(p, false);
}

const char *play_obstacle_device(struct play *p)
{
    return set_obstacle(p, true);
}

static const char *list(struct play *p, bool device)
{
    drape_contact_list l[2] = {{0}, {0}};
    int status[2] = {0, 0};
    int64_t nv = drape_vertices(p->world[0]);
    int bodies = p->s.def.n_cloths + p->s.def.n_obstacles;
    play_short(p);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = device ? drape_contacts_device(p->world[k], &l[k])
                           : drape_contacts(p->world[k], &l[k]);
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
    return play_unchanged(p);
}

const char *play_contacts(struct play *p)
{
    return list(p, false);
}

/* What two worlds say of a seam is the same, whatever triangles are sewn. */
static const char *look_at_seam(struct play *p, int seam)
{
    double gap[2][SMALL_SIDE][3], pull[2][SMALL_SIDE][3];
    int64_t nt = drape_triangles(p->world[0]);
    uint32_t most = (uint32_t)nt + 1;
    int64_t a = (int64_t)pick(&p->b, most), b = (int64_t)pick(&p->b, most);
    bool out = seam < 0 || seam >= p->s.def.n_seams;
    memset(gap, 0, sizeof gap);
    memset(pull, 0, sizeof pull);
    for (int k = 0; k < 2 && p->world[k]; k++) {
        int status = drape_seam_state(p->world[k], seam, gap[k], pull[k]);
        EXPECT(status == (out ? DRAPE_EARG : DRAPE_OK));
        int sewn = drape_are_sewn(p->world[k], a, b);
        EXPECT(a < nt && b < nt
                   ? sewn == drape_are_sewn(p->world[k], b, a) && sewn >= 0
                   : sewn == DRAPE_EARG);
        EXPECT(p->s.def.n_seams || sewn <= 0);
    }
    EXPECT(!p->world[1] || (!memcmp(gap[0], gap[1], sizeof gap[0]) &&
                            !memcmp(pull[0], pull[1], sizeof pull[0])));
    return NULL;
}

const char *play_seam(struct play *p)
{
    int seam = pick(&p->b, 8) < 7 ? 0 : draw_int(&p->b);
    int status[2] = {0, 0};
    double gap[SMALL_SIDE][3];
    bool out = seam < 0 || seam >= p->s.def.n_seams, given = pick(&p->b, 4);
    bool any = pick(&p->b, 8) == 7, huge = false;
    for (int k = 0; k < 3 * SMALL_SIDE; k++)
        gap[k / 3][k % 3] = draw_in(&p->b, -0.02, 0.02);
    if (any)
        gap[0][1] = draw_any(&p->b);
    huge = given && any && !(fabs(gap[0][1]) <= 0x1p60);
    if (given && any && !huge && fabs(gap[0][1]) > 1)
        gap[0][1] = 0.01; /* so that steps mean something */
    const char *failed = look_at_seam(p, seam);
    for (int k = 0; k < 2 && p->world[k]; k++)
        status[k] = drape_seam_target(p->world[k], seam,
                                      given ? (const double(*)[3])gap : NULL);
    EXPECT(status[0] == DRAPE_OK || out || huge);
    return failed ? failed : play_judge(p, status, out || huge);
}

const char *play_contacts_device(struct play *p)
{
    return list(p, true);
}

/* Plays the log on a fresh world, which ends as this one. */
static const char *play_back(struct play *p)
{
    drape_world *fresh;
    int status;
    drape_def def = p->began;
    def.threads = 3 - def.threads;
    def.cloths = p->cloth;
    def.obstacles = p->obstacle;
    def.seams = &p->seam;
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
        p->began = p->s.def;
        memcpy(p->cloth, p->s.cloth, sizeof p->cloth);
        memcpy(p->obstacle, p->s.obstacle, sizeof p->obstacle);
        p->seam = p->s.seam;
        p->recording =
            drape_record(p->world[0], tape_write, &p->log) == DRAPE_OK;
        EXPECT(p->recording);
        return play_unchanged(p);
    }
    p->recording = false;
    if (drape_record(p->world[0], NULL, NULL) != DRAPE_OK)
        return NULL;
    return play_back(p);
}
