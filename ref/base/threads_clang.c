/* SPDX-License-Identifier: Apache-2.0 */
/* The functions that clang calls for the parallel loops of ref/, with the
 * interface of LLVM's OpenMP library; they run on the pool of
 * ref/base/threads.c. ref/base/threads.syms renames clang's calls. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include "ref/base/threads.h"

typedef void micro(int32_t *, int32_t *, ...);

/* A loop: the function of one part, and the addresses of the variables that the
 * parts share. */
enum { SHARED = 16 };
struct call {
    micro *run;
    int n;
    void *at[SHARED];
};

/* where: the place in the source, for messages; thread: the result of
 * threads_global. Neither is used here. */
void threads_fork(void *where, int32_t n, micro *run, ...);
int32_t threads_global(void *where);
void threads_serialized(void *where, int32_t thread);
void threads_end_serialized(void *where, int32_t thread);
void threads_fini(void *where, int32_t thread);
int32_t threads_reduce(void *where, int32_t thread, int32_t n, size_t size,
                       void *data, void reduce(void *, void *), void *lock);
void threads_end_reduce(void *where, int32_t thread, void *lock);

#define TYPES_1 void *
#define TYPES_2 TYPES_1, void *
#define TYPES_3 TYPES_2, void *
#define TYPES_4 TYPES_3, void *
#define TYPES_5 TYPES_4, void *
#define TYPES_6 TYPES_5, void *
#define TYPES_7 TYPES_6, void *
#define TYPES_8 TYPES_7, void *
#define TYPES_9 TYPES_8, void *
#define TYPES_10 TYPES_9, void *
#define TYPES_11 TYPES_10, void *
#define TYPES_12 TYPES_11, void *
#define TYPES_13 TYPES_12, void *
#define TYPES_14 TYPES_13, void *
#define TYPES_15 TYPES_14, void *
#define TYPES_16 TYPES_15, void *
#define AT_1 a[0]
#define AT_2 AT_1, a[1]
#define AT_3 AT_2, a[2]
#define AT_4 AT_3, a[3]
#define AT_5 AT_4, a[4]
#define AT_6 AT_5, a[5]
#define AT_7 AT_6, a[6]
#define AT_8 AT_7, a[7]
#define AT_9 AT_8, a[8]
#define AT_10 AT_9, a[9]
#define AT_11 AT_10, a[10]
#define AT_12 AT_11, a[11]
#define AT_13 AT_12, a[12]
#define AT_14 AT_13, a[13]
#define AT_15 AT_14, a[14]
#define AT_16 AT_15, a[15]
#define CALL(n)                                                                \
    case n:                                                                    \
        ((void (*)(int32_t *, int32_t *, TYPES_##n))c->run)(&k, &zero,         \
                                                            AT_##n);           \
        break

static void call_part(void *data)
{
    struct call *c = data;
    void **a = c->at;
    int32_t k = threads_number(), zero = 0;
    switch (c->n) {
        CALL(1);
        CALL(2);
        CALL(3);
        CALL(4);
        CALL(5);
        CALL(6);
        CALL(7);
        CALL(8);
        CALL(9);
        CALL(10);
        CALL(11);
        CALL(12);
        CALL(13);
        CALL(14);
        CALL(15);
        CALL(16);
    default: /* no loop of ref/ shares more variables; such a loop would not
                run at all, which every test of it shows */
        break;
    }
}

void threads_fork(void *where, int32_t n, micro *run, ...)
{
    struct call c = {run, n, {NULL}};
    va_list args;
    (void)where;
    va_start(args, run);
    for (int k = 0; k < n && k < SHARED; k++)
        c.at[k] = va_arg(args, void *);
    va_end(args);
    threads_parallel(call_part, &c, 0, 0);
}

int32_t threads_global(void *where)
{
    (void)where;
    return threads_number();
}

void threads_serialized(void *where, int32_t thread)
{
    (void)where;
    (void)thread;
    threads_serial(1);
}

void threads_end_serialized(void *where, int32_t thread)
{
    (void)where;
    (void)thread;
    threads_serial(-1);
}

/* Narrows the iterations lower … upper, both included, to those of this
 * thread's part. `kind` is always the static schedule with one run of
 * iterations a part, the only schedule in ref/. */
#define STATIC_INIT(name, type)                                                \
    void name(void *where, int32_t thread, int32_t kind, int32_t *last,        \
              type *lower, type *upper, type *stride, type by, type chunk);    \
    void name(void *where, int32_t thread, int32_t kind, int32_t *last,        \
              type *lower, type *upper, type *stride, type by, type chunk)     \
    {                                                                          \
        type n = (type)threads_count(), k = (type)threads_number();            \
        type items = (type)((*upper - *lower) / by + 1);                       \
        type each = items / n, more = items % n;                               \
        type begin = (type)(k * each + (k < more ? k : more));                 \
        (void)where;                                                           \
        (void)thread;                                                          \
        (void)kind;                                                            \
        (void)chunk;                                                           \
        *last = k == n - 1;                                                    \
        *stride = items;                                                       \
        *lower = (type)(*lower + begin * by);                                  \
        *upper = (type)(*lower + (each + (k < more)) * by - by);               \
    }

STATIC_INIT(threads_init_4, int32_t)
STATIC_INIT(threads_init_4u, uint32_t)
STATIC_INIT(threads_init_8, int64_t)
STATIC_INIT(threads_init_8u, uint64_t)

void threads_fini(void *where, int32_t thread)
{
    (void)where;
    (void)thread;
}

/* A reduction. The parts add their sums to the shared sum one after the other,
 * under a lock: the result 1 tells the caller to add, then to call
 * threads_end_reduce. */
static pthread_mutex_t adding = PTHREAD_MUTEX_INITIALIZER;

int32_t threads_reduce(void *where, int32_t thread, int32_t n, size_t size,
                       void *data, void reduce(void *, void *), void *lock)
{
    (void)where;
    (void)thread;
    (void)n;
    (void)size;
    (void)data;
    (void)reduce;
    (void)lock;
    pthread_mutex_lock(&adding);
    return 1;
}

void threads_end_reduce(void *where, int32_t thread, void *lock)
{
    (void)where;
    (void)thread;
    (void)lock;
    pthread_mutex_unlock(&adding);
}
