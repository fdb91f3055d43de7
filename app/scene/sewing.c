/* SPDX-License-Identifier: Apache-2.0 */
/* Draws the seams of a scene's garments together: app/patterns/README.md §11.
 */
#include "app/scene/sewing.h"
#include "app/base/app.h"
#include "app/base/vec3.h"
#include "app/read/crossings.h"
#include "app/read/untangle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const sewing_stages[SEWING_STAGES] = {
    "darts", "around", "seams", "across", "free", "worn", "moving"};

/* The fastest target. Within a step of 1/60 s it falls by 8 mm, which is less
 * than cloth moves when it falls freely for 0.05 s. */
static const double fastest = 0.5; /* m/s */
/* Near its end a gap falls more slowly: by `slowest` and by itself in the time
 * `settle`. It bounds how far the cloth behind an edge goes on when the edge
 * stops. At 0.5 m/s 0.3 m of light cotton have 6 mJ per metre of the edge, more
 * than the 2 mJ of a curl with a radius of 7 mm (its moment times pi over twice
 * the radius), and borders went past each other and stayed curled; at the 0.1
 * m/s that are left at a gap of 5 mm they have 0.2 mJ. */
static const double slowest = 0.05; /* m/s */
static const double settle = 0.1;   /* s */
/* While it is sewn, the air is so dense that cloth loses its speed to 1/e on
 * this way: a panel whose edges stop would swing on, and then edges of one leg
 * go between those of the other that close beside them. */
static const double glide = 0.01; /* m */
/* The greatest pull of a seam while it is sewn, which strains light cotton by 3
 * %, and once it is worn, which is many times what a garment weighs. */
static const double sewing_pull = 30, worn_pull = 300; /* N/m */
/* What is called closed: this part of a cell; and what is near enough for the
 * next stage, in which seams pull harder. */
static const double closed = 0.01, near = 0.5;
/* Times the scene's tolerance: while sewn, as what one step leaves of a gap the
 * next one takes up; and once worn, as a tolerance is relative to what presses.
 * Cloth that is caught in an armpit is pressed by many times its weight, and
 * gaps beside it are to be below `closed`. */
static const double rough = 10, fine = 0.1;
/* At rest: the root mean square of the ways that particles go in this time, s,
 * is below this, m. */
static const double rest_way = 1e-3, rest_time = 1;
/* A stage ends, too, if what is open becomes less by no more than this part of
 * what was open when it began, in this time, s. What is then still held back
 * by friction closes as slowly in the next ones. */
static const double progress = 0.05, patience = 0.5;
enum { RAMP = 30 }; /* frames in which gravity comes */
/* A seam whose turn has not come is held once its gaps are in the mean longer
 * by this many cells than they began: the error in place that this leaves is
 * one cell, and a garment in which none is longer takes no seam before its
 * turn. */
static const double slack = 1;

static int failed(const char *what, int status)
{
    return complain(APP_FAILED, "sew: %s: %s", what, drape_status_text(status));
}

/* Finds the gaps of a seam that is not in the world, by the particles in s->x.
 */
static void find_gaps(const struct sewing *s, int k)
{
    const drape_seam *seam = &s->whole.seams[k];
    const double(*a)[3] =
        (const double(*)[3])s->x + drape_first_vertex(s->world, seam->cloth[0]);
    const double(*b)[3] =
        (const double(*)[3])s->x + drape_first_vertex(s->world, seam->cloth[1]);
    for (int64_t p = 0; p < seam->n; p++) {
        const double *x = a[seam->particle[p]], *y = b[seam->onto[p][0]];
        const double *z = b[seam->onto[p][1]];
        for (int i = 0; i < 3; i++)
            s->seam[k].gap[p][i] = x[i] - y[i] - seam->part[p] * (z[i] - y[i]);
    }
}

/* The mean length of a seam's gaps, m. */
static double mean_gap(const struct sewing_seam *seam)
{
    double sum = 0;
    for (int64_t p = 0; p < seam->n; p++)
        sum += vec3_length(seam->gap[p]);
    return sum / (double)seam->n;
}

static int make_seams(struct sewing *s)
{
    int seams = s->whole.n_seams;
    s->seam = pool_take(&s->pool, (size_t)seams + 1, sizeof *s->seam);
    if (!s->seam)
        return no_memory();
    for (int k = 0; k < seams; k++) {
        struct sewing_seam *seam = &s->seam[k];
        size_t n = (size_t)s->whole.seams[k].n;
        seam->n = (int64_t)n;
        seam->index = -1;
        for (int64_t p = 0; p < seam->n; p++)
            seam->spacing += s->scene->seam[k].length[p] / (double)seam->n;
        seam->gap = pool_take(&s->pool, n, sizeof *seam->gap);
        seam->pull = pool_take(&s->pool, n, sizeof *seam->pull);
        seam->target = pool_take(&s->pool, n, sizeof *seam->target);
        if (!seam->gap || !seam->pull || !seam->target)
            return no_memory();
        const struct scene_seam *about = &s->scene->seam[k];
        seam->stage = about->dart     ? SEWING_DARTS
                      : about->across ? SEWING_ACROSS
                      : about->around ? SEWING_AROUND
                                      : SEWING_SEAMS;
        find_gaps(s, k);
        seam->start = mean_gap(seam);
    }
    return APP_OK;
}

/* Tells triangles of cloth from those of bodies, and counts the particles that
 * have one. */
static int mark_cloth(struct sewing *s)
{
    bool *there = pool_take(&s->pool, (size_t)s->nv + 1, sizeof *there);
    if (!there)
        return no_memory();
    for (int64_t k = 0; k < s->nt; k++) {
        s->group[k] = s->tri[k][0] < s->nc;
        for (int i = 0; i < 3; i++)
            there[s->tri[k][i]] = s->group[k];
    }
    int64_t shown =
        drape_first_vertex(s->world, s->whole.n_cloths - s->scene->hidden);
    for (int64_t k = 0; k < shown; k++)
        s->particles += there[k];
    return APP_OK;
}

/* Makes the scene as it is once, to check it and to see where its bodies are at
 * time 0, and takes memory for what stages change. */
static int inspect_scene(struct sewing *s)
{
    const drape_def *def = &s->whole;
    int allowed = s->scene->def.allow_intersecting;
    int status = holds_begin(s);
    s->scene->def.allow_intersecting = 1; /* what begins in a body may move */
    if (status == APP_OK)
        status = scene_create(s->scene, s->overrides, &s->world);
    s->scene->def.allow_intersecting =
        allowed || s->overrides->allow_intersecting > 0;
    if (status != APP_OK)
        return status;
    s->whole = s->scene->def; /* with the overrides */
    int cloths = def->n_cloths, obstacles = def->n_obstacles;
    s->nv = drape_vertices(s->world);
    s->nt = drape_triangles(s->world);
    s->nc = drape_first_vertex(s->world, cloths);
    size_t nv = (size_t)s->nv, nt = (size_t)s->nt;
    s->x = pool_take(&s->pool, nv + 1, sizeof *s->x);
    s->was = pool_take(&s->pool, nv + 1, sizeof *s->was);
    s->v = pool_take(&s->pool, nv + 1, sizeof *s->v);
    s->tri = pool_take(&s->pool, nt + 1, sizeof *s->tri);
    s->group = pool_take(&s->pool, nt + 1, sizeof *s->group);
    s->cloth = pool_take(&s->pool, (size_t)cloths, sizeof *s->cloth);
    s->obstacle =
        pool_take(&s->pool, (size_t)obstacles + 1, sizeof *s->obstacle);
    s->turn = pool_take(&s->pool, (size_t)(def->n_seams + s->holds) + 1,
                        sizeof *s->turn);
    s->next = pool_take(&s->pool, nv + 1, sizeof *s->next);
    if (!s->x || !s->next || !s->was || !s->v || !s->tri || !s->group ||
        !s->cloth || !s->obstacle || !s->turn)
        return no_memory();
    int known = drape_read_triangles(s->world, s->tri);
    if (known == DRAPE_OK)
        known = drape_read(s->world, s->x, s->v);
    return known == DRAPE_OK ? mark_cloth(s) : failed("the state", known);
}

/* Says of each panel that was moved how far. */
static void tell_moves(const struct sewing *s, const struct clearing *c)
{
    for (int k = 0; k < s->whole.n_cloths; k++) {
        const double *way = c->way[k];
        if (c->by[k] < 0)
            continue;
        complain(APP_OK,
                 "%s: note: panel %s is moved by %.3g cm, (%.3g, %.3g, %.3g) "
                 "m, as %s%s begins in a body",
                 s->scene->file, s->scene->cloth_name[k],
                 1e2 * vec3_length(way), way[0], way[1], way[2],
                 c->by[k] == k ? "" : "panel ",
                 c->by[k] == k ? "it" : s->scene->cloth_name[c->by[k]]);
    }
}

/* Moves panels that begin in a body, if a start may not intersect. */
static int clear_start(struct sewing *s)
{
    const struct scene *scene = s->scene;
    int cloths = s->whole.n_cloths, parts = cloths + s->whole.n_obstacles;
    bool *moves = pool_take(&s->pool, (size_t)parts, sizeof *moves);
    int64_t *first = pool_take(&s->pool, (size_t)parts + 1, sizeof *first);
    if (!moves || !first)
        return no_memory();
    struct clearing c = {.nt = s->nt,
                         .x = s->x,
                         .tri = (const int32_t(*)[3])s->tri,
                         .parts = parts,
                         .first = first,
                         .moves = moves,
                         .threads = s->whole.threads,
                         .pool = &s->pool};
    for (int k = 0; k <= parts; k++)
        first[k] = drape_first_vertex(s->world, k);
    for (int k = 0; k < scene->garments; k++)
        for (int i = scene->garment_cloth[k]; i < scene->garment_cloth[k + 1];
             i++)
            moves[i] = !scene->garment_sewn[k];
    if (s->whole.allow_intersecting)
        return APP_OK;
    int status = lift_panels(s, moves);
    if (status == APP_OK)
        status = clear_panels(&c);
    if (status != APP_OK)
        return status;
    tell_moves(s, &c);
    s->way = c.way;
    s->by = c.by;
    if (c.stuck < 0)
        return APP_OK;
    const struct clear_place *at = &c.place;
    return complain(
        APP_USAGE,
        "%s: panel %s begins in %s, around (%.3g, %.3g, %.3g) m over %.3g cm, "
        "%lld pairs of triangles, and no way of up to %.3g cm is free",
        scene->file, scene->cloth_name[c.stuck],
        at->body < cloths ? scene->cloth_name[at->body]
                          : scene->obstacle_name[at->body - cloths],
        at->at[0], at->at[1], at->at[2], 1e2 * at->size, (long long)at->pairs,
        1e2 * at->tried);
}

/* Counts the steps of a trace since sewing began. */
static void trace(void *user, int64_t step, const char *stage, uint64_t digest,
                  double seconds)
{
    const struct sewing *s = user;
    s->whole.trace(s->whole.trace_user, s->begun[s->stage] + step, stage,
                   digest, seconds);
}

/* The air in which a garment is sewn. A plate of m kg/m² that it meets at the
 * speed v is slowed by ½ ρ v² = m v dv/dx, so v falls to 1/e on 2 m/ρ. m: of
 * the heaviest cloth. */
static drape_wind thick_air(const struct sewing *s)
{
    double most = 0;
    for (int k = 0; k < s->whole.n_cloths; k++)
        most = fmax(most, s->whole.cloths[k].material.density);
    return (drape_wind){.density = 2 * most / glide, .drag = 1};
}

/* The definition of a stage, in the state of the world before it. */
static void define_stage(struct sewing *s, enum sewing_stage stage)
{
    drape_def *def = &s->scene->def;
    bool worn = stage >= SEWING_WORN, moving = stage == SEWING_MOVING;
    int64_t at = 0;
    *def = s->whole;
    for (int k = 0; k < def->n_cloths; k++) {
        s->cloth[k] = s->whole.cloths[k];
        s->cloth[k].x = (const double(*)[3])s->x + at;
        s->cloth[k].velocity = (const double(*)[3])s->v + at;
        at += (int64_t)s->cloth[k].m * s->cloth[k].n;
        if (!worn)
            s->cloth[k].material.friction = 0;
    }
    for (int k = 0; k < def->n_obstacles; k++) {
        s->obstacle[k] = s->whole.obstacles[k];
        if (stage == SEWING_FREE)
            s->obstacle[k].friction = 0;
        if (moving && !s->holds)
            continue; /* it is led from its time 0 on, where it stands yet */
        s->obstacle[k].x = (const double(*)[3])s->x + at;
        s->obstacle[k].motion = -1;
        s->obstacle[k].frames = 0;
        at += s->obstacle[k].n_vertices;
    }
    def->cloths = s->cloth;
    def->obstacles = s->obstacle;
    def->seams = s->turn;
    def->n_seams = 0;
    for (int k = 0; k < s->whole.n_seams; k++) {
        s->seam[k].index = -1;
        s->seam[k].told = false;
        if (s->seam[k].stage > stage && !s->seam[k].held)
            continue;
        s->seam[k].index = def->n_seams;
        s->turn[def->n_seams] = s->whole.seams[k];
        s->turn[def->n_seams++].strength =
            (worn ? worn_pull : sewing_pull) * s->seam[k].spacing;
    }
    holds_define(s);
    if (def->trace) {
        def->trace = trace;
        def->trace_user = s;
    }
    if (!moving)
        memset(def->gravity, 0, sizeof def->gravity);
    if (!worn)
        def->wind = thick_air(s);
    else if (!moving)
        memset(def->wind.velocity, 0, sizeof def->wind.velocity);
    def->tolerance = fmin(1, def->tolerance * (worn ? fine : rough));
    if (!worn)
        def->sleep = 0;
}

/* Reads what the seams are like. */
static int read_seams(struct sewing *s)
{
    for (int k = 0; k < s->whole.n_seams; k++) {
        struct sewing_seam *seam = &s->seam[k];
        if (seam->index < 0)
            continue;
        int status =
            drape_seam_state(s->world, seam->index, seam->gap, seam->pull);
        if (status != DRAPE_OK)
            return failed("a seam", status);
        seam->most = seam->strongest = 0;
        for (int64_t p = 0; p < seam->n; p++) {
            double gap = vec3_length(seam->gap[p]);
            double pull = vec3_length(seam->pull[p]) / seam->spacing;
            if (gap > seam->most) {
                seam->most = gap;
                seam->worst = (int)p;
            }
            seam->strongest = fmax(seam->strongest, pull);
        }
        bool is = sewing_is_closed(s, k);
        seam->closed = !is ? 0 : seam->closed ? seam->closed : s->steps;
    }
    return APP_OK;
}

/* Makes the world of a stage from the state of the one before it. */
static int make_world(struct sewing *s, enum sewing_stage stage)
{
    /* the first stage has the state that was made for it */
    int status = s->steps ? drape_read(s->world, s->x, s->v) : DRAPE_OK;
    if (status != DRAPE_OK)
        return failed("the state", status);
    if (holds_may_begin(s, stage))
        holds_bind(s);
    drape_destroy(s->world);
    s->world = NULL;
    s->stage = stage;
    s->still_since = -1;
    s->heavy = stage == SEWING_MOVING;
    define_stage(s, stage);
    status = scene_create(s->scene, s->overrides, &s->world);
    return status == APP_OK ? read_seams(s) : status;
}

static int enter_stage(struct sewing *s, enum sewing_stage stage)
{
    s->begun[stage] = s->steps;
    s->still = 0;
    s->left = INFINITY;
    return make_world(s, stage);
}

/* Whether the turn of seam k has come. */
static bool has_turn(const struct sewing *s, int k)
{
    return s->seam[k].stage <= s->stage;
}

/* Whether each seam whose turn has come is near enough for the next stage. */
static bool all_near(const struct sewing *s)
{
    for (int k = 0; k < s->whole.n_seams; k++)
        if (has_turn(s, k) &&
            !(s->seam[k].most < near * s->scene->seam[k].cell))
            return false;
    return true;
}

/* The next stage that has something to sew. */
static enum sewing_stage next_stage(const struct sewing *s, int from)
{
    for (; from < SEWING_FREE; from++)
        for (int k = 0; k < s->whole.n_seams; k++)
            if ((int)s->seam[k].stage == from)
                return (enum sewing_stage)from;
    return from > SEWING_FREE || all_near(s) ? SEWING_WORN : SEWING_FREE;
}

int sewing_begin(struct sewing *sewing, struct scene *scene,
                 const struct overrides *overrides)
{
    *sewing = (struct sewing){
        .scene = scene, .overrides = overrides, .whole = scene->def};
    for (int k = 0; k < SEWING_STAGES; k++)
        sewing->begun[k] = -1;
    int status = inspect_scene(sewing);
    if (status == APP_OK)
        status = clear_start(sewing);
    if (status == APP_OK)
        status = make_seams(sewing);
    return status == APP_OK ? enter_stage(sewing, next_stage(sewing, 0))
                            : status;
}

void sewing_end(struct sewing *sewing)
{
    holds_end(sewing);
    drape_destroy(sewing->world);
    sewing->world = NULL;
    if (sewing->scene)
        sewing->scene->def = sewing->whole;
    pool_free(&sewing->pool);
}

bool sewing_is_closed(const struct sewing *sewing, int seam)
{
    return sewing->seam[seam].index >= 0 &&
           sewing->seam[seam].most < closed * sewing->scene->seam[seam].cell;
}

/* Whether something holds a point of seam k back: it pulls as hard as it may.
 */
static bool waits(const struct sewing *s, int k, int64_t p)
{
    const struct sewing_seam *seam = &s->seam[k];
    return vec3_length(seam->pull[p]) > 0.99 * s->turn[seam->index].strength;
}

/* The part of its gap that each point is to close in this step, so that all
 * that do not wait close at one time and none faster than it may. */
static double find_part(const struct sewing *s)
{
    double most = 0;
    for (int k = 0; k < s->whole.n_seams; k++)
        for (int64_t p = 0; has_turn(s, k) && p < s->seam[k].n; p++)
            if (!waits(s, k, p))
                most = fmax(most, vec3_length(s->seam[k].gap[p]));
    double step = fmin(fastest, slowest + most / settle) * s->whole.dt;
    return most > step ? step / most : 1;
}

/* The part by which a seam that is held so far is longer than it began. */
static double find_excess(const struct sewing_seam *seam)
{
    double mean = mean_gap(seam);
    return mean > seam->start ? 1 - seam->start / mean : 0;
}

/* Sets the target of each point: a part less of the gap that there is, so that
 * those of seams that meet agree, whatever has waited. */
static int move_targets(struct sewing *s)
{
    double all = find_part(s), step = fastest * s->whole.dt;
    for (int k = 0; k < s->whole.n_seams; k++) {
        struct sewing_seam *seam = &s->seam[k];
        if (seam->index < 0)
            continue;
        double part = has_turn(s, k) ? all : find_excess(seam);
        seam->waiting = 0;
        bool changes = !seam->told;
        for (int64_t p = 0; p < seam->n; p++) {
            double size = vec3_length(seam->gap[p]);
            double left = 1 - (size > step ? fmin(part, step / size) : part);
            for (int i = 0; i < 3; i++) {
                double was = seam->target[p][i];
                seam->target[p][i] = left * seam->gap[p][i];
                changes |= seam->target[p][i] != was;
            }
            seam->waiting += waits(s, k, p);
        }
        if (!changes)
            continue; /* a target that is set wakes all cloths */
        seam->told = true;
        int status = drape_seam_target(s->world, seam->index,
                                       (const double(*)[3])seam->target);
        if (status != DRAPE_OK)
            return failed("a seam's target", status);
    }
    return APP_OK;
}

/* Lets gravity and wind come evenly. */
static int raise_loads(struct sewing *s)
{
    double ramp = (double)RAMP * s->scene->steps_per_frame, g[3];
    drape_wind wind = s->whole.wind;
    double part = (double)(s->steps - s->begun[SEWING_WORN] + 1) / ramp;
    part = fmin(part, 1);
    if (part == s->heavy)
        return APP_OK;
    s->heavy = part;
    for (int i = 0; i < 3; i++) {
        g[i] = part * s->whole.gravity[i];
        wind.velocity[i] *= part;
    }
    int status = drape_set_gravity(s->world, g);
    if (status == DRAPE_OK && wind.density > 0)
        status = drape_set_wind(s->world, &wind);
    return status == DRAPE_OK ? APP_OK : failed("gravity", status);
}

/* Holds seams that have become longer than they began, though their turn has
 * not come: so what slides along a body as it is drawn together, a waistband
 * down from the hips, does not go far from what it will be sewn to. */
static int hold_seams(struct sewing *s)
{
    bool read = false, more = false;
    for (int k = 0; k < s->whole.n_seams; k++) {
        struct sewing_seam *seam = &s->seam[k];
        if (seam->index >= 0)
            continue;
        int status = read ? DRAPE_OK : drape_read(s->world, s->x, NULL);
        if (status != DRAPE_OK)
            return failed("the state", status);
        read = true;
        find_gaps(s, k);
        double most = seam->start + slack * s->scene->seam[k].cell;
        if (mean_gap(seam) >= most)
            seam->held = more = true;
    }
    return more ? make_world(s, s->stage) : APP_OK;
}

/* Whether the stage's seams are closed, or no longer close. */
static bool is_done(struct sewing *s)
{
    double left = 0;
    for (int k = 0; k < s->whole.n_seams; k++) {
        const struct sewing_seam *seam = &s->seam[k];
        if (!has_turn(s, k))
            continue;
        for (int64_t p = 0; p < seam->n; p++)
            left += vec3_length(seam->gap[p]) * s->scene->seam[k].length[p];
    }
    s->still++;
    if (s->left == INFINITY)
        s->open = left;
    if (left < s->left - progress * s->open) {
        s->left = left;
        s->still = 0;
    }
    return all_near(s) || (double)s->still * s->whole.dt > patience;
}

/* Whether a gap is open that nothing holds back. */
static bool is_closing(const struct sewing *s)
{
    bool closing = false;
    for (int k = 0; k < s->whole.n_seams; k++)
        closing |= s->seam[k].index >= 0 && !s->seam[k].waiting &&
                   !sewing_is_closed(s, k);
    return closing;
}

/* Whether the garments have come to rest: from an anchor that is a while old,
 * which is set anew where particles go too far from it. */
static int find_rest(struct sewing *s)
{
    double sum = 0;
    double ramp = (double)RAMP * s->scene->steps_per_frame;
    if ((double)(s->steps - s->begun[SEWING_WORN]) < ramp)
        return APP_OK;
    int status = drape_read(s->world, s->x, NULL);
    if (status != DRAPE_OK)
        return failed("the state", status);
    for (int64_t k = 0; k < s->nc; k++) {
        for (int i = 0; i < 3; i++) {
            double way = s->x[k][i] - s->was[k][i];
            sum += way * way;
        }
    }
    double mean = sqrt(sum / (double)s->particles);
    if (s->still_since < 0 || mean > rest_way) {
        memcpy(s->was, s->x, (size_t)s->nc * sizeof *s->x);
        s->still_since = s->steps;
    }
    s->rest = (double)(s->steps - s->still_since) * s->whole.dt > rest_time &&
              !holds_will_end(s) && !is_closing(s);
    return APP_OK;
}

int sewing_step(struct sewing *sewing, drape_step_report *report)
{
    int status = APP_OK;
    if (holds_may_begin(sewing, sewing->stage) || holds_are_due(sewing))
        status = make_world(sewing, sewing->stage);
    if (status == APP_OK)
        status = move_targets(sewing);
    if (status == APP_OK)
        status = holds_move(sewing);
    if (status == APP_OK && sewing->stage == SEWING_WORN)
        status = raise_loads(sewing);
    if (status != APP_OK)
        return status;
    int known = drape_step(sewing->world, report);
    if (known != DRAPE_OK)
        return failed("a step", known);
    sewing->steps++;
    report->step = sewing->steps;
    report->time = (double)sewing->steps * sewing->whole.dt;
    status = read_seams(sewing);
    if (status == APP_OK)
        status = holds_read(sewing);
    if (status == APP_OK && sewing->stage < SEWING_WORN && is_done(sewing))
        return enter_stage(sewing, next_stage(sewing, sewing->stage + 1));
    if (status == APP_OK && sewing->stage < SEWING_ACROSS)
        status = hold_seams(sewing);
    if (status == APP_OK && sewing->stage == SEWING_WORN)
        status = find_rest(sewing);
    return status;
}

/* The time at which an obstacle is where it stays. */
static double last_time(const drape_def *def, const drape_obstacle *o)
{
    if (o->frames > 0)
        return o->frame_time ? o->frame_time[o->frames - 1]
                             : (o->frames - 1) * o->frame_dt;
    const drape_motion *m = o->motion < 0 ? NULL : &def->motions[o->motion];
    return m ? m->time[m->keys - 1] : 0;
}

int64_t sewing_moves(const struct sewing *sewing)
{
    const drape_def *def = &sewing->whole;
    double last = 0;
    for (int k = 0; k < def->n_obstacles; k++)
        last = fmax(last, last_time(def, &def->obstacles[k]));
    return (int64_t)ceil(last / def->dt * (1 - 1e-12));
}

int sewing_move(struct sewing *sewing)
{
    return enter_stage(sewing, SEWING_MOVING);
}

int sewing_audit(struct sewing *sewing, int64_t *pairs, int64_t *sewn)
{
    int known = drape_read(sewing->world, sewing->x, NULL);
    const drape_mesh mesh = {.nv = sewing->nv,
                             .nt = sewing->nt,
                             .x = (const double(*)[3])sewing->x,
                             .tri = (const int32_t(*)[3])sewing->tri,
                             .group = sewing->group,
                             .threads = sewing->whole.threads};
    struct crossings c = {0};
    if (known != DRAPE_OK)
        return failed("the state", known);
    int status = crossings_find(&mesh, &c);
    if (status == APP_OK)
        crossings_part(&c, sewing->world);
    *pairs = c.found;
    *sewn = c.sewn;
    crossings_free(&c);
    return status;
}
