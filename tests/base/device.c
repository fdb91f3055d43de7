/* SPDX-License-Identifier: Apache-2.0 */
/* Runs one case of one stage on the device; see tests/base/device.h. */
#include "tests/base/device.h"

#include <stdio.h>
#include <stdlib.h>

enum { GUARD = 256, FIELDS = 64 };

/* The streams of one run, of the reference or of the device. */
struct streams {
    const struct stage *stage;
    struct gpu *g;     /* NULL: the reference, in memory of the host */
    uint8_t *s;        /* struct X */
    uint8_t *slab;     /* guard, stream, guard, stream, … guard */
    size_t bytes;      /* of the slab */
    size_t at[FIELDS]; /* offset of each stream in the slab */
    size_t size[FIELDS];
};

static void *must(void *p)
{
    if (!p) {
        fputs("check: out of memory\n", stderr);
        exit(3);
    }
    return p;
}

static size_t padded(size_t bytes)
{
    return (bytes + GUARD - 1) / GUARD * GUARD + GUARD;
}

static uint8_t **pointer_of(uint8_t *s, const struct field *f)
{
    return (uint8_t **)(void *)(s + f->at);
}

static bool is_stream(const struct field *f)
{
    return f->element != 0;
}

/* Lays out the streams of a generated struct in one slab. Returns the slab's
 * contents: poison, with the inputs in place. */
static uint8_t *fill(struct streams *r, const uint8_t *from, uint8_t poison)
{
    r->s = must(malloc(r->stage->size));
    memcpy(r->s, from, r->stage->size);
    size_t at = GUARD;
    for (int k = 0; r->stage->fields[k].name; k++) {
        const struct field *f = &r->stage->fields[k];
        int64_t n = f->fixed;
        if (!is_stream(f))
            continue;
        if (f->count_at >= 0)
            memcpy(&n, r->s + f->count_at, sizeof n);
        r->size[k] = (size_t)n * (size_t)f->per * f->element;
        r->at[k] = at;
        at += padded(r->size[k]);
    }
    r->bytes = at;
    uint8_t *image = must(malloc(at));
    memset(image, poison, at);
    for (int k = 0; r->stage->fields[k].name; k++) {
        const struct field *f = &r->stage->fields[k];
        bool in = f->kind == FIELD_IN || f->kind == FIELD_INOUT;
        if (is_stream(f) && in && r->size[k])
            memcpy(image + r->at[k], *pointer_of(r->s, f), r->size[k]);
    }
    return image;
}

/* Allocates the slab, copies the contents into it, and sets the pointers of
 * s. */
static void place(struct streams *r, const uint8_t *image)
{
    r->slab = r->g ? gpu_take(r->g, ARENA_OTHER, (int64_t)r->bytes, 1)
                   : malloc(r->bytes);
    must(r->slab);
    if (r->g)
        gpu_up(r->g, r->slab, image, r->bytes);
    else
        memcpy(r->slab, image, r->bytes);
    for (int k = 0; r->stage->fields[k].name; k++)
        if (is_stream(&r->stage->fields[k]))
            *pointer_of(r->s, &r->stage->fields[k]) = r->slab + r->at[k];
}

static void release(struct streams *r)
{
    if (r->g)
        gpu_give(r->g, r->slab);
    else
        free(r->slab);
    free(r->s);
}

static size_t used_bytes(const struct streams *r, int k)
{
    const struct field *f = &r->stage->fields[k];
    int64_t used;
    if (f->used_at < 0)
        return r->size[k];
    memcpy(&used, r->s + f->used_at, sizeof used);
    size_t size = (size_t)used * (size_t)f->per * f->element;
    return size < r->size[k] ? size : r->size[k];
}

static bool same_words(const struct stage *stage, const uint8_t *a,
                       const uint8_t *b, size_t bytes)
{
    bool wide = stage->bits == 64;
    size_t word = wide ? sizeof(double) : sizeof(float);
    for (size_t k = 0; k + word <= bytes; k += word) {
        float x[2];
        double y[2];
        if (!memcmp(a + k, b + k, word))
            continue;
        memcpy(wide ? (void *)&y[0] : (void *)&x[0], a + k, word);
        memcpy(wide ? (void *)&y[1] : (void *)&x[1], b + k, word);
        if (wide ? y[0] == y[0] || y[1] == y[1] : x[0] == x[0] || x[1] == x[1])
            return false;
    }
    return true;
}

static bool same(const struct stage *stage, const struct field *f,
                 const uint8_t *a, const uint8_t *b, size_t bytes)
{
    if (!bytes || !memcmp(a, b, bytes))
        return true;
    return f->reals && same_words(stage, a, b, bytes);
}

/* Compares outputs. Returns a text that names the first output that differs, or
 * NULL. image: a copy of the device's slab after the run. */
static const char *differs(const struct streams *ref, const struct streams *dev,
                           const uint8_t *image)
{
    static char text[128];
    for (int k = 0; ref->stage->fields[k].name; k++) {
        const struct field *f = &ref->stage->fields[k];
        bool equal = true;
        if (!is_stream(f))
            equal = same(ref->stage, f, ref->s + f->at, dev->s + f->at,
                         (size_t)f->per);
        else if (f->kind == FIELD_OUT || f->kind == FIELD_INOUT)
            equal = used_bytes(ref, k) == used_bytes(dev, k) &&
                    same(ref->stage, f, ref->slab + ref->at[k],
                         image + dev->at[k], used_bytes(ref, k));
        if (equal)
            continue;
        snprintf(text, sizeof text, "the device's %s differs", f->name);
        return text;
    }
    return NULL;
}

/* Checks that inputs and guards in the device's slab are as they were sent.
 * Overwrites the other streams of image. Returns NULL if so. */
static const char *disturbed(const struct streams *dev, const uint8_t *sent,
                             uint8_t *image)
{
    for (int k = 0; dev->stage->fields[k].name; k++) {
        const struct field *f = &dev->stage->fields[k];
        size_t at = dev->at[k];
        if (is_stream(f) && f->kind != FIELD_IN && dev->size[k])
            memcpy(image + at, sent + at, dev->size[k]);
    }
    return memcmp(image, sent, dev->bytes)
               ? "the device changed an input or wrote beside a stream"
               : NULL;
}

static const char *run_device(const struct streams *ref, int want,
                              struct gpu *g, const uint8_t *s, uint8_t poison)
{
    struct streams dev = {.stage = ref->stage, .g = g};
    uint8_t *sent = fill(&dev, s, poison), *back = must(malloc(dev.bytes));
    place(&dev, sent);
    int status = dev.stage->gpu(g, dev.s);
    const char *failed = NULL;
    gpu_down(g, back, dev.slab, dev.bytes);
    if (status != want)
        failed = "the device's status differs";
    if (!failed && status == DRAPE_OK)
        failed = differs(ref, &dev, back);
    if (!failed)
        failed = disturbed(&dev, sent, back);
    release(&dev);
    free(sent);
    free(back);
    return failed;
}

/* How one run on the device differs from others. */
struct device_run {
    int block;
    uint8_t poison;
    struct gpu_way way;
};

/* Whether the struct still points to memory of the generator. Such a pointer
 * has no row in the stage's fields, so it points to memory of the host, which
 * only a real device would notice. */
static bool unlisted(const struct streams *r, const struct bytes *b)
{
    for (size_t at = 0; at + sizeof(void *) <= r->stage->size;
         at += sizeof(void *))
        for (size_t k = 0; k < b->n_taken; k++)
            if (!memcmp(r->s + at, &b->taken[k], sizeof(void *)))
                return true;
    return false;
}

/* Whether the count of field f is a capacity: the stage may write fewer
 * items. */
static bool has_room(const struct stage *stage, const struct field *f)
{
    bool room = is_stream(f) && f->used_at >= 0;
    for (const struct field *e = stage->fields; e->name; e++)
        room &= !is_stream(e) || e->count_at != f->count_at || e->used_at >= 0;
    return room;
}

/* Runs both sides with a capacity that is exact, and with one that is too small
 * by 1: both sides must return the same status and the same results, and must
 * write nothing beside the outputs. s: as generated; ref: after its run. */
static const char *compare_rooms(const struct streams *ref, struct gpu *g,
                                 const uint8_t *s)
{
    const struct stage *stage = ref->stage;
    const char *failed = NULL;
    for (int k = 0; stage->fields[k].name && !failed; k++) {
        const struct field *f = &stage->fields[k];
        bool again = k > 0 && f->count_at == f[-1].count_at;
        int64_t used = 0;
        if (again || !has_room(stage, f))
            continue;
        memcpy(&used, ref->s + f->used_at, sizeof used);
        for (int64_t room = used - (used > 0); room <= used && !failed;
             room++) {
            struct streams own = {.stage = stage};
            uint8_t *less = must(malloc(stage->size));
            memcpy(less, s, stage->size);
            memcpy(less + f->count_at, &room, sizeof room);
            uint8_t *image = fill(&own, less, 0x55);
            place(&own, image);
            int status = stage->ref(own.s);
            failed = run_device(&own, status, g, less, 0x55);
            release(&own);
            free(image);
            free(less);
        }
    }
    return failed;
}

static struct case_result compare(const struct stage *stage, struct bytes *b,
                                  struct gpu *g, const struct device_run *run,
                                  int runs)
{
    struct case_result c = {0};
    uint8_t *s = must(calloc(1, stage->size));
    stage->gen(b, s);
    struct streams ref = {.stage = stage};
    uint8_t *image = fill(&ref, s, 0x55);
    place(&ref, image);
    if (unlisted(&ref, b))
        c.failed = "a pointer of its struct has no row in its fields";
    c.status = stage->ref(ref.s);
    for (int k = 0; k < runs && !c.failed; k++) {
        gpu_set_block(g, run[k].block);
        gpu_set_way(g, run[k].way);
        c.failed = run_device(&ref, c.status, g, s, run[k].poison);
    }
    gpu_set_way(g, (struct gpu_way){0});
    if (!c.failed && c.status == DRAPE_OK && gpu_device(g) < 0)
        c.failed = compare_rooms(&ref, g, s);
    release(&ref);
    free(image);
    free(s);
    return c;
}

struct case_result device_case(const struct stage *stage, struct bytes *b,
                               struct gpu *g)
{
    static const struct device_run run[3] = {
        {256, 0x55, {0}},
        {96, 0xaa, {.hosted = true, .descending = true}},
        {32, 0x33, {.shuffled = 5}}};
    return compare(stage, b, g, run, gpu_device(g) < 0 ? 3 : 2);
}

bool device_differs(const struct stage *stage, struct bytes *b, struct gpu *g,
                    struct gpu_way way)
{
    struct device_run run = {256, 0x55, way};
    return compare(stage, b, g, &run, 1).failed != NULL;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double device_bench(const struct stage *stage, struct gpu *g, int64_t *bytes)
{
    enum { REPEATS = 31 };
    double seconds[REPEATS];
    struct bytes b = {.seed = 1, .size = -1, .bench = true};
    uint8_t *s = must(calloc(1, stage->size));
    stage->gen(&b, s);
    struct streams dev = {.stage = stage, .g = g};
    uint8_t *image = fill(&dev, s, 0);
    place(&dev, image);
    uint8_t *again = must(malloc(stage->size));
    memcpy(again, dev.s, stage->size);
    gpu_set_block(g, 256);
    for (int k = 0; k < REPEATS; k++) {
        gpu_up(g, dev.slab, image, dev.bytes);
        memcpy(dev.s, again, stage->size);
        gpu_clock_start(g);
        stage->gpu(g, dev.s);
        seconds[k] = gpu_clock_stop(g);
    }
    *bytes = 0;
    for (int k = 0; stage->fields[k].name; k++)
        *bytes += (int64_t)dev.size[k];
    release(&dev);
    free(image);
    free(again);
    free(s);
    choices_free(&b);
    qsort(seconds, REPEATS, sizeof *seconds, ascending);
    return seconds[REPEATS / 2];
}
