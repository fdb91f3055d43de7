/* SPDX-License-Identifier: Apache-2.0 */
/* A run's checkpoint: the reports of its steps and the library's state. */
#include "app/checkpoint.h"
#include "app/app.h"
#include "app/file.h"

#include <errno.h>
#include <string.h>

/* The layout of the host: a checkpoint is for the build that wrote it. */
struct header {
    char magic[16];
    uint64_t report_bytes; /* of one drape_step_report */
    int64_t steps;
    double seconds;
};
static const char magic[16] = "drape run 1";

static int write_stream(void *user, const void *data, size_t bytes)
{
    return fwrite(data, 1, bytes, user) == bytes ? 0 : 1;
}

static int read_stream(void *user, void *data, size_t bytes)
{
    return fread(data, 1, bytes, user) == bytes ? 0 : 1;
}

int checkpoint_save(const char *directory, const struct report *report,
                    const drape_world *world)
{
    struct file file;
    if (!file_open(&file, directory, "checkpoint.drape"))
        return APP_FAILED;
    struct header header = {.report_bytes = sizeof(drape_step_report),
                            .steps = report->count,
                            .seconds = report->seconds};
    memcpy(header.magic, magic, sizeof magic);
    size_t bytes = (size_t)report->count * sizeof *report->step;
    fwrite(&header, sizeof header, 1, file.stream);
    if (bytes)
        fwrite(report->step, 1, bytes, file.stream);
    int status = drape_save(world, write_stream, file.stream);
    if (status != DRAPE_OK && status != DRAPE_EIO) {
        file_drop(&file);
        return complain(APP_FAILED, "checkpoint: %s",
                        drape_status_text(status));
    }
    return file_close(&file) ? APP_OK : APP_FAILED;
}

static int load(FILE *stream, const char *path, struct report *report,
                drape_world *world)
{
    struct header header;
    if (fread(&header, sizeof header, 1, stream) != 1 ||
        memcmp(header.magic, magic, sizeof magic) != 0 ||
        header.report_bytes != sizeof(drape_step_report) || header.steps < 0)
        return complain(APP_USAGE, "%s: not a checkpoint of this build", path);
    for (int64_t k = 0; k < header.steps; k++) {
        drape_step_report step;
        if (fread(&step, sizeof step, 1, stream) != 1)
            return complain(APP_USAGE, "%s: ends before step %lld", path,
                            (long long)header.steps);
        if (!report_add(report, &step))
            return APP_FAILED;
    }
    report->seconds = header.seconds;
    int status = drape_load(world, read_stream, stream);
    if (status == DRAPE_OK && fgetc(stream) != EOF)
        status = DRAPE_EMATCH;
    if (status != DRAPE_OK)
        return complain(APP_USAGE, "%s: %s", path, drape_status_text(status));
    return APP_OK;
}

int checkpoint_load(const char *path, struct report *report, drape_world *world)
{
    FILE *stream = fopen(path, "rb");
    if (!stream)
        return complain(APP_USAGE, "%s: %s", path, strerror(errno));
    int status = load(stream, path, report, world);
    fclose(stream);
    return status;
}
