/* SPDX-License-Identifier: Apache-2.0 */
/* Defaults of a definition, of a cloth and of an obstacle. */
#include <string.h>

#include "spec/drape.h"

void drape_default(drape_def *def)
{
    if (!def)
        return;
    memset(def, 0, sizeof *def);
    def->backend = DRAPE_REF;
    def->precision = 32;
    def->dt = 1.0 / 60;
    def->gravity[1] = -9.81;
    def->wind.drag = 1;
    def->wind.lift = 0.3;
    def->integrator = DRAPE_BW;
    def->max_substeps = 100000;
    def->precond = DRAPE_MULTIGRID;
    def->matrix = DRAPE_COMPACT;
    def->tolerance = 1e-3;
    def->max_iterations = 2000;
    def->self_collision = 1;
    def->max_rounds = 16;
    def->max_slices = 32;
    def->threads = 1;
    def->sleep = 1;
}

void drape_default_cloth(drape_cloth *cloth)
{
    if (!cloth)
        return;
    memset(cloth, 0, sizeof *cloth);
    cloth->m = cloth->n = 101;
    cloth->width = cloth->height = 1;
    cloth->material.density = 0.2;
    cloth->material.stretch = 1000;
    cloth->material.shear = 300;
    cloth->material.bend = 1e-5;
    cloth->material.damping = 1e-3;
    cloth->material.thickness = 2e-3;
    cloth->material.friction = 0.3;
    cloth->u[0] = 1;
    cloth->v[2] = 1;
}

void drape_default_obstacle(drape_obstacle *obstacle)
{
    if (!obstacle)
        return;
    memset(obstacle, 0, sizeof *obstacle);
    obstacle->friction = 0.3;
    obstacle->motion = -1;
}
