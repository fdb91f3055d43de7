/* SPDX-License-Identifier: Apache-2.0 */
/* report.json: every step of a run, and what it came to. */
#include "app/report.h"
#include "app/app.h"
#include "app/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const part_names[DRAPE_PART_COUNT] = {
    "integration", "solver", "broad", "proximity", "penetration"};
static const char *const outcome_names[] = {
    "unconverged", "zones", "rollback", "trapped", "diverged", "asleep"};
enum { OUTCOMES = 6 };

bool report_add(struct report *report, const drape_step_report *step)
{
    if (report->count == report->room) {
        int64_t room = report->room ? 2 * report->room : 256;
        drape_step_report *larger =
            realloc(report->step, (size_t)room * sizeof *larger);
        if (!larger) {
            complain(APP_FAILED, "out of memory");
            return false;
        }
        report->step = larger;
        report->room = room;
    }
    report->step[report->count++] = *step;
    return true;
}

void report_free(struct report *report)
{
    free(report->step);
    *report = (struct report){0};
}

const char *report_outcome(int outcome, char text[128])
{
    strcpy(text, outcome ? "" : "clean");
    for (int k = 0; k < OUTCOMES; k++)
        if (outcome >> k & 1) {
            strcat(text, *text ? "+" : "");
            strcat(text, outcome_names[k]);
        }
    return text;
}

/* A JSON text; bytes above 127 are UTF-8 already. */
static void put_text(FILE *out, const char *text)
{
    fputc('"', out);
    for (; *text; text++) {
        unsigned char c = (unsigned char)*text;
        if (c == '"' || c == '\\')
            fprintf(out, "\\%c", c);
        else if (c < 32)
            fprintf(out, "\\u%04x", c);
        else
            fputc(c, out);
    }
    fputc('"', out);
}

static void put_number(FILE *out, const char *name, double value)
{
    if (isfinite(value))
        fprintf(out, ", \"%s\": %.17g", name, value);
    else
        fprintf(out, ", \"%s\": null", name);
}

/* What was done, and beside it what was not. */
static void put_work(FILE *out, const drape_work *w, int64_t rounds)
{
    fprintf(out,
            "\"work\": {\"tries\": %d, \"solves\": %d, \"queries\": %d, "
            "\"narrow\": %d, \"narrow_skipped\": %lld, \"boxes\": %lld, "
            "\"boxes_kept\": %lld, \"walked\": %lld, \"cleared\": %lld, "
            "\"near\": %lld, \"later\": %lld}",
            w->tries, w->solves, w->queries, w->narrow,
            (long long)(rounds - w->narrow), (long long)w->boxes,
            (long long)w->boxes_kept, (long long)w->walked,
            (long long)w->cleared, (long long)w->near, (long long)w->later);
}

static void put_step(FILE *out, const drape_step_report *s)
{
    char words[128];
    fprintf(out, "    {\"step\": %lld", (long long)s->step);
    put_number(out, "time", s->time);
    fprintf(out,
            ", \"outcome\": \"%s\", \"slices\": %d, \"substeps\": %d, "
            "\"iterations\": %d",
            report_outcome(s->outcome, words), s->slices, s->substeps,
            s->iterations);
    put_number(out, "residual", s->residual);
    fprintf(out,
            ", \"rounds\": %d, \"contacts\": %lld, \"impacts\": %lld, "
            "\"candidates\": %lld, \"zone_vertices\": %lld, "
            "\"rolled_back\": %lld",
            s->rounds, (long long)s->contacts, (long long)s->impacts,
            (long long)s->candidates, (long long)s->zone_vertices,
            (long long)s->rolled_back);
    put_number(out, "kinetic", s->kinetic);
    put_number(out, "elastic", s->elastic);
    put_number(out, "potential", s->potential);
    fprintf(out, ", \"graphs\": %d, \"seconds\": {", s->graphs);
    for (int k = 0; k < DRAPE_PART_COUNT; k++)
        fprintf(out, "%s\"%s\": %.6g", k ? ", " : "", part_names[k],
                s->seconds[k]);
    fputs("}, ", out);
    put_work(out, &s->work, s->rounds);
    fputs("}", out);
}

static void add_work(drape_work *all, const drape_work *one)
{
    all->tries += one->tries;
    all->solves += one->solves;
    all->queries += one->queries;
    all->narrow += one->narrow;
    all->boxes += one->boxes;
    all->boxes_kept += one->boxes_kept;
    all->walked += one->walked;
    all->cleared += one->cleared;
    all->near += one->near;
    all->later += one->later;
}

static void put_summary(FILE *out, const struct report *report)
{
    int64_t outcomes[OUTCOMES] = {0}, contacts = 0, detections = 0, graphs = 0;
    drape_work work = {0};
    int rounds = 0, iterations = 0;
    double seconds[DRAPE_PART_COUNT] = {0};
    for (int64_t k = 0; k < report->count; k++) {
        const drape_step_report *s = &report->step[k];
        for (int j = 0; j < OUTCOMES; j++)
            outcomes[j] += s->outcome >> j & 1;
        for (int j = 0; j < DRAPE_PART_COUNT; j++)
            seconds[j] += s->seconds[j];
        add_work(&work, &s->work);
        detections += s->rounds;
        graphs += s->graphs;
        contacts = s->contacts > contacts ? s->contacts : contacts;
        rounds = s->rounds > rounds ? s->rounds : rounds;
        iterations = s->iterations > iterations ? s->iterations : iterations;
    }
    fprintf(out,
            "  \"summary\": {\"steps\": %lld, \"seconds\": %.6g, "
            "\"most_contacts\": %lld, \"most_rounds\": %d, "
            "\"most_iterations\": %d, \"graphs\": %lld,\n    "
            "\"outcomes\": {",
            (long long)report->count, report->seconds, (long long)contacts,
            rounds, iterations, (long long)graphs);
    for (int j = 0; j < OUTCOMES; j++)
        fprintf(out, "%s\"%s\": %lld", j ? ", " : "", outcome_names[j],
                (long long)outcomes[j]);
    fputs("},\n    \"part_seconds\": {", out);
    for (int j = 0; j < DRAPE_PART_COUNT; j++)
        fprintf(out, "%s\"%s\": %.6g", j ? ", " : "", part_names[j],
                seconds[j]);
    fputs("},\n    ", out);
    put_work(out, &work, detections);
    fputs("},\n", out);
}

/* What render needs to know of the frames' vertices. */
static void put_bodies(FILE *out, const struct scene *scene,
                       const drape_world *world)
{
    const drape_def *def = &scene->def;
    int bodies = def->n_cloths + def->n_obstacles;
    fputs("  \"bodies\": [\n", out);
    for (int k = 0; k < bodies; k++) {
        bool cloth = k < def->n_cloths;
        fputs("    {\"name\": ", out);
        put_text(out, cloth ? scene->cloth_name[k]
                            : scene->obstacle_name[k - def->n_cloths]);
        fprintf(out,
                ", \"kind\": \"%s\", \"first_vertex\": %lld, "
                "\"first_triangle\": %lld",
                cloth ? "cloth" : "obstacle",
                (long long)drape_first_vertex(world, k),
                (long long)drape_first_triangle(world, k));
        if (cloth) {
            const drape_cloth *c = &def->cloths[k];
            fprintf(out, ", \"particles\": [%d, %d], \"size\": [%.17g, %.17g]",
                    c->m, c->n, c->width, c->height);
        }
        fprintf(out, "}%s\n", k + 1 < bodies ? "," : "");
    }
    fprintf(out, "  ],\n  \"vertices\": %lld, \"triangles\": %lld,\n",
            (long long)drape_vertices(world),
            (long long)drape_triangles(world));
}

static void put_plan(FILE *out, const drape_world *world)
{
    drape_plan_row row[64];
    drape_memory m;
    drape_count(world, &m);
    fprintf(out,
            "  \"memory\": {\"host_bytes\": %zu, \"device_bytes\": %zu, "
            "\"borrowed_bytes\": %zu, "
            "\"host_allocations\": %lld, \"device_allocations\": %lld},\n",
            m.host_bytes, m.device_bytes, m.borrowed_bytes,
            (long long)m.host_allocations, (long long)m.device_allocations);
    int rows = drape_plan(world, row, 64);
    rows = rows < 64 ? rows : 64;
    fputs("  \"plan\": [\n", out);
    for (int k = 0; k < rows; k++) {
        fprintf(out,
                "    {\"stage\": \"%s\", \"on\": %s, \"bytes\": %zu, "
                "\"why\": ",
                row[k].stage, row[k].on ? "true" : "false", row[k].bytes);
        put_text(out, row[k].why);
        fprintf(out, "}%s\n", k + 1 < rows ? "," : "");
    }
    fputs("  ],\n", out);
}

static void put_camera(FILE *out, const struct camera *c)
{
    if (c->fov > 0)
        fprintf(out,
                "  \"camera\": {\"eye\": [%.17g, %.17g, %.17g], \"target\": "
                "[%.17g, %.17g, %.17g], \"fov\": %.17g},\n",
                c->eye[0], c->eye[1], c->eye[2], c->target[0], c->target[1],
                c->target[2], c->fov);
}

bool report_write(const struct report *report, const struct scene *scene,
                  const drape_world *world, const char *directory,
                  const char *end)
{
    struct file file;
    if (!file_open(&file, directory, "report.json"))
        return false;
    FILE *out = file.stream;
    const drape_def *def = &scene->def;
    fprintf(out, "{\n  \"drape\": \"%s\",\n  \"scene\": ", DRAPE_VERSION);
    put_text(out, scene->name);
    fputs(",\n  \"file\": ", out);
    put_text(out, scene->file);
    fprintf(out,
            ",\n  \"end\": \"%s\", \"backend\": \"%s\", \"precision\": %d, "
            "\"threads\": %d, \"dt\": %.17g, \"steps_per_frame\": %d,\n"
            "  \"held_bytes\": %zu,\n",
            end, def->backend == DRAPE_GPU ? "gpu" : "ref", def->precision,
            def->threads, def->dt, scene->steps_per_frame, scene->budget.held);
    if (report->estimate.asked > 0)
        fprintf(out,
                "  \"error\": {\"asked\": %.6g, \"estimated\": %.6g, "
                "\"horizon\": %.6g},\n",
                report->estimate.asked, report->estimate.error,
                report->estimate.horizon);
    fputs("  \"settings\": ", out);
    scene_settings(out, scene);
    fputs(",\n", out);
    put_camera(out, &scene->camera);
    put_bodies(out, scene, world);
    put_plan(out, world);
    put_summary(out, report);
    fputs("  \"steps\": [\n", out);
    for (int64_t k = 0; k < report->count; k++) {
        put_step(out, &report->step[k]);
        fputs(k + 1 < report->count ? ",\n" : "\n", out);
    }
    fputs("  ]\n}\n", out);
    return file_close(&file);
}
