/* SPDX-License-Identifier: Apache-2.0 */
/* The force on a cloth, and the streams it lies in. spec/cloth/dynamics.md */
#ifndef REF_FORCE_H
#define REF_FORCE_H

#include "ref/base/trace.h"
#include "ref/cloth/dynamics.h"
#include "ref/cloth/springs.h"
#include "ref/cloth/wind.h"

/* Stream k of work. */
static inline vec *force_stream(const struct dynamics *s, int k)
{
    return s->work + k * s->cloth->count;
}

static inline void force_trace(const struct dynamics *s, const char *stage,
                               const vec *out)
{
    trace_stage(s->trace, stage, out, (size_t)s->cloth->count * sizeof *out);
}

/* The two stages of the force, filled for either backend: wind at x, v, in an
 * implicit step of tau; the springs at x, which damp at damping, or do not
 * where that is NULL. */
void force_wind(const struct dynamics *s, const vec *x, const vec *v, real tau,
                struct wind *w);
void force_springs(const struct dynamics *s, const vec *x, const vec *damping,
                   struct springs *f);

/* Both, by the reference: s->force. */
void force_make(struct dynamics *s, const vec *x, const vec *v,
                const vec *damping);

/* x1 = x, v1 = v. */
void force_copy(struct dynamics *s, const vec *x, const vec *v);

#endif
