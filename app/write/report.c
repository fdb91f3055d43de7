/* SPDX-License-Identifier: Apache-2.0 */
/* Writes report.json: the report of each step of a run, and its totals. */
#include "app/write/report.h"
#include "app/base/file.h"
#include "app/base/text.h"

#include <string.h>

static const char *const part_names[] = {"integration", "solver", "broad",
                                         "proximity", "penetration"};
_Static_assert(sizeof part_names / sizeof *part_names == DRAPE_PART_COUNT,
               "a part has no name");

/* In the order of report_work. */
static const char *const work_names[] = {
    "tries",      "solves", "queries", "narrow", "boxes",
    "boxes_kept", "walked", "cleared", "near",   "later"};
_Static_assert(sizeof work_names / sizeof *work_names == WORKS,
               "a count of work has no name");

static void put_number(FILE *out, const char *name, double value)
{
    fprintf(out, ", \"%s\": ", name);
    text_put_number(out, "%.17g", value);
}

/* Writes the wall time of each part of the pipeline. */
static void put_parts(FILE *out, const double seconds[DRAPE_PART_COUNT])
{
    for (int k = 0; k < DRAPE_PART_COUNT; k++) {
        fprintf(out, "%s\"%s\": ", k ? ", " : "", part_names[k]);
        text_put_number(out, "%.6g", seconds[k]);
    }
}

/* Writes the counters of work. */
static void put_work(FILE *out, const int64_t work[WORKS])
{
    for (int k = 0; k < WORKS; k++) {
        fprintf(out, "%s\"%s\": %lld", k ? ", " : "\"work\": {", work_names[k],
                (long long)work[k]);
    }
    fputs("}", out);
}

static void put_step(FILE *out, const struct report *report, int64_t k)
{
    const drape_step_report *s = &report->step[k];
    char words[128];
    int64_t work[WORKS];
    fprintf(out, "    {\"step\": %lld", (long long)s->step);
    put_number(out, "time", s->time);
    fprintf(out,
            ", \"outcome\": \"%s\", \"slices\": %d, \"substeps\": %d, "
            "\"iterations\": %d",
            report_outcome(s->outcome, words), s->slices, s->substeps,
            s->iterations);
    put_number(out, "residual", s->residual);
    fprintf(out,
            ", \"rounds\": %d, \"asleep\": %d, \"contacts\": %lld, "
            "\"impacts\": %lld, "
            "\"candidates\": %lld, \"zone_vertices\": %lld, "
            "\"rolled_back\": %lld, \"intersecting\": %lld, \"sewn\": %lld",
            s->rounds, s->asleep, (long long)s->contacts, (long long)s->impacts,
            (long long)s->candidates, (long long)s->zone_vertices,
            (long long)s->rolled_back, (long long)s->intersecting,
            (long long)s->sewn);
    put_number(out, "kinetic", s->kinetic);
    put_number(out, "elastic", s->elastic);
    put_number(out, "potential", s->potential);
    fputs(", \"seconds\": {", out);
    put_parts(out, s->seconds);
    fputs("}, ", out);
    report_work(&s->work, work);
    put_work(out, work);
    contacts_put(out, &report->impulses, k);
    fputs("}", out);
}

/* Writes how many steps end intersecting, and the first and the last of them.
 */
static void put_intersecting(FILE *out, const struct totals *t)
{
    fprintf(out, "\"intersecting\": {\"count\": %lld",
            (long long)t->intersecting);
    if (t->intersecting)
        fprintf(out, ", \"first\": %lld, \"last\": %lld}", (long long)t->first,
                (long long)t->last);
    else
        fputs(", \"first\": null, \"last\": null}", out);
}

static void put_summary(FILE *out, const struct report *report)
{
    struct totals t;
    report_sum(report, &t);
    fprintf(out, "  \"summary\": {\"steps\": %lld, \"seconds\": ",
            (long long)t.done);
    text_put_number(out, "%.6g", report->seconds);
    fprintf(out,
            ", \"most_contacts\": %lld, \"most_rounds\": %lld, "
            "\"most_iterations\": %lld,\n    \"outcomes\": {",
            (long long)t.contacts, (long long)t.rounds,
            (long long)t.iterations);
    for (int j = 0; j < OUTCOMES; j++)
        fprintf(out, "%s\"%s\": %lld", j ? ", " : "", outcomes[j].name,
                (long long)t.outcome[j]);
    fputs("},\n    ", out);
    put_intersecting(out, &t);
    fputs(",\n    \"part_seconds\": {", out);
    put_parts(out, t.seconds);
    fputs("},\n    ", out);
    put_work(out, t.work);
    fputs("},\n", out);
}

/* Writes the bodies of the frames' vertices, which render reads. */
static void put_bodies(FILE *out, const struct scene *scene,
                       const drape_world *world)
{
    const drape_def *def = &scene->def;
    int bodies = def->n_cloths + def->n_obstacles;
    int cloths = def->n_cloths - scene->hidden;
    /* what the files do not show */
    int64_t v = drape_first_vertex(world, def->n_cloths) -
                drape_first_vertex(world, cloths);
    int64_t t = drape_first_triangle(world, def->n_cloths) -
                drape_first_triangle(world, cloths);
    fputs("  \"bodies\": [\n", out);
    for (int k = 0; k < bodies; k++) {
        bool cloth = k < def->n_cloths;
        if (cloth && k >= cloths)
            continue;
        fprintf(out, "%s    {\"name\": ", k ? ",\n" : "");
        text_put(out, cloth ? scene->cloth_name[k]
                            : scene->obstacle_name[k - def->n_cloths]);
        fprintf(out,
                ", \"kind\": \"%s\", \"first_vertex\": %lld, "
                "\"first_triangle\": %lld",
                cloth ? "cloth" : "obstacle",
                (long long)(drape_first_vertex(world, k) - (cloth ? 0 : v)),
                (long long)(drape_first_triangle(world, k) - (cloth ? 0 : t)));
        if (cloth) {
            const drape_cloth *c = &def->cloths[k];
            fprintf(out, ", \"particles\": [%d, %d], \"size\": [%.17g, %.17g]",
                    c->m, c->n, c->width, c->height);
        } else {
            const drape_obstacle *o = &def->obstacles[k - def->n_cloths];
            bool moves = o->motion >= 0 || o->frames > 0;
            fprintf(out, ", \"moving\": %s", moves ? "true" : "false");
        }
        const struct look *looks =
            cloth ? scene->cloth_look : scene->obstacle_look;
        if (looks) {
            fputs(", \"look\": ", out);
            look_write(out, &looks[cloth ? k : k - def->n_cloths]);
        }
        fputc('}', out);
    }
    fprintf(out, "\n  ],\n  \"vertices\": %lld, \"triangles\": %lld,\n",
            (long long)(drape_vertices(world) - v),
            (long long)(drape_triangles(world) - t));
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
        text_put(out, row[k].why);
        fprintf(out, "}%s\n", k + 1 < rows ? "," : "");
    }
    fputs("  ],\n", out);
}

/* Writes the estimate of a run that chose its settings by --error. */
static void put_estimate(FILE *out, const struct estimate *e)
{
    if (!(e->asked > 0))
        return;
    fputs("  \"error\": {\"asked\": ", out);
    text_put_number(out, "%.6g", e->asked);
    fputs(", \"estimated\": ", out);
    text_put_number(out, "%.6g", e->error);
    fputs(", \"horizon\": ", out);
    text_put_number(out, "%.6g", e->horizon);
    fputs("},\n", out);
}

static void put_vector(FILE *out, const char *name, const double v[3])
{
    fprintf(out, "\"%s\": [%.17g, %.17g, %.17g], ", name, v[0], v[1], v[2]);
}

/* Writes where the camera stands, if the scene says so, and what else pictures
 * need. */
static void put_camera(FILE *out, const struct camera *c)
{
    if (memcmp(c->eye, c->target, sizeof c->eye) != 0) {
        fputs("  \"camera\": {", out);
        put_vector(out, "eye", c->eye);
        put_vector(out, "target", c->target);
        fprintf(out, "\"fov\": %.17g},\n", c->fov);
    }
    fputs("  \"picture\": {", out);
    put_vector(out, "sun", c->sun);
    put_vector(out, "floor", c->floor);
    fprintf(out, "\"fov\": %.17g, \"turn\": %.17g, \"light\": %.17g},\n",
            c->fov, c->turn, c->light);
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
    char id[REPORT_ID];
    fprintf(out, "{\n  \"drape\": \"%s\", \"id\": \"%s\",\n  \"scene\": ",
            DRAPE_VERSION, report_id(report, scene, id));
    text_put(out, scene->name);
    fputs(",\n  \"file\": ", out);
    text_put(out, scene->file);
    fprintf(out,
            ",\n  \"end\": \"%s\", \"backend\": \"%s\", \"precision\": %d, "
            "\"threads\": %d, \"dt\": %.17g, \"steps_per_frame\": %d,\n"
            "  \"held_bytes\": %zu,\n",
            end, def->backend == DRAPE_GPU ? "gpu" : "ref", def->precision,
            def->threads, def->dt, scene->steps_per_frame, scene->budget.held);
    put_estimate(out, &report->estimate);
    fputs("  \"settings\": ", out);
    scene_settings(out, scene);
    fputs(",\n", out);
    put_camera(out, &scene->camera);
    put_bodies(out, scene, world);
    put_plan(out, world);
    put_summary(out, report);
    fputs("  \"steps\": [\n", out);
    for (int64_t k = 0; k < report->count; k++) {
        put_step(out, report, k);
        fputs(k + 1 < report->count ? ",\n" : "\n", out);
    }
    fputs("  ]\n}\n", out);
    return file_close(&file);
}
