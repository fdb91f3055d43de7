/* SPDX-License-Identifier: Apache-2.0 */
/* A place beside a mesh that follows one of its triangles. */
#include "app/base/skin.h"
#include "app/base/vec3.h"

#include <math.h>
#include <string.h>

/* The unit axes of a triangle: along its first side, across it, along its
 * normal. 0: it has no area. */
static int make_axes(const int32_t t[3], const double (*x)[3],
                     double axis[3][3])
{
    double side[3];
    vec3_subtract(x[t[1]], x[t[0]], axis[0]);
    vec3_subtract(x[t[2]], x[t[0]], side);
    vec3_cross(axis[0], side, axis[2]);
    double length = sqrt(vec3_dot(axis[0], axis[0]));
    double area = sqrt(vec3_dot(axis[2], axis[2]));
    if (!(area > 0 && length > 0))
        return 0;
    for (int i = 0; i < 3; i++) {
        axis[0][i] /= length;
        axis[2][i] /= area;
    }
    vec3_cross(axis[2], axis[0], axis[1]);
    return 1;
}

/* The nearest point of the side from corner k to the next, as parts of all
 * corners. */
static void find_on_side(const int32_t t[3], const double (*x)[3],
                         const double place[3], int k, double part[3])
{
    double side[3], to[3];
    vec3_subtract(x[t[(k + 1) % 3]], x[t[k]], side);
    vec3_subtract(place, x[t[k]], to);
    double at = fmin(fmax(vec3_dot(side, to) / vec3_dot(side, side), 0), 1);
    part[k] = 1 - at;
    part[(k + 1) % 3] = at;
    part[(k + 2) % 3] = 0;
}

/* The vector from a point of the triangle to the place; its squared length. */
static double find_way(const int32_t t[3], const double (*x)[3],
                       const double place[3], const double part[3],
                       double way[3])
{
    for (int i = 0; i < 3; i++)
        way[i] = place[i] - part[0] * x[t[0]][i] - part[1] * x[t[1]][i] -
                 part[2] * x[t[2]][i];
    return vec3_dot(way, way);
}

/* The parts of the corners of the point beneath a place, by areas. Whether it
 * is in the triangle. */
static int find_beneath(const int32_t t[3], const double (*x)[3],
                        const double place[3], const double normal[3],
                        double part[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double a[3], b[3], n[3];
        vec3_subtract(x[t[(k + 1) % 3]], place, a);
        vec3_subtract(x[t[(k + 2) % 3]], place, b);
        vec3_cross(a, b, n);
        part[k] = vec3_dot(n, normal);
        sum += part[k];
    }
    for (int k = 0; k < 3; k++)
        part[k] /= sum;
    return part[0] >= 0 && part[1] >= 0 && part[2] >= 0;
}

/* Whether the box of a triangle is further from a place than a squared length.
 */
static int is_far(const int32_t t[3], const double (*x)[3],
                  const double place[3], double squared)
{
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        double a = x[t[0]][i], b = x[t[1]][i], c = x[t[2]][i];
        double lo = fmin(fmin(a, b), c), hi = fmax(fmax(a, b), c);
        double way = fmax(fmax(lo - place[i], place[i] - hi), 0);
        sum += way * way;
    }
    return sum >= squared;
}

void skin_find(struct skin *skin, const double place[3],
               const int32_t (*tri)[3], int64_t from, int64_t to,
               const double (*x)[3])
{
    double least = INFINITY;
    *skin = (struct skin){.tri = -1};
    for (int64_t k = from; k < to; k++) {
        double axis[3][3], part[4][3], way[3];
        if (is_far(tri[k], x, place, least) || !make_axes(tri[k], x, axis))
            continue;
        int tries = find_beneath(tri[k], x, place, axis[2], part[3]) ? 3 : 0;
        for (int side = 0; side < 3 && !tries; side++)
            find_on_side(tri[k], x, place, side, part[side]);
        for (int c = tries; c < (tries ? 4 : 3); c++) {
            double squared = find_way(tri[k], x, place, part[c], way);
            if (!(squared < least))
                continue;
            least = squared;
            skin->tri = k;
            memcpy(skin->part, part[c], sizeof skin->part);
            for (int i = 0; i < 3; i++)
                skin->off[i] = vec3_dot(way, axis[i]);
        }
    }
}

void skin_follow(const struct skin *skin, const int32_t (*tri)[3],
                 const double (*x)[3], double place[3])
{
    const int32_t *t = tri[skin->tri];
    double axis[3][3];
    if (!make_axes(t, x, axis))
        memset(axis, 0, sizeof axis); /* the foot alone */
    for (int i = 0; i < 3; i++) {
        place[i] = 0;
        for (int k = 0; k < 3; k++)
            place[i] += skin->part[k] * x[t[k]][i] + skin->off[k] * axis[k][i];
    }
}
