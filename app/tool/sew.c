/* SPDX-License-Identifier: Apache-2.0 */
/* drape sew: sews the garments of a pattern or a scene, and drapes them. */
#include "app/render/model.h"
#include "app/scene/sewing.h"
#include "app/tool/options.h"
#include "app/tool/progress.h"
#include "app/write/output.h"
#include "app/write/parted.h"
#include "app/write/report.h"
#include "app/write/seams.h"
#include "app/write/sewn.h"
#include "app/write/trace.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

struct sew {
    struct scene scene;
    struct overrides overrides;
    struct sewing sewing;
    struct sewn sewn;
    struct output output;
    struct report report;
    struct progress progress;
    json_t *root; /* of the scene, whose files are named from the root on */
    const char *body, *motion, *rate, *apart, *fabric, *cell, *attach,
        *directory;
    char out[FILE_PATH];
    struct file trace;
    int64_t worn; /* steps after which the bodies began to move; 0: they did not
                   */
    int frames, tracing, obj, force, no_motion, no_picture;
};

/* Reads the value of an option, if it is given. */
static int read_number(const char *option, const char *text, double lo,
                       double hi, double *out)
{
    char *end;
    if (!text)
        return APP_OK;
    *out = strtod(text, &end);
    if (end != text && !*end && *out >= lo && *out <= hi)
        return APP_OK;
    return complain(APP_USAGE, "%s %s: expected a number from %g to %g", option,
                    text, lo, hi);
}

/* The obstacle of a body, which a second brings to where its motion begins. */
static json_t *wrap_body(const struct sew *sew, double rate, double apart)
{
    json_t *body = json_pack("{s:s, s:s}", "name", "body", "mesh", sew->body);
    if (sew->apart)
        json_object_set_new(body, "apart", json_real(apart));
    if (sew->motion)
        json_object_set_new(
            body, "frames",
            json_pack("{s:s, s:f, s:f}",
                      strchr(sew->motion, '%') ? "files" : "file", sew->motion,
                      "dt", 1 / rate, "lead", 1.0));
    return body;
}

/* A word of an attachment: how, to what, or for how long. false: none of these.
 */
static bool read_word(const char *word, json_t *attach)
{
    char *end;
    double number = strtod(word, &end);
    if (!strcmp(word, "soft") || !strcmp(word, "hard"))
        json_object_set_new(attach, "hold", json_string(word));
    else if (!strcmp(word, "body") || !strcmp(word, "world"))
        json_object_set_new(attach, "to", json_string(word));
    else if (*word && !*end && number > 0 && number <= 1e6)
        json_object_set_new(attach, "until", json_real(number));
    else
        return false;
    return true;
}

/* Reads LABEL[:soft|hard][:body|world][:SECONDS], and others behind commas, to
 * a garment's key; `none`: nothing is attached. */
static int read_attaches(const char *text, json_t *garment)
{
    json_t *list = json_array();
    char *copy = strdup(text), *place, *inner;
    json_object_set_new(garment, "attach", list);
    if (!copy)
        return no_memory();
    bool none = !strcmp(text, "none"), good = true;
    for (char *one = strtok_r(copy, ",", &place); one && !none && good;
         one = strtok_r(NULL, ",", &place)) {
        json_t *attach = json_object();
        char *word = strtok_r(one, ":", &inner);
        good = word != NULL;
        if (good)
            json_object_set_new(attach, "label", json_string(word));
        while (good && (word = strtok_r(NULL, ":", &inner)))
            good = read_word(word, attach);
        json_array_append_new(list, attach);
    }
    free(copy);
    return good && (none || json_array_size(list))
               ? APP_OK
               : complain(APP_USAGE,
                          "--attach %s: expected "
                          "LABEL[:soft|hard][:body|world][:SECONDS], more of "
                          "these behind commas, or none",
                          text);
}

/* The scene of a pattern and a body. NULL after one line. */
static json_t *wrap(const struct sew *sew, const char *file)
{
    double cell = 0.005, rate = 60, apart = 0;
    const char *slash = strrchr(file, '/');
    if (read_number("--cell", sew->cell, 1e-4, 0.1, &cell) != APP_OK ||
        read_number("--rate", sew->rate, 1e-3, 1e6, &rate) != APP_OK ||
        read_number("--apart", sew->apart, 0, 1, &apart) != APP_OK)
        return NULL;
    if (sew->rate && !sew->motion) {
        complain(APP_USAGE, "--rate: expected --motion beside it");
        return NULL;
    }
    if ((sew->motion || sew->apart) && !sew->body) {
        complain(APP_USAGE, "--%s: expected --body beside it",
                 sew->motion ? "motion" : "apart");
        return NULL;
    }
    json_t *garment = json_object(), *scene = json_object();
    json_object_set_new(garment, "pattern", json_string(file));
    json_object_set_new(garment, "cell", json_real(cell));
    if (sew->fabric)
        json_object_set_new(garment, "material", json_string(sew->fabric));
    if (sew->attach && read_attaches(sew->attach, garment) != APP_OK) {
        json_decref(garment);
        json_decref(scene);
        return NULL;
    }
    char name[256];
    snprintf(name, sizeof name, "%.250s", slash ? slash + 1 : file);
    char *dot = strrchr(name, '.');
    if (dot && dot != name)
        *dot = 0;
    json_object_set_new(scene, "name", json_string(name));
    json_object_set_new(scene, "frames", json_integer(600));
    json_object_set_new(scene, "garments", json_pack("[o]", garment));
    if (sew->body)
        json_object_set_new(scene, "obstacles",
                            json_pack("[o]", wrap_body(sew, rate, apart)));
    /* names begin in the present folder, as on every command line */
    sewn_name_files(scene, ".");
    return scene;
}

/* Reads the pattern or the scene. */
static int load(struct sew *sew, const char *file)
{
    sew->root = json_parse(file);
    if (!sew->root)
        return APP_USAGE;
    if (json_object_get(json_object_get(sew->root, "pattern"), "panels")) {
        json_decref(sew->root);
        sew->root = wrap(sew, file);
        if (!sew->root)
            return APP_USAGE;
    } else {
        if (sew->body || sew->cell || sew->fabric || sew->motion || sew->rate ||
            sew->apart || sew->attach)
            return complain(APP_USAGE,
                            "%s is no pattern: --body, --motion, --rate, "
                            "--apart, --cell, --fabric and --attach are keys "
                            "of a scene",
                            file);
        sewn_name_files(sew->root, file);
    }
    char *text = json_dumps(sew->root, JSON_REAL_PRECISION(17));
    if (!text)
        return no_memory();
    int status = scene_load_text(&sew->scene, text, strlen(text), file);
    free(text);
    if (status == APP_OK && !sew->scene.def.n_seams)
        status = complain(APP_USAGE, "%s: there is no seam to sew", file);
    return status;
}

/* The steps in which the bodies are to move. */
static int64_t moves(const struct sew *sew)
{
    return sew->no_motion ? 0 : sewing_moves(&sew->sewing);
}

static int begin(struct sew *sew, const char *file)
{
    struct scene *scene = &sew->scene;
    int status = load(sew, file);
    if (status != APP_OK)
        return status;
    if (sew->frames >= 0)
        scene->frames = sew->frames;
    if (!output_name(sew->out, scene, sew->directory))
        return APP_USAGE;
    if (!sew->force)
        status = folder_empty(sew->out);
    if (sew->tracing) {
        scene->def.trace = trace_row;
        scene->def.trace_user = &sew->trace;
    }
    if (status == APP_OK)
        status = sewing_begin(&sew->sewing, scene, &sew->overrides);
    if (status != APP_OK)
        return status;
    char id[REPORT_ID];
    struct claim claim = {report_id(&sew->report, scene, id), NULL, 0,
                          sew->force};
    sew->output.obj = sew->obj;
    sew->output.moving = moves(sew) > 0;
    status =
        output_open(&sew->output, scene, sew->sewing.world, sew->out, &claim);
    if (status == APP_OK &&
        (!parted_write(scene, sew->out) ||
         !seams_write(scene, &sew->sewing.whole, sew->sewing.holds, sew->out) ||
         !report_write(&sew->report, scene, sew->sewing.world, sew->out,
                       "unfinished")))
        status = APP_FAILED;
    return status == APP_OK && sew->tracing
               ? trace_begin(&sew->trace, sew->out, 0)
               : status;
}

static int put_frame(struct sew *sew, int k)
{
    int status = output_frame(&sew->output, sew->sewing.world, k);
    return status == APP_OK ? sewn_add(&sew->sewn, &sew->sewing, k) : status;
}

/* Shows which stage it is, and what is open. */
static void show(struct sew *sew)
{
    const struct sewing *s = &sew->sewing;
    int open = 0, waiting = 0;
    char words[160];
    for (int k = 0; k < s->whole.n_seams; k++) {
        open += !s->seam[k].closed;
        waiting += s->seam[k].index >= 0 ? s->seam[k].waiting : 0;
    }
    snprintf(words, sizeof words,
             "step %lld  %s  %d of %d seams open  %d points wait",
             (long long)s->steps, sewing_stages[s->stage], open,
             s->whole.n_seams, waiting);
    progress_show(&sew->progress, s->steps, words);
}

static int step(struct sew *sew)
{
    struct sewing *s = &sew->sewing;
    drape_step_report report;
    double began = seconds_now();
    int status = sewing_step(s, &report);
    sew->report.seconds += seconds_now() - began;
    if (status == APP_OK)
        status = trace_check(&sew->trace);
    if (status != APP_OK)
        return status;
    if (!report_add(&sew->report, &report))
        return APP_FAILED;
    if (report.outcome & DRAPE_DIVERGED)
        return complain(APP_FINDINGS,
                        "step %lld: diverged; the state before it is kept",
                        (long long)s->steps);
    show(sew);
    int64_t each = sew->scene.steps_per_frame;
    if (s->steps % each == 0)
        status = put_frame(sew, (int)(s->steps / each));
    return status;
}

/* Says what is attached, to what and for how long. */
static void tell_holds(const struct sewing *s)
{
    for (int k = 0; k < s->holds; k++) {
        const struct sewing_hold *hold = &s->hold[k];
        char until[64] = "to the end";
        if (hold->to >= 0)
            snprintf(until, sizeof until, "until step %lld",
                     (long long)hold->to);
        if (hold->from >= 0)
            complain(APP_OK,
                     "%s: %lld particles were held to %s from step %lld %s; "
                     "they slipped by at most %.2g mm, and the pull was %.2g "
                     "N/m at most",
                     hold->about->name, (long long)hold->about->n,
                     hold->body < 0 ? "the world"
                                    : s->scene->obstacle_name[hold->body],
                     (long long)hold->from, until, 1e3 * hold->slip,
                     hold->strongest);
    }
}

/* Names the seams that are open, and says how it ended. */
static int tell(const struct sew *sew, const struct totals *t, const char *end)
{
    const struct sewing *s = &sew->sewing;
    int open = 0;
    for (int k = 0; k < s->whole.n_seams; k++) {
        const struct sewing_seam *seam = &s->seam[k];
        if (seam->closed)
            continue;
        open++;
        if (seam->stage > s->stage)
            complain(APP_FINDINGS, "seam %s: its turn has not come",
                     s->scene->seam[k].name);
        else
            complain(APP_FINDINGS,
                     "seam %s is open by %.3g mm at point %d of %lld; %d "
                     "points wait, and it pulls by at most %.3g N/m",
                     s->scene->seam[k].name, 1e3 * seam->most, seam->worst,
                     (long long)seam->n, seam->waiting, seam->strongest);
    }
    tell_holds(s);
    if (t->unconverged)
        complain(0, "note: the solver missed its tolerance in %lld steps",
                 (long long)t->unconverged);
    stretch_tell(sew->output.stretch, sew->output.cloth_part,
                 sew->output.cloths);
    if (!s->rest)
        complain(0, "note: it has not come to rest%s",
                 sew->worn ? " before the bodies moved" : "");
    if (t->not_clean)
        complain(APP_FINDINGS, "%lld of %lld steps are not clean",
                 (long long)t->not_clean, (long long)t->steps);
    int64_t pairs = 0;
    for (int k = 0; k < sew->sewn.count; k++)
        pairs += sew->sewn.frame[k].pairs;
    say("%s: %lld steps, %.3g s, %s; %d of %d seams closed; %lld pairs in %d "
        "frames\n",
        sew->output.directory, (long long)t->done, sew->report.seconds, end,
        s->whole.n_seams - open, s->whole.n_seams, (long long)pairs,
        sew->sewn.count);
    return open || pairs || t->not_clean ? APP_FINDINGS : APP_OK;
}

/* Takes the frame at a step, or the one that is there before it, from the front
 * and from behind. */
static int take_pictures(const struct sew *sew, int64_t step)
{
    static const char *const names[] = {"front", "back"};
    struct pool pool = {0};
    struct run_look look;
    struct model model;
    struct shot shot = {.width = 600, .height = 800, .samples = 16};
    char folder[FILE_PATH], name[64];
    int k = (int)(step / sew->scene.steps_per_frame);
    k -= k % sew->output.every;
    uint8_t *rgb = malloc((size_t)shot.width * (size_t)shot.height * 3);
    int status = rgb ? look_load(&pool, sew->out, &look) : no_memory();
    if (status == APP_OK)
        status = model_load(&pool, sew->out, k, &look, &model);
    if (status == APP_OK && (!file_join(folder, sew->out, "pictures") ||
                             !file_make_directory(folder)))
        status = APP_FAILED;
    for (int side = 0; side < 2 && status == APP_OK; side++) {
        shot.camera = look.camera;
        shot.turned = 180 * side;
        status = picture_take(&model, &shot, rgb);
        snprintf(name, sizeof name, "%s_%04d.png", names[side], k);
        if (status == APP_OK &&
            !picture_save(folder, name, rgb, shot.width, shot.height))
            status = APP_FAILED;
    }
    free(rgb);
    pool_free(&pool);
    return status;
}

static int finish(struct sew *sew, int code)
{
    struct totals totals;
    struct sewing *s = &sew->sewing;
    report_sum(&sew->report, &totals);
    sew->scene.def = s->whole; /* not the last stage's */
    const char *end = code == APP_INTERRUPTED ? "interrupted"
                      : code == APP_FINDINGS  ? "diverged"
                      : s->rest && !sew->worn ? "at rest"
                                              : "complete";
    int64_t frame = totals.done / sew->scene.steps_per_frame;
    int status = output_cache(&sew->output, (int)frame);
    if (status != APP_OK ||
        !report_write(&sew->report, &sew->scene, s->world, sew->out, end) ||
        !sewn_write(&sew->sewn, s, sew->out) ||
        (!sew->worn && !sewn_save(s, sew->out)) ||
        !sewn_put_scene(sew->root, sew->out, "sewn.json") ||
        (sew->tracing && !file_close(&sew->trace)))
        return APP_FAILED;
    if (!sew->no_picture && sew->worn)
        status = take_pictures(sew, sew->worn);
    if (!sew->no_picture && status == APP_OK)
        status = take_pictures(sew, totals.done);
    int found = tell(sew, &totals, end);
    return status != APP_OK ? status : code == APP_OK ? found : code;
}

/* Sews the garment until it is at rest, at most so many steps. */
static int wear(struct sew *sew, int64_t total)
{
    int code = APP_OK;
    progress_begin(&sew->progress, 0, total);
    while (code == APP_OK && sew->sewing.steps < total && !sew->sewing.rest)
        code = progress_stopped() ? APP_INTERRUPTED : step(sew);
    progress_end(&sew->progress);
    return code;
}

/* Lets the bodies move, if the garment is worn, to a whole frame. */
static int move(struct sew *sew)
{
    int64_t each = sew->scene.steps_per_frame;
    int64_t total = sew->sewing.steps + moves(sew);
    if (!moves(sew))
        return APP_OK;
    if (sew->sewing.stage != SEWING_WORN)
        return complain(APP_OK, "note: no body moves, as the garment is not "
                                "worn after the frames of --frames");
    if (!sewn_save(&sew->sewing, sew->out))
        return APP_FAILED;
    sew->worn = sew->sewing.steps;
    int code = sewing_move(&sew->sewing);
    total = (total + each - 1) / each * each;
    progress_begin(&sew->progress, sew->worn, total);
    while (code == APP_OK && sew->sewing.steps < total)
        code = progress_stopped() ? APP_INTERRUPTED : step(sew);
    progress_end(&sew->progress);
    return code;
}

static int simulate(struct sew *sew)
{
    progress_catch_stop();
    int code = put_frame(sew, 0);
    if (code == APP_OK)
        code =
            wear(sew, (int64_t)sew->scene.frames * sew->scene.steps_per_frame);
    if (code == APP_OK)
        code = move(sew);
    return code == APP_FAILED ? code : finish(sew, code);
}

/* Whether a file is a mesh, whose UV charts are panels: Python sews it. */
static bool is_mesh(const char *path)
{
    size_t length = strlen(path);
    return length > 4 && strcasecmp(path + length - 4, ".obj") == 0;
}

int command_sew(int argc, char **argv)
{
    const char *unit = NULL;
    struct sew sew = {.frames = -1, .overrides = {NULL, -1, -1, -1, 0}};
    sew.output.every = 1;
    const struct option_row options[] = {
        TEXT_OPTION("--body", &sew.body),
        TEXT_OPTION("--motion", &sew.motion),
        TEXT_OPTION("--rate", &sew.rate),
        TEXT_OPTION("--apart", &sew.apart),
        TEXT_OPTION("--cell", &sew.cell),
        TEXT_OPTION("--fabric", &sew.fabric),
        TEXT_OPTION("--attach", &sew.attach),
        INT_OPTION("--frames", &sew.frames, 0, 1000000),
        TEXT_OPTION("--out", &sew.directory),
        TEXT_OPTION("--backend", &sew.overrides.backend),
        BITS_OPTION("--precision", &sew.overrides.precision),
        INT_OPTION("--threads", &sew.overrides.threads, 0, 4096),
        INT_OPTION("--block", &sew.overrides.block, 0, 256),
        INT_OPTION("--every", &sew.output.every, 1, 1000000),
        FLAG_OPTION("--force", &sew.force),
        FLAG_OPTION("--trace", &sew.tracing),
        FLAG_OPTION("--obj", &sew.obj),
        FLAG_OPTION("--no-motion", &sew.no_motion),
        FLAG_OPTION("--no-picture", &sew.no_picture),
        TEXT_OPTION("--unit", &unit),
        {0}};
    int positional;
    char **given = calloc((size_t)argc + 1, sizeof *given);
    if (!given)
        return no_memory();
    memcpy(given, argv, (size_t)argc * sizeof *given);
    int status = options_read(options, argc, argv, &positional);
    if (status == APP_OK && positional != 1)
        status = complain(APP_USAGE, "sew: expected one PATTERN.json, "
                                     "SCENE.json or MESH.obj");
    else if (status == APP_OK && is_mesh(argv[0]))
        status = become_python("sew-mesh", argc, given);
    else if (status == APP_OK && unit)
        status = complain(APP_USAGE, "sew: --unit is for a MESH.obj");
    free(given);
    if (status != APP_OK)
        return status;
    status = begin(&sew, argv[0]);
    if (status == APP_OK)
        status = simulate(&sew);
    file_drop(&sew.trace);
    sewing_end(&sew.sewing);
    output_close(&sew.output);
    report_free(&sew.report);
    sewn_free(&sew.sewn);
    json_decref(sew.root);
    scene_free(&sew.scene);
    return status;
}
