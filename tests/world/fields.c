/* SPDX-License-Identifier: Apache-2.0 */
/* A checkpoint fits one definition only. Each word of the definition is changed
 * in turn, and the checkpoint must then be refused, except for words that do
 * not change results. Only pointers and exceptions are listed here, so a field
 * that is added to the API is tested without a change of this file. */
#include <stdio.h>

#include "tests/world/recall.h"

enum { SIDE = 4, ROOM = 64, SPARE = 3 };

/* A definition whose pointers all point to data, with one spare item in each
 * array, so that counts can grow by one. */
struct scene {
    drape_def def;
    drape_cloth cloth[SPARE];
    drape_obstacle obstacle[SPARE];
    drape_motion motion[SPARE];
    double x[ROOM][3], velocity[ROOM][3];
    uint8_t hole[ROOM], cut[ROOM];
    drape_pin pin[SPARE];
    double corner[ROOM][3], frame[ROOM][3], frame_time[ROOM];
    int32_t tri[ROOM][3];
    double time[ROOM], position[ROOM][3], rotation[ROOM][4];
    drape_seam seam[SPARE];
    int32_t particle[SPARE], onto[SPARE][2];
    double part[SPARE];
    struct recall saved; /* checkpoint of the unchanged definition */
};

static void fill_cloths(struct scene *s)
{
    for (int k = 0; k < ROOM; k++) {
        s->x[k][0] = 0.1 * (k % SIDE);
        s->x[k][1] = 1;
        s->x[k][2] = 0.1 * (k / SIDE);
        s->velocity[k][1] = 0.5;
    }
    for (int k = 0; k < SPARE; k++) {
        drape_cloth *c = &s->cloth[k];
        drape_default_cloth(c);
        c->m = c->n = SIDE;
        c->width = c->height = 0.3;
        c->origin[1] = 2 + k;
        for (int i = 0; i < 3; i++)
            c->material.limit[i] = 0.5;
        s->pin[k] = (drape_pin){1, 1 + k, 0};
    }
    for (int o = 0; o < DRAPE_TABLES; o++)
        for (int k = 0; k < DRAPE_POINTS; k++) {
            s->cloth[0].material.table[o][k][0] = 0.01 * (k + 1);
            s->cloth[0].material.table[o][k][1] = 8 * (k + 1);
        }
    s->cloth[0].x = (const double(*)[3])s->x;
    s->cloth[0].velocity = (const double(*)[3])s->velocity;
    s->cloth[0].hole = s->hole;
    s->cloth[0].cut = s->cut;
    s->cloth[0].pins = s->cloth[1].pins = s->pin;
    s->cloth[0].n_pins = 2;
    s->hole[3] = s->cut[4] = 1;
}

static void fill_motions(struct scene *s)
{
    for (int k = 0; k < ROOM; k++) {
        s->time[k] = k;
        s->rotation[k][0] = 1;
    }
    for (int k = 0; k < SPARE; k++) {
        s->motion[k].keys = 2;
        s->motion[k].time = s->time;
        s->motion[k].position = (const double(*)[3])s->position;
        s->motion[k].rotation = (const double(*)[4])s->rotation;
    }
}

static void fill_obstacles(struct scene *s)
{
    for (int k = 0; k < ROOM; k++) {
        s->frame_time[k] = k - 1;
        s->corner[k][0] = s->frame[k][0] = k & 1;
        s->corner[k][2] = s->frame[k][2] = k >> 1 & 1;
        for (int i = 0; i < 3; i++)
            s->tri[k][i] = (i + k % 2) % 4;
    }
    for (int k = 0; k < SPARE; k++) {
        drape_obstacle *o = &s->obstacle[k];
        drape_default_obstacle(o);
        o->n_vertices = 4;
        o->n_triangles = 2;
        o->x = (const double(*)[3])s->corner;
        o->tri = (const int32_t(*)[3])s->tri;
        o->frame = (const double(*)[3])s->frame;
        o->frame_dt = 0.25;
    }
    s->obstacle[0].motion = 0;
    s->obstacle[1].frames = 2;
    s->obstacle[1].between = DRAPE_CUBIC;
    s->obstacle[1].frame_time = s->frame_time;
}

/* Two points each: a row of cloth 1 on another row of it. */
static void fill_seams(struct scene *s)
{
    for (int k = 0; k < SPARE; k++) {
        s->particle[k] = SIDE * (SIDE - 1) + k;
        s->onto[k][0] = k;
        s->onto[k][1] = k + 1;
        s->part[k] = 0.25;
        s->seam[k] = (drape_seam){
            {1, 1}, 2, s->particle, (const int32_t(*)[2])s->onto, s->part, 0};
    }
    s->def.seams = s->seam;
    s->def.n_seams = 2;
}

/* Makes the definition. It allows a start that intersects, so that few changed
 * definitions are invalid. */
static void fill(struct scene *s)
{
    drape_def *d = &s->def;
    memset(s, 0, sizeof *s);
    drape_default(d);
    fill_cloths(s);
    fill_motions(s);
    fill_obstacles(s);
    fill_seams(s);
    d->precision = REAL_BITS;
    d->threads = 1;
    d->block = 256;
    d->wind = (drape_wind){
        .velocity = {1, 2, 3}, .density = 1.25, .drag = 1, .lift = 0.5};
    d->allow_intersecting = 1;
    d->cloths = s->cloth;
    d->obstacles = s->obstacle;
    d->motions = s->motion;
    d->n_cloths = d->n_obstacles = d->n_motions = 2;
}

/* Returns drape_load's status for the saved checkpoint, or 1 if the definition
 * is invalid. */
static int try_load(struct scene *s)
{
    drape_world *world;
    if (drape_create(&s->def, &world, NULL) != DRAPE_OK)
        return 1;
    int status = recall_load(world, &s->saved);
    drape_destroy(world);
    return status;
}

/* Bytes [from, to) of a struct; a list of parts ends with {0, 0}. */
struct part {
    size_t from, to;
};

#define PART(X, member)                                                        \
    {                                                                          \
        offsetof(X, member), offsetof(X, member) + sizeof(((X *)0)->member)    \
    }
#define BETWEEN(X, a, b)                                                       \
    {                                                                          \
        offsetof(X, a) + sizeof(((X *)0)->a), offsetof(X, b)                   \
    }

struct walk {
    const char *name;
    void *data;
    size_t bytes, unit;       /* unit: bytes changed at once, 4 or 1 */
    const struct part *skip;  /* pointers, which are not changed */
    const struct part *free;  /* parts that do not change results */
    const struct part *stiff; /* parts that may have one valid value only */
};

static bool within(const struct part *p, size_t at)
{
    for (; p && p->to; p++)
        if (at >= p->from && at < p->to)
            return true;
    return false;
}

/* Changes the word at `at` until the definition is valid, and restores the
 * word. Returns the status of loading, or 1 if no change is valid. */
static int change(struct scene *s, const struct walk *w, size_t at)
{
    uint8_t *p = (uint8_t *)w->data + at;
    uint32_t old = 0, now;
    int status = 1;
    memcpy(&old, p, w->unit);
    for (unsigned k = 0; k < 16 * w->unit && status == 1; k++) {
        now = old ^ (k % 2 ? 3u : 1u) << k / 2; /* 32 to 64: two bits change */
        memcpy(p, &now, w->unit);
        status = try_load(s);
    }
    memcpy(p, &old, w->unit);
    return status;
}

static const char *walk(struct scene *s, const struct walk *w)
{
    static char text[96];
    for (size_t at = 0; at < w->bytes; at += w->unit) {
        if (within(w->skip, at))
            continue;
        int want = within(w->free, at) ? DRAPE_OK : DRAPE_EMATCH;
        int status = change(s, w, at);
        ran(1);
        if (status == want || (status == 1 && within(w->stiff, at)))
            continue;
        snprintf(text, sizeof text, "%s, byte %d: %d, expected %d", w->name,
                 (int)at, status, want);
        return text;
    }
    return NULL;
}

/* Padding counts as free: a definition's fingerprint must not depend on it. */
static const struct part def_skip[] = {
    PART(drape_def, cloths),     PART(drape_def, obstacles),
    PART(drape_def, motions),    PART(drape_def, seams),
    PART(drape_def, allocator),  PART(drape_def, device_allocator),
    PART(drape_def, stream),     PART(drape_def, log),
    PART(drape_def, log_user),   PART(drape_def, trace),
    PART(drape_def, trace_user), {0, 0}};
static const struct part def_free[] = {PART(drape_def, backend),
                                       PART(drape_def, threads),
                                       PART(drape_def, block),
                                       BETWEEN(drape_def, sleep, cloths),
                                       BETWEEN(drape_def, n_cloths, obstacles),
                                       BETWEEN(drape_def, n_obstacles, motions),
                                       BETWEEN(drape_def, n_motions, seams),
                                       BETWEEN(drape_def, n_seams, allocator),
                                       {0, 0}};
/* Without a device on this machine the first two may have one valid value only.
 * Seams need one response; others are tested without them. */
static const struct part def_stiff[] = {PART(drape_def, solver),
                                        PART(drape_def, backend),
                                        PART(drape_def, response),
                                        {0, 0}};
static const struct part seam_skip[] = {PART(drape_seam, particle),
                                        PART(drape_seam, onto),
                                        PART(drape_seam, part),
                                        {0, 0}};
/* No cloth has 2^32 particles. */
static const struct part seam_stiff[] = {
    {offsetof(drape_seam, n) + 4, offsetof(drape_seam, n) + 8}, {0, 0}};
static const struct part cloth_skip[] = {PART(drape_cloth, x),
                                         PART(drape_cloth, velocity),
                                         PART(drape_cloth, hole),
                                         PART(drape_cloth, cut),
                                         PART(drape_cloth, pins),
                                         PART(drape_cloth, panel),
                                         {0, 0}};
/* Cloth 0 has whole tables, which need triples; cloth 1 has none. */
static const struct part table[] = {PART(drape_cloth, material.table), {0, 0}};
static const struct part bending[] = {PART(drape_cloth, bending), {0, 0}};
static const struct part obstacle_skip[] = {PART(drape_obstacle, x),
                                            PART(drape_obstacle, tri),
                                            PART(drape_obstacle, frame),
                                            PART(drape_obstacle, frame_time),
                                            {0, 0}};
/* Parts of an obstacle without another valid value: the upper halves of counts,
 * as a mesh of 2^32 is refused. An obstacle has a motion or frames, not both:
 * obstacle 0 tests the one, obstacle 1 the other. */
#define UPPER_HALVES                                                           \
    {offsetof(drape_obstacle, n_vertices) + 4,                                 \
     offsetof(drape_obstacle, n_vertices) + 8},                                \
    {                                                                          \
        offsetof(drape_obstacle, n_triangles) + 4,                             \
            offsetof(drape_obstacle, n_triangles) + 8                          \
    }
static const struct part obstacle_stiff[2][4] = {
    {UPPER_HALVES, PART(drape_obstacle, frames), {0, 0}},
    {UPPER_HALVES, PART(drape_obstacle, motion), {0, 0}}};
static const struct part obstacle_free[] = {
    BETWEEN(drape_obstacle, between, frame_dt), {0, 0}};
static const struct part motion_skip[] = {PART(drape_motion, time),
                                          PART(drape_motion, position),
                                          PART(drape_motion, rotation),
                                          {0, 0}};
static const struct part motion_free[] = {BETWEEN(drape_motion, keys, time),
                                          {0, 0}};

static const char *walk_structs(struct scene *s)
{
    const char *failed = NULL;
    const struct walk def = {"drape_def", &s->def,  sizeof s->def, 4,
                             def_skip,    def_free, def_stiff};
    failed = walk(s, &def);
    for (int k = 0; k < 2 && !failed; k++) {
        const struct walk all[] = {
            {"drape_cloth", &s->cloth[k], sizeof s->cloth[k], 4, cloth_skip,
             k ? table : NULL, k ? table : bending},
            {"drape_obstacle", &s->obstacle[k], sizeof s->obstacle[k], 4,
             obstacle_skip, obstacle_free, obstacle_stiff[k]},
            {"drape_motion", &s->motion[k], sizeof s->motion[k], 4, motion_skip,
             motion_free, NULL},
            {"drape_seam", &s->seam[k], sizeof s->seam[k], 4, seam_skip, NULL,
             seam_stiff}};
        for (int i = 0; i < 4 && !failed; i++)
            failed = walk(s, &all[i]);
    }
    return failed;
}

/* Changes each word of the arrays behind the pointers. */
static const char *walk_arrays(struct scene *s)
{
    const size_t n = SIDE * SIDE;
    const struct walk all[] = {
        {"x", s->x, n * sizeof *s->x, 4, NULL, NULL, NULL},
        {"velocity", s->velocity, n * sizeof *s->x, 4, NULL, NULL, NULL},
        {"hole", s->hole + 10, n - 10, 1, NULL, NULL,
         NULL}, /* the particles after the pinned ones */
        {"cut", s->cut, (SIDE - 1) * (SIDE - 1), 1, NULL, NULL, NULL},
        {"pins", s->pin, 2 * sizeof *s->pin, 4, NULL, NULL, NULL},
        {"corners", s->corner, 4 * sizeof *s->corner, 4, NULL, NULL, NULL},
        {"tri", s->tri, 2 * sizeof *s->tri, 4, NULL, NULL, NULL},
        {"frame", s->frame, 8 * sizeof *s->frame, 4, NULL, NULL, NULL},
        {"frame_time", s->frame_time, 2 * sizeof *s->frame_time, 4, NULL, NULL,
         NULL},
        {"particle", s->particle, 2 * sizeof *s->particle, 4, NULL, NULL, NULL},
        {"onto", s->onto, 2 * sizeof *s->onto, 4, NULL, NULL, NULL},
        {"part", s->part, 2 * sizeof *s->part, 4, NULL, NULL, NULL},
        {"time", s->time, 2 * sizeof *s->time, 4, NULL, NULL, NULL},
        {"position", s->position, 2 * sizeof *s->position, 4, NULL, NULL, NULL},
        {"rotation", s->rotation, 2 * sizeof *s->rotation, 4, NULL, NULL,
         NULL}};
    const char *failed = NULL;
    for (size_t k = 0; k < sizeof all / sizeof *all && !failed; k++)
        failed = walk(s, &all[k]);
    return failed;
}

/* Removes optional arrays one by one. */
static const char *drop_arrays(struct scene *s)
{
    drape_cloth cloth = s->cloth[0];
    s->cloth[0].x = NULL;
    EXPECT(try_load(s) == DRAPE_EMATCH);
    s->cloth[0] = cloth;
    s->cloth[0].velocity = NULL;
    EXPECT(try_load(s) == DRAPE_EMATCH);
    s->cloth[0] = cloth;
    s->cloth[0].hole = NULL;
    EXPECT(try_load(s) == DRAPE_EMATCH);
    s->cloth[0] = cloth;
    s->cloth[0].cut = NULL;
    EXPECT(try_load(s) == DRAPE_EMATCH);
    s->cloth[0] = cloth;
    s->motion[1].rotation = NULL;
    EXPECT(try_load(s) == DRAPE_EMATCH);
    s->motion[1].rotation = (const double(*)[4])s->rotation;
    s->obstacle[1].frame_time = NULL;
    EXPECT(try_load(s) == DRAPE_EMATCH);
    s->obstacle[1].frame_time = s->frame_time;
    EXPECT(try_load(s) == DRAPE_OK);
    return NULL;
}

/* Without seams the response may be another one. */
static const char *change_response(struct scene *s)
{
    drape_world *world;
    s->def.n_seams = 0;
    EXPECT(try_load(s) == DRAPE_EMATCH);
    EXPECT(drape_create(&s->def, &world, NULL) == DRAPE_OK);
    bool saved = recall_save(world, &s->saved);
    drape_destroy(world);
    EXPECT(saved && try_load(s) == DRAPE_OK);
    s->def.response = DRAPE_IMPULSES;
    EXPECT(try_load(s) == DRAPE_EMATCH);
    return NULL;
}

const char *test_checkpoint_fields(void)
{
    static struct scene s;
    drape_world *world;
    fill(&s);
    EXPECT(drape_create(&s.def, &world, NULL) == DRAPE_OK);
    EXPECT(recall_save(world, &s.saved));
    drape_destroy(world);
    EXPECT(try_load(&s) == DRAPE_OK);
    const char *failed = walk_structs(&s);
    failed = failed ? failed : walk_arrays(&s);
    failed = failed ? failed : drop_arrays(&s);
    return failed ? failed : change_response(&s);
}
