/* SPDX-License-Identifier: Apache-2.0 */
/* Properties: values at several sizes, their error and order of convergence,
 * and whether they meet their bars. spec/validation.md §1 */
#include "validate/validate.h"

#include <math.h>
#include <stdlib.h>

void *take(size_t count, size_t size)
{
    void *p = calloc(count + 1, size);
    if (!p) {
        fputs("validate: out of memory\n", stderr);
        exit(2);
    }
    return p;
}

void property_add(struct property *p, double size, double value)
{
    if (p->count == SIZES) {
        fprintf(stderr, "validate: %s: more than %d sizes\n", p->name, SIZES);
        exit(2);
    }
    p->size[p->count] = size;
    p->value[p->count++] = value;
}

/* The error of value k: from theory, or from the next coarser size. */
static double error_of(const struct property *p, int k)
{
    bool known = !isnan(p->theory);
    double from = known ? p->theory : k ? p->value[k - 1] : NAN;
    double error = fabs(p->value[k] - from);
    return p->share ? error / fabs(from) : error;
}

/* The largest error of the sizes for which the bar holds; NAN beyond all. */
static double worst(const struct property *p)
{
    double most = 0;
    for (int k = 0; k < p->count; k++) {
        bool judged = k == p->count - 1 || p->size[k] <= p->up_to * (1 + 1e-9);
        double error = error_of(p, k);
        if (judged && !(error <= most))
            most = error;
        if (judged && isnan(error))
            return NAN;
    }
    return p->count ? most : NAN;
}

/* The slope of the errors over the sizes, on logarithmic scales, by least
 * squares; NAN where fewer than two errors are above rounding. */
static double order(const struct property *p)
{
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (int k = 0; k < p->count; k++) {
        double error = error_of(p, k);
        double least = p->share ? 1e-9 : 1e-9 * fabs(p->value[k]);
        if (!(error > least))
            continue;
        double a = log(p->size[k]), b = log(error);
        n++;
        x += a;
        y += b;
        xx += a * a;
        xy += a * b;
    }
    return n > 1 ? (n * xy - x * y) / (n * xx - x * x) : NAN;
}

static void number(FILE *out, double value)
{
    if (isnan(value))
        fputc(',', out);
    else
        fprintf(out, "%.6g,", value);
}

void property_end(struct validate *v, const struct property *p)
{
    const char *backend = v->backend == DRAPE_GPU ? "gpu" : "ref";
    for (int k = 0; k < p->count; k++) {
        fprintf(v->values, "%s,%s,%s,%d,", p->part, p->name, backend, v->bits);
        number(v->values, p->size[k]);
        number(v->values, p->value[k]);
        number(v->values, p->theory);
        fprintf(v->values, "%s\n", p->unit);
    }
    double error = worst(p);
    bool judged = !isnan(p->bar), good = error <= p->bar;
    const char *result = !judged ? "shown" : good ? "met" : "MISSED";
    fprintf(v->properties, "%s,%s,%s,%d,%s,", p->part, p->name, backend,
            v->bits, p->unit);
    number(v->properties, p->theory);
    for (int k = 0; k < SIZES; k++)
        number(v->properties, k < p->count ? p->size[k] : NAN);
    for (int k = 0; k < SIZES; k++)
        number(v->properties, k < p->count ? p->value[k] : NAN);
    number(v->properties, error);
    number(v->properties, order(p));
    number(v->properties, p->bar);
    fprintf(v->properties, "%s,%s\n", p->promised ? "yes" : "no", result);
    fflush(v->properties);
    fflush(v->values);
    if (judged && !good)
        printf("%s %s, %s, %d bits: error %.3g, bar %.3g\n",
               p->promised ? "FAILED" : "known", p->part, p->name, v->bits,
               error, p->bar);
    if (judged && p->promised)
        ++*(good ? &v->passed : &v->failed);
    else if (judged && !good)
        v->known++;
}
