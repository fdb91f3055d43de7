/* SPDX-License-Identifier: Apache-2.0 */
/* drape run: simulates a scene and writes its frames. */
#include "app/scene/error.h"
#include "app/tool/options.h"
#include "app/tool/progress.h"
#include "app/write/checkpoint.h"
#include "app/write/output.h"
#include "app/write/parted.h"
#include "app/write/seams.h"
#include "app/write/trace.h"

#include <stdlib.h>
#include <string.h>

struct run {
    struct scene scene;
    struct overrides overrides;
    drape_world *world;
    struct output output;
    struct report report;
    struct progress progress;
    struct file trace;
    struct checkpoint from; /* of --resume */
    const char *resume, *directory, *error;
    char out[FILE_PATH]; /* the directory, given or by the scene's name */
    int frames, checkpoint_every, tracing, obj, no_obj, force, contacts;
    bool failed; /* a step failed; the state before the step is intact */
};

/* Opens the trace. A resumed run keeps the rows of its earlier steps, also if
 * it does not trace its later steps. */
static int open_trace(struct run *run)
{
    char path[FILE_PATH];
    const char *out = run->output.directory;
    if (!file_join(path, out, "trace.csv"))
        return APP_USAGE;
    if (!run->tracing && !file_exists(path))
        return APP_OK;
    int status = trace_begin(&run->trace, out, run->report.count);
    if (status != APP_OK || run->tracing)
        return status;
    return file_close(&run->trace) ? APP_OK : APP_FAILED;
}

/* Opens the output. Nothing is written before scene and checkpoint have been
 * accepted. The report is written first, so that the frames of a killed run
 * have a report too. */
static int open_output(struct run *run)
{
    const struct scene *scene = &run->scene;
    int64_t frame = run->report.count / scene->steps_per_frame;
    char id[REPORT_ID];
    struct claim claim = {report_id(&run->report, scene, id), run->resume,
                          (int)frame, run->force};
    run->output.obj = run->obj && !run->no_obj;
    run->output.contacts = run->report.impulses.on = run->contacts;
    run->report.impulses.first = run->report.count;
    int status = output_open(&run->output, scene, run->world, run->out, &claim);
    if (status == APP_OK && (!parted_write(scene, run->out) ||
                             !seams_write(scene, &scene->def, 0, run->out) ||
                             !report_write(&run->report, scene, run->world,
                                           run->out, "unfinished")))
        status = APP_FAILED;
    return status == APP_OK ? open_trace(run) : status;
}

/* --error: chooses the settings before the run, and prints them. */
static int choose(struct run *run)
{
    struct scene *scene = &run->scene;
    struct estimate *e = &run->report.estimate;
    char *end;
    double asked = strtod(run->error, &end);
    if (*end || end == run->error || !(asked > 0 && asked <= 1e3))
        return complain(APP_USAGE, "--error %s: expected m above 0, to 1000",
                        run->error);
    if (run->resume)
        return complain(APP_USAGE, "--error: a resumed run has its settings");
    int status = error_choose(scene, &run->overrides, asked, e);
    if (status != APP_OK)
        return status;
    double whole = scene->frames * scene->steps_per_frame * scene->def.dt;
    say("--error %g: %s, dt %.4g s, tolerance %g; estimated %.2g m rms for "
        "%.3g s, of time and solver\n",
        asked, scene_integrator(scene), scene->def.dt, scene->def.tolerance,
        e->error, e->horizon);
    if (e->horizon < whole * (1 - 1e-9))
        complain(0,
                 "note: --error %g holds for the first %.3g s of %.3g s, and "
                 "with half the step for no longer",
                 asked, e->horizon, whole);
    return APP_OK;
}

/* Makes the scene's world, at its start or in the state of the checkpoint. */
static int make_world(struct run *run)
{
    int status = scene_create(&run->scene, &run->overrides, &run->world);
    if (status != APP_OK)
        return status;
    int known = checkpoint_start(run->world, &run->report.start);
    if (known != DRAPE_OK)
        return complain(APP_FAILED, "%s: %s", run->scene.file,
                        drape_status_text(known));
    if (!run->resume)
        return APP_OK;
    status = checkpoint_load(&run->from, &run->report, run->world);
    checkpoint_close(&run->from);
    return status;
}

/* Says which options have no effect on this run. */
static void say_idle(const struct run *run)
{
    bool gpu = run->scene.def.backend == DRAPE_GPU;
    scene_idle(&run->scene, &run->overrides);
    if (run->overrides.block >= 0 && !gpu)
        complain(0, "note: --block has no effect: backend ref computes");
    if (run->overrides.threads >= 0 && gpu)
        complain(0, "note: --threads has no effect: backend gpu computes");
    if (run->checkpoint_every > run->scene.frames)
        complain(0,
                 "note: --checkpoint-every %d has no effect: the run has %d "
                 "frames",
                 run->checkpoint_every, run->scene.frames);
}

static int begin(struct run *run, const char *scene_file)
{
    struct scene *scene = &run->scene;
    int status = scene_load(scene, scene_file);
    if (status != APP_OK)
        return status;
    if (scene->unsewn)
        return complain(APP_USAGE,
                        "%s: a garment is not sewn yet: `drape sew` sews it, "
                        "and writes a scene that runs",
                        scene_file);
    if (run->frames >= 0)
        scene->frames = run->frames;
    if (!output_name(run->out, scene, run->directory))
        return APP_USAGE;
    if (!run->resume && !run->force)
        status = folder_empty(run->out);
    if (status == APP_OK && run->error)
        status = choose(run);
    if (status == APP_OK && run->resume) {
        status = checkpoint_open(&run->from, run->resume);
        if (status == APP_OK)
            status = checkpoint_settings(&run->from, scene);
    }
    if (status == APP_OK && run->contacts)
        status = contacts_known(scene->def.integrator, scene_file);
    if (status != APP_OK)
        return status;
    if (run->tracing) {
        scene->def.trace = trace_row;
        scene->def.trace_user = &run->trace;
    }
    status = make_world(run);
    if (status != APP_OK)
        return status;
    if (scene->degenerate)
        complain(0, "%s: note: obstacles have %lld triangles without area",
                 scene_file, (long long)scene->degenerate);
    say_idle(run);
    return open_output(run);
}

/* Saves a checkpoint. The trace is published first: it may have rows of steps
 * after the checkpoint, but must not lack rows of steps before it. */
static int save(struct run *run)
{
    const char *out = run->output.directory;
    int status = trace_publish(&run->trace, out);
    if (status != APP_OK)
        return status;
    return checkpoint_save(out, &run->report, &run->scene, run->world);
}

/* Makes one step and writes the frame and the checkpoint that are due. */
static int step(struct run *run)
{
    drape_step_report report;
    double began = seconds_now();
    int status = drape_step(run->world, &report);
    run->failed = status != DRAPE_OK;
    if (run->failed)
        return complain(APP_FAILED, "step %lld: %s",
                        (long long)run->report.count + 1,
                        drape_status_text(status));
    int code = trace_check(&run->trace);
    if (code != APP_OK)
        return code;
    run->report.seconds += seconds_now() - began;
    if (!report_add(&run->report, &report))
        return APP_FAILED;
    if (run->report.impulses.on)
        code = contacts_add(&run->report.impulses, run->world);
    if (code != APP_OK)
        return code;
    progress_step(&run->progress, &report);
    if (report.outcome & DRAPE_DIVERGED)
        return complain(APP_FINDINGS,
                        "step %lld: diverged; the state before it is kept",
                        (long long)run->report.count);
    int64_t done = run->report.count, each = run->scene.steps_per_frame;
    if (done % each == 0)
        code = output_frame(&run->output, run->world, (int)(done / each));
    if (code == APP_OK && run->checkpoint_every &&
        done % (each * run->checkpoint_every) == 0)
        code = save(run);
    return code;
}

/* Prints the result of a run in one line, with further lines for steps that are
 * not clean. */
static void tell(const struct run *run, const struct totals *t, const char *end)
{
    if (t->unconverged)
        complain(0, "note: the solver missed its tolerance in %lld steps",
                 (long long)t->unconverged);
    stretch_tell(run->output.stretch, run->output.cloth_part,
                 run->output.cloths);
    if (t->not_clean)
        complain(APP_FINDINGS, "%lld of %lld steps are not clean",
                 (long long)t->not_clean, (long long)t->steps);
    say("%s: %lld steps, %.3g s, %s", run->output.directory, (long long)t->done,
        run->report.seconds, end);
    if (t->intersecting)
        say("; %lld of them intersect at their end, from step %lld to step "
            "%lld",
            (long long)t->intersecting, (long long)t->first,
            (long long)t->last);
    say("\n");
}

/* Writes the final files of a run, however it ended. */
static int finish(struct run *run, int code)
{
    struct totals totals;
    report_sum(&run->report, &totals);
    const char *end = code == APP_INTERRUPTED ? "interrupted"
                      : code == APP_FINDINGS  ? "diverged"
                      : run->failed           ? "failed"
                                              : "complete";
    int status = code == APP_INTERRUPTED ? save(run) : APP_OK;
    if (status != APP_OK)
        return status;
    int64_t frame = totals.done / run->scene.steps_per_frame;
    status = output_cache(&run->output, (int)frame);
    if (status != APP_OK ||
        !report_write(&run->report, &run->scene, run->world,
                      run->output.directory, end) ||
        (run->tracing && !file_close(&run->trace)))
        return APP_FAILED;
    tell(run, &totals, end);
    return code == APP_OK && totals.not_clean ? APP_FINDINGS : code;
}

static int simulate(struct run *run)
{
    int64_t each = run->scene.steps_per_frame;
    int64_t total = run->scene.frames * each;
    progress_catch_stop();
    int code = APP_OK;
    if (run->report.count == 0)
        code = output_frame(&run->output, run->world, 0);
    progress_begin(&run->progress, run->report.count, total);
    while (code == APP_OK && run->report.count < total) {
        if (progress_stopped()) {
            code = APP_INTERRUPTED;
            break;
        }
        code = step(run);
    }
    progress_end(&run->progress);
    /* after a failure of the disk nothing more is written */
    bool left = code == APP_FAILED && !run->failed;
    return left || code == APP_USAGE ? code : finish(run, code);
}

int command_run(int argc, char **argv)
{
    struct run run = {.frames = -1, .overrides = {NULL, -1, -1, -1, 0}};
    run.output.every = 1;
    const struct option_row options[] = {
        INT_OPTION("--frames", &run.frames, 0, 1000000),
        TEXT_OPTION("--out", &run.directory),
        TEXT_OPTION("--backend", &run.overrides.backend),
        BITS_OPTION("--precision", &run.overrides.precision),
        INT_OPTION("--threads", &run.overrides.threads, 0, 4096),
        INT_OPTION("--block", &run.overrides.block, 0, 256),
        INT_OPTION("--every", &run.output.every, 1, 1000000),
        INT_OPTION("--checkpoint-every", &run.checkpoint_every, 1, 1000000),
        TEXT_OPTION("--error", &run.error),
        TEXT_OPTION("--resume", &run.resume),
        FLAG_OPTION("--force", &run.force),
        FLAG_OPTION("--trace", &run.tracing),
        FLAG_OPTION("--obj", &run.obj),
        FLAG_OPTION("--contacts", &run.contacts),
        FLAG_OPTION("--no-obj", &run.no_obj),
        FLAG_OPTION("--allow-intersecting", &run.overrides.allow_intersecting),
        {0}};
    int positional;
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (positional != 1)
        return complain(APP_USAGE, "run: expected one SCENE.json");
    status = begin(&run, argv[0]);
    if (status == APP_OK)
        status = simulate(&run);
    file_drop(&run.trace);
    checkpoint_close(&run.from);
    drape_destroy(run.world);
    output_close(&run.output);
    report_free(&run.report);
    scene_free(&run.scene);
    return status;
}
