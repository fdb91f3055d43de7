/* SPDX-License-Identifier: Apache-2.0 */
/* Stage penalty: generator and properties. spec/38_penalty.md */
#include "ref/penalty.h"

#include "ref/contacts.h"
#include "tests/harness.h"

const struct field fields_penalty[] = {IN(penalty, w, nv, 1),
                                       IN(penalty, u, nv, 1),
                                       INOUT(penalty, contact, n, 1),
                                       SCRATCH(penalty, start, nv1, 1),
                                       SCRATCH(penalty, item, n4, 1),
                                       SCRATCH(penalty, vertex, n4, 1),
                                       SCRATCH(penalty, slide, n, 1),
                                       SCRATCH(penalty, share, n, 1),
                                       OUT(penalty, force, nv, 1),
                                       OUT(penalty, hold, nv, 1),
                                       FIELD_END};

/* The same contacts as the stage that solves them otherwise. */
void gen_contacts(struct bytes *b, struct contacts *s);

void gen_penalty(struct bytes *b, struct penalty *s)
{
    struct contacts c = {0};
    gen_contacts(b, &c);
    s->nv = c.nv;
    s->n = c.n;
    s->nv1 = c.nv1;
    s->n4 = c.n4;
    s->w = c.w;
    s->u = c.u;
    s->contact = c.contact;
    s->stiffness = R(100.0) * (real)(1 + pick(b, 8));
    s->dt = R(1.0) / (real)(30 << pick(b, 5));
    s->tau = pick(b, 2) ? s->dt : s->dt * R(2.0) / 3;
    s->slip = R(0.001) * (real)(1 + pick(b, 5));
}

static double dot(vec a, vec b)
{
    return (double)a.x * (double)b.x + (double)a.y * (double)b.y +
           (double)a.z * (double)b.z;
}

/* §3: Σ a·hold·a over free vertices against the contacts' own matrix, for
 * one made-up vector a; *size scales the roundings of both. */
static double slack(const struct penalty *s, double *size)
{
    double own = 0, hold = 0;
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        double sum[3] = {0, 0, 0};
        for (int j = 0; j < 4; j++) {
            int32_t i = c->v[j];
            double a[3] = {1 + i % 3, 1 - i % 5, 2 - i % 7};
            for (int d = 0; d < 3 && s->w[i] > 0; d++)
                sum[d] += (double)c->c[j] * a[d];
        }
        double n[3] = {(double)c->n.x, (double)c->n.y, (double)c->n.z};
        double along = sum[0] * n[0] + sum[1] * n[1] + sum[2] * n[2];
        double all = sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2];
        double normal = (double)(s->stiffness * s->tau * s->tau);
        own += (c->impulse > 0 ? normal : 0) * along * along;
        own += (double)(s->slide[k] * s->tau / s->dt) * (all - along * along);
    }
    for (int64_t i = 0; i < s->nv; i++) {
        vec a =
            vec_make((real)(1 + i % 3), (real)(1 - i % 5), (real)(2 - i % 7));
        hold += dot(a, sym_apply(s->hold[i], a));
    }
    *size = hold;
    return hold - own;
}

const char *prop_penalty(const struct penalty *s)
{
    double total[3] = {0, 0, 0}, size = 0;
    bool free_all = true;
    for (int64_t k = 0; k < s->n; k++) {
        const struct contact *c = &s->contact[k];
        real length = vec_length(c->tangent);
        /* §1, §2: it pushes, within the cone; 8 roundings */
        EXPECT(c->impulse >= 0);
        EXPECT(length <= c->friction * c->impulse * (1 + R(0x1p-20)));
        for (int j = 0; j < 4; j++)
            free_all &= s->w[c->v[j]] > 0;
        size += (double)(c->impulse + length);
    }
    for (int64_t i = 0; i < s->nv; i++) {
        vec f = s->force[i];
        EXPECT(s->w[i] > 0 || (f.x == 0 && f.y == 0 && f.z == 0));
        total[0] += (double)f.x;
        total[1] += (double)f.y;
        total[2] += (double)f.z;
    }
    /* Weights sum to 0: what a contact gives one side it takes from the
     * other. At most n + 8 roundings touch each term. */
    double unit = REAL_BITS == 32 ? 0x1p-24 : 0x1p-53;
    double bound = 8 * ((double)s->n + 8) * unit * size;
    for (int d = 0; d < 3 && free_all; d++)
        EXPECT(fabs(total[d]) <= bound);
    double most, left = slack(s, &most);
    EXPECT(left >= -16 * ((double)s->n + 8) * unit * most);
    return NULL;
}
