/* SPDX-License-Identifier: Apache-2.0 */
/* Where triangles intersect, by drape's exact audit. */
#include "app/read/crossings.h"
#include "app/base/app.h"

#include <stdlib.h>
#include <string.h>

int crossings_find(const drape_mesh *mesh, struct crossings *crossings)
{
    struct crossings *c = crossings;
    *c = (struct crossings){0};
    int status = drape_audit(mesh, 0, NULL, &c->found, &c->degenerate);
    if (status == DRAPE_OK && c->found) {
        c->pair = malloc((size_t)c->found * sizeof *c->pair);
        if (!c->pair)
            return no_memory();
        status =
            drape_audit(mesh, c->found, c->pair, &c->found, &c->degenerate);
    }
    return status == DRAPE_OK
               ? APP_OK
               : complain(APP_FAILED, "audit: %s", drape_status_text(status));
}

void crossings_part(struct crossings *crossings, const drape_world *world)
{
    int64_t kept = 0;
    for (int64_t k = 0; crossings->pair && k < crossings->found; k++) {
        const int32_t *pair = crossings->pair[k];
        if (drape_are_sewn(world, pair[0], pair[1]) != 1)
            memmove(crossings->pair[kept++], pair, sizeof *crossings->pair);
    }
    crossings->sewn = crossings->found - kept;
    crossings->found = kept;
}

void crossings_free(struct crossings *crossings)
{
    free(crossings->pair);
    crossings->pair = NULL;
}
