/* SPDX-License-Identifier: Apache-2.0 */
/* Parts meshes that go through each other: app/patterns/README.md §13. */
#include "app/read/untangle.h"
#include "app/base/app.h"
#include "app/base/vec3.h"
#include "app/read/apart.h"
#include "app/read/crossings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of the mean edge of a triangle: how far a vertex is to be outside of a solid
 * body, and how far it is moved at most in a round. */
static const double outside = 0.1, most = 0.5;
/* Of what a way differs from its neighbours': it is given up in a round. */
static const double soft = 0.05;
/* Of the sum of the lengths of what it sums: a gradient below tells no side. */
static const double weak = 0.03;
/* The longest gradient of a crossing, of which the length of what is cut
 * changes by so much per way: an edge that goes along a triangle has any. */
static const double steepest = 4;
enum {
    SPREADS = 3,   /* to neighbours, so that cells keep their shape */
    PATIENCE = 30, /* rounds without fewer pairs, after which a try ends */
    WORSE = 3,     /* so does one that has so many times the pairs */
    TRIES = 4      /* of two sheets either may move, to either of its sides */
};

struct knot {
    struct untangling *u;
    drape_mesh mesh;
    int32_t *part, *group;     /* [nt] */
    bool *solid, *inward;      /* [parts] closed; its triangles face inwards */
    int32_t (*beyond)[3];      /* [nt] */
    double (*was)[3];          /* [nv] at the start */
    double (*way)[3], *need;   /* [nv] of a round: a direction; m */
    double (*mean)[3], *share; /* [nv] of neighbours */
    int32_t *owner; /* [nv] the region, as found, for which it moves; -1 */
    bool *back;     /* [found] it is put back */
    struct crossings pairs;
    struct regions regions;
    int tried; /* number of the try */
};

static const double *corner(const struct knot *k, int32_t triangle, int i)
{
    return k->u->x[k->u->tri[triangle][i % 3]];
}

static void find_normal(const struct knot *k, int32_t triangle, double n[3])
{
    double a[3], b[3];
    vec3_subtract(corner(k, triangle, 1), corner(k, triangle, 0), a);
    vec3_subtract(corner(k, triangle, 2), corner(k, triangle, 0), b);
    vec3_cross(a, b, n);
    vec3_normalise(n);
}

/* The mean edge of a triangle, m. */
static double find_size(const struct knot *k, int32_t triangle)
{
    double sum = 0, e[3];
    for (int i = 0; i < 3; i++) {
        vec3_subtract(corner(k, triangle, i + 1), corner(k, triangle, i), e);
        sum += sqrt(vec3_dot(e, e)) / 3;
    }
    return sum;
}

/* An end of the line in which two triangles intersect: where an edge of one
 * goes through the other. */
struct end {
    double at[3], edge[3], n[3]; /* edge and normal of the other: unit */
    int side;                    /* whose edge it is */
};

/* Whether a point of a triangle's plane is in it. */
static bool is_in(const struct knot *k, int32_t triangle, const double n[3],
                  const double at[3])
{
    bool in = true;
    for (int i = 0; i < 3; i++) {
        double e[3], to[3], out[3];
        vec3_subtract(corner(k, triangle, i + 1), corner(k, triangle, i), e);
        vec3_subtract(at, corner(k, triangle, i), to);
        vec3_cross(e, to, out);
        in &= vec3_dot(out, n) >= -1e-12 * vec3_dot(e, e);
    }
    return in;
}

/* Finds both ends of the line of a pair. false: roundings hide one. */
static bool find_line(const struct knot *k, const int32_t pair[2],
                      struct end end[2])
{
    int count = 0;
    for (int s = 0; s < 2 && count < 2; s++) {
        double n[3], far[3], to[3];
        find_normal(k, pair[!s], n);
        for (int i = 0; i < 3; i++) {
            vec3_subtract(corner(k, pair[s], i), corner(k, pair[!s], 0), to);
            far[i] = vec3_dot(to, n);
        }
        for (int i = 0; i < 3 && count < 2; i++) {
            int j = (i + 1) % 3;
            const double *a = corner(k, pair[s], i), *b = corner(k, pair[s], j);
            if ((far[i] > 0) == (far[j] > 0))
                continue;
            struct end *e = &end[count];
            for (int d = 0; d < 3; d++)
                e->at[d] = a[d] + far[i] / (far[i] - far[j]) * (b[d] - a[d]);
            if (!is_in(k, pair[!s], n, e->at))
                continue;
            vec3_subtract(b, a, e->edge);
            vec3_normalise(e->edge);
            memcpy(e->n, n, sizeof n);
            e->side = s;
            count++;
        }
    }
    return count == 2;
}

static int find_pairs(struct knot *k)
{
    crossings_free(&k->pairs);
    int status = crossings_find(&k->mesh, &k->pairs);
    if (status == APP_OK && k->u->world)
        crossings_part(&k->pairs, k->u->world);
    return status;
}

/* Lists the regions of the pairs. mark: NULL, or [nt] */
static int list(struct knot *k, struct tangles *tangles, int32_t *mark)
{
    struct untangling *u = k->u;
    int status = crossings_group(u->pool, &k->pairs,
                                 (const int32_t(*)[3])k->beyond, &k->regions);
    if (status != APP_OK)
        return status;
    tangles->count = k->regions.count;
    tangles->row =
        pool_take(u->pool, (size_t)tangles->count + 1, sizeof *tangles->row);
    if (!tangles->row)
        return no_memory();
    for (int64_t p = 0; p < k->pairs.found; p++) {
        const int32_t *pair = k->pairs.pair[p];
        struct tangle *row = &tangles->row[k->regions.of[p]];
        struct end end[2];
        double to[3];
        bool line = find_line(k, pair, end);
        if (!row->pairs++)
            for (int i = 0; i < 3; i++) {
                row->lo[i] = INFINITY;
                row->hi[i] = -INFINITY;
            }
        if (line) {
            vec3_subtract(end[1].at, end[0].at, to);
            row->length += sqrt(vec3_dot(to, to));
        }
        for (int i = 0; i < 2; i++) {
            const double *at = line ? end[i].at : corner(k, pair[i], 0);
            for (int d = 0; d < 3; d++) {
                row->lo[d] = fmin(row->lo[d], at[d]);
                row->hi[d] = fmax(row->hi[d], at[d]);
            }
            row->body[i] = k->part[pair[i ^ k->regions.turned[p]]];
            if (mark)
                mark[pair[i]] = k->regions.of[p];
        }
    }
    return APP_OK;
}

/* Adds a way to the vertices of a triangle, of which each is moved by `most` of
 * its size, or by what it lacks to be outside of the plane through `from`. */
static void push(struct knot *k, int32_t triangle, const double to[3],
                 const double *from, int32_t owner)
{
    double size = find_size(k, triangle), far[3];
    for (int i = 0; i < 3; i++) {
        int32_t v = k->u->tri[triangle][i];
        double lacks = most * size;
        if (from) {
            vec3_subtract(k->u->x[v], from, far);
            lacks = fmin(lacks, outside * size - vec3_dot(far, to));
        }
        if (!(lacks > 0))
            continue;
        for (int d = 0; d < 3; d++)
            k->way[v][d] += to[d];
        k->need[v] = fmax(k->need[v], lacks);
        k->owner[v] = k->owner[v] < 0 ? owner : k->owner[v];
    }
}

/* The region, as found, of a pair: that of its first vertex that has one, as a
 * pair that is new has one that moved. */
static int32_t find_owner(const struct knot *k, const int32_t pair[2])
{
    int32_t owner = -1;
    for (int i = 0; i < 6 && owner < 0; i++)
        owner = k->owner[k->u->tri[pair[i / 3]][i % 3]];
    return owner;
}

/* The body of a pair that is solid, as a place in the pair; -1: none. */
static int find_solid(const struct knot *k, const int32_t pair[2])
{
    for (int s = 0; s < 2; s++)
        if (k->solid[k->part[pair[s]]])
            return s;
    return -1;
}

/* Adds to the gradient of a region's line what a pair has of it: by which way
 * of side 0 the line becomes shorter. *size: adds how much that is. */
static void add_gradient(const struct knot *k, int64_t p, double sum[3],
                         double *size)
{
    struct end end[2];
    if (!find_line(k, k->pairs.pair[p], end))
        return;
    for (int e = 0; e < 2; e++) {
        double along[3], g[3];
        vec3_subtract(end[!e].at, end[e].at, along);
        vec3_normalise(along);
        /* the end slides in the plane of the other as the edge moves */
        double slant = vec3_dot(end[e].edge, end[e].n);
        double slide = vec3_dot(end[e].edge, along) / (slant == 0 ? 1 : slant);
        for (int i = 0; i < 3; i++)
            g[i] = along[i] - slide * end[e].n[i];
        double length = sqrt(vec3_dot(g, g));
        double part = length > steepest ? steepest / length : 1;
        bool first = (end[e].side ^ k->regions.turned[p]) == 0;
        for (int i = 0; i < 3; i++)
            sum[i] += (first ? part : -part) * g[i];
        *size += part * length;
    }
}

/* Of a region of two sheets: by which ways of side 0 the line becomes shorter,
 * and of both sides the normals and how far they were moved along these. */
struct sheets {
    double gradient[3], size, normal[2][3], moved[2];
    double gain[4]; /* of side 0 along its normals and against them, and of 1 */
    int body[2];
    bool fixed[2], weak; /* weak: the line tells no side */
};

static void see_sheets(const struct knot *k, struct sheets *sheets)
{
    const struct untangling *u = k->u;
    for (int64_t p = 0; p < k->pairs.found; p++) {
        struct sheets *r = &sheets[k->regions.of[p]];
        if (find_solid(k, k->pairs.pair[p]) >= 0)
            continue;
        add_gradient(k, p, r->gradient, &r->size);
        for (int s = 0; s < 2; s++) {
            int32_t t = k->pairs.pair[p][s ^ k->regions.turned[p]];
            double n[3], way[3];
            find_normal(k, t, n);
            r->body[s] = k->part[t];
            r->fixed[s] |= u->fixed[k->part[t]];
            for (int i = 0; i < 3; i++) {
                r->normal[s][i] += n[i];
                vec3_subtract(u->x[u->tri[t][i]], k->was[u->tri[t][i]], way);
                r->moved[s] += vec3_dot(way, n);
            }
        }
    }
}

/* Finds the gains of all regions. Lines that end at borders, as those of two
 * interwoven tubes, may be as long wherever sheets are: such regions of
 * different bodies all take the sum of their gains, so that they agree on which
 * body goes where. */
static void find_gains(struct sheets *sheets, int count)
{
    double all[4] = {0};
    for (int i = 0; i < count; i++) {
        struct sheets *r = &sheets[i];
        bool swap = r->body[0] > r->body[1];
        vec3_normalise(r->normal[0]);
        vec3_normalise(r->normal[1]);
        r->weak = r->body[0] != r->body[1];
        for (int o = 0; o < 4; o++) {
            double g =
                vec3_dot(r->gradient, r->normal[o / 2]) / (r->size + 1e-300);
            r->gain[o] = o % 2 == o / 2 ? g : -g;
            r->weak &= fabs(g) < weak;
        }
        for (int o = 0; o < 4 && r->weak; o++)
            all[o] += r->size * r->gain[swap ? (o + 2) % 4 : o];
    }
    for (int i = 0; i < 4 * count; i++) {
        struct sheets *r = &sheets[i / 4];
        bool swap = r->body[0] > r->body[1];
        if (r->weak)
            r->gain[i % 4] = all[swap ? (i + 2) % 4 : i % 4];
        if (r->fixed[i % 4 / 2])
            r->gain[i % 4] = -INFINITY;
    }
}

/* Chooses which side of a region moves, along its normals or against them: as
 * it did; at first by how much the line becomes shorter, and in later tries by
 * what comes next. *side, return value: 1 or -1. */
static int choose(const struct knot *k, struct sheets *r, int *side)
{
    double *gain = r->gain;
    if (fabs(r->moved[0]) + fabs(r->moved[1]) > 0) {
        *side = fabs(r->moved[1]) > fabs(r->moved[0]);
        return r->moved[*side] > 0 ? 1 : -1;
    }
    int best = 0;
    for (int t = 0; t <= k->tried; t++) {
        best = 0;
        for (int o = 1; o < 4; o++)
            if (gain[o] > gain[best])
                best = o;
        if (t < k->tried)
            gain[best] = -INFINITY;
    }
    *side = best / 2;
    return best % 2 ? -1 : 1;
}

/* Finds the way of each vertex: out of solid bodies along their normals; of two
 * sheets, that of one of them along its own. */
static int find_ways(struct knot *k)
{
    size_t nv = (size_t)k->mesh.nv, count = (size_t)k->regions.count + 1;
    struct sheets *sheets = calloc(count, sizeof *sheets);
    int *sign = calloc(count, sizeof *sign),
        *side = calloc(count, sizeof *side);
    memset(k->way, 0, nv * sizeof *k->way);
    memset(k->need, 0, nv * sizeof *k->need);
    bool good = sheets && sign && side;
    if (good)
        see_sheets(k, sheets);
    if (good)
        find_gains(sheets, k->regions.count);
    for (int r = 0; good && r < k->regions.count; r++)
        sign[r] = choose(k, &sheets[r], &side[r]);
    for (int64_t p = 0; good && p < k->pairs.found; p++) {
        const int32_t *pair = k->pairs.pair[p];
        int r = k->regions.of[p], s = find_solid(k, pair);
        int32_t moves = pair[s >= 0 ? !s : side[r] ^ k->regions.turned[p]];
        double n[3];
        find_normal(k, s >= 0 ? pair[s] : moves, n);
        bool back = s >= 0 ? k->inward[k->part[pair[s]]] : sign[r] < 0;
        for (int i = 0; i < 3 && back; i++)
            n[i] = -n[i];
        if (!k->u->fixed[k->part[moves]])
            push(k, moves, n, s >= 0 ? corner(k, pair[s], 0) : NULL,
                 find_owner(k, pair));
    }
    for (size_t v = 0; good && v < nv; v++) {
        vec3_normalise(k->way[v]);
        for (int i = 0; i < 3; i++)
            k->way[v][i] *= k->need[v];
    }
    free(sheets);
    free(sign);
    free(side);
    return good ? APP_OK : no_memory();
}

/* Sums the ways of each vertex's neighbours, of this round or from the start,
 * and counts these: mean, share. */
static void sum_neighbours(struct knot *k, bool round)
{
    struct untangling *u = k->u;
    size_t nv = (size_t)k->mesh.nv;
    memset(k->mean, 0, nv * sizeof *k->mean);
    memset(k->share, 0, nv * sizeof *k->share);
    for (int64_t t = 0; t < u->nt; t++)
        for (int c = 0; c < 6 && !u->fixed[k->part[t]]; c++) {
            int32_t to = u->tri[t][c / 2];
            int32_t from = u->tri[t][(c / 2 + 1 + c % 2) % 3];
            for (int i = 0; i < 3; i++)
                k->mean[to][i] +=
                    round ? k->way[from][i] : u->x[from][i] - k->was[from][i];
            k->share[to]++;
            if (round && k->owner[to] < 0 &&
                vec3_dot(k->way[from], k->way[from]) > 0)
                k->owner[to] = k->owner[from];
        }
}

/* Gives vertices that have no way the mean of their neighbours'. */
static void spread(struct knot *k)
{
    sum_neighbours(k, true);
    for (int64_t v = 0; v < k->mesh.nv; v++)
        for (int i = 0; i < 3 && k->need[v] == 0 && k->share[v] > 0; i++)
            k->way[v][i] = k->mean[v][i] / k->share[v];
}

static void move(struct knot *k)
{
    for (int64_t v = 0; v < k->mesh.nv; v++)
        for (int i = 0; i < 3; i++)
            if (k->way[v][i] != 0)
                k->u->x[v][i] = (float)(k->u->x[v][i] + k->way[v][i]);
}

/* Brings ways from the start nearer to the mean of their neighbours', so that
 * cells that were pushed about do not fold. */
static void smooth(struct knot *k)
{
    sum_neighbours(k, false);
    for (int64_t v = 0; v < k->mesh.nv; v++)
        for (int i = 0; i < 3 && k->owner[v] >= 0 && k->share[v] > 0; i++)
            k->way[v][i] += soft * (k->mean[v][i] / k->share[v] -
                                    (k->u->x[v][i] - k->was[v][i]));
}

static bool has_moved(const struct knot *k, int32_t v)
{
    return memcmp(k->u->x[v], k->was[v], sizeof k->was[v]) != 0;
}

/* Puts back what moved for the regions, as they were found, of which something
 * still intersects. *more: some of that had moved. */
static void put_back(struct knot *k, bool *more)
{
    struct untangling *u = k->u;
    *more = false;
    memset(k->back, 0, ((size_t)u->found.count + 1) * sizeof *k->back);
    for (int64_t p = 0; p < 6 * k->pairs.found; p++) {
        int32_t v = u->tri[k->pairs.pair[p / 6][p / 3 % 2]][p % 3];
        if (!has_moved(k, v) || k->owner[v] < 0)
            continue;
        *more = true;
        k->back[k->owner[v]] = true;
    }
    for (int64_t v = 0; v < k->mesh.nv; v++)
        if (k->owner[v] >= 0 && k->back[k->owner[v]])
            memcpy(u->x[v], k->was[v], sizeof k->was[v]);
}

/* Makes rounds until nothing intersects or nothing more parts, and puts back
 * what has not. */
static int try_part(struct knot *k)
{
    struct untangling *u = k->u;
    int64_t least = k->pairs.found;
    int status = APP_OK, still = 0;
    while (status == APP_OK && k->pairs.found && u->made < u->rounds &&
           still++ < PATIENCE && k->pairs.found < WORSE * least + 100) {
        struct tangles now;
        status = list(k, &now, NULL);
        if (status == APP_OK)
            status = find_ways(k);
        if (status != APP_OK)
            return status;
        for (int i = 0; i < SPREADS; i++)
            spread(k);
        smooth(k);
        move(k);
        u->made++;
        status = find_pairs(k);
        if (k->pairs.found < least) {
            least = k->pairs.found;
            still = 0;
        }
    }
    bool more = true;
    while (status == APP_OK && k->pairs.found && more) {
        put_back(k, &more);
        if (more)
            status = find_pairs(k);
    }
    return status;
}

static int part(struct knot *k)
{
    int status = APP_OK;
    for (k->tried = 0; k->tried < TRIES && k->pairs.found && status == APP_OK;
         k->tried++)
        status = try_part(k);
    return status;
}

/* Takes memory, and looks at what bodies are like. */
static int begin(struct knot *k)
{
    struct untangling *u = k->u;
    struct pool *pool = u->pool;
    size_t nt = (size_t)u->nt + 1, nv = (size_t)u->first[u->parts] + 1;
    size_t parts = (size_t)u->parts + 1;
    k->part = pool_take(pool, nt, sizeof *k->part);
    k->group = pool_take(pool, nt, sizeof *k->group);
    k->beyond = pool_take(pool, nt, sizeof *k->beyond);
    k->solid = pool_take(pool, parts, sizeof *k->solid);
    k->inward = pool_take(pool, parts, sizeof *k->inward);
    k->was = pool_take(pool, nv, sizeof *k->was);
    k->way = pool_take(pool, nv, sizeof *k->way);
    k->need = pool_take(pool, nv, sizeof *k->need);
    k->mean = pool_take(pool, nv, sizeof *k->mean);
    k->share = pool_take(pool, nv, sizeof *k->share);
    k->owner = pool_take(pool, nv, sizeof *k->owner);
    u->way = pool_take(pool, parts, sizeof *u->way);
    u->mark = pool_take(pool, nt, sizeof *u->mark);
    if (!k->part || !k->group || !k->beyond || !k->solid || !k->inward ||
        !k->was || !k->way || !k->need || !k->mean || !k->share || !k->owner ||
        !u->way || !u->mark)
        return no_memory();
    memcpy(k->was, u->x, (nv - 1) * sizeof *k->was);
    for (size_t v = 0; v < nv; v++)
        k->owner[v] = -1;
    int64_t from = 0;
    for (int p = 0; p < u->parts; p++) {
        int64_t to = from;
        double volume = 0, n[3];
        for (; to < u->nt && u->tri[to][0] < u->first[p + 1]; to++) {
            k->part[to] = p;
            k->group[to] = !u->fixed[p];
            u->mark[to] = -1;
            const int32_t *t = u->tri[to];
            double a[3], b[3], c[3];
            for (int i = 0; i < 3; i++) {
                a[i] = u->x[t[0]][i] - u->x[u->first[p]][i];
                b[i] = u->x[t[1]][i] - u->x[u->first[p]][i];
                c[i] = u->x[t[2]][i] - u->x[u->first[p]][i];
            }
            vec3_cross(b, c, n);
            volume += vec3_dot(a, n);
        }
        struct mesh mesh = {u->first[u->parts], to - from, u->x,
                            (int32_t(*)[3])u->tri + from};
        int closed = u->fixed[p] && to > from ? apart_closed(&mesh) : 0;
        if (closed < 0)
            return no_memory();
        k->solid[p] = closed;
        k->inward[p] = volume < 0;
        from = to;
    }
    k->mesh = (drape_mesh){.nv = u->first[u->parts],
                           .nt = u->nt,
                           .x = (const double(*)[3])u->x,
                           .tri = u->tri,
                           .group = k->group,
                           .threads = u->threads};
    return crossings_adjacent(&k->mesh, k->beyond);
}

int untangle(struct untangling *untangling)
{
    struct untangling *u = untangling;
    struct knot k = {.u = u};
    int status = begin(&k);
    if (status == APP_OK)
        status = find_pairs(&k);
    if (status == APP_OK)
        status = list(&k, &u->found, u->mark);
    k.back = pool_take(u->pool, (size_t)u->found.count + 1, sizeof *k.back);
    if (!k.back)
        return no_memory();
    for (int64_t p = 0; p < 6 * k.pairs.found && status == APP_OK; p++)
        k.owner[u->tri[k.pairs.pair[p / 6][p / 3 % 2]][p % 3]] =
            k.regions.of[p / 6];
    if (status == APP_OK && u->rounds)
        status = part(&k);
    if (status == APP_OK)
        status = list(&k, &u->left, NULL);
    for (int r = 0; status == APP_OK && r < u->found.count; r++)
        u->found.row[r].parted = true;
    for (int64_t p = 0; status == APP_OK && p < 2 * k.pairs.found; p++) {
        int32_t r = u->mark[k.pairs.pair[p / 2][p % 2]];
        if (r >= 0)
            u->found.row[r].parted = false;
    }
    for (int p = 0; status == APP_OK && p < u->parts; p++)
        for (int64_t v = u->first[p]; v < u->first[p + 1]; v++) {
            double way[3];
            vec3_subtract(u->x[v], k.was[v], way);
            u->way[p] = fmax(u->way[p], sqrt(vec3_dot(way, way)));
        }
    crossings_free(&k.pairs);
    return status;
}
