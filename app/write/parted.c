/* SPDX-License-Identifier: Apache-2.0 */
/* parted.json: where parts of bodies gave way to each other. */
#include "app/write/parted.h"
#include "app/base/file.h"
#include "app/base/text.h"

#include <inttypes.h>

bool parted_write(const struct scene *scene, const char *directory)
{
    struct file file;
    const struct parted_list *list = &scene->parted;
    if (!list->count)
        return true;
    if (!file_open(&file, directory, "parted.json"))
        return false;
    fputs("[\n", file.stream);
    for (int k = 0; k < list->count; k++) {
        const struct parted *row = &list->row[k];
        fputs("  {\"body\": ", file.stream);
        text_put(file.stream, scene->obstacle_name[row->body]);
        fprintf(file.stream,
                ", \"frame\": %d, \"first_vertex\": %" PRId64
                ", \"vertices\": %" PRId64 ", \"depth_m\": %.6g, "
                "\"at_m\": [%.6g, %.6g, %.6g], \"left\": %" PRId64
                ", \"parted\": %s}%s\n",
                row->frame, row->first, row->vertices, row->depth, row->at[0],
                row->at[1], row->at[2], row->left,
                row->parted ? "true" : "false", k + 1 < list->count ? "," : "");
    }
    fputs("]\n", file.stream);
    return file_close(&file);
}
