/* SPDX-License-Identifier: Apache-2.0 */
/* Exact queries, and definitions that are refused. */
#include "tests/whole/whole.h"

#include <string.h>

enum { QUERIES = 3000, SIDE = 9 };

/* Draws four points on a grid. On a coarse grid points often coincide or lie on
 * a line or in a plane; fine grids exercise the floating-point filters. */
static void draw(double x[4][3], uint32_t *state, int k)
{
    static const double grid[] = {2, 4, 1 << 20, 1e12};
    double cells = grid[k % 4];
    for (int p = 0; p < 4; p++)
        for (int i = 0; i < 3; i++)
            x[p][i] = (double)(int64_t)(cells * show_random(state)) / cells;
}

static int touch(void *user, int kind, const int32_t v[4], double toi)
{
    fprintf(user, "touch %d %d %d %d %d %a\n", kind, v[0], v[1], v[2], v[3],
            toi);
    return 0;
}

/* Continuous query: one half of a sheet folds flat onto the other half. */
static void write_frames(int threads, FILE *out)
{
    enum { CELLS = SIDE - 1 };
    double x0[SIDE * SIDE][3], x1[SIDE * SIDE][3];
    int32_t tri[2 * CELLS * CELLS][3];
    int n = 0;
    for (int p = 0; p < SIDE * SIDE; p++) {
        int i = p % SIDE, j = p / SIDE, a = p, right = i < CELLS;
        x0[p][0] = i;
        x0[p][1] = i > CELLS / 2 ? 0.25 * (i - CELLS / 2) : 0;
        x0[p][2] = j + 0.125 * i;
        memcpy(x1[p], x0[p], sizeof x1[p]);
        x1[p][0] = i > CELLS / 2 ? CELLS - i + 0.0625 * j : i;
        x1[p][1] = i > CELLS / 2 ? -0.25 : 0;
        if (!right || j == CELLS)
            continue;
        const int32_t two[2][3] = {{a, a + 1, a + SIDE},
                                   {a + 1, a + SIDE + 1, a + SIDE}};
        memcpy(tri[n], two, sizeof two);
        n += 2;
    }
    drape_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.nv = SIDE * SIDE;
    mesh.nt = n;
    mesh.x = (const double(*)[3])x0;
    mesh.tri = (const int32_t(*)[3])tri;
    mesh.threads = threads;
    int64_t tested[2] = {0, 0};
    int status =
        drape_ccd_frames(&mesh, (const double(*)[3])x1, touch, out, tested);
    fprintf(out, "frames %d %lld %lld\n", status, (long long)tested[0],
            (long long)tested[1]);
}

/* Writes the pairs that the audit finds among triangles on a coarse grid, many
 * of which lie in one plane, share corners or have no area. */
static void write_audits(int threads, FILE *out)
{
    enum { TRIANGLES = 60, AUDITS = 12, PAIRS = 400 };
    uint32_t state = 11;
    for (int k = 0; k < AUDITS; k++) {
        double x[3 * TRIANGLES][3];
        int32_t tri[TRIANGLES][3], pair[PAIRS][2];
        for (int p = 0; p < 3 * TRIANGLES; p++) {
            tri[p / 3][p % 3] = p;
            for (int i = 0; i < 3; i++)
                x[p][i] = i == k % 3 && k < 9 ? 1.0 / 3
                                              : (int)(6 * show_random(&state));
        }
        drape_mesh mesh;
        memset(&mesh, 0, sizeof mesh);
        mesh.nv = 3 * TRIANGLES;
        mesh.nt = TRIANGLES;
        mesh.x = (const double(*)[3])x;
        mesh.tri = (const int32_t(*)[3])tri;
        mesh.threads = threads;
        int64_t found = 0, flat = 0;
        int status = drape_audit(&mesh, PAIRS, pair, &found, &flat);
        fprintf(out, "audit %d %d %lld %lld", k, status, (long long)found,
                (long long)flat);
        for (int64_t j = 0; j < PAIRS && j < found; j++)
            fprintf(out, " %d-%d", pair[j][0], pair[j][1]);
        fputs("\n", out);
    }
}

void show_queries(int threads, FILE *out)
{
    uint32_t state = 7;
    for (int k = 0; k < QUERIES; k++) {
        double x0[4][3], x1[4][3], toi = -1;
        draw(x0, &state, k);
        draw(x1, &state, k / 3);
        int answer = drape_ccd(k & 1, (const double(*)[3])x0,
                               (const double(*)[3])x1, &toi);
        fprintf(out, "query %d %d %a\n", k, answer, toi);
    }
    write_frames(threads, out);
    write_audits(threads, out);
}

/* Definitions that are refused */

static void refuse(struct show *s, const char *what, FILE *out)
{
    drape_world *world = NULL;
    drape_error error;
    memset(&error, 0, sizeof error);
    int status = drape_create(&s->def, &world, &error);
    fprintf(out, "%s: %d %s\n", what, status, error.text);
    drape_destroy(world);
}

/* Sets each number of a definition out of its range in turn. */
static void refuse_numbers(struct show *s, FILE *out)
{
    drape_def *d = &s->def;
    drape_cloth *c = &s->cloth[0];
    double *real[] = {&d->dt,
                      &d->gravity[1],
                      &d->wind.density,
                      &d->wind.drag,
                      &d->tolerance,
                      &c->width,
                      &c->u[0],
                      &c->material.density,
                      &c->material.stretch,
                      &c->material.thickness,
                      &c->material.friction,
                      &s->obstacle[0].friction,
                      &s->time[0][1],
                      &s->turn[0][1][0]};
    int *whole[] = {&d->backend,
                    &d->precision,
                    &d->threads,
                    &c->n_pins,
                    &d->precond,
                    &d->matrix,
                    &d->max_iterations,
                    &d->max_rounds,
                    &d->max_slices,
                    &d->n_cloths,
                    &c->m,
                    &d->integrator,
                    &s->pin[0].i,
                    &s->motion[0].keys};
    char what[32];
    for (size_t k = 0; k < sizeof real / sizeof real[0]; k++) {
        double kept = *real[k];
        *real[k] = k % 2 ? -1e300 : -1;
        snprintf(what, sizeof what, "refused number %zu", k);
        refuse(s, what, out);
        *real[k] = kept;
    }
    for (size_t k = 0; k < sizeof whole / sizeof whole[0]; k++) {
        int kept = *whole[k];
        *whole[k] = k % 2 ? -7 : 1 << 30; /* odd: array sizes, too */
        snprintf(what, sizeof what, "refused whole %zu", k);
        refuse(s, what, out);
        *whole[k] = kept;
    }
}

void show_refusals(FILE *out)
{
    const double way[3] = {0, 1, 0};
    struct show s;
    memset(&s, 0, sizeof s);
    drape_default(&s.def);
    s.def.cloths = s.cloth;
    s.def.obstacles = s.obstacle;
    s.def.motions = s.motion;
    show_cloth(&s, 5, 5, 0.02, 0);
    show_box(&s, -1, 0.1);
    show_pin(&s, 0, 0, show_motion(&s, 1, way, 0));
    refuse_numbers(&s, out);
    s.cloth[0].origin[1] = -1;
    refuse(&s, "a start that intersects", out);
    show_free(&s);
}
