/* SPDX-License-Identifier: Apache-2.0 */
/* Makes the seams of a world: their points, and which vertices they bring so
 * close together that contact passes over them. spec/seam/seam.md */
#include "ref/seam/hinge.h"
#include "ref/seam/seam.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

/* §5: how far along seams vertices are sewn together, and how many ties a
 * vertex may have. */
static const double NEAR = 2 + 1e-9;
enum { TIES = 64 };

static int say(drape_error *error, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    if (error)
        vsnprintf(error->text, sizeof error->text, format, args);
    va_end(args);
    return DRAPE_EARG;
}

static void *take_array(struct world *w, int64_t n, size_t size)
{
    return arena_take(w->arena, ARENA_OTHER, n, size);
}

void sew_size(struct world *w, const drape_def *def)
{
    w->seams.count = def->n_seams;
    for (int k = 0; k < def->n_seams; k++)
        w->seams.n += def->seams[k].n;
}

/* §1: weights of a place that add to 1 exactly. The greater one is first. */
static void weigh_place(struct seam_point *p, double part)
{
    real second = (real)part;
    if (second > R(0.5)) {
        int32_t v = p->v[1];
        p->v[1] = p->v[2];
        p->v[2] = v;
        second = (real)(1 - part);
    }
    p->c[0] = 1 - second; /* ≥ 1/2, so that 1 - c[0] is exact */
    p->c[1] = 1 - p->c[0];
    if (p->v[1] == p->v[2]) {
        p->c[0] = 1;
        p->c[1] = 0;
    }
}

static bool is_missing(const struct world *w, int cloth, int32_t particle)
{
    return w->sheet[cloth].cloth.fixed[particle] == CLOTH_ABSENT;
}

/* Makes the points of seam k. seen [nv]: scratch, k where a point of seam k - 1
 * has its particle. */
static int fill_seam(struct world *w, const drape_seam *def, int k,
                     int32_t *seen, drape_error *error)
{
    const int *cloth = def->cloth;
    int64_t first[2] = {w->sheet[cloth[0]].first, w->sheet[cloth[1]].first};
    struct seam_point *to = (struct seam_point *)w->seams.point;
    to += w->seams.first[k];
    for (int64_t i = 0; i < def->n; i++) {
        const int32_t v[3] = {def->particle[i], def->onto[i][0],
                              def->onto[i][1]};
        for (int j = 0; j < 3; j++) {
            if (is_missing(w, cloth[j > 0], v[j]))
                return say(error,
                           "seam %d: point %lld: particle %d of cloth %d is "
                           "missing",
                           k, (long long)i, (int)v[j], cloth[j > 0]);
            to[i].v[j] = (int32_t)(first[j > 0] + v[j]);
        }
        if (seen[to[i].v[0]] == k + 1)
            return say(error,
                       "seam %d: point %lld: particle %d is in the seam "
                       "already",
                       k, (long long)i, (int)v[0]);
        seen[to[i].v[0]] = k + 1;
        weigh_place(&to[i], def->part[i]);
        to[i].strength = (real)def->strength;
    }
    return DRAPE_OK;
}

/* §6: the hinges of seam k, from its definition. */
static void fill_hinges(struct world *w, const drape_def *def, int k)
{
    struct seams *s = &w->seams;
    const drape_seam *seam = &def->seams[k];
    struct hinge found;
    for (int64_t i = 0; i < seam->n; i++) {
        if (!hinge_find(def, seam, i, &found))
            continue;
        struct seam_hinge *to = (struct seam_hinge *)s->hinge + s->n_hinges++;
        to->point = (int32_t)(s->first[k] + i);
        to->behind = (real)found.behind;
        to->shape = (real)found.shape;
        for (int j = 0; j < 4; j++) {
            const struct sheet *of = &w->sheet[seam->cloth[j > 1]];
            to->v[j] = (int32_t)(of->first + found.at[j]);
            to->c[j] = (real)found.c[j];
        }
    }
}

/* §6: the stiffnesses of the hinges. */
static void stiffen_hinges(struct world *w)
{
    const struct seams *s = &w->seams;
    struct seam_hinge *h = (struct seam_hinge *)w->home->seams.hinge;
    for (int64_t i = 0, k = 0; i < s->n_hinges; i++) {
        while (h[i].point >= s->first[k + 1])
            k++;
        double bend = hinge_bend(&w->sheet[s->cloth[k][0]].made.material,
                                 &w->sheet[s->cloth[k][1]].made.material);
        h[i].stiffness = (real)(bend * (double)h[i].shape);
    }
    if (w != w->home && s->n_hinges > 0)
        w->run->send(w->on, (void *)s->hinge, h,
                     (size_t)s->n_hinges * sizeof *h);
}

void sew_stiffen(struct world *w)
{
    struct world *h = w->home;
    stiffen_hinges(w);
    for (int k = 0; k < w->seams.count; k++) {
        double least = 0;
        for (int j = 0; j < 2; j++) {
            double a = w->sheet[w->seams.cloth[k][j]].made.material.stretch;
            least = j == 0 || a < least ? a : least;
        }
        struct seam_point *p = (struct seam_point *)h->seams.point;
        for (int64_t i = h->seams.first[k]; i < h->seams.first[k + 1]; i++)
            p[i].stiffness = SEAM_SOFT * (real)least;
    }
    if (w != h && w->seams.n > 0)
        w->run->send(w->on, (void *)w->seams.point, h->seams.point,
                     (size_t)w->seams.n * sizeof *w->seams.point);
}

/* §5: ties between vertices, by how far apart along seams they are. */

struct tie {
    int32_t to;
    float far;
};

struct ties {
    int32_t *start;   /* [nv + 1] */
    struct tie *item; /* [start[nv]] */
    int32_t *mark;    /* [nv] 1 + its place in `found`, 0: it has none */
    int32_t *found;   /* vertices that a search has reached */
    double *far;      /* how far they are */
    int64_t n, cap;
};

/* Calls tie(user, a, b, far) for each pair that the points tie. */
struct tie_user {
    struct ties *t;
    bool counts;
};

static void add_tie(const struct tie_user *u, int32_t a, int32_t b, double far)
{
    if (a == b)
        return;
    int32_t *at = u->t->start;
    if (u->counts) {
        at[a]++;
        at[b]++;
        return;
    }
    u->t->item[at[a]++] = (struct tie){b, (float)far};
    u->t->item[at[b]++] = (struct tie){a, (float)far};
}

/* Whether particles a and b, vertices of cloth k, are neighbours on its grid.
 */
static bool are_neighbours(const struct world *w, int k, int32_t a, int32_t b)
{
    const struct sheet *s = &w->sheet[k];
    int64_t p = a - s->first, q = b - s->first, m = s->cloth.m;
    int64_t i = p % m - q % m, j = p / m - q / m;
    return a != b && i >= -1 && i <= 1 && j >= -1 && j <= 1;
}

/* The ties of point p, and to the point before it, which may be NULL: from a
 * particle to its place, and from neighbour to neighbour along the seam. */
static void tie_point(const struct world *w, const struct tie_user *u, int k,
                      const struct seam_point *p,
                      const struct seam_point *before)
{
    const int *cloth = w->seams.cloth[k];
    add_tie(u, p->v[0], p->v[1], (double)p->c[1]);
    if (p->c[1] > 0) {
        add_tie(u, p->v[0], p->v[2], (double)p->c[0]);
        if (are_neighbours(w, cloth[1], p->v[1], p->v[2]))
            add_tie(u, p->v[1], p->v[2], 1);
    }
    if (!before)
        return;
    if (are_neighbours(w, cloth[0], p->v[0], before->v[0]))
        add_tie(u, p->v[0], before->v[0], 1);
    for (int i = 1; i < 3; i++)
        for (int j = 1; j < 3; j++)
            if (are_neighbours(w, cloth[1], p->v[i], before->v[j]))
                add_tie(u, p->v[i], before->v[j], 1);
}

static void tie_all(const struct world *w, const struct tie_user *u)
{
    const struct seams *s = &w->seams;
    for (int k = 0; k < s->count; k++)
        for (int64_t i = s->first[k]; i < s->first[k + 1]; i++)
            tie_point(w, u, k, &s->point[i],
                      i > s->first[k] ? &s->point[i - 1] : NULL);
}

/* Turns counts into where lists start. Returns their sum. */
static int64_t sum_starts(int64_t n, int32_t *start)
{
    int64_t at = 0;
    for (int64_t i = 0; i <= n; i++) {
        int32_t count = start[i];
        start[i] = (int32_t)at;
        at += count;
    }
    return at;
}

/* Filling has moved each start to that of the next list. */
static void move_back(int64_t n, int32_t *start)
{
    for (int64_t i = n; i > 0; i--)
        start[i] = start[i - 1];
    start[0] = 0;
}

/* No vertex has so many ties that lists grow with the square of a seam. */
static int check_ties(const struct world *w, const struct ties *t,
                      drape_error *error)
{
    for (int64_t i = 0; i < w->nc; i++) {
        if (t->start[i] <= 6 * TIES)
            continue;
        int k = w->body[i];
        return say(error,
                   "seams: too many points are held to particle %d of cloth "
                   "%d: expected at most %d",
                   (int)(i - w->sheet[k].first), k, TIES);
    }
    return DRAPE_OK;
}

static int make_ties(struct world *w, struct ties *t, drape_error *error)
{
    struct tie_user u = {t, true};
    t->start = take_array(w, w->nv + 1, sizeof *t->start);
    t->mark = take_array(w, w->nv, sizeof *t->mark);
    if (!t->start || !t->mark)
        return DRAPE_ENOMEM;
    tie_all(w, &u);
    int status = check_ties(w, t, error);
    if (status != DRAPE_OK)
        return status;
    int64_t all = sum_starts(w->nv, t->start);
    t->item = take_array(w, all, sizeof *t->item);
    t->cap = all + 1;
    t->found = take_array(w, t->cap, sizeof *t->found);
    t->far = take_array(w, t->cap, sizeof *t->far);
    if (!t->item || !t->found || !t->far)
        return DRAPE_ENOMEM;
    u.counts = false;
    tie_all(w, &u);
    move_back(w->nv, t->start);
    return DRAPE_OK;
}

/* Notes that vertex v is so far away. Whether that is nearer than was known. */
static bool reach(struct ties *t, int32_t v, double far)
{
    if (!t->mark[v]) {
        t->found[t->n] = v;
        t->far[t->n++] = far;
        t->mark[v] = (int32_t)t->n;
        return true;
    }
    double *known = &t->far[t->mark[v] - 1];
    bool nearer = far < *known - 1e-9;
    *known = nearer ? far : *known;
    return nearer;
}

static int compare_vertices(const void *a, const void *b)
{
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* Finds the vertices near v along seams, without v itself, ascending: found
 * [n]. */
static void search_ties(struct ties *t, int32_t v)
{
    t->n = 0;
    reach(t, v, 0);
    for (bool again = true; again;) {
        again = false;
        for (int64_t k = 0; k < t->n; k++) {
            int32_t at = t->found[k];
            for (int32_t i = t->start[at]; i < t->start[at + 1]; i++) {
                double far = t->far[k] + (double)t->item[i].far;
                again |= far <= NEAR && reach(t, t->item[i].to, far);
            }
        }
    }
    for (int64_t k = 0; k < t->n; k++)
        t->mark[t->found[k]] = 0;
    t->found[0] = t->found[--t->n];
    qsort(t->found, (size_t)t->n, sizeof *t->found, compare_vertices);
}

/* The lists of §5. */
static int list_sewn(struct world *w, struct ties *t)
{
    int32_t *start = take_array(w, w->nv + 1, sizeof *start), *sewn = NULL;
    for (int pass = 0; pass < 2 && start; pass++) {
        for (int32_t v = 0; v < w->nc; v++) {
            if (t->start[v] == t->start[v + 1])
                continue;
            search_ties(t, v);
            for (int64_t k = 0; k < t->n && pass; k++)
                sewn[start[v] + k] = t->found[k];
            start[v] += pass ? 0 : (int32_t)t->n;
        }
        if (pass)
            break;
        w->seams.n_sewn = sum_starts(w->nv, start);
        sewn = take_array(w, w->seams.n_sewn, sizeof *sewn);
        if (!sewn)
            return DRAPE_ENOMEM;
    }
    w->seams.n_start = w->nv + 1;
    w->seams.start = start;
    w->seams.sewn = sewn;
    return start ? DRAPE_OK : DRAPE_ENOMEM;
}

static int make_lists(struct world *w, drape_error *error)
{
    struct ties t = {0};
    int status = make_ties(w, &t, error);
    if (status == DRAPE_OK)
        status = list_sewn(w, &t);
    arena_give(w->arena, t.start);
    arena_give(w->arena, t.item);
    arena_give(w->arena, t.mark);
    arena_give(w->arena, t.found);
    arena_give(w->arena, t.far);
    return status;
}

/* Copies an array of a definition. */
static void *copy_array(struct world *w, const void *from, int64_t n,
                        size_t size)
{
    void *to = take_array(w, n, size);
    if (to && n > 0)
        memcpy(to, from, (size_t)n * size);
    return to;
}

/* Copies the definitions of all seams. */
static void keep_definitions(struct world *w, const drape_def *def)
{
    drape_seam *made = take_array(w, def->n_seams, sizeof *made);
    for (int k = 0; k < def->n_seams && made; k++) {
        const drape_seam *s = &def->seams[k];
        made[k] = *s;
        made[k].particle =
            copy_array(w, s->particle, s->n, sizeof *s->particle);
        made[k].onto = copy_array(w, s->onto, s->n, sizeof *s->onto);
        made[k].part = copy_array(w, s->part, s->n, sizeof *s->part);
    }
    w->seams.made = made;
}

int sew_fill(struct world *w, const drape_def *def, drape_error *error)
{
    struct seams *s = &w->seams;
    if (s->n == 0)
        return DRAPE_OK;
    int32_t *seen = take_array(w, w->nv, sizeof *seen);
    s->first = take_array(w, s->count + 1, sizeof *s->first);
    s->cloth = take_array(w, s->count, sizeof *s->cloth);
    s->point = take_array(w, s->n, sizeof *s->point);
    s->next = arena_take(w->arena, ARENA_STATE, s->n, sizeof *s->next);
    s->hinge = take_array(w, s->n, sizeof *s->hinge);
    s->aside = arena_take(w->arena, ARENA_RESPONSE, 2 * s->n, sizeof *s->aside);
    keep_definitions(w, def);
    int status = w->arena->failed ? DRAPE_ENOMEM : DRAPE_OK;
    for (int k = 0; k < s->count && status == DRAPE_OK; k++) {
        s->first[k + 1] = s->first[k] + def->seams[k].n;
        memcpy(s->cloth[k], def->seams[k].cloth, sizeof s->cloth[k]);
        status = fill_seam(w, &def->seams[k], k, seen, error);
        if (status == DRAPE_OK)
            fill_hinges(w, def, k);
    }
    arena_give(w->arena, seen);
    if (status != DRAPE_OK)
        return status;
    sew_stiffen(w);
    ref_seam_gap(NULL, s->n, s->point, w->x0, s->to);
    memcpy(s->from, s->to, (size_t)s->n * sizeof *s->to);
    status = sew_grids(w, def);
    return status == DRAPE_OK ? make_lists(w, error) : status;
}

bool sew_joins(const struct world *w, int32_t a, int32_t b)
{
    const struct seams *s = &w->home->seams;
    for (int i = 0; i < 3 && s->n_start > 0; i++)
        for (int j = 0; j < 3; j++) {
            int32_t v = w->home->tri[a][i], u = w->home->tri[b][j];
            for (int32_t k = s->start[v]; k < s->start[v + 1]; k++)
                if (s->sewn[k] == u)
                    return true;
        }
    return false;
}
