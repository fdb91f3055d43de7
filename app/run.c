/* SPDX-License-Identifier: Apache-2.0 */
/* drape run: simulates a scene and writes its frames. */
#include "app/app.h"
#include "app/checkpoint.h"
#include "app/error.h"
#include "app/output.h"
#include "app/progress.h"

#include <limits.h>
#include <signal.h>
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
    const char *resume, *directory, *error;
    int frames, checkpoint_every, tracing, no_obj;
    bool failed; /* a step did: the state before it is there */
};

/* Set by Ctrl-C, looked at between steps. */
static volatile sig_atomic_t stopped;

static void stop(int signal_number)
{
    (void)signal_number;
    stopped = 1;
}

/* The first Ctrl-C asks for an orderly end, the second one kills. */
static void catch_signals(void)
{
    struct sigaction action;
    memset(&action, 0, sizeof action);
    action.sa_handler = stop;
    action.sa_flags = (int)SA_RESETHAND;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

static void trace(void *user, int64_t step, const char *stage, uint64_t digest,
                  double seconds)
{
    struct file *file = user;
    if (file->stream)
        fprintf(file->stream, "%lld,%s,%016llx,%.6g\n", (long long)step, stage,
                (unsigned long long)digest, seconds);
}

/* Nothing is written before the scene and the checkpoint have been taken. */
static int open_output(struct run *run)
{
    const struct scene *scene = &run->scene;
    char directory[FILE_PATH + 8];
    snprintf(directory, sizeof directory, "%s.out", scene->name);
    for (char *p = directory; *p; p++)
        *p = *p == '/' ? '_' : *p;
    const char *out = run->directory ? run->directory : directory;
    run->output.obj = !run->no_obj;
    int status = output_open(&run->output, scene, run->world, out);
    if (status != APP_OK || !run->tracing)
        return status;
    if (!file_open(&run->trace, out, "trace.csv"))
        return APP_FAILED;
    fputs("step,stage,digest,seconds\n", run->trace.stream);
    return APP_OK;
}

/* --error: finds the settings before the run, and says which. */
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
    if (status == APP_OK)
        printf("--error %g: %s, dt %.4g s, tolerance %g; estimated %.2g m rms "
               "after %.3g s, of time and solver\n",
               asked, scene_integrator(scene), scene->def.dt,
               scene->def.tolerance, e->error, e->horizon);
    return status;
}

static int begin(struct run *run, const char *scene_file)
{
    struct scene *scene = &run->scene;
    int status = scene_load(scene, scene_file);
    if (status != APP_OK)
        return status;
    if (run->frames >= 0)
        scene->frames = run->frames;
    if (run->error && (status = choose(run)) != APP_OK)
        return status;
    if (run->tracing) {
        scene->def.trace = trace;
        scene->def.trace_user = &run->trace;
    }
    status = scene_create(scene, &run->overrides, &run->world);
    if (status == APP_OK && run->resume)
        status = checkpoint_load(run->resume, &run->report, run->world);
    if (status != APP_OK)
        return status;
    if (scene->degenerate)
        complain(0, "%s: note: obstacles have %lld triangles without area",
                 scene_file, (long long)scene->degenerate);
    return open_output(run);
}

/* One step and what is due after it. */
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
    run->report.seconds += seconds_now() - began;
    if (!report_add(&run->report, &report))
        return APP_FAILED;
    progress_step(&run->progress, &report);
    if (report.outcome & DRAPE_DIVERGED)
        return complain(APP_FINDINGS,
                        "step %lld: diverged; the last good state is kept",
                        (long long)report.step);
    int64_t done = run->report.count, each = run->scene.steps_per_frame;
    int code = APP_OK;
    if (done % each == 0)
        code = output_frame(&run->output, run->world, (int)(done / each));
    if (code == APP_OK && run->checkpoint_every &&
        done % (each * run->checkpoint_every) == 0)
        code = checkpoint_save(run->output.directory, &run->report, run->world);
    return code;
}

/* Everything that a run leaves at its end, however it ended. */
static int finish(struct run *run, int code)
{
    int64_t done = run->report.count, each = run->scene.steps_per_frame;
    const char *end = code == APP_INTERRUPTED ? "interrupted"
                      : code == APP_FINDINGS  ? "diverged"
                      : run->failed           ? "failed"
                                              : "complete";
    if (code == APP_INTERRUPTED) {
        int status =
            checkpoint_save(run->output.directory, &run->report, run->world);
        if (status != APP_OK)
            return status;
    }
    int status = output_cache(&run->output, (int)(done / each));
    if (status != APP_OK ||
        !report_write(&run->report, &run->scene, run->world,
                      run->output.directory, end) ||
        (run->tracing && !file_close(&run->trace)))
        return APP_FAILED;
    int64_t bad = 0, loose = 0;
    for (int64_t k = 0; k < done; k++) {
        bad += (run->report.step[k].outcome & NOT_CLEAN) != 0;
        loose += (run->report.step[k].outcome & DRAPE_UNCONVERGED) != 0;
    }
    if (loose)
        complain(0, "note: the solver missed its tolerance in %lld steps",
                 (long long)loose);
    if (bad)
        complain(0, "%lld of %lld steps are not clean", (long long)bad,
                 (long long)done);
    printf("%s: %lld steps, %.3g s, %s\n", run->output.directory,
           (long long)done, run->report.seconds, end);
    return code == APP_OK && bad ? APP_FINDINGS : code;
}

static int simulate(struct run *run)
{
    int64_t each = run->scene.steps_per_frame;
    int64_t total = run->scene.frames * each;
    catch_signals();
    int code = APP_OK;
    if (run->report.count == 0) {
        output_clear(&run->output);
        code = output_frame(&run->output, run->world, 0);
    }
    progress_begin(&run->progress, run->report.count, total);
    while (code == APP_OK && run->report.count < total) {
        if (stopped) {
            code = APP_INTERRUPTED;
            break;
        }
        code = step(run);
    }
    progress_end(&run->progress);
    /* where the disk failed it is not tried again */
    bool left = code == APP_FAILED && !run->failed;
    return left || code == APP_USAGE ? code : finish(run, code);
}

int command_run(int argc, char **argv)
{
    struct run run = {.frames = -1, .overrides = {NULL, -1, -1, -1, 0}};
    run.output.every = 1;
    const struct option options[] = {
        {"--frames", OPTION_INT, &run.frames, 0, 1000000},
        {"--out", OPTION_TEXT, &run.directory, 0, 0},
        {"--backend", OPTION_TEXT, &run.overrides.backend, 0, 0},
        {"--precision", OPTION_INT, &run.overrides.precision, 32, 64},
        {"--threads", OPTION_INT, &run.overrides.threads, 0, 4096},
        {"--block", OPTION_INT, &run.overrides.block, 0, 256},
        {"--every", OPTION_INT, &run.output.every, 1, 1000000},
        {"--checkpoint-every", OPTION_INT, &run.checkpoint_every, 1, 1000000},
        {"--error", OPTION_TEXT, &run.error, 0, 0},
        {"--resume", OPTION_TEXT, &run.resume, 0, 0},
        {"--trace", OPTION_FLAG, &run.tracing, 0, 0},
        {"--no-obj", OPTION_FLAG, &run.no_obj, 0, 0},
        {"--allow-intersecting", OPTION_FLAG, &run.overrides.allow_intersecting,
         0, 0},
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
    drape_destroy(run.world);
    output_close(&run.output);
    report_free(&run.report);
    scene_free(&run.scene);
    return status;
}
