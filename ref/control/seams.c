/* SPDX-License-Identifier: Apache-2.0 */
/* The caller's part of seams between two steps, on either backend: targets, and
 * what seams are like. spec/seam/seam.md §4 */
#include "ref/control/control.h"
#include "ref/seam/seam.h"
#include "ref/sleep/sleep.h"

int64_t control_seam_points(const struct world *w, int seam)
{
    const struct seams *s = &w->seams;
    return seam >= 0 && seam < s->count ? s->first[seam + 1] - s->first[seam]
                                        : -1;
}

int control_seam_target(struct world *w, int seam, int64_t n,
                        const double (*gap)[3])
{
    const struct seams *s = &w->seams;
    vec *to = w->home->seams.next;
    bool sane = true;
    if (control_seam_points(w, seam) != n)
        return DRAPE_EARG;
    to += s->first[seam];
    for (int64_t i = 0; i < n; i++) {
        to[i] =
            gap ? vec_make((real)gap[i][0], (real)gap[i][1], (real)gap[i][2])
                : vec_make(0, 0, 0);
        sane &= vec_sane(to[i]);
    }
    if (!sane)
        return DRAPE_EDATA;
    w->run->begin(w->on);
    w->run->send(w->on, s->to + s->first[seam], to, (size_t)n * sizeof *to);
    sleep_wake(w);
    return w->run->status(w->on);
}

static void copy_out(int64_t n, const vec *from, double (*to)[3])
{
    for (int64_t i = 0; i < n; i++) {
        to[i][0] = (double)from[i].x;
        to[i][1] = (double)from[i].y;
        to[i][2] = (double)from[i].z;
    }
}

int control_seam_state(const struct world *w, int seam, double (*gap)[3],
                       double (*pull)[3])
{
    const struct seams *s = &w->seams;
    int64_t n = control_seam_points(w, seam);
    if (n < 0)
        return DRAPE_EARG;
    vec *here = w->home->seams.next + s->first[seam]; /* free between steps */
    vec *there = s->next + s->first[seam];
    size_t bytes = (size_t)n * sizeof *here;
    w->run->begin(w->on);
    if (gap) {
        w->run->seam_gap(w->on, n, s->point + s->first[seam], w->x0, there);
        if (here != there)
            w->run->fetch(w->on, here, there, bytes);
        copy_out(n, here, gap);
    }
    if (pull) {
        w->run->fetch(w->on, here, s->pull + s->first[seam], bytes);
        copy_out(n, here, pull);
    }
    return w->run->status(w->on);
}

void control_end_seams(struct world *w)
{
    const struct seams *s = &w->seams;
    if (s->n > 0)
        w->run->copy(w->on, s->from, s->to, (size_t)s->n * sizeof *s->to);
}

bool control_are_sewn(const struct world *w, int32_t a, int32_t b)
{
    return sew_joins(w, a, b);
}
