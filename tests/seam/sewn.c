/* SPDX-License-Identifier: Apache-2.0 */
/* Two rectangles that are sewn along an edge; see tests/seam/sewn.h. */
#include "tests/seam/sewn.h"

/* The finer edge's particles are held to places on the other one. */
static void sew_edges(struct sewn *s)
{
    int fine = s->cloth[1].m > s->cloth[0].m, coarse = !fine;
    const drape_cloth *a = &s->cloth[fine], *b = &s->cloth[coarse];
    int32_t from = fine ? 0 : a->m * (a->n - 1);
    int32_t to = coarse ? 0 : b->m * (b->n - 1);
    for (int i = 0; i < a->m; i++) {
        double at = (double)i * (b->m - 1) / (a->m - 1);
        int cell = (int)(at + 1e-9);
        cell = cell > b->m - 2 ? b->m - 2 : cell;
        s->particle[i] = from + i;
        s->onto[i][0] = to + cell;
        s->onto[i][1] = to + cell + 1;
        s->part[i] = fmin(fmax(at - cell, 0), 1);
    }
    s->seam = (drape_seam){.cloth = {fine, coarse},
                           .n = a->m,
                           .particle = s->particle,
                           .onto = (const int32_t(*)[2])s->onto,
                           .part = s->part};
}

void sewn_make(struct sewn *s, const int m[2], const double size[2], bool hangs,
               double apart)
{
    memset(s, 0, sizeof *s);
    drape_default(&s->def);
    for (int k = 0; k < 2; k++) {
        drape_cloth *c = &s->cloth[k];
        drape_default_cloth(c);
        c->m = m[k];
        c->width = size[0];
        c->height = size[1] / 2;
        c->n = 1 + (int)lround((m[k] - 1) * c->height / c->width);
        c->v[1] = hangs ? -1 : 0;
        c->v[2] = hangs ? 0 : -1;
        c->origin[hangs ? 1 : 2] = -k * (c->height + apart);
        c->pins = s->pin + k * SEWN_SIDE;
    }
    sew_edges(s);
    s->def.precision = REAL_BITS;
    s->def.cloths = s->cloth;
    s->def.n_cloths = 2;
    s->def.seams = &s->seam;
    s->def.n_seams = 1;
}

void sewn_add_ball(struct sewn *s, double radius)
{
    const double pi = 3.1415926535897932;
    int64_t n = 0;
    for (int k = 0; k < BALL_SIDE; k++) {
        double a = 2 * pi * (k % BALL_ROUND) / BALL_ROUND;
        double b = pi * (k / BALL_ROUND + 0.1) / (BALL_RINGS - 0.8);
        s->ball_x[k][0] = radius * sin(b) * cos(a);
        s->ball_x[k][1] = radius * cos(b);
        s->ball_x[k][2] = radius * sin(b) * sin(a);
    }
    for (int k = 0; k < BALL_SIDE - BALL_ROUND; k++) {
        int32_t up = k - k % BALL_ROUND, i = k % BALL_ROUND;
        int32_t a = k, b = up + (i + 1) % BALL_ROUND, c = a + BALL_ROUND;
        int32_t d = b + BALL_ROUND;
        memcpy(s->ball_tri[n++], (int32_t[3]){a, b, c}, sizeof *s->ball_tri);
        memcpy(s->ball_tri[n++], (int32_t[3]){b, d, c}, sizeof *s->ball_tri);
    }
    drape_default_obstacle(&s->ball);
    s->ball.n_vertices = BALL_SIDE;
    s->ball.n_triangles = n;
    s->ball.x = (const double(*)[3])s->ball_x;
    s->ball.tri = (const int32_t(*)[3])s->ball_tri;
    s->def.obstacles = &s->ball;
    s->def.n_obstacles = 1;
}

void sewn_pin_row(struct sewn *s, int k, int j, int motion)
{
    drape_cloth *c = &s->cloth[k];
    for (int i = 0; i < c->m; i++)
        s->pin[k * SEWN_SIDE + c->n_pins++] = (drape_pin){i, j, motion};
}

double sewn_gap(const struct sewn *s, const drape_world *world,
                const double (*target)[3])
{
    static double gap[SEWN_SIDE][3];
    const drape_cloth *c = &s->cloth[s->seam.cloth[0]];
    double most = 0;
    if (drape_seam_state(world, 0, gap, NULL) != DRAPE_OK)
        return HUGE_VAL;
    for (int64_t k = 0; k < s->seam.n; k++) {
        double square = 0;
        for (int i = 0; i < 3; i++) {
            double off = gap[k][i] - (target ? target[k][i] : 0);
            square += off * off;
        }
        most = fmax(most, sqrt(square));
    }
    return most / (c->width / (c->m - 1));
}

void sewn_pull(const struct sewn *s, const drape_world *world, double pull[3])
{
    static double all[SEWN_SIDE][3];
    memset(pull, 0, 3 * sizeof *pull);
    if (drape_seam_state(world, 0, NULL, all) != DRAPE_OK)
        pull[0] = HUGE_VAL;
    for (int64_t k = 0; k < s->seam.n; k++)
        for (int i = 0; i < 3; i++)
            pull[i] += all[k][i];
}
