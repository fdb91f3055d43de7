/* SPDX-License-Identifier: Apache-2.0 */
/* Calls every function of spec/drape.h with each pointer NULL in turn and each
 * integer at its extremes: the call returns a status, and the world is as it
 * was. */
#include "tests/api/api.h"

#include <stdio.h>

/* Calls on a world */

/* The defaults that drape.h states; all that it does not name is 0. */
static const drape_def default_def = {
    .backend = DRAPE_REF,
    .threads = 1,
    .precision = 32,
    .dt = 1.0 / 60,
    .gravity = {0, -9.81, 0},
    .wind = {.density = 0, .drag = 1, .lift = 0.3},
    .integrator = DRAPE_BW,
    .precond = DRAPE_MULTIGRID,
    .matrix = DRAPE_COMPACT,
    .tolerance = 1e-3,
    .max_iterations = 2000,
    .max_substeps = 100000,
    .self_collision = 1,
    .max_rounds = 16,
    .max_slices = 32,
    .sleep = 1};
static const drape_cloth default_cloth = {.m = 101,
                                          .n = 101,
                                          .width = 1,
                                          .height = 1,
                                          .u = {1, 0, 0},
                                          .v = {0, 0, 1},
                                          .bending = DRAPE_TRIPLES,
                                          .material = {.density = 0.2,
                                                       .stretch = 1000,
                                                       .shear = 300,
                                                       .bend = 1e-5,
                                                       .damping = 1e-3,
                                                       .thickness = 0.002,
                                                       .friction = 0.3}};
static const drape_obstacle default_obstacle = {.friction = 0.3, .motion = -1};

static const char *call_defaults(struct api *a)
{
    drape_def def;
    drape_cloth cloth;
    drape_obstacle obstacle;
    (void)a;
    drape_default(NULL);
    drape_default_cloth(NULL);
    drape_default_obstacle(NULL);
    memset(&def, 0xff, sizeof def);
    memset(&cloth, 0xff, sizeof cloth);
    memset(&obstacle, 0xff, sizeof obstacle);
    drape_default(&def);
    drape_default_cloth(&cloth);
    drape_default_obstacle(&obstacle);
    EXPECT(!memcmp(&def, &default_def, sizeof def));
    EXPECT(!memcmp(&cloth, &default_cloth, sizeof cloth));
    EXPECT(!memcmp(&obstacle, &default_obstacle, sizeof obstacle));
    ran(6);
    return NULL;
}

static const char *call_destroy(struct api *a)
{
    (void)a;
    drape_destroy(NULL);
    ran(1);
    return NULL;
}

static const char *call_step(struct api *a)
{
    drape_step_report r;
    REFUSES(drape_step(NULL, &r));
    REFUSES(drape_step(NULL, NULL));
    EXPECT(drape_step(a->world, NULL) == DRAPE_OK);
    return NULL;
}

static const char *call_step_many(struct api *a)
{
    drape_world *none = NULL, *twice[2] = {a->world, a->world};
    REFUSES(drape_step_many(&none, 1, 1, 1, NULL, NULL));
    REFUSES(drape_step_many(NULL, 1, 1, 1, NULL, NULL));
    REFUSES(drape_step_many(twice, 2, 1, 1, NULL, NULL));
    REFUSES(drape_step_many(twice, -1, 1, 1, NULL, NULL));
    REFUSES(drape_step_many(twice, 1, -1, 1, NULL, NULL));
    REFUSES(drape_step_many(twice, 1, 1, -1, NULL, NULL));
    EXPECT(drape_step_many(twice, 1, 1, 1, NULL, NULL) == DRAPE_OK);
    return NULL;
}

static const char *call_counts(struct api *a)
{
    int k;
    REFUSES(drape_vertices(NULL));
    REFUSES(drape_triangles(NULL));
    REFUSES(drape_first_vertex(NULL, 0));
    REFUSES(drape_first_triangle(NULL, 0));
    REFUSES_EACH(api_extremes, k, drape_first_vertex(a->world, k));
    REFUSES_EACH(api_extremes, k, drape_first_triangle(a->world, k));
    REFUSES(drape_first_vertex(a->world, 3));
    EXPECT(drape_first_vertex(a->world, 2) == drape_vertices(a->world));
    return NULL;
}

static const char *call_reads(struct api *a)
{
    drape_view view;
    int64_t step;
    double time;
    REFUSES(drape_read(NULL, a->x, a->x));
    EXPECT(drape_read(a->world, NULL, NULL) == DRAPE_OK);
    REFUSES(drape_read_triangles(NULL, a->tri));
    REFUSES(drape_read_triangles(a->world, NULL));
    REFUSES(drape_clock(NULL, &step, &time));
    REFUSES(drape_clock(NULL, NULL, NULL));
    EXPECT(drape_clock(a->world, NULL, NULL) == DRAPE_OK);
    REFUSES(drape_borrow(NULL, &view));
    REFUSES(drape_borrow(a->world, NULL));
    return NULL;
}

/* Wrong wind is refused with the same code as in a definition. */
static const char *call_wind(struct api *a)
{
    const drape_wind calm = {
        .velocity = {0, 0, 0}, .density = 0, .drag = 1, .lift = 1};
    drape_wind now;
    drape_wake(NULL);
    REFUSES(drape_set_wind(NULL, &calm));
    REFUSES(drape_set_wind(a->world, NULL));
    REFUSES(drape_read_wind(NULL, &now));
    REFUSES(drape_read_wind(a->world, NULL));
    for (int k = 0; k < WRONG + 1; k++) {
        drape_wind w[4] = {calm, calm, calm, calm};
        double a_number = k < WRONG ? api_wrong[k] : -1;
        w[0].velocity[k % 3] = a_number;
        w[1].density = a_number;
        w[2].drag = a_number;
        w[3].lift = a_number;
        for (int i = 0; i < 4; i++) {
            int want = k < WRONG ? DRAPE_EDATA : i ? DRAPE_EARG : DRAPE_OK;
            drape_world *world;
            struct input d;
            EXPECT(drape_set_wind(a->world, &w[i]) == want);
            api_input(&d);
            d.g.def.wind = w[i];
            EXPECT(drape_create(&d.g.def, &world, NULL) == want);
            drape_destroy(world);
            ran(1);
        }
    }
    return NULL;
}

static const char *call_plan(struct api *a)
{
    drape_plan_row row;
    drape_memory memory;
    REFUSES(drape_plan(NULL, &row, 1));
    REFUSES(drape_plan(a->world, NULL, 1));
    REFUSES(drape_plan(a->world, &row, -1));
    REFUSES(drape_plan(a->world, &row, INT32_MIN));
    EXPECT(drape_plan(a->world, NULL, 0) > 0);
    REFUSES(drape_count(NULL, &memory));
    REFUSES(drape_count(a->world, NULL));
    return NULL;
}

/* A world without seams: tests/seam/calls.c has one with them. */
static const char *call_seams(struct api *a)
{
    double gap[1][3] = {{0, 0, 0}};
    int64_t n = drape_triangles(a->world);
    REFUSES(drape_seam_target(NULL, 0, NULL));
    REFUSES(drape_seam_target(a->world, 0, (const double(*)[3])gap));
    REFUSES(drape_seam_target(a->world, -1, NULL));
    REFUSES(drape_seam_state(NULL, 0, gap, gap));
    REFUSES(drape_seam_state(a->world, 0, gap, gap));
    REFUSES(drape_are_sewn(NULL, 0, 0));
    REFUSES(drape_are_sewn(a->world, -1, 0));
    REFUSES(drape_are_sewn(a->world, 0, n));
    EXPECT(drape_are_sewn(a->world, 0, n - 1) == 0);
    return NULL;
}

int api_write_none(void *user, const void *data, size_t bytes)
{
    (void)user;
    (void)data;
    (void)bytes;
    return 1;
}

int api_read_zeros(void *user, void *data, size_t bytes)
{
    (void)user;
    memset(data, 0, bytes);
    return 0;
}

static const char *call_saves(struct api *a)
{
    REFUSES(drape_save(NULL, api_write_none, NULL));
    REFUSES(drape_save(a->world, NULL, NULL));
    EXPECT(drape_save(a->world, api_write_none, NULL) == DRAPE_EIO);
    REFUSES(drape_load(NULL, api_read_zeros, NULL));
    REFUSES(drape_load(a->world, NULL, NULL));
    EXPECT(drape_load(a->world, api_read_zeros, NULL) == DRAPE_EMATCH);
    return NULL;
}

static const char *call_texts(struct api *a)
{
    (void)a;
    EXPECT(drape_info() && drape_info()[0]);
    for (int k = 0; k < EXTREMES; k++)
        EXPECT(drape_status_text(api_extremes[k])[0]);
    ran(1);
    return NULL;
}

/* The table of all functions */

static const struct {
    const char *name;
    const char *(*call)(struct api *a);
} table[] = {
    {"drape_create", api_call_create},
    {"drape_destroy", call_destroy},
    {"drape_default", call_defaults},
    {"drape_default_cloth", call_defaults},
    {"drape_default_obstacle", call_defaults},
    {"drape_step", call_step},
    {"drape_step_many", call_step_many},
    {"drape_vertices", call_counts},
    {"drape_triangles", call_counts},
    {"drape_first_vertex", call_counts},
    {"drape_first_triangle", call_counts},
    {"drape_read", call_reads},
    {"drape_read_triangles", call_reads},
    {"drape_clock", call_reads},
    {"drape_read_material", api_call_material},
    {"drape_read_wind", call_wind},
    {"drape_read_gravity", api_call_gravity},
    {"drape_borrow", call_reads},
    {"drape_wake", call_wind},
    {"drape_set_wind", call_wind},
    {"drape_set_gravity", api_call_gravity},
    {"drape_set_material", api_call_material},
    {"drape_set_positions", api_call_state},
    {"drape_set_positions_device", api_call_state},
    {"drape_set_velocities", api_call_state},
    {"drape_set_velocities_device", api_call_state},
    {"drape_set_pins", api_call_pins},
    {"drape_set_pins_device", api_call_pins},
    {"drape_set_obstacle", api_call_obstacle},
    {"drape_set_obstacle_device", api_call_obstacle},
    {"drape_set_pose", api_call_obstacle},
    {"drape_seam_target", call_seams},
    {"drape_seam_state", call_seams},
    {"drape_are_sewn", call_seams},
    {"drape_bodies", api_call_bodies},
    {"drape_add_cloth", api_call_bodies},
    {"drape_add_obstacle", api_call_bodies},
    {"drape_remove", api_call_bodies},
    {"drape_contacts", api_call_contacts},
    {"drape_contacts_device", api_call_contacts},
    {"drape_record", api_call_log},
    {"drape_replay", api_call_log},
    {"drape_plan", call_plan},
    {"drape_count", call_plan},
    {"drape_save", call_saves},
    {"drape_load", call_saves},
    {"drape_audit", api_call_audit},
    {"drape_ccd", api_call_ccd},
    {"drape_ccd_frames", api_call_frames},
    {"drape_info", call_texts},
    {"drape_status_text", call_texts},
};
enum { ROWS = sizeof table / sizeof *table };

static bool in_table(const char *name, size_t length)
{
    for (int k = 0; k < ROWS; k++)
        if (strlen(table[k].name) == length &&
            !strncmp(table[k].name, name, length))
            return true;
    return false;
}

/* Counts the prototypes of the header whose names the table lacks. */
static int count_missing(FILE *header, int *prototypes)
{
    char line[256];
    int missing = 0;
    while (fgets(line, sizeof line, header)) {
        const char *name = strstr(line, "drape_");
        if (line[0] < 'a' || line[0] > 'z' || !strncmp(line, "typedef", 7))
            continue;
        while (name) {
            size_t n = strspn(name, "abcdefghijklmnopqrstuvwxyz_0123456789");
            if (name[n] == '(') {
                bool here = in_table(name, n);
                if (!here)
                    printf("%.*s is not in the table\n", (int)n, name);
                missing += !here;
                ++*prototypes;
                break;
            }
            name = strstr(name + n, "drape_");
        }
    }
    return missing;
}

const char *test_api_refuses(void)
{
    struct api a = {.x = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                    .tri = {{0, 1, 2}}};
    int prototypes = 0;
    a.at = (const double(*)[3])a.x;
    FILE *header = fopen("spec/drape.h", "r");
    EXPECT(header);
    int missing = count_missing(header, &prototypes);
    fclose(header);
    EXPECT(missing == 0 && prototypes == ROWS);
    a.mesh = (drape_mesh){.nv = 4,
                          .nt = 1,
                          .x = (const double(*)[3])a.x,
                          .tri = (const int32_t(*)[3])a.tri};
    api_input(&a.input);
    EXPECT(drape_create(&a.input.g.def, &a.world, NULL) == DRAPE_OK);
    EXPECT(guest_go(a.world, 1) == DRAPE_OK);
    for (int k = 0; k < ROWS; k++) {
        const char *what = table[k].call(&a);
        if (what) {
            printf("%s\n", table[k].name);
            return what;
        }
    }
    EXPECT(guest_go(a.world, 1) == DRAPE_OK);
    drape_destroy(a.world);
    return NULL;
}
