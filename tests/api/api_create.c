/* SPDX-License-Identifier: Apache-2.0 */
/* drape_create refuses NULL pointers, integers at their extremes, and NaN or
 * infinite numbers, each with the status that spec/drape.h names. */
#include "tests/api/api.h"

const int api_extremes[] = {INT32_MIN, -1, INT32_MAX};
const int64_t api_wide[] = {INT64_MIN, -1, INT64_MAX};

/* A definition changed by `change` is refused with `status` and a message. */
#define REFUSES_DEF(change, status)                                            \
    do {                                                                       \
        struct input d;                                                        \
        api_input(&d);                                                         \
        change;                                                                \
        drape_error e;                                                         \
        drape_world *w = (drape_world *)(void *)&d;                            \
        EXPECT(drape_create(&d.g.def, &w, &e) == (status));                    \
        EXPECT(!w && e.text[0]);                                               \
        EXPECT(drape_create(&d.g.def, &w, NULL) == (status) && !w);            \
        ran(1);                                                                \
    } while (0)
#define REFUSES_EXTREMES(lvalue)                                               \
    do {                                                                       \
        for (int k_ = 0; k_ < EXTREMES; k_++)                                  \
            REFUSES_DEF(lvalue = api_extremes[k_], DRAPE_EARG);                \
    } while (0)
/* The codes for a number that must be above 0, or at least 0. */
#define REFUSES_NUMBER(lvalue)                                                 \
    do {                                                                       \
        REFUSES_DEF(lvalue = -1, DRAPE_EARG);                                  \
        REFUSES_DEF(lvalue = (double)NAN, DRAPE_EDATA);                        \
        REFUSES_DEF(lvalue = (double)INFINITY, DRAPE_EDATA);                   \
        REFUSES_DEF(lvalue = -0x1p61, DRAPE_EDATA);                            \
    } while (0)
/* The codes for a coordinate, which may be negative. */
#define REFUSES_COORDINATE(lvalue)                                             \
    do {                                                                       \
        REFUSES_DEF(lvalue = (double)NAN, DRAPE_EDATA);                        \
        REFUSES_DEF(lvalue = (double)-INFINITY, DRAPE_EDATA);                  \
        REFUSES_DEF(lvalue = 0x1p61, DRAPE_EDATA);                             \
    } while (0)

void api_input(struct input *d)
{
    guest_make(&d->g, DRAPE_REF);
    d->pin = (drape_pin){0, 0, 0};
    d->g.cloth.pins = &d->pin;
    d->g.cloth.n_pins = 1;
    d->time[0] = 0;
    d->time[1] = 1;
    memset(d->position, 0, sizeof d->position);
    memset(d->rotation, 0, sizeof d->rotation);
    memset(d->frame, 0, sizeof d->frame);
    d->rotation[0][0] = d->rotation[1][0] = 1;
    d->motion = (drape_motion){
        .keys = 2,
        .time = d->time,
        .position = (const double(*)[3])d->position,
        .rotation = (const double(*)[4])d->rotation,
    };
    d->g.def.motions = &d->motion;
    d->g.def.n_motions = 1;
}

static const char *refuse_scalars(void)
{
    REFUSES_EXTREMES(d.g.def.backend);
    REFUSES_EXTREMES(d.g.def.precision);
    REFUSES_EXTREMES(d.g.def.threads);
    REFUSES_EXTREMES(d.g.def.block);
    REFUSES_EXTREMES(d.g.def.integrator);
    REFUSES_EXTREMES(d.g.def.precond);
    REFUSES_EXTREMES(d.g.def.matrix);
    REFUSES_EXTREMES(d.g.def.solver);
    REFUSES_EXTREMES(d.g.def.newton);
    REFUSES_EXTREMES(d.g.def.max_rounds);
    REFUSES_EXTREMES(d.g.def.max_slices);
    REFUSES_DEF(d.g.def.max_slices = 48, DRAPE_EARG);
    REFUSES_EXTREMES(d.g.def.n_cloths);
    REFUSES_EXTREMES(d.g.def.n_obstacles);
    REFUSES_EXTREMES(d.g.def.n_motions);
    for (int k = 0; k < 2; k++) { /* INT_MAX is allowed */
        REFUSES_DEF(d.g.def.max_substeps = api_extremes[k], DRAPE_EARG);
        REFUSES_DEF(d.g.def.max_iterations = api_extremes[k], DRAPE_EARG);
    }
    REFUSES_DEF(d.g.def.cloths = NULL, DRAPE_EARG);
    REFUSES_DEF(d.g.def.obstacles = NULL, DRAPE_EARG);
    REFUSES_DEF(d.g.def.motions = NULL, DRAPE_EARG);
    REFUSES_DEF(d.g.def.allocator.allocate = NULL, DRAPE_EARG);
    REFUSES_DEF(d.g.def.allocator.release = NULL, DRAPE_EARG);
    REFUSES_DEF(d.g.def.device_allocator.allocate = NULL, DRAPE_EARG);
    REFUSES_DEF(d.g.def.device_allocator.release = NULL, DRAPE_EARG);
    REFUSES_NUMBER(d.g.def.dt);
    REFUSES_NUMBER(d.g.def.tolerance);
    REFUSES_NUMBER(d.g.def.wind.density);
    REFUSES_NUMBER(d.g.def.wind.drag);
    REFUSES_NUMBER(d.g.def.wind.lift);
    REFUSES_COORDINATE(d.g.def.wind.velocity[2]);
    REFUSES_COORDINATE(d.g.def.gravity[1]);
    return NULL;
}

static const char *refuse_cloth(void)
{
    REFUSES_EXTREMES(d.g.cloth.m);
    REFUSES_EXTREMES(d.g.cloth.n);
    REFUSES_EXTREMES(d.g.cloth.n_pins);
    REFUSES_EXTREMES(d.pin.i);
    REFUSES_EXTREMES(d.pin.j);
    REFUSES_DEF(d.pin.motion = INT32_MIN, DRAPE_EARG);
    REFUSES_DEF(d.pin.motion = INT32_MAX, DRAPE_EARG);
    REFUSES_DEF(d.g.cloth.pins = NULL, DRAPE_EARG);
    REFUSES_NUMBER(d.g.cloth.width);
    REFUSES_NUMBER(d.g.cloth.height);
    REFUSES_NUMBER(d.g.cloth.material.density);
    REFUSES_NUMBER(d.g.cloth.material.stretch);
    REFUSES_NUMBER(d.g.cloth.material.shear);
    REFUSES_NUMBER(d.g.cloth.material.bend);
    REFUSES_NUMBER(d.g.cloth.material.damping);
    REFUSES_NUMBER(d.g.cloth.material.thickness);
    REFUSES_NUMBER(d.g.cloth.material.friction);
    REFUSES_NUMBER(d.g.cloth.material.limit[0]);
    REFUSES_NUMBER(d.g.cloth.material.limit[2]);
    REFUSES_DEF(d.g.cloth.material.limit[1] = 0.009, DRAPE_EARG);
    REFUSES_DEF(d.g.cloth.material.limit[1] = 10.1, DRAPE_EARG);
    REFUSES_COORDINATE(d.g.cloth.origin[0]);
    REFUSES_COORDINATE(d.g.cloth.u[1]);
    REFUSES_COORDINATE(d.g.cloth.v[2]);
    return NULL;
}

/* Sets points 0 and 1 of a table in warp. */
static void set_table(drape_material *m, double e0, double f0, double e1,
                      double f1)
{
    const double points[][2] = {{e0, f0}, {e1, f1}};
    memcpy(m->table[DRAPE_WARP], points, sizeof points);
}

static const char *refuse_table(void)
{
#define REFUSES_TABLE(e0, f0, e1, f1, want)                                    \
    REFUSES_DEF(set_table(&d.g.cloth.material, e0, f0, e1, f1), want)
    REFUSES_TABLE(0.01, 8, 0.01, 9, DRAPE_EARG);
    REFUSES_TABLE(0.02, 8, 0.01, 9, DRAPE_EARG);
    REFUSES_TABLE(0.01, 8, 0.02, 7, DRAPE_EARG);
    REFUSES_TABLE(0.01, 8, 0.02, 8, DRAPE_EARG); /* cloth.md §9.4 */
    REFUSES_TABLE(-0.01, 8, 0.02, 9, DRAPE_EARG);
    REFUSES_TABLE(0.01, -8, 0.02, 9, DRAPE_EARG);
    REFUSES_TABLE(0.01, 0, 0.02, 9, DRAPE_EARG);
    REFUSES_TABLE(0.01, 8, 11, 1e5, DRAPE_EARG);
    REFUSES_TABLE(NAN, 8, 0, 0, DRAPE_EDATA);
    REFUSES_TABLE(0.01, INFINITY, 0, 0, DRAPE_EDATA);
    return NULL;
}

static const char *refuse_bodies(void)
{
    for (int k = 0; k < EXTREMES; k++) {
        REFUSES_DEF(d.g.plate.n_vertices = api_wide[k], DRAPE_EARG);
        REFUSES_DEF(d.g.plate.n_triangles = api_wide[k], DRAPE_EARG);
        REFUSES_DEF(d.g.plate.n_vertices = api_extremes[k], DRAPE_EARG);
        REFUSES_DEF(d.g.plate.n_triangles = api_extremes[k], DRAPE_EARG);
    }
    REFUSES_EXTREMES(d.g.plate.frames);
    REFUSES_DEF(d.g.plate.motion = INT32_MIN, DRAPE_EARG);
    REFUSES_DEF(d.g.plate.motion = INT32_MAX, DRAPE_EARG);
    REFUSES_DEF(d.g.plate.x = NULL, DRAPE_EARG);
    REFUSES_DEF(d.g.plate.tri = NULL, DRAPE_EARG);
    REFUSES_DEF((d.g.plate.frames = 2, d.g.plate.frame_dt = 1), DRAPE_EARG);
    REFUSES_DEF(
        (d.g.plate.frames = 2, d.g.plate.frame = (const double(*)[3])d.frame),
        DRAPE_EARG);
#define FRAMES                                                                 \
    (d.g.plate.frames = 2, d.g.plate.frame = (const double(*)[3])d.frame,      \
     d.g.plate.frame_time = d.time)
    REFUSES_DEF((FRAMES, d.g.plate.frame = NULL), DRAPE_EARG);
    REFUSES_DEF((FRAMES, d.g.plate.motion = 0), DRAPE_EARG);
    REFUSES_DEF((FRAMES, d.g.plate.between = -1), DRAPE_EARG);
    REFUSES_DEF((FRAMES, d.g.plate.between = DRAPE_CUBIC + 1), DRAPE_EARG);
    REFUSES_DEF((FRAMES, d.time[1] = d.time[0]), DRAPE_EARG);
    REFUSES_DEF((FRAMES, d.frame[7][2] = (double)NAN), DRAPE_EDATA);
    REFUSES_DEF((FRAMES, d.frame[7][2] = -0x1p61), DRAPE_EDATA);
    REFUSES_NUMBER(d.g.plate.friction);
    REFUSES_EXTREMES(d.motion.keys);
    REFUSES_DEF(d.motion.time = NULL, DRAPE_EARG);
    REFUSES_DEF(d.motion.position = NULL, DRAPE_EARG);
    REFUSES_DEF(d.time[1] = 0, DRAPE_EARG);
    REFUSES_DEF(d.rotation[1][0] = 2, DRAPE_EARG);
    REFUSES_COORDINATE(d.time[1]);
    REFUSES_COORDINATE(d.rotation[1][3]);
    REFUSES_COORDINATE(d.position[1][2]);
    REFUSES_COORDINATE(d.motion.pivot[0]);
    return NULL;
}

const char *api_call_create(struct api *a)
{
    drape_world *world = a->world;
    drape_error e;
    REFUSES(drape_create(NULL, &world, &e));
    EXPECT(!world && strstr(e.text, "def is NULL"));
    REFUSES(drape_create(NULL, &world, NULL));
    REFUSES(drape_create(&a->input.g.def, NULL, &e));
    EXPECT(strstr(e.text, "world is NULL"));
    REFUSES(drape_create(NULL, NULL, NULL));
    const char *what = refuse_scalars();
    what = what ? what : refuse_cloth();
    what = what ? what : refuse_table();
    return what ? what : refuse_bodies();
}
