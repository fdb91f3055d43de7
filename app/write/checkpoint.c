/* SPDX-License-Identifier: Apache-2.0 */
/* A run's checkpoint: header, reports, the library's state, and last of all 8
 * bytes that are a checksum of all before. */
#include "app/write/checkpoint.h"
#include "app/base/app.h"
#include "app/base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Checkpoints have the host's memory layout, so a checkpoint is for the build
 * that wrote it. The number in the magic text is the version of this layout. */
static const char magic[16] = "drape run 2", family[] = "drape run ";

/* The checksum: 64-bit FNV-1a, which a change of one byte always changes. */
static const uint64_t BEGIN = 0xcbf29ce484222325u;
static uint64_t mix(uint64_t sum, const void *data, size_t bytes)
{
    const unsigned char *byte = data;
    for (size_t k = 0; k < bytes; k++)
        sum = (sum ^ byte[k]) * 0x100000001b3u;
    return sum;
}

/* A stream of bytes and the checksum so far. */
struct summed {
    FILE *stream; /* NULL: bytes are summed only */
    uint64_t sum;
};

static int write_summed(void *user, const void *data, size_t bytes)
{
    struct summed *s = user;
    if (bytes == 0) /* data may be NULL then */
        return 0;
    s->sum = mix(s->sum, data, bytes);
    return s->stream && fwrite(data, 1, bytes, s->stream) != bytes;
}

static int read_stream(void *user, void *data, size_t bytes)
{
    return bytes > 0 && fread(data, 1, bytes, user) != bytes;
}

int checkpoint_start(const drape_world *world, uint64_t *start)
{
    struct summed summed = {NULL, BEGIN};
    int status = drape_save(world, write_summed, &summed);
    *start = summed.sum;
    return status;
}

int checkpoint_save(const char *directory, const struct report *report,
                    const struct scene *scene, const drape_world *world)
{
    struct file file;
    if (!file_open(&file, directory, "checkpoint.drape"))
        return APP_FAILED;
    struct checkpoint_header header;
    memset(&header, 0, sizeof header);
    memcpy(header.magic, magic, sizeof magic);
    header.report_bytes = sizeof *report->step;
    header.start = report->start;
    header.steps = report->count;
    header.seconds = report->seconds;
    header.estimate = report->estimate;
    header.dt = scene->def.dt;
    header.tolerance = scene->def.tolerance;
    header.steps_per_frame = scene->steps_per_frame;
    header.integrator = scene->def.integrator;
    struct summed summed = {file.stream, BEGIN};
    write_summed(&summed, &header, sizeof header);
    for (int64_t k = 0; k < report->count; k++)
        write_summed(&summed, &report->step[k], sizeof *report->step);
    int status = drape_save(world, write_summed, &summed);
    fwrite(&summed.sum, sizeof summed.sum, 1, file.stream);
    if (status != DRAPE_OK && status != DRAPE_EIO) {
        file_drop(&file);
        return complain(APP_FAILED, "checkpoint: %s",
                        drape_status_text(status));
    }
    return file_close(&file) ? APP_OK : APP_FAILED;
}

static int refuse(const struct checkpoint *c, const char *why)
{
    return complain(APP_USAGE, "%s: %s", c->path, why);
}

/* Whether the last 8 bytes are the checksum of all bytes before them. Appended
 * or missing bytes are detected like changed bytes. */
static bool is_whole(FILE *stream)
{
    unsigned char block[1 << 14];
    uint64_t sum = BEGIN, told;
    size_t kept = 0, size;
    /* the last 8 bytes read are held back, as they may be the checksum */
    while ((size = fread(block + kept, 1, sizeof block - kept, stream)) > 0) {
        size += kept;
        kept = size < sizeof told ? size : sizeof told;
        sum = mix(sum, block, size - kept);
        memmove(block, block + size - kept, kept);
    }
    memcpy(&told, block, sizeof told);
    return !ferror(stream) && kept == sizeof told && sum == told;
}

static int open_checked(struct checkpoint *c)
{
    struct checkpoint_header *h = &c->header;
    if (read_stream(c->stream, h->magic, sizeof h->magic) ||
        memcmp(h->magic, family, sizeof family - 1) != 0)
        return refuse(c, "not a checkpoint of drape run");
    if (memcmp(h->magic, magic, sizeof magic) != 0)
        return refuse(c, "a checkpoint of another version of drape; expected "
                         "one of this version");
    if (fseek(c->stream, 0, SEEK_SET) != 0)
        return refuse(c, "cannot be read twice; expected a file");
    if (!is_whole(c->stream))
        return refuse(c, "damaged or cut off: its checksum is not that of its "
                         "bytes");
    rewind(c->stream);
    if (read_stream(c->stream, h, sizeof *h))
        return refuse(c, "cannot be read twice; expected a file");
    return h->report_bytes == sizeof(drape_step_report)
               ? APP_OK
               : refuse(c, "a checkpoint of another build of drape");
}

int checkpoint_open(struct checkpoint *c, const char *path)
{
    c->path = path;
    c->stream = file_stream(path);
    return c->stream ? open_checked(c) : APP_USAGE;
}

void checkpoint_close(struct checkpoint *c)
{
    if (c->stream)
        fclose(c->stream);
    c->stream = NULL;
}

static bool in(int64_t value, int64_t most)
{
    return value >= 0 && value <= most;
}

static bool is_number(double value, double least)
{
    return isfinite(value) && value >= least;
}

int checkpoint_settings(const struct checkpoint *c, struct scene *scene)
{
    const struct checkpoint_header *h = &c->header;
    if (h->steps_per_frame < 1 || h->steps_per_frame > 1000000000 ||
        h->integrator < DRAPE_EULER || h->integrator > DRAPE_BDF2 ||
        !(h->estimate.asked >= 0 && h->estimate.asked <= 1e3) ||
        !is_number(h->estimate.error, 0) || !is_number(h->estimate.horizon, 0))
        return refuse(c, "its settings are out of range");
    if (h->estimate.asked > 0) {
        scene->def.dt = h->dt;
        scene->def.tolerance = h->tolerance;
        scene->def.integrator = h->integrator;
        scene->steps_per_frame = h->steps_per_frame;
    }
    return APP_OK;
}

/* Whether *s can be a run's report of step number `step`. */
static bool is_report(const drape_step_report *s, int64_t step)
{
    const int64_t most = (int64_t)1 << 40;
    const drape_work *w = &s->work;
    const int64_t count[] = {
        s->slices,      s->substeps,     s->iterations, s->rounds,
        s->contacts,    s->impacts,      s->candidates, s->zone_vertices,
        s->rolled_back, s->intersecting, s->sewn,       w->tries,
        w->solves,      w->queries,      w->narrow,     w->boxes,
        w->boxes_kept,  w->walked,       w->cleared,    w->near,
        w->later,       s->asleep};
    bool good = s->step == step && is_number(s->time, 0) &&
                is_number(s->residual, 0) && is_number(s->kinetic, 0) &&
                is_number(s->elastic, 0) && isfinite(s->potential) &&
                in(s->outcome, (1 << OUTCOMES) - 1) &&
                !(s->outcome & DRAPE_DIVERGED);
    for (size_t k = 0; k < sizeof count / sizeof *count; k++)
        good = good && in(count[k], most);
    for (int k = 0; k < DRAPE_PART_COUNT; k++)
        good = good && is_number(s->seconds[k], 0);
    return good;
}

static int load_reports(struct checkpoint *c, struct report *report)
{
    if (!is_number(c->header.seconds, 0) || c->header.steps < 0)
        return refuse(c, "its settings are out of range");
    for (int64_t k = 0; k < c->header.steps; k++) {
        drape_step_report step;
        if (read_stream(c->stream, &step, sizeof step))
            return complain(APP_USAGE, "%s: ends before step %lld", c->path,
                            (long long)c->header.steps);
        if (!is_report(&step, k + 1))
            return complain(APP_USAGE, "%s: step %lld: a value is out of range",
                            c->path, (long long)k + 1);
        if (!report_add(report, &step))
            return APP_FAILED;
    }
    report->seconds = c->header.seconds;
    report->estimate = c->header.estimate;
    return APP_OK;
}

int checkpoint_load(struct checkpoint *c, struct report *report,
                    drape_world *world)
{
    unsigned char rest[sizeof(uint64_t) + 1];
    if (c->header.start != report->start)
        return refuse(c, drape_status_text(DRAPE_EMATCH));
    int status = load_reports(c, report);
    if (status != APP_OK)
        return status;
    status = drape_load(world, read_stream, c->stream);
    if (status != DRAPE_OK)
        return complain(status == DRAPE_ENOMEM || status == DRAPE_EDEVICE
                            ? APP_FAILED
                            : APP_USAGE,
                        "%s: %s", c->path, drape_status_text(status));
    /* only the checksum is left, which is verified already */
    if (fread(rest, 1, sizeof rest, c->stream) != sizeof(uint64_t))
        return refuse(c, "has bytes behind its end");
    return APP_OK;
}
