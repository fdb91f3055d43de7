/* SPDX-License-Identifier: Apache-2.0 */
/* Writes meshes as PLY and OBJ. */
#include "app/file.h"
#include "app/mesh.h"

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
