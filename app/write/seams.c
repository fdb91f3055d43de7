/* SPDX-License-Identifier: Apache-2.0 */
/* seams.json: which cloths are panels, and the particles that their seams join.
 */
#include "app/write/seams.h"
#include "app/base/file.h"
#include "app/base/text.h"

#include <inttypes.h>

/* Writes a key with n numbers of particles. */
static void put_particles(FILE *out, const char *key, const int32_t *particle,
                          int64_t n)
{
    fprintf(out, ",\n     \"%s\": [", key);
    for (int64_t k = 0; k < n; k++)
        fprintf(out, "%s%" PRId32, k ? ", " : "", particle[k]);
    fputc(']', out);
}

static void put_seam(FILE *out, const struct scene *scene,
                     const drape_def *whole, int k)
{
    const drape_seam *seam = &whole->seams[k];
    fputs("    {\"name\": ", out);
    text_put(out, scene->seam[k].name);
    fprintf(out, ", \"cloths\": [%d, %d]", seam->cloth[0], seam->cloth[1]);
    put_particles(out, "particles", seam->particle, seam->n);
    put_particles(out, "onto", seam->onto[0], 2 * seam->n);
    fputs(",\n     \"part\": [", out);
    for (int64_t i = 0; i < seam->n; i++)
        fprintf(out, "%s%.17g", i ? ", " : "", seam->part[i]);
    fputs(k + 1 < whole->n_seams ? "]},\n" : "]}\n", out);
}

bool seams_write(const struct scene *scene, const drape_def *whole,
                 int attaches, const char *directory)
{
    struct file file;
    if (!whole->n_seams)
        return true;
    if (!file_open(&file, directory, "seams.json"))
        return false;
    FILE *out = file.stream;
    fputs("{\n  \"panels\": [", out);
    const char *comma = "";
    for (int k = 0; k < whole->n_cloths; k++)
        if (whole->cloths[k].panel) {
            fprintf(out, "%s%d", comma, k);
            comma = ", ";
        }
    fputs("],\n  \"seams\": [\n", out);
    for (int k = 0; k < whole->n_seams; k++)
        put_seam(out, scene, whole, k);
    fputs("  ],\n  \"attachments\": [\n", out);
    for (int k = 0; k < attaches; k++) {
        const struct scene_attach *attach = &scene->attach[k];
        fputs("    {\"name\": ", out);
        text_put(out, attach->name);
        fprintf(out, ", \"cloth\": %d", attach->cloth);
        put_particles(out, "particles", attach->particle, attach->n);
        fputs(k + 1 < attaches ? "},\n" : "}\n", out);
    }
    fputs("  ]\n}\n", out);
    return file_close(&file);
}
