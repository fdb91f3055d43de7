/* SPDX-License-Identifier: Apache-2.0 */
/* Holds labelled borders of garments once they are worn: app/patterns/README.md
 * §14. A hold is a seam to anchors: particles of a cloth that is pinned far
 * above the bodies and that no file shows, whose target is the way from the
 * anchor to the place where the particle is to be. So what holds softly, by so
 * many newtons at most, and what holds by any force are one thing. */
#include "app/base/app.h"
#include "app/base/skin.h"
#include "app/base/vec3.h"
#include "app/scene/sewing.h"

#include <math.h>
#include <string.h>

/* Anchors are this far above all bodies and garments, m: near enough that a way
 * from there has an error of a millionth of a metre, and above all jumps. */
static const double above = 4;
/* Each anchor is a corner of a cell of this side, m, with a cell between any
 * two, so that no two are neighbours: contact would pass over what is sewn to
 * them (spec/seam/seam.md §5). */
static const double side = 0.01;
enum { COLUMNS = 128 }; /* of anchors, at most */
/* Frames of being worn after which it is held although a seam is still open: a
 * border that nothing holds has fallen by 3 mm, as gravity comes evenly. */
enum { FRAMES = 6 };

static int failed(const char *what, int status)
{
    return complain(APP_FAILED, "sew: %s: %s", what, drape_status_text(status));
}

struct box {
    double lo[3], hi[3];
};

static void stretch(struct box *box, const double (*x)[3], int64_t n)
{
    for (int64_t k = 0; x && k < n; k++)
        for (int i = 0; i < 3; i++) {
            box->lo[i] = fmin(box->lo[i], x[k][i]);
            box->hi[i] = fmax(box->hi[i], x[k][i]);
        }
}

/* All places to which a motion may take a mesh: balls about those of its pivot.
 */
static void sweep(struct box *box, const drape_motion *m,
                  const drape_obstacle *o)
{
    double radius = 0;
    for (int64_t k = 0; k < o->n_vertices; k++) {
        double from[3];
        for (int i = 0; i < 3; i++)
            from[i] = o->x[k][i] - m->pivot[i];
        radius = fmax(radius, vec3_length(from));
    }
    for (int k = 0; k < m->keys; k++)
        for (int i = 0; i < 3; i++) {
            box->lo[i] = fmin(box->lo[i], m->position[k][i] - radius);
            box->hi[i] = fmax(box->hi[i], m->position[k][i] + radius);
        }
}

/* Where garments are at the start, and where bodies ever are. */
static struct box find_box(const drape_def *def)
{
    struct box box = {{INFINITY, INFINITY, INFINITY},
                      {-INFINITY, -INFINITY, -INFINITY}};
    for (int k = 0; k < def->n_cloths; k++)
        stretch(&box, def->cloths[k].x,
                (int64_t)def->cloths[k].m * def->cloths[k].n);
    for (int k = 0; k < def->n_obstacles; k++) {
        const drape_obstacle *o = &def->obstacles[k];
        if (o->motion >= 0)
            sweep(&box, &def->motions[o->motion], o);
        else if (o->frames)
            stretch(&box, o->frame, o->frames * o->n_vertices);
        else
            stretch(&box, o->x, o->n_vertices);
    }
    return box;
}

/* Places the particles of the anchors' cloth in a level sheet. */
static void place_sheet(const drape_def *def, const drape_cloth *sheet,
                        double (*x)[3])
{
    struct box box = find_box(def);
    const double *g = def->gravity;
    int up = fabs(g[0]) > fabs(g[1]) ? 0 : 1;
    up = fabs(g[2]) > fabs(g[up]) ? 2 : up;
    int u = (up + 1) % 3, v = (up + 2) % 3;
    for (int j = 0; j < sheet->n; j++)
        for (int i = 0; i < sheet->m; i++) {
            double *p = x[i + (int64_t)sheet->m * j];
            p[up] = g[up] > 0 ? box.lo[up] - above : box.hi[up] + above;
            p[u] = 0.5 * (box.lo[u] + box.hi[u]) + side * i;
            p[v] = 0.5 * (box.lo[v] + box.hi[v]) + side * j;
        }
}

/* Makes the cloth of `count` anchors: cells that do not touch, pinned. */
static int make_sheet(struct sewing *s, int64_t count, drape_cloth *sheet)
{
    int columns = (int)(count < COLUMNS ? count : COLUMNS);
    drape_default_cloth(sheet);
    sheet->bending = DRAPE_SPRINGS; /* so that no seam to it bends */
    sheet->m = 2 * columns;
    sheet->n = 2 * (int)((count + columns - 1) / columns);
    sheet->width = side * (sheet->m - 1);
    sheet->height = side * (sheet->n - 1);
    size_t m = (size_t)sheet->m, n = (size_t)sheet->n;
    double(*x)[3] = pool_take(&s->pool, m * n, sizeof *x);
    uint8_t *cut = pool_take(&s->pool, (m - 1) * (n - 1), 1);
    drape_pin *pin = pool_take(&s->pool, m * n, sizeof *pin);
    if (!x || !cut || !pin)
        return no_memory();
    for (size_t k = 0; k < (m - 1) * (n - 1); k++)
        cut[k] = k % (m - 1) % 2 || k / (m - 1) % 2;
    for (size_t k = 0; k < m * n; k++)
        pin[k] = (drape_pin){(int)(k % m), (int)(k / m), -1};
    place_sheet(&s->scene->def, sheet, x);
    sheet->x = (const double(*)[3])x;
    sheet->cut = cut;
    sheet->pins = pin;
    sheet->n_pins = (int)(m * n);
    s->anchor_at = (const double(*)[3])x;
    return APP_OK;
}

/* Adds the cloth of the anchors behind those of the scene. */
static int add_sheet(struct sewing *s, int64_t count)
{
    drape_def *def = &s->scene->def;
    size_t n = (size_t)def->n_cloths;
    drape_cloth *cloth = pool_take(&s->scene->pool, n + 1, sizeof *cloth);
    char **name = pool_take(&s->scene->pool, n + 2, sizeof *name);
    if (!cloth || !name)
        return no_memory();
    memcpy(cloth, def->cloths, n * sizeof *cloth);
    memcpy(name, s->scene->cloth_name, n * sizeof *name);
    name[n] = pool_text(&s->scene->pool, "anchors");
    int status = name[n] ? make_sheet(s, count, &cloth[n]) : no_memory();
    def->cloths = cloth;
    def->n_cloths++;
    s->scene->cloth_name = name;
    s->scene->hidden = 1;
    return status;
}

/* The particle of the sheet that is an anchor. */
static int32_t anchor_of(const drape_cloth *sheet, int64_t k)
{
    int64_t columns = sheet->m / 2;
    return (int32_t)(2 * (k % columns) + sheet->m * 2 * (k / columns));
}

static int make_hold(struct sewing *s, struct sewing_hold *hold, int64_t first)
{
    const struct scene_attach *about = hold->about;
    const drape_cloth *sheet =
        &s->scene->def.cloths[s->scene->def.n_cloths - 1];
    size_t n = (size_t)about->n;
    hold->onto = pool_take(&s->pool, n, sizeof *hold->onto);
    hold->part = pool_take(&s->pool, n, sizeof *hold->part);
    hold->skin = pool_take(&s->pool, n, sizeof *hold->skin);
    hold->gap = pool_take(&s->pool, n, sizeof *hold->gap);
    hold->pull = pool_take(&s->pool, n, sizeof *hold->pull);
    hold->target = pool_take(&s->pool, n, sizeof *hold->target);
    if (!hold->onto || !hold->part || !hold->skin || !hold->gap ||
        !hold->pull || !hold->target)
        return no_memory();
    for (size_t p = 0; p < n; p++)
        hold->onto[p][0] = hold->onto[p][1] =
            anchor_of(sheet, first + (int64_t)p);
    hold->index = hold->body = -1;
    hold->from = hold->to = -1;
    return APP_OK;
}

int holds_begin(struct sewing *s)
{
    const struct scene *scene = s->scene;
    int64_t count = 0;
    s->holds = scene->attaches;
    for (int k = 0; k < s->holds; k++)
        count += scene->attach[k].n;
    if (count < 1)
        return APP_OK;
    s->hold = pool_take(&s->pool, (size_t)s->holds, sizeof *s->hold);
    if (!s->hold)
        return no_memory();
    int status = add_sheet(s, count);
    count = 0;
    for (int k = 0; k < s->holds && status == APP_OK; k++) {
        s->hold[k].about = &scene->attach[k];
        status = make_hold(s, &s->hold[k], count);
        count += scene->attach[k].n;
    }
    return status;
}

bool holds_may_begin(const struct sewing *s, enum sewing_stage stage)
{
    bool closed = true;
    if (!s->holds || s->hold[0].from >= 0 || stage < SEWING_WORN)
        return false;
    for (int k = 0; k < s->whole.n_seams; k++)
        closed &= sewing_is_closed(s, k);
    return closed || stage > SEWING_WORN ||
           s->steps - s->begun[SEWING_WORN] >=
               (int64_t)FRAMES * s->scene->steps_per_frame;
}

/* The particle of a point, among all vertices. */
static int64_t vertex_of(const struct sewing *s, const struct sewing_hold *hold,
                         int64_t p)
{
    return drape_first_vertex(s->world, hold->about->cloth) +
           hold->about->particle[p];
}

/* The body that most of a hold's points are nearest to; -1: none. */
static int find_body(const struct sewing *s, const struct sewing_hold *hold)
{
    int best = -1, cloths = s->whole.n_cloths;
    int64_t most = 0;
    for (int k = 0; k < s->whole.n_obstacles; k++) {
        int64_t from = drape_first_triangle(s->world, cloths + k), count = 0;
        int64_t to = drape_first_triangle(s->world, cloths + k + 1);
        for (int64_t p = 0; p < hold->about->n; p++)
            count += hold->skin[p].tri >= from && hold->skin[p].tri < to;
        if (count > most) {
            most = count;
            best = k;
        }
    }
    return best;
}

void holds_bind(struct sewing *s)
{
    int64_t bodies = drape_first_triangle(s->world, s->whole.n_cloths);
    for (int k = 0; k < s->holds; k++) {
        struct sewing_hold *hold = &s->hold[k];
        hold->from = s->steps;
        for (int64_t p = 0; p < hold->about->n; p++) {
            const double *x = s->x[vertex_of(s, hold, p)];
            const double *anchor = s->anchor_at[hold->onto[p][0]];
            skin_find(&hold->skin[p], x, (const int32_t(*)[3])s->tri,
                      hold->about->world ? s->nt : bodies, s->nt,
                      (const double(*)[3])s->x);
            for (int i = 0; i < 3; i++)
                hold->target[p][i] = x[i] - anchor[i];
        }
        hold->body = find_body(s, hold);
    }
}

/* Whether a hold has had its time after so many steps. */
static bool is_over(const struct sewing *s, const struct sewing_hold *hold)
{
    return (double)(s->steps - hold->from) * s->whole.dt >
           hold->about->until - 0.5 * s->whole.dt;
}

bool holds_are_due(const struct sewing *s)
{
    for (int k = 0; k < s->holds; k++)
        if (s->hold[k].index >= 0 && is_over(s, &s->hold[k]))
            return true;
    return false;
}

bool holds_will_end(const struct sewing *s)
{
    for (int k = 0; k < s->holds; k++)
        if (s->hold[k].index >= 0 && s->hold[k].about->until < INFINITY)
            return true;
    return false;
}

void holds_define(struct sewing *s)
{
    drape_def *def = &s->scene->def;
    for (int k = 0; k < s->holds; k++) {
        struct sewing_hold *hold = &s->hold[k];
        const struct scene_attach *about = hold->about;
        bool held = hold->index >= 0;
        hold->index = -1;
        hold->told = false;
        if (hold->from < 0 || is_over(s, hold)) {
            hold->to = held ? s->steps : hold->to;
            continue;
        }
        hold->index = def->n_seams;
        s->turn[def->n_seams++] =
            (drape_seam){.cloth = {about->cloth, def->n_cloths - 1},
                         .n = about->n,
                         .particle = about->particle,
                         .onto = (const int32_t(*)[2])hold->onto,
                         .part = hold->part,
                         .strength = about->strength * about->spacing};
    }
}

/* A world of the bodies alone, which is a step ahead, as a target is where
 * something is at the end of a step. Its cloth of one cell is beside the
 * anchors. */
static int make_ahead(struct sewing *s)
{
    drape_def def = s->whole;
    drape_cloth cloth;
    drape_default_cloth(&cloth);
    cloth.m = cloth.n = 2;
    cloth.width = cloth.height = side;
    memcpy(cloth.origin, s->anchor_at[0], sizeof cloth.origin);
    def.backend = DRAPE_REF;
    def.solver = DRAPE_EXACT;
    def.cloths = &cloth;
    def.n_cloths = 1;
    def.n_seams = 0;
    def.trace = NULL;
    memset(def.gravity, 0, sizeof def.gravity);
    def.wind = (drape_wind){0};
    int status = drape_create(&def, &s->ahead, NULL);
    return status == DRAPE_OK ? APP_OK : failed("the bodies", status);
}

/* Moves the bodies to where they are at the end of the next step, and reads
 * this. */
static int lead_bodies(struct sewing *s)
{
    int status = s->ahead ? APP_OK : make_ahead(s);
    if (status != APP_OK)
        return status;
    int known = drape_step(s->ahead, NULL);
    /* obstacles lie behind four particles, as behind nc vertices here */
    if (known == DRAPE_OK)
        known = drape_read(s->ahead, s->next + s->nc - 4, NULL);
    for (int k = 0; k < s->whole.n_obstacles && known == DRAPE_OK; k++) {
        const drape_obstacle *o = &s->whole.obstacles[k];
        int64_t v = drape_first_vertex(s->world, s->whole.n_cloths + k);
        if (o->motion >= 0 || o->frames > 0)
            known = drape_set_obstacle(s->world, k,
                                       (const double(*)[3])s->next + v);
    }
    return known == DRAPE_OK ? APP_OK : failed("the bodies", known);
}

/* Sets the targets of a hold to where its triangles will be. */
static void follow(struct sewing *s, struct sewing_hold *hold)
{
    for (int64_t p = 0; p < hold->about->n; p++) {
        double place[3];
        if (hold->skin[p].tri < 0)
            continue;
        skin_follow(&hold->skin[p], (const int32_t(*)[3])s->tri,
                    (const double(*)[3])s->next, place);
        for (int i = 0; i < 3; i++) {
            double to = place[i] - s->anchor_at[hold->onto[p][0]][i];
            hold->told &= to == hold->target[p][i];
            hold->target[p][i] = to;
        }
    }
}

int holds_move(struct sewing *s)
{
    int status =
        s->holds && s->stage == SEWING_MOVING ? lead_bodies(s) : APP_OK;
    for (int k = 0; k < s->holds && status == APP_OK; k++) {
        struct sewing_hold *hold = &s->hold[k];
        if (hold->index < 0)
            continue;
        if (s->stage == SEWING_MOVING)
            follow(s, hold);
        if (hold->told)
            continue; /* a target that is set wakes all cloths */
        hold->told = true;
        int known = drape_seam_target(s->world, hold->index,
                                      (const double(*)[3])hold->target);
        if (known != DRAPE_OK)
            status = failed("an attachment's target", known);
    }
    return status;
}

int holds_read(struct sewing *s)
{
    for (int k = 0; k < s->holds; k++) {
        struct sewing_hold *hold = &s->hold[k];
        if (hold->index < 0)
            continue;
        int known =
            drape_seam_state(s->world, hold->index, hold->gap, hold->pull);
        if (known != DRAPE_OK)
            return failed("an attachment", known);
        hold->slip = hold->strongest = 0;
        for (int64_t p = 0; p < hold->about->n; p++) {
            double slip[3];
            for (int i = 0; i < 3; i++)
                slip[i] = hold->gap[p][i] - hold->target[p][i];
            hold->slip = fmax(hold->slip, vec3_length(slip));
            hold->strongest = fmax(hold->strongest, vec3_length(hold->pull[p]) /
                                                        hold->about->spacing);
        }
    }
    return APP_OK;
}

void holds_end(struct sewing *s)
{
    drape_destroy(s->ahead);
    s->ahead = NULL;
}
