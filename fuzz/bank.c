/* SPDX-License-Identifier: Apache-2.0 */
/* Implements exact-size memory, the checking allocator and byte buffers. See
 * fuzz/bank.h. */
#include "fuzz/bank.h"

#include <stdlib.h>
#include <string.h>

static void *must(void *p)
{
    if (!p)
        abort();
    return p;
}

void *shelf_take(struct shelf *s, size_t count, size_t size)
{
    if (s->n == 64)
        abort();
    void *p = must(calloc(count ? count : 1, size));
    s->p[s->n++] = p;
    return p;
}

void shelf_free(struct shelf *s)
{
    while (s->n)
        free(s->p[--s->n]);
}

/* The header before each block. Device memory is aligned to 256 bytes. A block
 * ends where its memory ends, so that a sanitizer sees reads beyond it. */
struct stub {
    size_t bytes;
    uint64_t mark;
};
enum { STUB = 256, MARK = 0x6b6e6162 };

static void *bank_give(void *user, size_t bytes)
{
    struct bank *bank = user;
    int64_t call = bank->calls++;
    if (call >= bank->from && call - bank->from < bank->times)
        return NULL;
    if (bytes > bank->most - bank->held)
        return NULL;
    void *p = NULL;
    if (posix_memalign(&p, STUB, STUB + bytes) != 0)
        abort();
    uint8_t *at = (uint8_t *)p + STUB;
    memset(p, 0xa5, STUB + bytes);
    memcpy(at - sizeof(struct stub), &(struct stub){bytes, MARK},
           sizeof(struct stub));
    bank->held += bytes;
    bank->blocks++;
    return at;
}

static void bank_take(void *user, void *p, size_t bytes)
{
    struct bank *bank = user;
    struct stub stub;
    uint8_t *at = p;
    memcpy(&stub, at - sizeof stub, sizeof stub);
    bank->wrong |= stub.bytes != bytes || stub.mark != MARK;
    if (bank->wrong)
        return;
    bank->held -= bytes;
    bank->blocks--;
    free(at - STUB);
}

void bank_open(struct bank *bank, size_t most)
{
    *bank = (struct bank){.most = most, .from = INT64_MAX};
}

drape_allocator bank_of(struct bank *bank)
{
    return (drape_allocator){bank_give, bank_take, bank};
}

int tape_write(void *user, const void *data, size_t bytes)
{
    struct tape *t = user;
    if (t->left >= 0 && t->left-- == 0)
        return 1;
    if (t->size + bytes > t->room) {
        t->room = 2 * (t->size + bytes);
        t->data = must(realloc(t->data, t->room));
    }
    if (bytes)
        memcpy(t->data + t->size, data, bytes);
    t->size += bytes;
    return 0;
}

int tape_read(void *user, void *data, size_t bytes)
{
    struct tape *t = user;
    if ((t->left >= 0 && t->left-- == 0) || bytes > t->size - t->at)
        return 1;
    if (bytes)
        memcpy(data, t->data + t->at, bytes);
    t->at += bytes;
    return 0;
}

bool tape_save(struct tape *tape, const drape_world *world)
{
    tape->size = tape->at = 0;
    tape->left = -1;
    return drape_save(world, tape_write, tape) == DRAPE_OK;
}

bool tape_same(const struct tape *a, const struct tape *b)
{
    return a->size == b->size && a->size &&
           memcmp(a->data, b->data, a->size) == 0;
}
