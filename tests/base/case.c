/* SPDX-License-Identifier: Apache-2.0 */
/* Runs one case of one stage; see tests/base/case.h. */
#include "tests/base/case.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { GUARD = 64, FIELDS = 64 };

struct buffer {
    uint8_t *memory; /* guard, stream, guard; NULL: an input, which the
                        generator owns */
    uint8_t *data;
    size_t size;
    uint8_t *before; /* the stream as it was generated, for IN and INOUT */
};

struct run {
    const struct stage *stage;
    uint8_t *s; /* struct X */
    struct buffer buffer[FIELDS];
};

static int64_t count_of(const struct run *r, const struct field *f)
{
    int64_t n = f->fixed;
    if (f->count_at >= 0)
        memcpy(&n, r->s + f->count_at, sizeof n);
    return n;
}

static uint8_t **pointer_of(struct run *r, const struct field *f)
{
    return (uint8_t **)(void *)(r->s + f->at);
}

static bool is_value(const struct field *f)
{
    return f->element == 0;
}

/* The bytes of a stream that hold results: all, or as many items as the stage's
 * member `used` counts. */
static size_t used_bytes(const struct run *r, const struct field *f, size_t all)
{
    int64_t used;
    if (f->used_at < 0)
        return all;
    memcpy(&used, r->s + f->used_at, sizeof used);
    size_t size = (size_t)used * (size_t)f->per * f->element;
    return size < all ? size : all;
}

static void allocate(struct run *r, uint8_t poison)
{
    for (int k = 0; r->stage->fields[k].name; k++) {
        const struct field *f = &r->stage->fields[k];
        struct buffer *u = &r->buffer[k];
        if (is_value(f))
            continue;
        u->size = (size_t)count_of(r, f) * (size_t)f->per * f->element;
        if (f->kind == FIELD_IN) {
            u->data = *pointer_of(r, f);
        } else {
            u->memory = malloc(u->size + 2 * GUARD);
            if (!u->memory)
                abort();
            memset(u->memory, poison, u->size + 2 * GUARD);
            u->data = u->memory + GUARD;
        }
        if (f->kind == FIELD_INOUT && u->size)
            memcpy(u->data, *pointer_of(r, f), u->size);
        *pointer_of(r, f) = u->data;
    }
}

static void release(struct run *r)
{
    for (int k = 0; r->stage->fields[k].name; k++)
        free(r->buffer[k].memory);
}

static bool guards_hold(const struct run *r, uint8_t poison)
{
    for (int k = 0; r->stage->fields[k].name; k++) {
        const struct buffer *u = &r->buffer[k];
        for (int g = 0; u->memory && g < GUARD; g++)
            if (u->memory[g] != poison ||
                u->memory[GUARD + u->size + (size_t)g] != poison)
                return false;
    }
    return true;
}

static uint64_t hash_inputs(const struct run *r)
{
    uint64_t hash = HASH_START;
    for (int k = 0; r->stage->fields[k].name; k++)
        if (r->stage->fields[k].kind == FIELD_IN &&
            !is_value(&r->stage->fields[k]))
            hash = hash_bytes(hash, r->buffer[k].data, r->buffer[k].size);
    return hash;
}

static uint64_t hash_outputs(struct run *r, int status)
{
    uint64_t hash = hash_bytes(HASH_START, &status, sizeof status);
    for (int k = 0; r->stage->fields[k].name && status == DRAPE_OK; k++) {
        const struct field *f = &r->stage->fields[k];
        if (is_value(f))
            hash = hash_bytes(hash, r->s + f->at, (size_t)f->per);
        else if (f->kind == FIELD_OUT || f->kind == FIELD_INOUT)
            hash = hash_bytes(hash, r->buffer[k].data,
                              used_bytes(r, f, r->buffer[k].size));
    }
    return hash;
}

/* Plants the fault in the first stream that can have it. Returns false if there
 * is no such stream. */
static bool plant(struct run *r, enum fault fault, uint8_t poison)
{
    for (int k = 0; r->stage->fields[k].name; k++) {
        const struct field *f = &r->stage->fields[k];
        struct buffer *u = &r->buffer[k];
        size_t used = used_bytes(r, f, u->size);
        if (is_value(f) || !used ||
            (f->kind == FIELD_IN) != (fault == FAULT_INPUT) ||
            f->kind == FIELD_SCRATCH)
            continue;
        if (fault == FAULT_FLIP)
            u->data[used / 2] ^= (uint8_t)(poison & 1 ? 4 : 0);
        else if (fault == FAULT_MISS)
            memset(u->data + used - f->element, poison, f->element);
        else if (fault == FAULT_OVERRUN)
            u->data[u->size] ^= 1;
        else if (fault == FAULT_UNDERRUN)
            u->data[-1] ^= 1;
        else
            u->data[used / 2] ^= 1;
        return true;
    }
    return false;
}

static struct case_result run_once(const struct stage *stage, const uint8_t *s,
                                   uint8_t poison, enum fault fault, bool prop)
{
    struct case_result c = {0};
    struct run r = {.stage = stage};
    r.s = malloc(stage->size);
    if (!r.s)
        abort();
    memcpy(r.s, s, stage->size);
    allocate(&r, poison);
    uint64_t inputs = hash_inputs(&r);
    c.status = stage->ref(r.s);
    if (fault != FAULT_NONE && c.status == DRAPE_OK)
        c.faulted = plant(&r, fault, poison);
    if (!guards_hold(&r, poison))
        c.failed = "a guard beside an output or scratch was overwritten";
    else if (hash_inputs(&r) != inputs)
        c.failed = "an input was changed";
    if (c.faulted && fault == FAULT_INPUT)
        plant(&r, fault, poison); /* a second flip restores the input */
    c.hash = hash_outputs(&r, c.status);
    if (!c.failed && c.status == DRAPE_OK && prop)
        c.failed = stage->prop(r.s);
    release(&r);
    free(r.s);
    return c;
}

struct case_result case_run(const struct stage *stage, struct bytes *b,
                            enum fault fault, bool prop)
{
    uint8_t *s = calloc(1, stage->size);
    if (!s)
        abort();
    stage->gen(b, s);
    /* The properties are not checked in the second run, since its outputs must
     * be equal to those of the first. */
    struct case_result a = run_once(stage, s, 0x55, fault, prop);
    struct case_result z = run_once(stage, s, 0xaa, fault, false);
    if (!a.failed)
        a.failed = z.failed;
    if (!a.failed && a.hash != z.hash)
        a.failed = "outputs depend on what was in their memory before";
    free(s);
    return a;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double case_bench(const struct stage *stage, int64_t *bytes)
{
    enum { REPEATS = 9 };
    double seconds[REPEATS], all = 0;
    int n = 0;
    struct bytes b = {.seed = 1, .size = -1, .bench = true};
    uint8_t *s = calloc(1, stage->size);
    if (!s)
        abort();
    stage->gen(&b, s);
    for (; n < REPEATS && all < 2; n++) { /* 2 s: a long stage runs once */
        struct run r = {.stage = stage};
        r.s = malloc(stage->size);
        if (!r.s)
            abort();
        memcpy(r.s, s, stage->size);
        allocate(&r, 0);
        double start = now();
        stage->ref(r.s);
        seconds[n] = now() - start;
        all += seconds[n];
        *bytes = 0;
        for (int f = 0; stage->fields[f].name; f++)
            *bytes += (int64_t)r.buffer[f].size;
        release(&r);
        free(r.s);
    }
    qsort(seconds, (size_t)n, sizeof *seconds, ascending);
    choices_free(&b);
    free(s);
    return seconds[n / 2];
}
