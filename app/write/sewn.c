/* SPDX-License-Identifier: Apache-2.0 */
/* Writes how garments were sewn: sew.json, and the sewn garments as meshes. */
#include "app/write/sewn.h"
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/base/text.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int sewn_add(struct sewn *sewn, struct sewing *sewing, int frame)
{
    if (sewn->count == sewn->room) {
        int room = sewn->room ? 2 * sewn->room : 256;
        struct sewn_frame *larger =
            realloc(sewn->frame, (size_t)room * sizeof *larger);
        if (!larger)
            return no_memory();
        sewn->frame = larger;
        sewn->room = room;
    }
    struct sewn_frame row = {.frame = frame,
                             .step = sewing->steps,
                             .stage = sewing->stage,
                             .seam = -1};
    for (int k = 0; k < sewing->whole.n_seams; k++) {
        const struct sewing_seam *seam = &sewing->seam[k];
        if (seam->stage > sewing->stage)
            continue; /* at most held until its turn comes */
        double gap = seam->most / sewing->scene->seam[k].cell;
        if (row.seam < 0 || gap > row.gap) {
            row.gap = gap;
            row.seam = k;
        }
        row.waiting += seam->waiting;
        row.open += !seam->closed;
    }
    int status = sewing_audit(sewing, &row.pairs, &row.sewn);
    if (status == APP_OK)
        sewn->frame[sewn->count++] = row;
    return status;
}

void sewn_free(struct sewn *sewn)
{
    free(sewn->frame);
    *sewn = (struct sewn){0};
}

static void put_seam(FILE *out, const struct sewing *s, int k)
{
    const struct sewing_seam *seam = &s->seam[k];
    const struct scene_seam *about = &s->scene->seam[k];
    fputs("    {\"name\": ", out);
    text_put(out, about->name);
    fprintf(out, ", \"stage\": \"%s\", \"points\": %" PRId64 ", \"gap_m\": ",
            sewing_stages[seam->stage], seam->n);
    text_put_number(out, "%.6g", seam->most);
    fputs(", \"gap_cells\": ", out);
    text_put_number(out, "%.6g", seam->most / about->cell);
    fputs(", \"pull_N_per_m\": ", out);
    text_put_number(out, "%.6g", seam->strongest);
    fprintf(out, ", \"waiting\": %d, \"closed\": ", seam->waiting);
    if (seam->closed)
        fprintf(out, "%" PRId64, seam->closed);
    else
        fputs("null", out);
    fputc('}', out);
}

/* A step, or null where it has not come. */
static void put_step(FILE *out, const char *key, int64_t step)
{
    fprintf(out, ", \"%s\": ", key);
    if (step < 0)
        fputs("null", out);
    else
        fprintf(out, "%" PRId64, step);
}

/* An attachment; the body is null where the world holds it. */
static void put_hold(FILE *out, const struct sewing *s, int k)
{
    const struct sewing_hold *hold = &s->hold[k];
    const struct scene_attach *about = hold->about;
    fputs("    {\"name\": ", out);
    text_put(out, about->name);
    fputs(", \"body\": ", out);
    if (hold->body < 0)
        fputs("null", out);
    else
        text_put(out, s->scene->obstacle_name[hold->body]);
    fprintf(out, ", \"hold\": \"%s\", \"points\": %" PRId64,
            about->strength > 0 ? "soft" : "hard", about->n);
    put_step(out, "from", hold->from);
    put_step(out, "until", hold->to);
    fputs(", \"slip_m\": ", out);
    text_put_number(out, "%.6g", hold->slip);
    fputs(", \"pull_N_per_m\": ", out);
    text_put_number(out, "%.6g", hold->strongest);
    fputs(k + 1 < s->holds ? "},\n" : "}\n", out);
}

static void put_frame(FILE *out, const struct sewing *s,
                      const struct sewn_frame *row)
{
    fprintf(out,
            "    {\"frame\": %d, \"step\": %" PRId64
            ", \"stage\": \"%s\", \"gap_cells\": ",
            row->frame, row->step, sewing_stages[row->stage]);
    text_put_number(out, "%.6g", row->gap);
    fputs(", \"seam\": ", out);
    if (row->seam < 0)
        fputs("null", out);
    else
        text_put(out, s->scene->seam[row->seam].name);
    fprintf(out,
            ", \"open\": %d, \"waiting\": %d, \"pairs\": %" PRId64
            ", \"sewn_pairs\": %" PRId64 "}",
            row->open, row->waiting, row->pairs, row->sewn);
}

/* The panels that were lifted; those that began in a body, and those that they
 * pushed. */
static void put_moves(FILE *out, const struct sewing *s)
{
    const char *comma = "";
    fputs("  \"lifted_m\": {", out);
    for (int k = 0; s->lift && k < s->whole.n_cloths; k++) {
        if (s->lift[k] == 0)
            continue;
        fputs(comma, out);
        text_put(out, s->scene->cloth_name[k]);
        fprintf(out, ": %.6g", s->lift[k]);
        comma = ", ";
    }
    fputs("},\n", out);
    comma = "";
    fputs("  \"moved\": [", out);
    for (int k = 0; s->by && k < s->whole.n_cloths; k++) {
        const double *way = s->way[k];
        if (s->by[k] < 0)
            continue;
        fprintf(out, "%s\n    {\"panel\": ", comma);
        text_put(out, s->scene->cloth_name[k]);
        fputs(", \"by\": ", out);
        text_put(out, s->scene->cloth_name[s->by[k]]);
        fprintf(out, ", \"way_m\": [%.6g, %.6g, %.6g]}", way[0], way[1],
                way[2]);
        comma = ",";
    }
    fputs("],\n", out);
}

bool sewn_write(const struct sewn *sewn, const struct sewing *sewing,
                const char *directory)
{
    struct file file;
    if (!file_open(&file, directory, "sew.json"))
        return false;
    FILE *out = file.stream;
    fprintf(out, "{\n  \"steps\": %" PRId64 ", \"dt\": %.17g,\n  \"stages\": {",
            sewing->steps, sewing->whole.dt);
    const char *comma = "";
    for (int k = 0; k < SEWING_STAGES; k++)
        if (sewing->begun[k] >= 0) {
            fprintf(out, "%s\"%s\": %" PRId64, comma, sewing_stages[k],
                    sewing->begun[k]);
            comma = ", ";
        }
    fputs("},\n", out);
    put_moves(out, sewing);
    fputs("  \"seams\": [\n", out);
    for (int k = 0; k < sewing->whole.n_seams; k++) {
        put_seam(out, sewing, k);
        fputs(k + 1 < sewing->whole.n_seams ? ",\n" : "\n", out);
    }
    fputs("  ],\n  \"attachments\": [\n", out);
    for (int k = 0; k < sewing->holds; k++)
        put_hold(out, sewing, k);
    fputs("  ],\n  \"frames\": [\n", out);
    for (int k = 0; k < sewn->count; k++) {
        put_frame(out, sewing, &sewn->frame[k]);
        fputs(k + 1 < sewn->count ? ",\n" : "\n", out);
    }
    fputs("  ]\n}\n", out);
    return file_close(&file);
}

/* Writes the cloths from `first` to before `last` as one mesh. */
static bool save(const struct sewing *s, int first, int last,
                 const char *directory, const char *name)
{
    int64_t v = drape_first_vertex(s->world, first);
    int64_t t = drape_first_triangle(s->world, first);
    struct mesh mesh = {.nv = drape_first_vertex(s->world, last) - v,
                        .nt = drape_first_triangle(s->world, last) - t,
                        .x = s->x + v};
    mesh.tri = malloc(((size_t)mesh.nt + 1) * sizeof *mesh.tri);
    if (!mesh.tri) {
        no_memory();
        return false;
    }
    for (int64_t k = 0; k < mesh.nt; k++)
        for (int i = 0; i < 3; i++)
            mesh.tri[k][i] = s->tri[t + k][i] - (int32_t)v;
    bool good = ply_save(directory, name, &mesh, s->whole.precision);
    free(mesh.tri);
    return good;
}

bool sewn_save(struct sewing *sewing, const char *directory)
{
    const struct scene *scene = sewing->scene;
    if (drape_read(sewing->world, sewing->x, NULL) != DRAPE_OK) {
        complain(APP_FAILED, "sew: the state cannot be read");
        return false;
    }
    bool good = true;
    for (int k = 0; k < scene->garments && good; k++) {
        char name[64];
        snprintf(name, sizeof name, "sewn_%04d.ply", k);
        good = save(sewing, scene->garment_cloth[k],
                    scene->garment_cloth[k + 1], directory, name);
    }
    return good;
}

/* Replaces a file's name, if it is one in this folder, by its whole path. */
static void name_wholly(json_t *object, const char *key, const char *folder)
{
    char there[FILE_PATH], all[FILE_PATH], here[FILE_PATH];
    const char *name = json_string_value(json_object_get(object, key));
    if (!name || name[0] == '/' || !file_join(there, folder, name) ||
        (!strchr(name, '%') && !file_exists(there)))
        return;
    if (there[0] != '/' && getcwd(here, sizeof here) &&
        file_join(all, here, there))
        strcpy(there, all);
    json_object_set_new(object, key, json_string(there));
}

void sewn_name_files(json_t *root, const char *file)
{
    char folder[FILE_PATH];
    snprintf(folder, sizeof folder, "%s", file);
    char *slash = strrchr(folder, '/');
    strcpy(slash ? slash + (slash == folder) : folder, slash ? "" : ".");
    size_t k;
    json_t *item;
    json_array_foreach(json_object_get(root, "garments"), k, item)
    {
        name_wholly(item, "pattern", folder);
        name_wholly(item, "sewn", folder);
    }
    json_array_foreach(json_object_get(root, "cloths"), k, item)
        name_wholly(json_object_get(item, "panel"), "pattern", folder);
    json_array_foreach(json_object_get(root, "obstacles"), k, item)
    {
        name_wholly(item, "mesh", folder);
        name_wholly(json_object_get(item, "frames"), "file", folder);
        name_wholly(json_object_get(item, "frames"), "files", folder);
    }
}

bool sewn_put_scene(json_t *root, const char *directory, const char *name)
{
    struct file file;
    size_t k;
    json_t *garment;
    json_array_foreach(json_object_get(root, "garments"), k, garment)
    {
        char mesh[64];
        snprintf(mesh, sizeof mesh, "sewn_%04d.ply", (int)k);
        json_object_set_new(garment, "sewn", json_string(mesh));
        json_object_del(garment, "at");
    }
    if (!file_open(&file, directory, name))
        return false;
    json_dumpf(root, file.stream, JSON_INDENT(1) | JSON_REAL_PRECISION(17));
    fputc('\n', file.stream);
    return file_close(&file);
}
