/* SPDX-License-Identifier: Apache-2.0 */
/* untangle.json: where bodies intersected, and what was parted. */
#include "app/write/untangled.h"
#include "app/base/file.h"
#include "app/base/text.h"

#include <inttypes.h>

static void put_row(FILE *out, const struct tangle *row,
                    const char *const *name, bool found)
{
    fputs("    {\"bodies\": [", out);
    text_put(out, name[row->body[0]]);
    fputs(", ", out);
    text_put(out, name[row->body[1]]);
    fprintf(out,
            "], \"pairs\": %" PRId64 ", \"line_m\": %.6g, \"from_m\": "
            "[%.6g, %.6g, %.6g], \"to_m\": [%.6g, %.6g, %.6g]",
            row->pairs, row->length, row->lo[0], row->lo[1], row->lo[2],
            row->hi[0], row->hi[1], row->hi[2]);
    if (found)
        fprintf(out, ", \"parted\": %s", row->parted ? "true" : "false");
    fputc('}', out);
}

static void put_rows(FILE *out, const struct tangles *rows,
                     const char *const *name, bool found)
{
    for (int k = 0; k < rows->count; k++) {
        fputs(k ? ",\n" : "\n", out);
        put_row(out, &rows->row[k], name, found);
    }
    fputs("],\n", out);
}

bool untangled_write(const struct untangling *u, const char *const *name,
                     const char *directory)
{
    struct file file;
    if (!file_open(&file, directory, "untangle.json"))
        return false;
    fputs("{\n  \"found\": [", file.stream);
    put_rows(file.stream, &u->found, name, true);
    fputs("  \"left\": [", file.stream);
    put_rows(file.stream, &u->left, name, false);
    fprintf(file.stream, "  \"rounds\": %d,\n  \"bodies\": [", u->made);
    for (int p = 0; p < u->parts; p++) {
        fprintf(file.stream, "%s\n    {\"name\": ", p ? "," : "");
        text_put(file.stream, name[p]);
        fprintf(file.stream, ", \"way_m\": %.6g}", u->way[p]);
    }
    fputs("]\n}\n", file.stream);
    return file_close(&file);
}
