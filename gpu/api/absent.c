/* SPDX-License-Identifier: Apache-2.0 */
/* Built in place of gpu/ in a build without CUDA: worlds on a device are
 * refused. */
#include <stdio.h>

#include "certificate.h"
#include "ref/api/ops.h"
#include "ref/base/info.h"

static int refuse(const drape_def *def, struct arena *arena,
                  struct world **world, drape_error *error)
{
    (void)def;
    (void)arena;
    *world = NULL;
    if (error)
        snprintf(
            error->text, sizeof error->text,
            "backend gpu: not in this build (GPU=yes makes it, with nvcc)");
    return DRAPE_EDEVICE;
}

const char *gpu_info(void)
{
    return WORLD_INFO("not built in");
}

const struct world_ops world_ops_gpu_32 = {.make = refuse};
const struct world_ops world_ops_gpu_64 = {.make = refuse};
