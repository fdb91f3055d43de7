/* SPDX-License-Identifier: Apache-2.0 */
/* drape ccd: collision queries from exact rationals. */
#include "app/app.h"

#include <drape.h>
#include <errno.h>
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

/* numerator ÷ denominator, which must be a binary64 number. */
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

/* Cuts a line at its commas; the number of columns, at most COLUMNS + 1. */
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

static int answer(struct queries *q)
{
    double toi = 0;
    int hit = drape_ccd(q->kind, (const double(*)[3])q->x,
                        (const double(*)[3])(q->x + 4), &toi);
    if (hit < 0)
        return refuse(q, "numbers within 2^60 in the 8 rows up to here");
    if (hit)
        printf("1 %.17g\n", toi);
    else
        printf("0\n");
    q->asked++;
    q->missed += q->truth == 1 && !hit;
    q->invented += q->truth == 0 && hit;
    return APP_OK;
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
        if (strlen(line) != (size_t)length)
            status = refuse(q, "text");
        else
            status = read_row(q, line, row);
        if (status == APP_OK && ++row == ROWS) {
            row = 0;
            status = answer(q);
        }
    }
    free(line);
    if (status == APP_OK && ferror(q->stream))
        return complain(APP_USAGE, "%s: cannot be read", q->path);
    if (status == APP_OK && row)
        return refuse(q, "8 rows a query; the file ends within one");
    if (status == APP_OK && !q->asked)
        return refuse(q, "at least one query");
    return status;
}

int command_ccd(int argc, char **argv)
{
    const char *kind = NULL;
    const struct option options[] = {{"--kind", OPTION_TEXT, &kind, 0, 0}, {0}};
    int positional;
    int status = options_read(options, argc, argv, &positional);
    if (status != APP_OK)
        return status;
    if (!kind || (strcmp(kind, "vf") != 0 && strcmp(kind, "ee") != 0))
        return complain(APP_USAGE, "ccd: expected --kind vf or --kind ee");
    if (positional != 1)
        return complain(APP_USAGE, "ccd: expected one FILE.csv");
    struct queries q = {
        .path = argv[0], .kind = strcmp(kind, "ee") == 0, .truth = -1};
    q.stream = fopen(q.path, "r");
    if (!q.stream)
        return complain(APP_USAGE, "%s: %s", q.path, strerror(errno));
    mpq_init(q.exact);
    mpq_init(q.back);
    status = read_all(&q);
    mpq_clear(q.exact);
    mpq_clear(q.back);
    fclose(q.stream);
    if (status == APP_OK && q.columns == 7)
        fprintf(stderr, "%ld queries, %ld missed, %ld invented\n", q.asked,
                q.missed, q.invented);
    return status == APP_OK && q.missed + q.invented ? APP_FINDINGS : status;
}
