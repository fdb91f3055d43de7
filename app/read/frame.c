/* SPDX-License-Identifier: Apache-2.0 */
/* Writes meshes as PLY and OBJ. */
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/read/mesh.h"

#include <stdlib.h>
#include <string.h>

/* PLY is written little-endian on every host. */
static void put(FILE *out, const void *value, size_t size)
{
    const uint16_t one = 1;
    unsigned char bytes[8], first;
    memcpy(bytes, value, size);
    memcpy(&first, &one, 1);
    for (size_t k = 0; first == 0 && k < size / 2; k++) {
        unsigned char swap = bytes[k];
        bytes[k] = bytes[size - 1 - k];
        bytes[size - 1 - k] = swap;
    }
    fwrite(bytes, size, 1, out);
}

static void put_vertex(FILE *out, const double x[3], int bits)
{
    for (int i = 0; i < 3; i++) {
        float single = (float)x[i];
        if (bits == 32)
            put(out, &single, sizeof single);
        else
            put(out, &x[i], sizeof x[i]);
    }
}

void ply_put(FILE *out, const struct mesh *mesh, int bits)
{
    const char *type = bits == 32 ? "float" : "double";
    fprintf(out,
            "ply\nformat binary_little_endian 1.0\ncomment drape, metres\n"
            "element vertex %lld\nproperty %s x\nproperty %s y\n"
            "property %s z\nelement face %lld\n"
            "property list uchar int vertex_indices\nend_header\n",
            (long long)mesh->nv, type, type, type, (long long)mesh->nt);
    for (int64_t k = 0; k < mesh->nv; k++)
        put_vertex(out, mesh->x[k], bits);
    for (int64_t k = 0; k < mesh->nt; k++) {
        fputc(3, out);
        for (int i = 0; i < 3; i++)
            put(out, &mesh->tri[k][i], sizeof(int32_t));
    }
}

bool ply_save(const char *directory, const char *name, const struct mesh *mesh,
              int bits)
{
    struct file file;
    if (!file_open(&file, directory, name))
        return false;
    ply_put(file.stream, mesh, bits);
    return file_close(&file);
}

bool obj_save(const char *directory, const char *name, const struct mesh *mesh,
              int bits)
{
    struct file file;
    if (!file_open(&file, directory, name))
        return false;
    /* with this many digits a number reads back with the same bits */
    int digits = bits == 32 ? 9 : 17;
    fputs("# drape, metres\n", file.stream);
    for (int64_t k = 0; k < mesh->nv; k++)
        fprintf(file.stream, "v %.*g %.*g %.*g\n", digits, mesh->x[k][0],
                digits, mesh->x[k][1], digits, mesh->x[k][2]);
    for (int64_t k = 0; k < mesh->nt; k++)
        fprintf(file.stream, "f %d %d %d\n", (int)mesh->tri[k][0] + 1,
                (int)mesh->tri[k][1] + 1, (int)mesh->tri[k][2] + 1);
    return file_close(&file);
}

/* Sets number[k] to vertex k's number in the file, from 1, or to 0 if no
 * triangle has the vertex. */
static void number_vertices(const struct mesh *mesh, int32_t *number)
{
    for (int64_t k = 0; k < mesh->nt; k++)
        for (int i = 0; i < 3; i++)
            number[mesh->tri[k][i]] = 1;
    int32_t next = 1;
    for (int64_t k = 0; k < mesh->nv; k++)
        if (number[k])
            number[k] = next++;
}

/* Writes where a particle of a cloth is on the sheet, 0 to 1 along each side; a
 * panel's border is not where the grid has it. */
static void put_place(FILE *out, const struct part *part, int64_t k)
{
    double u = (double)(k % part->m) / (part->m - 1);
    double v = (double)(k / part->m) / (part->n - 1);
    if (part->rest) {
        u = part->rest[k][0] / part->size[0];
        v = part->rest[k][1] / part->size[1];
    }
    fprintf(out, "vt %.9g %.9g\n", u, v);
}

/* Writes a body as an object: its name, vertices and places on its sheet. */
static void put_object(FILE *out, const struct part *part, double (*x)[3],
                       const int32_t *number, int bits)
{
    /* with this many digits a number reads back with the same bits */
    int digits = bits == 32 ? 9 : 17;
    fputs("o ", out);
    for (const char *p = part->name; *p; p++)
        fputc((unsigned char)*p <= 32 || *p == 127 ? '_' : *p, out);
    fputc('\n', out);
    for (int64_t k = 0; k < part->nv; k++)
        if (number[k])
            fprintf(out, "v %.*g %.*g %.*g\n", digits, x[k][0], digits, x[k][1],
                    digits, x[k][2]);
    for (int64_t k = 0; part->m && k < part->nv; k++)
        if (number[k])
            put_place(out, part, k);
}

static void put_face(FILE *out, const int32_t tri[3], const int32_t *number,
                     bool with_uv)
{
    int a = number[tri[0]], b = number[tri[1]], c = number[tri[2]];
    if (with_uv)
        fprintf(out, "f %d/%d %d/%d %d/%d\n", a, a, b, b, c, c);
    else
        fprintf(out, "f %d %d %d\n", a, b, c);
}

bool obj_save_parts(const char *directory, const char *name,
                    const struct mesh *mesh, const struct part *part, int parts,
                    int bits)
{
    struct file file;
    int32_t *number = calloc((size_t)mesh->nv + 1, sizeof *number);
    if (!number) {
        complain(APP_FAILED, "%s: out of memory", name);
        return false;
    }
    if (!file_open(&file, directory, name)) {
        free(number);
        return false;
    }
    number_vertices(mesh, number);
    fputs("# drape, metres\n", file.stream);
    int64_t v = 0, t = 0;
    for (int k = 0; k < parts; k++) {
        put_object(file.stream, &part[k], mesh->x + v, number + v, bits);
        for (int64_t end = t + part[k].nt; t < end; t++)
            put_face(file.stream, mesh->tri[t], number, part[k].m > 0);
        v += part[k].nv;
    }
    free(number);
    return file_close(&file);
}
