/* SPDX-License-Identifier: Apache-2.0 */
/* The stream of choices that every generator reads. A choice is a word of 32
 * bits, so a failed case can be saved as a file of words. */
#include "tests/base/choices.h"

#include <stdio.h>
#include <stdlib.h>

static void *must(void *p)
{
    if (!p) {
        fprintf(stderr, "check: out of memory\n");
        exit(3);
    }
    return p;
}

/* SplitMix64 (Steele, Lea, Flood 2014). */
static uint64_t next_random(uint64_t *state)
{
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static uint32_t note(struct bytes *b, uint32_t word)
{
    if (b->bench)
        return word;
    if (b->n_record == b->cap_record) {
        b->cap_record = b->cap_record ? 2 * b->cap_record : 1024;
        b->record = must(realloc(b->record, b->cap_record * sizeof *b->record));
    }
    b->record[b->n_record++] = word;
    return word;
}

uint32_t choose(struct bytes *b)
{
    if (!b->data)
        return note(b, (uint32_t)(next_random(&b->seed) >> 32));
    return note(b, b->at < b->n_data ? b->data[b->at++] : 0);
}

uint32_t pick(struct bytes *b, uint32_t n)
{
    return choose(b) % n;
}

int64_t pick_size(struct bytes *b)
{
    if (b->size >= 0)
        return note(b, (uint32_t)b->size);
    return choose(b) % 1025;
}

void pick_four(struct bytes *b, int64_t n, int32_t four[4])
{
    for (int j = 0; j < 4; j++)
        four[j] = (int32_t)pick(b, (uint32_t)n);
}

void *take(struct bytes *b, int64_t count, size_t size)
{
    if (b->n_taken == b->cap_taken) {
        b->cap_taken = b->cap_taken ? 2 * b->cap_taken : 16;
        b->taken = must(realloc(b->taken, b->cap_taken * sizeof *b->taken));
    }
    void *p = must(calloc((size_t)count + 1, size ? size : 1));
    b->taken[b->n_taken++] = p;
    return p;
}

bool for_bench(const struct bytes *b)
{
    return b->bench;
}

void choices_free(struct bytes *b)
{
    for (size_t i = 0; i < b->n_taken; i++)
        free(b->taken[i]);
    free(b->taken);
    free(b->record);
}
