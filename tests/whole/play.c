/* SPDX-License-Identifier: Apache-2.0 */
/* Runs one small scene and writes lines about it. */
#include "tests/whole/whole.h"

#include <stdlib.h>
#include <string.h>

#include "ref/base/hash.h"

/* The state of a run: its output and its checkpoint. */
struct play {
    struct show show;
    drape_world *world;
    FILE *out;
    const char *name;
    char *saved; /* checkpoint, made by open_memstream */
    size_t bytes, read;
    double (*x)[3], (*v)[3]; /* [vertices] of the state */
    int32_t (*tri)[3];
};

static void stage(void *user, int64_t step, const char *name, uint64_t digest,
                  double seconds)
{
    struct play *p = user;
    (void)seconds;
    fprintf(p->out, "%s %d stage %lld %s %016llx\n", p->name,
            p->show.def.precision, (long long)step, name,
            (unsigned long long)digest);
}

static void hear(void *user, const char *line)
{
    struct play *p = user;
    fprintf(p->out, "%s %d log %s\n", p->name, p->show.def.precision, line);
}

static int write_bytes(void *user, const void *data, size_t bytes)
{
    return bytes > 0 && fwrite(data, 1, bytes, user) != bytes;
}

static int read_bytes(void *user, void *data, size_t bytes)
{
    struct play *p = user;
    if (bytes > p->bytes - p->read)
        return 1;
    if (bytes > 0)
        memcpy(data, p->saved + p->read, bytes);
    p->read += bytes;
    return 0;
}

static uint64_t state(struct play *p)
{
    size_t bytes = (size_t)drape_vertices(p->world) * sizeof *p->x;
    drape_read(p->world, p->x, p->v);
    return hash_mix(hash_mix(HASH_SEED, p->x, bytes), p->v, bytes);
}

/* Writes the report of a step without its times. */
static void report(struct play *p, int status, const drape_step_report *r)
{
    const drape_work *w = &r->work;
    fprintf(p->out, "%s %d step %lld %d %d %d %d %d %a %d", p->name,
            p->show.def.precision, (long long)r->step, status, r->outcome,
            r->slices, r->substeps, r->iterations, r->residual, r->rounds);
    fprintf(p->out, " %lld %lld %lld %lld %lld %a %a %a",
            (long long)r->contacts, (long long)r->impacts,
            (long long)r->candidates, (long long)r->zone_vertices,
            (long long)r->rolled_back, r->kinetic, r->elastic, r->potential);
    fprintf(p->out, " %d %d %d %d %lld %lld %lld %lld %lld %lld", w->tries,
            w->solves, w->queries, w->narrow, (long long)w->boxes,
            (long long)w->boxes_kept, (long long)w->walked,
            (long long)w->cleared, (long long)w->near, (long long)w->later);
    fprintf(p->out, " state %016llx\n", (unsigned long long)state(p));
}

/* Makes the steps from `from` up to `to` - 1. Returns the hash of the last
 * state.
 */
static uint64_t steps(struct play *p, int from, int to)
{
    for (int k = from; k < to; k++) {
        drape_step_report r;
        memset(&r, 0, sizeof r);
        int status = drape_step(p->world, &r);
        report(p, status, &r);
        if (p->show.between)
            p->show.between(&p->show, p->world, k);
    }
    return state(p);
}

static void write_plan(struct play *p)
{
    drape_plan_row row[64];
    int n = drape_plan(p->world, row, 64);
    for (int k = 0; k < n; k++)
        fprintf(p->out, "%s plan %s %d %zu %s\n", p->name, row[k].stage,
                row[k].on, row[k].bytes, row[k].why);
}

/* Writes the intersecting pairs of the state, among all triangles of cloths and
 * obstacles. */
static void write_audit(struct play *p)
{
    enum { PAIRS = 8 };
    int32_t pair[PAIRS][2];
    int64_t found = 0, flat = 0;
    drape_mesh mesh;
    memset(&mesh, 0, sizeof mesh);
    mesh.nv = drape_vertices(p->world);
    mesh.nt = drape_triangles(p->world);
    mesh.x = (const double(*)[3])p->x;
    mesh.tri = (const int32_t(*)[3])p->tri;
    mesh.threads = p->show.def.threads;
    drape_read_triangles(p->world, p->tri);
    int status = drape_audit(&mesh, PAIRS, pair, &found, &flat);
    fprintf(p->out, "%s audit %d %lld %lld", p->name, status, (long long)found,
            (long long)flat);
    for (int64_t k = 0; k < PAIRS && k < found; k++)
        fprintf(p->out, " %d-%d", pair[k][0], pair[k][1]);
    fputs("\n", p->out);
}

/* Writes the view of the state that drape_borrow gives. */
static void write_view(struct play *p)
{
    drape_view view;
    int status = drape_borrow(p->world, &view);
    size_t each = view.precision == 64 ? sizeof(double) : sizeof(float);
    size_t bytes = (size_t)view.vertices * 3 * each;
    fprintf(p->out, "%s view %d %lld %lld %d %016llx\n", p->name, status,
            (long long)view.vertices, (long long)view.triangles, view.device,
            (unsigned long long)hash_mix(HASH_SEED, view.x, bytes));
}

/* Repeats the second half in a new world from a checkpoint of the middle.
 * Returns whether it ends with the hash `wanted`. */
static int resumed(struct play *p, int half, uint64_t wanted)
{
    drape_destroy(p->world);
    p->world = NULL;
    if (drape_create(&p->show.def, &p->world, NULL) != DRAPE_OK ||
        drape_load(p->world, read_bytes, p) != DRAPE_OK) {
        fprintf(p->out, "%s: the checkpoint is refused\n", p->name);
        return 0;
    }
    fprintf(p->out, "%s resumed\n", p->name);
    return steps(p, half, p->show.steps) == wanted;
}

static int run(struct play *p)
{
    int half = p->show.steps / 2;
    steps(p, 0, half);
    FILE *file = open_memstream(&p->saved, &p->bytes);
    if (!file || drape_save(p->world, write_bytes, file) != DRAPE_OK)
        return 0;
    fclose(file);
    uint64_t last = steps(p, half, p->show.steps);
    write_plan(p);
    write_audit(p);
    write_view(p);
    return resumed(p, half, last);
}

int show_play(const struct scene_row *row, int precision, int threads,
              FILE *out)
{
    struct play p;
    memset(&p, 0, sizeof p);
    p.name = row->name;
    p.out = out;
    drape_default(&p.show.def);
    p.show.def.cloths = p.show.cloth;
    p.show.def.obstacles = p.show.obstacle;
    p.show.def.motions = p.show.motion;
    p.show.def.precision = precision;
    p.show.def.threads = threads;
    p.show.def.trace = stage;
    p.show.def.log = hear;
    p.show.def.trace_user = p.show.def.log_user = &p;
    row->make(&p.show);
    drape_error error;
    int good = 0;
    if (drape_create(&p.show.def, &p.world, &error) == DRAPE_OK) {
        p.x = malloc((size_t)drape_vertices(p.world) * sizeof *p.x);
        p.v = malloc((size_t)drape_vertices(p.world) * sizeof *p.v);
        p.tri = malloc((size_t)drape_triangles(p.world) * sizeof *p.tri);
        good = p.x && p.v && p.tri && run(&p);
    } else {
        fprintf(out, "%s: %s\n", row->name, error.text);
    }
    drape_destroy(p.world);
    free(p.x);
    free(p.v);
    free(p.tri);
    free(p.saved);
    show_free(&p.show);
    return good;
}
