/* SPDX-License-Identifier: Apache-2.0 */
/* drape ccd: continuous collision queries, single ones given by exact rational
 * numbers, or all pairs of a moving mesh. */
#include "app/base/file.h"
#include "app/read/mesh.h"
#include "app/tool/options.h"

#include <drape.h>
#include <gmp.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 7, ROWS = 8 };

struct queries {
    const char *path;
    FILE *stream;
    long line;
    int kind, columns; /* columns: 6 or 7, as in the first row */
    mpq_t exact, back; /* scratch */
    double x[ROWS][3];
    int truth; /* -1: none */
    long asked, missed, invented;
};

static int refuse(const struct queries *q, const char *expected)
{
    return complain(APP_USAGE, "%s: line %ld: expected %s", q->path, q->line,
                    expected);
}

/* Digits with an optional sign; GMP itself would also take spaces. */
static bool is_integer(const char *text)
{
    text += *text == '-' || *text == '+';
    size_t digits = strspn(text, "0123456789");
    return digits > 0 && !text[digits];
}

/* Reads numerator ÷ denominator; the quotient must be a binary64 number. */
static int read_rational(struct queries *q, const char *numerator,
                         const char *denominator, double *out)
{
    if (!is_integer(numerator) || !is_integer(denominator))
        return refuse(q, "whole numbers xn,xd,yn,yd,zn,zd");
    mpz_set_str(mpq_numref(q->exact), numerator + (*numerator == '+'), 10);
    mpz_set_str(mpq_denref(q->exact), denominator + (*denominator == '+'), 10);
    if (mpz_sgn(mpq_denref(q->exact)) == 0)
        return refuse(q, "denominators other than 0");
    mpq_canonicalize(q->exact);
    double value = mpq_get_d(q->exact);
    if (!isfinite(value))
        return refuse(q, "finite quotients");
    mpq_set_d(q->back, value);
    if (!mpq_equal(q->exact, q->back))
        return refuse(q, "quotients that are binary64 numbers");
    *out = value;
    return APP_OK;
}

/* Splits a line at its commas. Returns the number of columns, at most
 * COLUMNS + 1. */
static int split(char *line, char *column[COLUMNS + 1])
{
    int count = 0;
    line[strcspn(line, "\r\n")] = 0;
    while (count <= COLUMNS) {
        column[count++] = line;
        line = strchr(line, ',');
        if (!line)
            break;
        *line++ = 0;
    }
    return count;
}

static int read_row(struct queries *q, char *line, int row)
{
    char *column[COLUMNS + 1];
    int count = split(line, column), status = APP_OK;
    if (count != 6 && count != 7)
        return refuse(q, "6 or 7 columns");
    if (q->columns && count != q->columns)
        return refuse(q, "as many columns as in the rows before");
    q->columns = count;
    for (int i = 0; i < 3 && status == APP_OK; i++)
        status =
            read_rational(q, column[2 * i], column[2 * i + 1], &q->x[row][i]);
    if (status != APP_OK)
        return status;
    int truth = -1;
    if (count == 7) {
        if (strcmp(column[6], "0") != 0 && strcmp(column[6], "1") != 0)
            return refuse(q, "truth 0 or 1 in column 7");
        truth = column[6][0] - '0';
    }
    if (row && truth != q->truth)
        return refuse(q, "the same truth in all 8 rows of a query");
    q->truth = truth;
    return APP_OK;
}

/* Answers the query of the last 8 rows. They are finite and the kind is one of
 * the two, so drape_ccd does not refuse it. */
static void answer(struct queries *q)
{
    double toi;
    bool hit = drape_ccd(q->kind, (const double(*)[3])q->x,
                         (const double(*)[3])(q->x + 4), &toi) > 0;
    if (hit)
        printf("1 %.17g\n", toi);
    else
        printf("0\n");
    q->asked++;
    q->missed += q->truth == 1 && !hit;
    q->invented += q->truth == 0 && hit;
}

static int read_all(struct queries *q)
{
    char *line = NULL;
    size_t room = 0;
    int row = 0, status = APP_OK;
    ssize_t length;
    while (status == APP_OK &&
           (length = getline(&line, &room, q->stream)) > 0) {
        q->line++;
        if (q->line == 1 && file_is_utf16(line, (size_t)length, q->path))
            status = APP_USAGE;
        else if (strlen(line) != (size_t)length)
            status = refuse(q, "text");
        else
            status = read_row(q, line, row);
        if (status == APP_OK && ++row == ROWS) {
            row = 0;
            answer(q);
        }
    }
    free(line);
    if (status == APP_OK && ferror(q->stream))
        return complain(APP_USAGE, "%s: cannot be read", q->path);
    if (status == APP_OK && row)
        return refuse(q, "8 rows a query; the file ends within one");
    if (status == APP_OK && !q->asked)
        return complain(APP_USAGE, "%s: expected at least one query, is empty",
                        q->path);
    return status;
}

static int answer_file(const char *path, const char *kind)
{
    struct queries q = {
        .path = path, .kind = strcmp(kind, "ee") == 0, .truth = -1};
    q.stream = file_stream(q.path);
    if (!q.stream)
        return APP_USAGE;
    mpq_init(q.exact);
    mpq_init(q.back);
    int status = read_all(&q);
    mpq_clear(q.exact);
    mpq_clear(q.back);
    fclose(q.stream);
    if (status == APP_OK && q.columns == 7)
        fprintf(stderr, "%ld queries, %ld missed, %ld invented\n", q.asked,
                q.missed, q.invented);
    return status == APP_OK && q.missed + q.invented ? APP_FINDINGS : status;
}

/* The pairs that touch: kind and four vertices each. */
struct touches {
    int32_t (*pair)[5];
    size_t n, room;
};

/* A drape_touch that stores the pair in a normal form: an edge begins at its
 * smaller vertex, and the edge with the smaller first vertex comes first. */
static int keep(void *user, int kind, const int32_t v[4], double toi)
{
    struct touches *all = user;
    (void)toi;
    if (all->n == all->room) {
        size_t room = all->room ? 2 * all->room : 1024;
        void *more = realloc(all->pair, room * sizeof *all->pair);
        if (!more)
            return 1;
        all->pair = more;
        all->room = room;
    }
    int a = kind && v[0] > v[1], b = kind && v[2] > v[3];
    int swap = kind && v[a] > v[2 + b] ? 2 : 0;
    int32_t *p = all->pair[all->n++];
    p[0] = kind;
    p[1 + swap] = v[a];
    p[2 + swap] = v[1 - a];
    p[3 - swap] = v[2 + b];
    p[4 - swap] = v[3 - b];
    return 0;
}

static int by_kind(const void *a, const void *b)
{
    const int32_t *p = a, *q = b;
    for (int k = 0; k < 5; k++)
        if (p[k] != q[k])
            return p[k] < q[k] ? -1 : 1;
    return 0;
}

static int answer_meshes(struct pool *pool, char **path)
{
    struct mesh from, to;
    struct touches all = {0};
    int64_t asked[2];
    int status = mesh_load(pool, path[0], &from);
    if (status == APP_OK)
        status = mesh_load(pool, path[1], &to);
    if (status != APP_OK)
        return status;
    if (from.nv != to.nv || from.nt != to.nt ||
        memcmp(from.tri, to.tri, (size_t)to.nt * sizeof *to.tri) != 0)
        return complain(APP_USAGE, "%s: expected the triangles of %s", path[1],
                        path[0]);
    drape_mesh mesh = {.nv = from.nv,
                       .nt = from.nt,
                       .x = (const double(*)[3])from.x,
                       .tri = (const int32_t(*)[3])from.tri};
    int end =
        drape_ccd_frames(&mesh, (const double(*)[3])to.x, keep, &all, asked);
    if (all.n)
        qsort(all.pair, all.n, sizeof *all.pair, by_kind);
    for (size_t k = 0; end == DRAPE_OK && k < all.n; k++) {
        const int32_t *p = all.pair[k];
        printf("%s %d %d %d %d\n", p[0] ? "ee" : "vf", (int)p[1], (int)p[2],
               (int)p[3], (int)p[4]);
    }
    if (end == DRAPE_OK)
        fprintf(stderr, "%lld vf and %lld ee candidates, %zu touch\n",
                (long long)asked[0], (long long)asked[1], all.n);
    free(all.pair);
    return end == DRAPE_OK
               ? APP_OK
               : complain(end == DRAPE_EDATA ? APP_USAGE : APP_FAILED,
                          "ccd: %s", drape_status_text(end));
}

int command_ccd(int argc, char **argv)
{
    const char *kind = NULL;
    int frames = 0, positional;
    const struct option_row options[] = {
        TEXT_OPTION("--kind", &kind), FLAG_OPTION("--frames", &frames), {0}};
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (frames && (kind || positional != 2))
        return complain(APP_USAGE, "ccd --frames: expected two meshes");
    if (frames) {
        struct pool pool = {0};
        status = answer_meshes(&pool, argv);
        pool_free(&pool);
        return status;
    }
    if (!kind || (strcmp(kind, "vf") != 0 && strcmp(kind, "ee") != 0))
        return complain(APP_USAGE, "ccd: expected --kind vf or --kind ee");
    if (positional != 1)
        return complain(APP_USAGE, "ccd: expected one FILE.csv");
    return answer_file(argv[0], kind);
}
