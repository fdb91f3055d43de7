/* SPDX-License-Identifier: Apache-2.0 */
/* The reference's table of the functions that the API calls, of one precision.
 */
#include "ref/api/ops.h"
#include "ref/control/control.h"
#include "ref/control/edit.h"
#include "ref/control/list.h"
#include "ref/sleep/sleep.h"
#include "ref/world/checkpoint.h"
#include "ref/world/state.h"
#include "ref/world/step.h"

static int borrow_streams(struct world *w, drape_view *view)
{
    view->x = w->x0;
    view->v = w->v0;
    view->tri = (const int32_t(*)[3])w->tri;
    view->device = -1;
    view->stream = NULL;
    return DRAPE_OK;
}

const struct world_ops world_ops = {.make = world_make,
                                    .step = step_advance,
                                    .read = world_read,
                                    .read_triangles = world_read_triangles,
                                    .clock = state_clock,
                                    .material = state_material,
                                    .wind = state_wind,
                                    .gravity = state_gravity,
                                    .first_vertex = state_first_vertex,
                                    .first_triangle = state_first_triangle,
                                    .wake = sleep_wake,
                                    .set_wind = control_wind,
                                    .control = CONTROL_OPS,
                                    .edit = EDIT_OPS(world_make_edited),
                                    .contacts = list_contacts,
                                    .plan = plan_rows,
                                    .save = checkpoint_save,
                                    .load = checkpoint_load,
                                    .borrow = borrow_streams};
