/* SPDX-License-Identifier: Apache-2.0 */
/* trace.csv: a digest of each stage of each step of a run. */
#include "app/write/trace.h"
#include "app/base/app.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static const char head[] = "step,stage,digest,seconds\n";

void trace_row(void *user, int64_t step, const char *stage, uint64_t digest,
               double seconds)
{
    struct file *file = user;
    if (file->stream)
        fprintf(file->stream, "%lld,%s,%016llx,%.6g\n", (long long)step, stage,
                (unsigned long long)digest, seconds);
}

/* Copies the rows of steps before `done`; returns the number of steps copied.
 */
static int64_t copy_rows(FILE *from, FILE *to, int64_t done)
{
    char row[256];
    int64_t steps = 0;
    long long before = -1;
    if (!fgets(row, sizeof row, from) || strcmp(row, head) != 0)
        return 0;
    while (fgets(row, sizeof row, from)) {
        char *end;
        long long step = strtoll(row, &end, 10);
        if (end == row || *end != ',' || !strchr(row, '\n') || step < before ||
            step >= done)
            break;
        steps += step > before;
        before = step;
        fputs(row, to);
    }
    return steps;
}

int trace_begin(struct file *trace, const char *directory, int64_t done)
{
    if (!file_open(trace, directory, "trace.csv"))
        return APP_FAILED;
    fputs(head, trace->stream);
    FILE *old =
        done && file_is_regular(trace->path) ? fopen(trace->path, "rb") : NULL;
    int64_t kept = old ? copy_rows(old, trace->stream, done) : 0;
    if (old)
        fclose(old);
    if (kept < done)
        complain(0, "note: %s has rows of %lld of the %lld steps before",
                 trace->path, (long long)kept, (long long)done);
    return trace_check(trace);
}

int trace_check(struct file *trace)
{
    if (!trace->stream || !ferror(trace->stream))
        return APP_OK;
    int why = errno;
    file_drop(trace);
    return complain(APP_FAILED, "%s: cannot write: %s", trace->path,
                    why ? strerror(why) : "the disk took only a part");
}

static int copy(FILE *from, FILE *to)
{
    char block[1 << 14];
    size_t size;
    while ((size = fread(block, 1, sizeof block, from)) > 0)
        fwrite(block, 1, size, to);
    return ferror(from) ? APP_FAILED : APP_OK;
}

int trace_publish(struct file *trace, const char *directory)
{
    struct file whole;
    if (!trace->stream)
        return APP_OK;
    fflush(trace->stream);
    int status = trace_check(trace);
    if (status != APP_OK)
        return status;
    FILE *rows = fopen(trace->part, "rb");
    if (!rows)
        return complain(APP_FAILED, "%s: %s", trace->part, strerror(errno));
    if (!file_open(&whole, directory, "trace.csv")) {
        fclose(rows);
        return APP_FAILED;
    }
    if (copy(rows, whole.stream) != APP_OK) {
        complain(APP_FAILED, "%s: %s", trace->part, strerror(errno));
        file_drop(&whole);
    }
    fclose(rows);
    return whole.stream && file_close(&whole) ? APP_OK : APP_FAILED;
}
