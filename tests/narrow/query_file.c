/* SPDX-License-Identifier: Apache-2.0 */
/* Reads the public queries with exact truth that ci/data.sh fetches. */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/base/data.h"
#include "tests/narrow/query.h"

struct list {
    struct known *at;
    int n, room;
};

static struct known *append(struct list *l)
{
    if (l->n == l->room) {
        l->room = l->room ? 2 * l->room : 1024;
        l->at = realloc(l->at, (size_t)l->room * sizeof *l->at);
        if (!l->at)
            abort();
    }
    memset(&l->at[l->n], 0, sizeof *l->at);
    return &l->at[l->n++];
}

/* Reads a row xn,xd,yn,yd,zn,zd,truth, in which each quotient is exactly a
 * binary64 number. Returns false for any other row. */
static bool read_row(const char *line, struct known *k, int row)
{
    double a[7];
    const char *at = line;
    for (int i = 0; i < 7; i++) {
        char *end;
        a[i] = strtod(at, &end);
        if (end == at)
            return false;
        at = end + (*end == ',');
    }
    for (int i = 0; i < 3; i++) {
        double x = a[2 * i] / a[2 * i + 1];
        real *y = query_at(&k->q, 3 * row + i);
        *y = (real)x;
        k->exact = k->exact && (double)*y == x;
    }
    k->truth = a[6] != 0;
    return true;
}

/* Reads a file, eight rows a query. */
static bool read_file(const char *path, int kind, struct list *l)
{
    char line[4096];
    int row = 0;
    bool good = true;
    FILE *f = fopen(path, "r");
    if (!f)
        return false;
    while (good && fgets(line, sizeof line, f)) {
        struct known *k = row ? &l->at[l->n - 1] : append(l);
        if (row == 0) {
            k->exact = true;
            k->q.kind = kind;
        }
        good = read_row(line, k, row);
        row = (row + 1) % 8;
    }
    fclose(f);
    return good && row == 0;
}

struct known *query_load(int *n)
{
    struct list l = {0};
    struct dirent **file;
    char home[512];
    snprintf(home, sizeof home, "%s/ccd/queries", data_home());
    int files = scandir(home, &file, NULL, alphasort);
    bool good = true;
    for (int i = 0; i < files; i++) {
        char path[1024];
        const char *name = file[i]->d_name, *dot = strrchr(name, '.');
        bool csv = dot && !strcmp(dot, ".csv") && dot - name >= 2;
        snprintf(path, sizeof path, "%s/%s", home, name);
        if (csv)
            good = read_file(path, !strncmp(dot - 2, "ee", 2), &l) && good;
        free(file[i]);
    }
    if (files >= 0)
        free(file);
    *n = good ? l.n : -1;
    if (good)
        return l.at;
    free(l.at);
    return NULL;
}
