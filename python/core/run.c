/* SPDX-License-Identifier: Apache-2.0 */
/* A run's files, written from Python as the tool writes them: core.h. */
#include "app/base/app.h"
#include "app/write/checkpoint.h"
#include "app/write/output.h"
#include "app/write/seams.h"
#include "python/core/core.h"

#include <stdlib.h>

struct core_run {
    struct scene *scene;
    struct output output;
    struct report report;
};

static int begin(core_run *run, drape_world *world, const char *folder,
                 int force)
{
    char out[FILE_PATH], id[REPORT_ID];
    if (!output_name(out, run->scene, folder))
        return APP_USAGE;
    int status = force ? APP_OK : folder_empty(out);
    if (status != APP_OK)
        return status;
    int known = checkpoint_start(world, &run->report.start);
    if (known != DRAPE_OK)
        return complain(APP_FAILED, "%s: %s", run->scene->file,
                        drape_status_text(known));
    struct claim claim = {report_id(&run->report, run->scene, id), NULL, 0,
                          force};
    status = output_open(&run->output, run->scene, world, out, &claim);
    if (status == APP_OK &&
        (!seams_write(run->scene, &run->scene->def, 0, out) ||
         !report_write(&run->report, run->scene, world, out, "unfinished")))
        status = APP_FAILED;
    return status;
}

static void end_run(core_run *run)
{
    output_close(&run->output);
    report_free(&run->report);
    free(run);
}

int core_run_open(struct scene *scene, drape_world *world, const char *folder,
                  const core_run_how *how, core_run **run)
{
    *run = calloc(1, sizeof **run);
    if (!*run)
        return complain(APP_FAILED, "out of memory");
    (*run)->scene = scene;
    (*run)->output.every = 1;
    (*run)->output.obj = how->obj != 0;
    (*run)->output.contacts = how->contacts != 0;
    (*run)->report.impulses.on = how->contacts != 0;
    int status = how->contacts
                     ? contacts_known(scene->def.integrator, scene->file)
                     : APP_OK;
    if (status == APP_OK)
        status = begin(*run, world, folder, how->force);
    if (status == APP_OK)
        return status;
    end_run(*run);
    *run = NULL;
    return status;
}

int core_run_frame(core_run *run, drape_world *world, int k)
{
    return output_frame(&run->output, world, k);
}

int core_run_add(core_run *run, drape_world *world,
                 const drape_step_report *report)
{
    for (int k = 0; k < DRAPE_PART_COUNT; k++)
        run->report.seconds += report->seconds[k];
    if (!report_add(&run->report, report))
        return APP_FAILED;
    return run->report.impulses.on ? contacts_add(&run->report.impulses, world)
                                   : APP_OK;
}

int core_run_close(core_run *run, drape_world *world, int last, const char *end)
{
    int status = end ? output_cache(&run->output, last) : APP_OK;
    if (end && status == APP_OK &&
        !report_write(&run->report, run->scene, world, run->output.directory,
                      end))
        status = APP_FAILED;
    end_run(run);
    return status;
}
