/* SPDX-License-Identifier: Apache-2.0 */
/* How far the cloths of a run are stretched. A step is clean whatever a cloth
 * bears, as its springs do not tear; the run says where no fabric would bear
 * it. */
#include "app/write/stretch.h"
#include "app/base/app.h"
#include "app/base/curve.h"

#include <math.h>
#include <string.h>

static const double TWICE = 2;

/* The length of a side at rest; of a rectangle, infinite for the diagonal of a
 * cell. base: the vertex of particle 0. */
static double rest_of(const drape_cloth *c, int64_t base, int32_t a, int32_t b)
{
    int32_t by = a < b ? b - a : a - b;
    if (c->panel) {
        const double *p = c->panel->rest[a - base];
        const double *q = c->panel->rest[b - base];
        return plane_length(q[0] - p[0], q[1] - p[1]);
    }
    return by == 1      ? c->width / (c->m - 1)
           : by == c->m ? c->height / (c->n - 1)
                        : INFINITY;
}

/* The square of a side's length by that of its length at rest; 0 for the
 * diagonal of a rectangle's cell. */
static double side(const struct mesh *mesh, const drape_cloth *c, int64_t base,
                   int32_t a, int32_t b)
{
    double rest = rest_of(c, base, a, b);
    double square = 0;
    for (int i = 0; i < 3; i++) {
        double d = mesh->x[b][i] - mesh->x[a][i];
        square += d * d;
    }
    return square / (rest * rest);
}

void stretch_look(struct stretch *stretch, const drape_cloth *cloth,
                  const struct part *part, int cloths, const struct mesh *mesh,
                  int frame)
{
    int64_t first = 0, base = 0;
    for (int k = 0; k < cloths; first += part[k++].nt) {
        double most = 0;
        base += k ? (int64_t)cloth[k - 1].m * cloth[k - 1].n : 0;
        for (int64_t t = first; t < first + part[k].nt; t++)
            for (int i = 0; i < 3; i++)
                most = fmax(most, side(mesh, &cloth[k], base, mesh->tri[t][i],
                                       mesh->tri[t][(i + 1) % 3]));
        most = sqrt(most);
        if (most > stretch[k].most)
            stretch[k] = (struct stretch){most, frame};
    }
}

void stretch_tell(const struct stretch *stretch, const struct part *part,
                  int cloths)
{
    for (int k = 0; k < cloths; k++)
        if (stretch[k].most > TWICE)
            complain(
                APP_OK,
                "note: cloth %d (%s) is stretched to %.3g times its length "
                "in frame %d, where fabrics tear; a stiffer material or "
                "its limit of strain holds it",
                k, part[k].name, stretch[k].most, stretch[k].frame);
}
