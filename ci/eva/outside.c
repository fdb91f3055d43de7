/* SPDX-License-Identifier: Apache-2.0 */
/* Calls a function of ref/ as its contract allows and then, with a second
 * argument, just outside of it. In the flavour that asserts contracts
 * (ci/eva/eva.mk) the second call must end the program.
 * usage: outside NAME [outside] */
#include <stdio.h>
#include <string.h>

#include "ref/narrow/closest.h"
#include "ref/narrow/split.h"
#include "ref/narrow/tritri.h"

/* Whether a call is outside: what the calls below take of it. */
static bool far;

static double beyond(double inside)
{
    return far ? 2 * inside : inside;
}

static void call_closest(const char *name)
{
    struct wide x[4] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
    struct closest r = {.c = {1, 0, 0, -1}};
    real c[4];
    x[3].z = beyond(-0x1p60);
    if (strcmp(name, "closest_vf") == 0)
        closest_vf(x, &r);
    else if (strcmp(name, "closest_ee") == 0)
        closest_ee(x, &r);
    else if (strcmp(name, "closest_normal") == 0)
        (void)closest_normal(x, 1);
    r.c[3] = beyond(-1);
    if (strcmp(name, "closest_weights") == 0)
        closest_weights(&r, 1, c);
}

static void call_filter(const char *name)
{
    double x[2][4][3] = {{{0}}};
    struct motion m;
    struct forms s;
    bool inside;
    uint32_t toi;
    x[1][3][2] = beyond(0x1p1023);
    if (strcmp(name, "motion_vf") == 0)
        motion_vf(x, &m);
    if (strcmp(name, "motion_ee") == 0)
        motion_ee(x, &m);
    x[1][3][2] = 1;
    motion_ee(x, &m);
    m.count = far && strcmp(name, "filter_signs") == 0 ? 5 : 4;
    (void)filter_signs(&m, &s, &inside);
    s.v[2] = beyond(0x1p700);
    if (strcmp(name, "split_interval") == 0)
        (void)split_interval(&m, &s, &toi);
}

static void call_exact(const char *name)
{
    struct face t = {{0, 1, 2}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, s = t;
    struct plane p = ref_plane(&t);
    double q[3] = {0, 0, beyond(0x1p60)};
    for (int k = 0; k < 3; k++) {
        s.v[k] += 3;
        s.p[k][2] = k ? q[2] : -q[2]; /* on both sides of t's plane */
    }
    if (strcmp(name, "ref_orient3") == 0)
        (void)ref_orient3(t.p[0], t.p[1], t.p[2], q);
    else if (strcmp(name, "ref_orient2") == 0)
        (void)ref_orient2(t.p[0], t.p[1], t.p[2], 0, far ? 3 : 1);
    else if (strcmp(name, "ref_plane") == 0)
        (void)ref_plane(&s);
    else if (strcmp(name, "ref_tritri") == 0)
        (void)ref_tritri(&t, &p, &s);
}

int main(int argc, char **argv)
{
    for (int k = 0; k < argc - 1; k++) {
        far = k == 1;
        call_closest(argv[1]);
        call_filter(argv[1]);
        call_exact(argv[1]);
        puts(far ? "outside" : "inside");
        (void)fflush(stdout);
    }
    return 0;
}
