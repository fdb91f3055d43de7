/* SPDX-License-Identifier: Apache-2.0 */
/* Reads binary PLY meshes for tests. See tests/narrow/ply.h. */
#include "tests/narrow/ply.h"

#include <stdio.h>
#include <stdlib.h>

struct header {
    bool big;   /* big-endian */
    int bytes;  /* bytes of a coordinate */
    int stride; /* bytes of a vertex */
    long nv, nt;
};

static bool read_header(FILE *f, struct header *h)
{
    char line[256], type[32], name[32];
    bool vertices = false;
    memset(h, 0, sizeof *h);
    while (fgets(line, sizeof line, f)) {
        if (!strncmp(line, "end_header", 10))
            return h->nv > 0 && h->nt > 0 && h->bytes > 0;
        if (!strncmp(line, "format binary_big", 17))
            h->big = true;
        if (!strncmp(line, "format ascii", 12))
            return false;
        if (sscanf(line, "element vertex %ld", &h->nv) == 1)
            vertices = true;
        if (sscanf(line, "element face %ld", &h->nt) == 1)
            vertices = false;
        if (!vertices || sscanf(line, "property %31s %31s", type, name) != 2)
            continue;
        int size = !strcmp(type, "double") ? 8 : !strcmp(type, "float") ? 4 : 1;
        h->stride += size;
        if (!strcmp(name, "x"))
            h->bytes = size;
    }
    return false;
}

/* Reads a number of `bytes` bytes in the file's byte order. */
static uint64_t number(const uint8_t *p, int bytes, bool big)
{
    uint64_t word = 0;
    for (int k = 0; k < bytes; k++)
        word |= (uint64_t)p[big ? bytes - 1 - k : k] << (8 * k);
    return word;
}

static real coordinate(const uint8_t *p, const struct header *h)
{
    uint64_t word = number(p, h->bytes, h->big);
    if (h->bytes == 8) {
        double d;
        memcpy(&d, &word, sizeof d);
        return (real)d;
    }
    uint32_t half = (uint32_t)word;
    float f;
    memcpy(&f, &half, sizeof f);
    return (real)f;
}

static bool read_body(FILE *f, const struct header *h, struct ply *p)
{
    uint8_t item[256];
    if (h->stride > (int)sizeof item)
        return false;
    for (long k = 0; k < h->nv; k++) {
        if (fread(item, (size_t)h->stride, 1, f) != 1)
            return false;
        p->x[k] = vec_make(coordinate(item, h), coordinate(item + h->bytes, h),
                           coordinate(item + 2 * h->bytes, h));
    }
    for (long k = 0; k < h->nt; k++) {
        if (fread(item, 13, 1, f) != 1 || item[0] != 3)
            return false;
        for (int c = 0; c < 3; c++)
            p->tri[k][c] = (int32_t)number(item + 1 + 4 * c, 4, h->big);
    }
    return true;
}

bool ply_read(const char *path, struct ply *p)
{
    struct header h;
    memset(p, 0, sizeof *p);
    FILE *f = fopen(path, "rb");
    bool good = f && read_header(f, &h);
    if (good) {
        p->nv = (int32_t)h.nv;
        p->nt = (int32_t)h.nt;
        p->x = malloc((size_t)h.nv * sizeof *p->x);
        p->tri = malloc((size_t)h.nt * sizeof *p->tri);
        good = p->x && p->tri && read_body(f, &h, p);
    }
    if (f)
        fclose(f);
    return good;
}

void ply_free(struct ply *p)
{
    free(p->x);
    free(p->tri);
}
