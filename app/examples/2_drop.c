/* SPDX-License-Identifier: Apache-2.0 */
/* 2 of 5. A sheet falls on a slope and slides down. New here: an obstacle,
 * which is a mesh of triangles, and the list of contacts with what they push.
 *
 * Theory: what lies on a slope of angle θ presses on it with m g cos θ. While
 * it slides, friction is μ times that, and the acceleration g (sin θ - μ cos
 * θ). */
#include <drape.h>
#include <stdio.h>

enum { SIDE = 21, COUNT = SIDE * SIDE, LANDED = 30, STEPS = 90 };
static const double SINE = 0.6, COSINE = 0.8, FRICTION = 0.25;

static drape_world *make(void)
{
    /* A square of 8 m that falls along x. A mesh may be open, as this one. */
    const double dx = 4 * COSINE, dy = 4 * SINE;
    const double corner[][3] = {
        {-dx, dy, -4}, {-dx, dy, 4}, {dx, -dy, 4}, {dx, -dy, -4}};
    const int32_t triangle[][3] = {{0, 1, 2}, {0, 2, 3}};
    drape_obstacle slope;
    drape_default_obstacle(&slope);
    slope.n_vertices = 4;
    slope.n_triangles = 2;
    slope.x = corner;
    slope.tri = triangle;
    slope.friction = FRICTION;

    drape_cloth sheet; /* starts 5 mm above the slope and parallel to it */
    drape_default_cloth(&sheet);
    sheet.m = sheet.n = SIDE;
    sheet.width = sheet.height = 0.5;
    sheet.material.friction = FRICTION; /* a pair takes the larger one */
    sheet.u[0] = COSINE;
    sheet.u[1] = -SINE;
    sheet.origin[0] = 0.005 * SINE - dx / 2;
    sheet.origin[1] = 0.005 * COSINE + dy / 2;

    drape_def def;
    drape_default(&def);
    def.cloths = &sheet;
    def.n_cloths = 1;
    def.obstacles = &slope;
    def.n_obstacles = 1;
    drape_world *world;
    return drape_create(&def, &world, NULL) == DRAPE_OK ? world : NULL;
}

/* The mean speed of the sheet's particles down the slope. */
static double speed(const drape_world *world)
{
    static double v[COUNT + 4][3]; /* cloths come first, then obstacles */
    double sum = 0;
    drape_read(world, NULL, v);
    for (int k = 0; k < COUNT; k++)
        sum += (v[k][0] * COSINE - v[k][1] * SINE) / COUNT;
    return sum;
}

int main(void)
{
    drape_world *world = make();
    double landed = 0, clean = 0;
    for (int k = 0; k < STEPS && world; k++) {
        drape_step_report report;
        clean += drape_step(world, &report) == DRAPE_OK && !report.outcome;
        landed = k + 1 == LANDED ? speed(world) : landed;
    }
    drape_contact_list list; /* of the last step, valid until the next */
    if (!world || drape_contacts(world, &list) != DRAPE_OK)
        return 1;
    const double *j = list.impulse[0]; /* N s, what body 0 got: the sheet */
    printf("%.0f of %d steps clean, presses %.4f N, rubs %.4f N, gains %.4f "
           "m/s2\n",
           clean, STEPS, (j[0] * SINE + j[1] * COSINE) / list.dt,
           (j[1] * SINE - j[0] * COSINE) / list.dt,
           (speed(world) - landed) * 60 / (STEPS - LANDED));
    drape_destroy(world);
    return clean == STEPS ? 0 : 1;
}
