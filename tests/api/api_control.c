/* SPDX-License-Identifier: Apache-2.0 */
/* Faults that the calls of live control and its log refuse. A refused call
 * changes nothing; the caller of the table checks that. spec/drape.h */
#include "tests/api/api.h"

enum { CLOTH = 7 * 6, PLATE = 4 };

const double api_wrong[] = {(double)NAN, (double)INFINITY, 0x1p61, -0x1p61};

const char *api_call_gravity(struct api *a)
{
    double g[3] = {0, -9.81, 0}, now[3];
    REFUSES(drape_read_gravity(NULL, now));
    REFUSES(drape_read_gravity(a->world, NULL));
    REFUSES(drape_set_gravity(NULL, g));
    REFUSES(drape_set_gravity(a->world, NULL));
    for (int k = 0; k < WRONG; k++) {
        double bad[3] = {0, 0, 0};
        bad[k % 3] = api_wrong[k];
        EXPECT(drape_set_gravity(a->world, bad) == DRAPE_EDATA);
    }
    EXPECT(drape_set_gravity(a->world, g) == DRAPE_OK);
    return NULL;
}

/* A wrong material is refused with the same code as in a definition. */
const char *api_call_material(struct api *a)
{
    drape_material m = a->input.g.cloth.material, now;
    int k;
    REFUSES(drape_read_material(NULL, 0, &now));
    REFUSES(drape_read_material(a->world, 0, NULL));
    REFUSES(drape_read_material(a->world, 1, &now));
    REFUSES_EACH(api_extremes, k, drape_read_material(a->world, k, &now));
    REFUSES(drape_set_material(NULL, 0, &m));
    REFUSES(drape_set_material(a->world, 0, NULL));
    REFUSES(drape_set_material(a->world, 1, &m));
    REFUSES_EACH(api_extremes, k, drape_set_material(a->world, k, &m));
    double *number[] = {&m.density,  &m.stretch,  &m.shear,
                        &m.bend,     &m.damping,  &m.thickness,
                        &m.friction, &m.limit[0], &m.limit[2]};
    for (int i = 0; i < 9; i++) {
        double kept = *number[i];
        for (int j = 0; j < WRONG; j++) {
            *number[i] = api_wrong[j];
            EXPECT(drape_set_material(a->world, 0, &m) == DRAPE_EDATA);
            ran(1);
        }
        *number[i] = -1;
        REFUSES(drape_set_material(a->world, 0, &m));
        *number[i] = kept;
    }
    m.table[DRAPE_WEFT][0][0] = 0.01; /* without a force */
    REFUSES(drape_set_material(a->world, 0, &m));
    m.table[DRAPE_WEFT][0][1] = 8;
    EXPECT(drape_set_material(a->world, 0, &m) == DRAPE_OK);
    m.table[DRAPE_WEFT][0][0] = 0;
    m.shear = 0.6 * m.stretch;
    REFUSES(drape_set_material(a->world, 0, &m));
    m.shear = a->input.g.cloth.material.shear;
    EXPECT(drape_set_material(a->world, 0, &m) == DRAPE_OK);
    return NULL;
}

/* Every number of an array, at its ends and where it is wrong. */
static const char *refuse_state(struct api *a, double (*x)[3],
                                const double (*is)[3])
{
    drape_error error;
    REFUSES(drape_set_positions(NULL, 0, 1, is, &error));
    REFUSES(drape_set_positions(a->world, 0, 1, NULL, &error));
    REFUSES(drape_set_velocities(NULL, 0, 1, is));
    REFUSES(drape_set_velocities(a->world, 0, 1, NULL));
    REFUSES(drape_set_positions_device(NULL, 0, 1, is, NULL));
    REFUSES(drape_set_positions_device(a->world, 0, 1, NULL, NULL));
    REFUSES(drape_set_velocities_device(NULL, 0, 1, is));
    REFUSES(drape_set_velocities_device(a->world, 0, 1, NULL));
    const int64_t range[][2] = {
        {-1, 1},        {0, -1},        {0, CLOTH + 1}, {CLOTH, 1},
        {CLOTH + 1, 0}, {1, INT64_MAX}, {INT64_MIN, 1}, {INT64_MAX, INT64_MAX}};
    for (int k = 0; k < 8; k++) {
        int64_t first = range[k][0], n = range[k][1];
        REFUSES(drape_set_positions(a->world, first, n, is, NULL));
        REFUSES(drape_set_velocities(a->world, first, n, is));
        REFUSES(drape_set_positions_device(a->world, first, n, is, NULL));
        REFUSES(drape_set_velocities_device(a->world, first, n, is));
    }
    for (int k = 0; k < WRONG; k++) {
        double kept = x[7][k % 3];
        x[7][k % 3] = api_wrong[k];
        EXPECT(drape_set_positions(a->world, 0, CLOTH, is, NULL) ==
               DRAPE_EDATA);
        EXPECT(drape_set_velocities(a->world, 0, CLOTH, is) == DRAPE_EDATA);
        x[7][k % 3] = kept;
        ran(2);
    }
    return NULL;
}

const char *api_call_state(struct api *a)
{
    static double x[CLOTH + PLATE][3];
    EXPECT(drape_vertices(a->world) == CLOTH + PLATE);
    EXPECT(drape_read(a->world, x, NULL) == DRAPE_OK);
    const double(*is)[3] = (const double(*)[3])x;
    const char *what = refuse_state(a, x, is);
    if (what)
        return what;
    EXPECT(drape_set_positions(a->world, 0, 0, NULL, NULL) == DRAPE_OK);
    EXPECT(drape_set_positions(a->world, 0, CLOTH, is, NULL) == DRAPE_OK);
    return NULL;
}

const char *api_call_pins(struct api *a)
{
    static double x[CLOTH + PLATE][3];
    int32_t list[2] = {3, 4};
    int k;
    int64_t n;
    drape_read(a->world, x, NULL);
    const double(*is)[3] = (const double(*)[3])x;
    REFUSES(drape_set_pins(NULL, 0, 2, list, is));
    REFUSES(drape_set_pins(a->world, 1, 2, list, is));
    REFUSES_EACH(api_extremes, k, drape_set_pins(a->world, k, 2, list, is));
    REFUSES_EACH(api_wide, n, drape_set_pins(a->world, 0, n, list, is));
    REFUSES(drape_set_pins(a->world, 0, CLOTH + 1, list, is));
    REFUSES(drape_set_pins(a->world, 0, 2, NULL, is));
    REFUSES(drape_set_pins_device(NULL, 0, 2, list, is));
    REFUSES(drape_set_pins_device(a->world, 1, 2, list, is));
    REFUSES(drape_set_pins_device(a->world, 0, 2, NULL, is));
    REFUSES_EACH(api_extremes, list[1],
                 drape_set_pins(a->world, 0, 2, list, is));
    list[1] = CLOTH;
    REFUSES(drape_set_pins(a->world, 0, 2, list, is));
    list[1] = list[0];
    REFUSES(drape_set_pins(a->world, 0, 2, list, is));
    list[1] = 4;
    for (int i = 0; i < WRONG; i++) {
        x[1][i % 3] = api_wrong[i];
        EXPECT(drape_set_pins(a->world, 0, 2, list, is) == DRAPE_EDATA);
        x[1][i % 3] = 0;
    }
    EXPECT(drape_set_pins(a->world, 0, 0, NULL, NULL) == DRAPE_OK);
    return NULL;
}

const char *api_call_obstacle(struct api *a)
{
    static double x[CLOTH + PLATE][3];
    const double zero[3] = {0, 0, 0}, turn[4] = {1, 0, 0, 0};
    const double long_turn[4] = {1, 0.01, 0, 0};
    int k;
    drape_read(a->world, x, NULL);
    const double(*is)[3] = (const double(*)[3])x + CLOTH;
    REFUSES(drape_set_obstacle(NULL, 0, is));
    REFUSES(drape_set_obstacle(a->world, 1, is));
    REFUSES(drape_set_obstacle(a->world, 0, NULL));
    REFUSES_EACH(api_extremes, k, drape_set_obstacle(a->world, k, is));
    REFUSES(drape_set_obstacle_device(NULL, 0, is));
    REFUSES(drape_set_obstacle_device(a->world, 1, is));
    REFUSES(drape_set_obstacle_device(a->world, 0, NULL));
    REFUSES(drape_set_pose(NULL, 0, zero, turn, zero));
    REFUSES(drape_set_pose(a->world, 0, NULL, turn, zero));
    REFUSES(drape_set_pose(a->world, 1, zero, turn, zero));
    REFUSES_EACH(api_extremes, k,
                 drape_set_pose(a->world, k, zero, turn, zero));
    REFUSES(drape_set_pose(a->world, 0, zero, long_turn, zero));
    for (int i = 0; i < WRONG; i++) {
        double bad[4] = {api_wrong[i], 0, 0, 0};
        x[CLOTH + 1][i % 3] = api_wrong[i];
        EXPECT(drape_set_obstacle(a->world, 0, is) == DRAPE_EDATA);
        x[CLOTH + 1][i % 3] = 0;
        EXPECT(drape_set_pose(a->world, 0, bad, turn, zero) == DRAPE_EDATA);
        EXPECT(drape_set_pose(a->world, 0, zero, bad, zero) == DRAPE_EDATA);
        EXPECT(drape_set_pose(a->world, 0, zero, turn, bad) == DRAPE_EDATA);
        ran(4);
    }
    const double far[3] = {0x1p60, 0, 0};
    EXPECT(drape_set_pose(a->world, 0, far, turn, far) == DRAPE_OK);
    const double beyond[3] = {-0x1p60, 0, 0};
    EXPECT(drape_set_pose(a->world, 0, far, turn, beyond) == DRAPE_EDATA);
    EXPECT(drape_set_pose(a->world, 0, zero, NULL, NULL) == DRAPE_OK);
    return NULL;
}

/* A body that the definition would refuse is refused with the same code. */
const char *api_call_bodies(struct api *a)
{
    drape_cloth cloth = a->input.g.cloth;
    drape_obstacle plate = a->input.g.plate;
    drape_error error;
    int k;
    cloth.pins = NULL;
    cloth.n_pins = 0;
    cloth.origin[1] = 9;
    EXPECT(drape_bodies(NULL, &k) == DRAPE_EARG);
    EXPECT(drape_bodies(a->world, NULL) == 2);
    EXPECT(drape_bodies(a->world, &k) == 2 && k == 1);
    REFUSES(drape_add_cloth(NULL, &cloth, &error));
    REFUSES(drape_add_cloth(a->world, NULL, &error));
    REFUSES(drape_add_obstacle(NULL, &plate, &error));
    REFUSES(drape_add_obstacle(a->world, NULL, &error));
    REFUSES(drape_remove(NULL, 0));
    REFUSES(drape_remove(a->world, 0)); /* the only cloth */
    REFUSES(drape_remove(a->world, 2));
    REFUSES_EACH(api_extremes, k, drape_remove(a->world, k));
    REFUSES_EACH(api_extremes, cloth.m,
                 drape_add_cloth(a->world, &cloth, NULL));
    cloth.m = a->input.g.cloth.m;
    REFUSES_EACH(api_wide, plate.n_triangles,
                 drape_add_obstacle(a->world, &plate, &error));
    EXPECT(strstr(error.text, "obstacle 1: n_triangles"));
    plate.n_triangles = 2;
    plate.motion = 1;
    REFUSES(drape_add_obstacle(a->world, &plate, &error));
    EXPECT(strstr(error.text, "obstacle 1: motion"));
    for (int i = 0; i < WRONG; i++) {
        cloth.width = api_wrong[i];
        EXPECT(drape_add_cloth(a->world, &cloth, &error) < 0);
        EXPECT(strstr(error.text, "cloth 1: width"));
        ran(1);
    }
    EXPECT(drape_bodies(a->world, NULL) == 2);
    return NULL;
}

const char *api_call_contacts(struct api *a)
{
    drape_contact_list list;
    REFUSES(drape_contacts(NULL, &list));
    REFUSES(drape_contacts(a->world, NULL));
    REFUSES(drape_contacts_device(NULL, &list));
    REFUSES(drape_contacts_device(a->world, NULL));
    return NULL;
}

static int read_none(void *user, void *data, size_t bytes)
{
    (void)user;
    (void)data;
    (void)bytes;
    return 1;
}

const char *api_call_log(struct api *a)
{
    REFUSES(drape_record(NULL, api_write_none, NULL));
    EXPECT(drape_record(a->world, api_write_none, NULL) == DRAPE_EIO);
    EXPECT(drape_record(a->world, NULL, NULL) == DRAPE_OK);
    REFUSES(drape_replay(NULL, read_none, NULL, NULL));
    REFUSES(drape_replay(a->world, NULL, NULL, NULL));
    EXPECT(drape_replay(a->world, read_none, NULL, NULL) == 0);
    EXPECT(drape_replay(a->world, api_read_zeros, NULL, NULL) == DRAPE_EMATCH);
    return NULL;
}
