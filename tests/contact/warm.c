/* SPDX-License-Identifier: Apache-2.0 */
/* Stage warm: generator and properties. spec/contact/warm.md */
#include "ref/contact/warm.h"

#include "ref/contact/contacts.h"
#include "ref/contact/incidence.h"
#include "ref/world/state.h"
#include "ref/world/step.h"
#include "tests/world/slab.h"

const struct field fields_warm[] = {
    IN(warm, w, nv, 1),        IN(warm, g, nv, 1),
    IN(warm, v, nv, 1),        INOUT(warm, contact, n, 1),
    IN(warm, start, nv1, 1),   IN(warm, item, n4, 1),
    SCRATCH(warm, all, nv, 1), OUT(warm, press, nv, 1),
    IN(warm, before, nv, 1),   FIELD_END};

/* Stage contacts' generator; both stages take the same input. */
void gen_contacts(struct bytes *b, struct contacts *s);

void gen_warm(struct bytes *b, struct warm *s)
{
    struct contacts c = {0};
    gen_contacts(b, &c);
    s->nv = c.nv;
    s->n = c.n;
    s->nv1 = c.nv1;
    s->n4 = c.n4;
    s->w = c.w;
    s->contact = c.contact;
    s->part = R(15.0) * (real)(1 << pick(b, 7));
    s->again = 2 / s->part;
    s->speed = R(0.01) * (real)pick(b, 9);
    vec *g = take(b, s->nv, sizeof *g);
    for (int64_t i = 0; i < s->nv; i++)
        g[i] = pick_vec(b, R(0.01));
    s->g = g;
    vec *before = take(b, s->nv, sizeof *before);
    bool first = pick(b, 2);
    for (int64_t i = 0; i < s->nv && !first; i++)
        before[i] = pick_vec(b, R(0.5));
    s->before = before;
    vec *v = take(b, s->nv, sizeof *v);
    bool still = pick(b, 2);
    for (int64_t i = 0; i < s->nv && !still; i++)
        v[i] = pick_vec(b, R(0.1));
    s->v = v;
    for (int64_t k = 0; k < s->n; k++)
        s->contact[k].held = pick(b, 4) > 0;
    int32_t *start = take(b, s->nv1, sizeof *start);
    int32_t *item = take(b, s->n4, sizeof *item);
    int32_t *vertex = take(b, s->n4, sizeof *vertex);
    struct incidence by = {s->nv, s->n, s->w,   s->contact,
                           start, item, vertex, 0};
    ref_incidence(&by);
    s->start = start;
    s->item = item;
}

/* §2: whether the impulse of contact k is at most what each of its free
 * vertices took up along n, less the impulse that stops the approach with which
 * the slice began. */
static bool spares(const struct warm *s, int64_t k, double unit)
{
    const struct contact *c = &s->contact[k];
    double speed = 0, give = 0, took = 0x1p60, sizes = 0;
    for (int j = 0; j < 4; j++) {
        int32_t i = c->v[j];
        double share = (double)c->c[j], w = (double)s->w[i];
        double size = (double)(vec_length(s->v[i]) + real_abs(s->v[i].x));
        speed += share * (double)vec_dot(c->n, s->v[i]);
        sizes += fabs(share) * size;
        if (!(w > 0) || share == 0)
            continue;
        double along = (double)vec_dot(c->n, s->g[i]) / share;
        give += share * share * w;
        /* the vertex's other contacts take their shares */
        took = fmin(took, along + 16 * unit * (double)vec_length(s->g[i]) /
                                      fabs(share));
    }
    if (!c->held || !(give > 0))
        return c->impulse == 0;
    double most = took + (fmin(speed, 0) + 16 * unit * sizes) / give;
    return (double)c->impulse <= fmax(most, 0) * (1 + 64 * unit) + 0x1p-60;
}

/* §1: whether all_i is the sum of |c| of the held contacts of vertex i: with a
 * larger sum the limits below would hold, and less be kept than there was. */
static bool shares(const struct warm *s, int64_t i, double unit)
{
    double sum = 0;
    int items = s->start[i + 1] - s->start[i];
    for (int32_t k = s->start[i]; k < s->start[i + 1]; k++) {
        const struct contact *c = &s->contact[s->item[k] / 4];
        sum += c->held ? fabs((double)c->c[s->item[k] % 4]) : 0;
    }
    return fabs((double)s->all[i] - sum) <= items * unit * sum;
}

const char *prop_warm(const struct warm *s)
{
    double total[3] = {0, 0, 0}, size = 0;
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    bool free_all = true;
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        double impulse = (double)c->impulse;
        EXPECT(impulse >= 0 && (c->held || impulse == 0)); /* no pull */
        EXPECT(spares(s, k, unit));
        for (int j = 0; j < 4; j++)
            free_all &= s->w[c->v[j]] > 0;
        size += (double)s->part * impulse;
    }
    /* §3: press comes from contacts alone, so the forces of two sides cancel.
     * Subnormal numbers have an absolute error. */
    size += (double)s->n * (REAL_BITS == 32 ? 0x1p-61 : 0x1p-509);
    for (int64_t i = 0; i < s->nv; i++) {
        vec f = s->press[i];
        double took = (double)vec_length(s->g[i]);
        EXPECT(shares(s, i, unit));
        double grown = (double)s->again * (double)vec_length(s->before[i]);
        int items = s->start[i + 1] - s->start[i];
        if (s->w[i] > 0)
            grown += (double)s->speed / (double)s->w[i];
        /* §2: the press of a vertex is bounded by the impulse that it took up,
         * and by twice the press before plus the push that moves it by a part
         * of the reach. Each term is rounded at most 16 times, and once in each
         * sum over a vertex's items; n is exact to a few units in the last
         * place. */
        double most = (double)s->part * fmin(took, grown);
        EXPECT((double)vec_length(f) <=
               most * (1 + (items + 16) * unit) + 0x1p-60);
        EXPECT(items || (f.x == 0 && f.y == 0 && f.z == 0));
        total[0] += (double)f.x;
        total[1] += (double)f.y;
        total[2] += (double)f.z;
    }
    for (int d = 0; d < 3 && free_all; d++)
        EXPECT(fabs(total[d]) <= 8 * ((double)s->n + 8) * unit * size);
    return NULL;
}

/* §5: makes four steps of a sheet on a slab. The last step starts with a press
 * of `force` N upwards on the middle of the sheet; with force 0 it starts
 * without press. */
static const char *press_once(real force, struct world **world,
                              struct arena *arena, drape_step_report *r)
{
    struct slab d;
    drape_error error;
    slab_make(&d, DRAPE_BW);
    d.cloth.width = d.cloth.height = 0.19;
    d.cloth.origin[0] = d.cloth.origin[2] = -0.095;
    d.cloth.origin[1] = 0.1039;
    d.obstacle.motion = -1;
    arena_init(arena, &d.def.allocator);
    EXPECT(world_make(&d.def, arena, world, &error) == DRAPE_OK);
    struct world *w = *world;
    for (int step = 0; step < 4; step++) {
        EXPECT(step == 0 || w->pressed > 0);
        if (step == 3 && force > 0)
            w->press[w->nc / 2].y = force;
        if (step == 3 && !(force > 0))
            w->pressed = 0;
        EXPECT(step_advance(w, r) == DRAPE_OK && r->contacts > 0);
        EXPECT(r->outcome == 0);
    }
    return NULL;
}

/* §5: a step whose motion diverges with its press has the same bits as a step
 * that starts without press. */
const char *test_world_cold(void)
{
    struct world *w[2];
    struct arena arena[2];
    drape_step_report r[2];
    const char *failed = press_once(0, &w[0], &arena[0], &r[0]);
    if (!failed)
        failed = press_once(R(1e9), &w[1], &arena[1], &r[1]);
    if (failed)
        return failed;
    size_t bytes = (size_t)w[0]->nc * sizeof(vec);
    EXPECT(r[1].work.tries == r[0].work.tries + 1);
    EXPECT(r[1].slices == r[0].slices);
    EXPECT(!memcmp(w[0]->x0, w[1]->x0, bytes));
    EXPECT(!memcmp(w[0]->v0, w[1]->v0, bytes));
    EXPECT(!memcmp(w[0]->press, w[1]->press, bytes));
    for (int k = 0; k < 2; k++)
        arena_free(&arena[k]);
    ran(1);
    return NULL;
}
