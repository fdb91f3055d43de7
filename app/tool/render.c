/* SPDX-License-Identifier: Apache-2.0 */
/* drape render: makes pictures and a film of a run's frames. */
#include "app/base/file.h"
#include "app/render/model.h"
#include "app/tool/options.h"
#include "app/tool/progress.h"
#include "app/write/output.h"

#include <errno.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>

extern char **environ;

struct render {
    const char *directory;
    char pictures[FILE_PATH];
    struct run_look look;
    struct shot shot;
    uint8_t *rgb;
    int frame, every, no_film, rate;
    int turn;           /* pictures of one frame from all around; 0: a film */
    int *frames, count; /* numbers of the existing frames, ascending */
};

static int take(struct render *r, int frame, int number)
{
    struct pool pool = {0};
    struct model model;
    char name[64];
    bool one = r->frame >= 0 && !r->turn;
    snprintf(name, sizeof name, "%s_%04d.png", one ? "frame" : "film", number);
    r->shot.turned = r->turn ? 360.0 * number / r->turn
                             : r->look.camera.turn * frame / r->look.rate;
    int status = model_load(&pool, r->directory, frame, &r->look, &model);
    if (status == APP_OK)
        status = picture_take(&model, &r->shot, r->rgb);
    pool_free(&pool);
    if (status == APP_OK &&
        !picture_save(r->pictures, name, r->rgb, r->shot.width, r->shot.height))
        return APP_FAILED;
    return status;
}

/* Runs a program found in PATH and waits for its end. Returns its exit status,
 * 1 if a signal ended it, or -1 if it was not found. */
static int call(char *const argv[])
{
    pid_t child;
    int status;
    if (posix_spawnp(&child, argv[0], NULL, NULL, argv, environ) != 0)
        return -1;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    if (!WIFEXITED(status))
        return 1;
    return WEXITSTATUS(status) == 127 ? -1 : WEXITSTATUS(status);
}

/* Makes film.mp4 of the pictures, if ffmpeg is installed. */
static int make_film(const struct render *r)
{
    char rate[32], pattern[FILE_PATH], part[FILE_PATH], film[FILE_PATH];
    snprintf(rate, sizeof rate, "%d", r->rate);
    if (!file_join(pattern, r->pictures, "film_%04d.png") ||
        !file_join(part, r->directory, ".film.part.mp4") ||
        !file_join(film, r->directory, "film.mp4"))
        return APP_USAGE;
    char *const argv[] = {
        "ffmpeg",   "-nostdin", "-v",
        "error",    "-y",       "-framerate",
        rate,       "-i",       pattern,
        "-c:v",     "libx264",  "-crf",
        "18",       "-vf",      "pad=ceil(iw/2)*2:ceil(ih/2)*2",
        "-pix_fmt", "yuv420p",  part,
        NULL};
    int status = call(argv);
    if (status < 0) {
        complain(0,
                 "note: no ffmpeg here, so no film; the pictures are in "
                 "%s",
                 r->pictures);
        return APP_OK;
    }
    if (status == 0 && rename(part, film) == 0) {
        say("%s\n", film);
        return APP_OK;
    }
    remove(part);
    return complain(APP_FAILED, "render: ffmpeg failed on %s", film);
}

static int take_one(struct render *r)
{
    int status = take(r, r->frame, r->frame);
    if (status == APP_OK)
        say("%s/frame_%04d.png\n", r->pictures, r->frame);
    return status;
}

static int take_all(struct render *r)
{
    int made = 0, status = folder_clear_film(r->directory);
    int total = r->turn ? r->turn : (r->count + r->every - 1) / r->every;
    int still = r->frame >= 0 ? r->frame : r->frames[r->count - 1];
    struct progress progress;
    progress_begin(&progress, 0, total);
    for (int k = 0; made < total && status == APP_OK; k += r->every) {
        char words[64];
        status = take(r, r->turn ? still : r->frames[k], made);
        made++;
        snprintf(words, sizeof words, "picture %d/%d", made, total);
        if (status == APP_OK)
            progress_show(&progress, made, words);
    }
    progress_end(&progress);
    if (status != APP_OK)
        return status;
    say("%s: %d pictures\n", r->pictures, made);
    /* a run may have written only every n-th frame */
    int apart = r->count > 1 ? r->frames[1] - r->frames[0] : 1;
    if (!r->rate) /* once around in six seconds, or as fast as the run */
        r->rate = r->turn ? r->turn / 6
                          : (int)(r->look.rate / r->every / apart + 0.5);
    r->rate = r->rate < 1 ? 1 : r->rate;
    return r->no_film ? APP_OK : make_film(r);
}

static int render(struct render *r)
{
    char path[FILE_PATH];
    if (r->frame >= 0 && (!output_path(path, r->directory, "cloth", r->frame) ||
                          !file_exists(path)))
        return complain(APP_USAGE,
                        "--frame %d: it is not there; the last frame is %d",
                        r->frame, r->frames[r->count - 1]);
    if (!file_join(r->pictures, r->directory, "pictures"))
        return APP_USAGE;
    if (!file_make_directory(r->pictures))
        return APP_FAILED;
    return r->frame >= 0 && !r->turn ? take_one(r) : take_all(r);
}

int command_render(int argc, char **argv)
{
    struct render r = {.frame = -1, .every = 1};
    r.shot = (struct shot){.width = 800, .height = 600, .samples = 8};
    const struct option_row options[] = {
        INT_OPTION("--frame", &r.frame, 0, 1000000),
        INT_OPTION("--every", &r.every, 1, 1000000),
        INT_OPTION("--turn", &r.turn, 1, 100000),
        INT_OPTION("--width", &r.shot.width, 16, 16384),
        INT_OPTION("--height", &r.shot.height, 16, 16384),
        INT_OPTION("--samples", &r.shot.samples, 1, 65536),
        INT_OPTION("--threads", &r.shot.threads, 0, 256),
        INT_OPTION("--rate", &r.rate, 1, 1000),
        FLAG_OPTION("--no-film", &r.no_film),
        {0}};
    int positional;
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (positional != 1)
        return complain(APP_USAGE, "render: expected one DIR of a run");
    if (!file_is_directory(argv[0]))
        return complain(APP_USAGE, "%s: no such folder; expected a run's",
                        argv[0]);
    r.directory = argv[0];
    r.frames = output_frames(r.directory, &r.count);
    if (!r.frames)
        return APP_USAGE;
    struct pool pool = {0};
    status = look_load(&pool, r.directory, &r.look);
    r.shot.camera = r.look.camera;
    r.rgb = malloc((size_t)r.shot.width * (size_t)r.shot.height * 3);
    if (status == APP_OK)
        status = r.rgb ? render(&r) : complain(APP_FAILED, "out of memory");
    free(r.rgb);
    free(r.frames);
    pool_free(&pool);
    return status;
}
