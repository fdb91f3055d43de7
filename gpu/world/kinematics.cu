/* SPDX-License-Identifier: Apache-2.0 */
/* Stage kinematics on the device: computes the prescribed positions of
 * obstacles and pins, and their streams. spec/world/kinematics.md */
#include "gpu/base/real.cuh"

extern "C" {
#include "gpu/world/sheet.h"
}

/* Thread k owns vertex k: it reads rest, the others and motion of the vertex,
 * and writes x[k]; it sets *bad if x[k] is out of range. Any order is correct,
 * since all threads write the same value to *bad. */
KERNEL kinematics_kernel(const struct kinematics &s, int64_t *bad)
{
    ITEM(k, s.n);
    double a[3], d[3];
    for (int i = 0; i < 3; i++) {
        double rest = s.rest[3 * k + i];
        a[i] = rest;
        for (int f = 0; f < KINEMATICS_OTHERS; f++)
            if (f < s.others)
                a[i] += s.weight[f] * (s.other[f][3 * k + i] - rest);
    }
    int32_t motion = s.motion[k];
    if (motion >= 0) {
        const struct pose *p = &s.pose[motion];
        for (int i = 0; i < 3; i++)
            d[i] = a[i] - p->pivot[i];
        for (int i = 0; i < 3; i++) {
            const double *r = p->rotation + 3 * i;
            a[i] = p->p[i] + ((r[0] * d[0] + r[1] * d[1]) + r[2] * d[2]);
        }
    }
    vec x = make((real)a[0], (real)a[1], (real)a[2]);
    s.x[k] = x;
    if (!sane(x))
        *bad = 1;
}

int gpu_kinematics(struct gpu *g, struct kinematics *s)
{
    int64_t *bad = gpu_words(g);
    LAUNCH(g, s->n, kinematics_kernel, *s, bad);
    bool out = gpu_read_back(g, 1)[0] != 0;
    int status = gpu_status(g);
    return status == DRAPE_OK && out ? DRAPE_EDATA : status;
}

void gpu_kinematics_make(struct gpu *g, enum arena_part part,
                         const struct kinematics *host,
                         const struct pose *posed, struct kinematics *k)
{
    *k = *host;
    k->rest = NULL;
    double *rest = NULL;
    int32_t *motion = NULL;
    GPU_TAKE_COPY(g, rest, part, host->rest, 3 * host->n);
    GPU_TAKE_COPY(g, motion, part, host->motion, host->n);
    k->rest = rest;
    k->motion = motion;
    k->pose = posed;
}
