/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of where bodies intersect. */
#include "app/render/marks.h"
#include "app/base/app.h"
#include "app/base/curve.h"
#include "app/base/vec.h"
#include "app/render/picture.h"

#include <stdlib.h>
#include <string.h>

enum { RED, STONE, CLOTHS, SHADES = 6 };
static const double least_ring = 8, wide = 1.5; /* pixels */

/* Makes the model of the bodies, normals and all. */
static bool fill(struct pool *pool, const struct untangling *u,
                 const double (*x)[3], struct model *m)
{
    size_t nv = (size_t)u->first[u->parts] + 1, nt = (size_t)u->nt + 1;
    struct surface *surface = pool_take(pool, CLOTHS + SHADES, sizeof *surface);
    *m = (struct model){.nv = u->first[u->parts],
                        .nt = u->nt,
                        .x = pool_take(pool, nv, sizeof *m->x),
                        .normal = pool_take(pool, nv, sizeof *m->normal),
                        .uv = pool_take(pool, nv, sizeof *m->uv),
                        .tri = pool_take(pool, nt, sizeof *m->tri),
                        .paint = pool_take(pool, nt, sizeof *m->paint),
                        .surface = surface,
                        .floor = NAN};
    if (!surface || !m->x || !m->normal || !m->uv || !m->tri || !m->paint)
        return false;
    for (int k = 0; k < CLOTHS + SHADES; k++)
        for (int side = 0; side < 2; side++) {
            vec c = k == RED     ? make(.8f, .01f, .01f)
                    : k == STONE ? make(.60f, .555f, .49f)
                                 : scale(make(.30f, .45f, .60f),
                                         1 - 0.1f * (float)(k - CLOTHS));
            memcpy(surface[k].side[side], &c.x, sizeof surface[k].side[side]);
        }
    for (int64_t k = 0; k < m->nv; k++)
        for (int i = 0; i < 3; i++)
            m->x[k][i] = (float)x[k][i];
    int part = 0;
    for (int64_t k = 0; k < m->nt; k++) {
        vec p[3];
        for (int i = 0; i < 3; i++) {
            m->tri[k][i] = (uint32_t)u->tri[k][i];
            p[i] = from(m->x[u->tri[k][i]]);
        }
        vec n = cross(sub(p[1], p[0]), sub(p[2], p[0]));
        for (int i = 0; i < 3; i++) {
            vec sum = add(from(m->normal[u->tri[k][i]]), n);
            memcpy(m->normal[u->tri[k][i]], &sum.x, sizeof *m->normal);
        }
        while (u->tri[k][0] >= u->first[part + 1])
            part++;
        m->paint[k] = (uint16_t)(u->mark[k] >= 0  ? RED
                                 : u->fixed[part] ? STONE
                                                  : CLOTHS + part % SHADES);
    }
    for (int64_t k = 0; k < m->nv; k++) {
        vec n = unit(from(m->normal[k]));
        memcpy(m->normal[k], &n.x, sizeof *m->normal);
    }
    return true;
}

/* Looks at the regions, with as much of the bodies around as shows where that
 * is. */
static void aim(const struct untangling *u, const struct model *m, int back,
                struct camera *c)
{
    static const double way[3] = {0.5, 0.4, 1};
    double lo[3] = {INFINITY, INFINITY, INFINITY}, size = 0, all = 0;
    double hi[3] = {-INFINITY, -INFINITY, -INFINITY};
    *c = (struct camera){.fov = 35, .light = 1, .floor = {.635, .627, .623}};
    for (int i = 0; i < 3; i++) {
        float least = INFINITY, most = -INFINITY;
        for (int64_t k = 0; k < m->nv; k++) {
            least = fminf(least, m->x[k][i]);
            most = fmaxf(most, m->x[k][i]);
        }
        all = fmax(all, (double)most - (double)least);
        for (int k = 0; k < u->found.count; k++) {
            lo[i] = fmin(lo[i], u->found.row[k].lo[i]);
            hi[i] = fmax(hi[i], u->found.row[k].hi[i]);
        }
        size = fmax(size, hi[i] - lo[i]);
    }
    for (int i = 0; i < 3; i++) {
        double far = way[i] * (1.6 * size + 0.5 * all);
        c->target[i] = (lo[i] + hi[i]) / 2;
        c->eye[i] = c->target[i] + (back && i != 1 ? -far : far);
    }
}

/* Draws a ring around each region. */
static void draw_rings(const struct untangling *u, const struct shot *shot,
                       uint8_t *rgb)
{
    const struct camera *c = &shot->camera;
    vec eye = make((float)c->eye[0], (float)c->eye[1], (float)c->eye[2]);
    vec target =
        make((float)c->target[0], (float)c->target[1], (float)c->target[2]);
    vec ahead = unit(sub(target, eye));
    vec right = unit(cross(ahead, make(0, 1, 0))), up = cross(right, ahead);
    double scale = shot->height / 2.0 / tan(c->fov * acos(-1) / 360);
    for (int k = 0; k < u->found.count; k++) {
        const struct tangle *row = &u->found.row[k];
        float p[3];
        double across = 0;
        for (int i = 0; i < 3; i++) {
            p[i] = (float)((row->lo[i] + row->hi[i]) / 2);
            across += (row->hi[i] - row->lo[i]) * (row->hi[i] - row->lo[i]);
        }
        vec to = sub(from(p), eye);
        double far = dot(to, ahead), unit_pixels = scale / far;
        if (!(far > 0))
            continue;
        double at[2] = {shot->width / 2.0 + dot(to, right) * unit_pixels,
                        shot->height / 2.0 - dot(to, up) * unit_pixels};
        double r = fmax(sqrt(across) / 2 * unit_pixels, least_ring);
        for (int y = 0; y < shot->height; y++)
            for (int x = 0; x < shot->width; x++) {
                double off = plane_length(x - at[0], y - at[1]) - r;
                static const uint8_t ink[3] = {220, 0, 0};
                if (fabs(off) < wide)
                    memcpy(
                        rgb + 3 * ((size_t)y * (size_t)shot->width + (size_t)x),
                        ink, sizeof ink);
            }
    }
}

int marks_draw(const struct untangling *u, const double (*x)[3],
               const char *directory)
{
    static const char *const names[] = {"front.png", "back.png"};
    struct pool pool = {0};
    struct model model = {0};
    struct shot shot = {.width = 800, .height = 800, .samples = 8};
    uint8_t *rgb = malloc((size_t)shot.width * (size_t)shot.height * 3);
    bool good = rgb && fill(&pool, u, x, &model);
    int status = good ? APP_OK : no_memory();
    for (int back = 0; good && back < 2 && status == APP_OK; back++) {
        aim(u, &model, back, &shot.camera);
        status = picture_take(&model, &shot, rgb);
        if (status != APP_OK)
            break;
        draw_rings(u, &shot, rgb);
        if (!picture_save(directory, names[back], rgb, shot.width, shot.height))
            status = APP_FAILED;
    }
    free(rgb);
    pool_free(&pool);
    return status;
}
