/* SPDX-License-Identifier: Apache-2.0 */
/* Cuts a panel: what is left is one piece whose cells are joined by edges.
 * app/patterns/README.md §6. */
#include "app/base/cut.h"

#include <stdlib.h>

/* A piece of at most so many cells may be left out. */
enum { CRUMB = 8 };

/* The cell of which particle p is corner k, or -1 beyond the grid. */
static int64_t cell_at(const struct cut *cut, int32_t p, int k)
{
    int i = p % cut->m - (k == 1 || k == 2), j = p / cut->m - (k >= 2);
    if (i < 0 || j < 0 || i >= cut->m - 1 || j >= cut->n - 1)
        return -1;
    return i + (int64_t)(cut->m - 1) * j;
}

/* The cells around a particle are counted counter-clockwise by the corner that
 * it is of them. round[k]: cell k has the particle; linked[k]: cells k and
 * k + 1 share an edge that ends in it. Returns in how many fans they are; a
 * closed ring is none. */
static int fans_of(const struct cut *cut, int32_t p, bool round[4],
                   bool linked[4])
{
    uint8_t cell[4];
    int fans = 0;
    for (int k = 0; k < 4; k++) {
        int64_t c = cell_at(cut, p, k);
        cell[k] = c < 0 ? CUT_ABSENT : cut->cell[c];
        round[k] = cut_has(cell[k], k);
    }
    for (int k = 0; k < 4; k++) {
        int next = (k + 1) % 4;
        linked[k] = round[k] && round[next] && cut_has(cell[k], (k + 3) % 4) &&
                    cut_has(cell[next], (next + 1) % 4);
        fans += round[k] - linked[k];
    }
    return fans;
}

/* Removes all cells around a particle but the largest fan. */
static void thin(struct cut *cut, int32_t p, const bool round[4],
                 const bool linked[4])
{
    int best = -1, most = 0;
    for (int k = 0; k < 4; k++) {
        int length = 1;
        if (!round[k] || linked[(k + 3) % 4])
            continue; /* no fan begins here */
        while (length < 4 && linked[(k + length - 1) % 4])
            length++;
        if (length > most) {
            most = length;
            best = k;
        }
    }
    for (int k = 0; k < 4; k++) {
        if (!round[k] || (k - best + 4) % 4 < most)
            continue;
        cut->cell[cell_at(cut, p, k)] = CUT_ABSENT;
        cut->parted++;
    }
}

/* Two fans that meet in a particle alone would be hinged there. */
static void unhinge(struct cut *cut)
{
    bool round[4], linked[4], again = true;
    while (again) {
        again = false;
        for (int32_t p = 0; p < cut->m * cut->n; p++) {
            if (cut->kind[p] < CUT_BORDER || fans_of(cut, p, round, linked) < 2)
                continue;
            thin(cut, p, round, linked);
            again = true;
        }
    }
}

/* The cell across side k of a cell, where both have the side; else -1. */
static int64_t across(const struct cut *cut, int64_t cell, int k)
{
    static const int di[4] = {0, 1, 0, -1}, dj[4] = {-1, 0, 1, 0};
    int i = (int)(cell % (cut->m - 1)) + di[k];
    int j = (int)(cell / (cut->m - 1)) + dj[k];
    if (i < 0 || j < 0 || i >= cut->m - 1 || j >= cut->n - 1)
        return -1;
    int64_t to = i + (int64_t)(cut->m - 1) * j;
    bool shared = cut_has(cut->cell[cell], k) &&
                  cut_has(cut->cell[cell], (k + 1) % 4) &&
                  cut_has(cut->cell[to], (k + 2) % 4) &&
                  cut_has(cut->cell[to], (k + 3) % 4);
    return shared ? to : -1;
}

/* Gives the cells that edges join to cell `from` the label; returns how many.
 * queue: [cells] */
static int64_t flood(const struct cut *cut, int64_t from, int32_t label,
                     int32_t *labels, int32_t *queue)
{
    int64_t count = 1;
    queue[0] = (int32_t)from;
    labels[from] = label;
    for (int64_t k = 0; k < count; k++)
        for (int side = 0; side < 4; side++) {
            int64_t to = across(cut, queue[k], side);
            if (to < 0 || labels[to])
                continue;
            labels[to] = label;
            queue[count++] = (int32_t)to;
        }
    return count;
}

/* Leaves the largest piece alone. */
static enum cut_status keep_largest(struct cut *cut, double x[2],
                                    int32_t *labels, int32_t *queue)
{
    int64_t cells = (int64_t)(cut->m - 1) * (cut->n - 1), most = 0;
    int32_t label = 0, best = 0;
    enum cut_status status = CUT_OK;
    for (int64_t c = 0; c < cells; c++) {
        if (cut->cell[c] == CUT_ABSENT || labels[c])
            continue;
        int64_t count = flood(cut, c, ++label, labels, queue);
        int32_t small = label;
        int64_t lost = count < most ? count : most;
        if (count > most) {
            most = count;
            small = best;
            best = label;
        }
        if (lost > CRUMB && status == CUT_OK) {
            status = CUT_APART;
            int64_t at = 0;
            while (labels[at] != small)
                at++;
            x[0] = cut->at[0] + cut->h * ((double)(at % (cut->m - 1)) + 0.5);
            x[1] = cut->at[1] + cut->h * ((double)(at / (cut->m - 1)) + 0.5);
        }
    }
    for (int64_t c = 0; c < cells; c++)
        if (labels[c] != best && cut->cell[c] != CUT_ABSENT) {
            cut->cell[c] = CUT_ABSENT;
            cut->parted++;
        }
    return best ? status : CUT_NONE;
}

/* A particle without a cell is none. */
static void drop_particles(struct cut *cut)
{
    for (int32_t p = 0; p < cut->m * cut->n; p++) {
        bool used = false;
        for (int k = 0; k < 4 && !used; k++) {
            int64_t c = cell_at(cut, p, k);
            used = c >= 0 && cut_has(cut->cell[c], k);
        }
        if (!used)
            cut->kind[p] = CUT_OUT;
    }
}

enum cut_status cut_join(struct cut *cut, double x[2])
{
    size_t cells = (size_t)(cut->m - 1) * (size_t)(cut->n - 1);
    int32_t *labels = calloc(cells, sizeof *labels);
    int32_t *queue = malloc(cells * sizeof *queue);
    enum cut_status status = CUT_MEMORY;
    if (labels && queue) {
        unhinge(cut);
        status = keep_largest(cut, x, labels, queue);
        drop_particles(cut);
    }
    free(labels);
    free(queue);
    return status;
}
