/* SPDX-License-Identifier: Apache-2.0 */
/* DLPack: a world's arrays for other libraries, without a copy. The two structs
 * are those of dlpack.h, version 1.0 (github.com/dmlc/dlpack, Apache-2.0). */
#define Py_LIMITED_API 0x030A0000
#include <Python.h>
/* Python.h comes first */
#include "python/core/core.h"

#include <stdlib.h>

typedef struct {
    void *data;
    int32_t device_type, device_id;
    int32_t ndim;
    struct {
        uint8_t code, bits;
        uint16_t lanes;
    } dtype;
    int64_t *shape, *strides;
    uint64_t byte_offset;
} tensor;

typedef struct old {
    tensor tensor;
    void *context;
    void (*deleter)(struct old *self);
} old; /* DLManagedTensor, of capsules called dltensor */

typedef struct versioned {
    uint32_t major, minor;
    void *context;
    void (*deleter)(struct versioned *self);
    uint64_t flags; /* bit 0: read only */
    tensor tensor;
} versioned; /* DLManagedTensorVersioned, of capsules called dltensor_versioned
              */

struct block {
    union {
        old old;
        versioned versioned;
    } is;
    int64_t shape[2], strides[2];
    PyObject *owner;
};

/* Called once, by whoever takes the tensor, on any thread. */
static void drop(struct block *block)
{
    PyGILState_STATE state = PyGILState_Ensure();
    Py_DECREF(block->owner);
    PyGILState_Release(state);
    free(block);
}

static void drop_old(old *self)
{
    drop(self->context);
}

static void drop_versioned(versioned *self)
{
    drop(self->context);
}

void *core_tensor(void *data, int64_t n, int code, int bits, int device_type,
                  int device, int is_versioned, void *owner)
{
    struct block *b = calloc(1, sizeof *b);
    if (!b)
        return NULL;
    b->shape[0] = n;
    b->shape[1] = b->strides[0] = 3;
    b->strides[1] = 1;
    b->owner = owner;
    tensor t = {.data = data,
                .device_type = device_type,
                .device_id = device,
                .ndim = 2,
                .dtype = {(uint8_t)code, (uint8_t)bits, 1},
                .shape = b->shape,
                .strides = b->strides};
    if (is_versioned)
        b->is.versioned = (versioned){.major = 1,
                                      .context = b,
                                      .deleter = drop_versioned,
                                      .flags = 1,
                                      .tensor = t};
    else
        b->is.old = (old){.tensor = t, .context = b, .deleter = drop_old};
    PyGILState_STATE state = PyGILState_Ensure();
    Py_INCREF(b->owner);
    PyGILState_Release(state);
    return b;
}

/* A capsule that nobody took has its first name still. */
void core_tensor_end(void *capsule)
{
    if (PyCapsule_IsValid(capsule, "dltensor")) {
        old *t = PyCapsule_GetPointer(capsule, "dltensor");
        t->deleter(t);
    } else if (PyCapsule_IsValid(capsule, "dltensor_versioned")) {
        versioned *t = PyCapsule_GetPointer(capsule, "dltensor_versioned");
        t->deleter(t);
    }
}
