/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzes the functions of spec/drape.h that need no world: the audit, collision
 * queries, defaults and texts. */
#include <math.h>
#include <stdlib.h>

#include "fuzz/draw.h"
#include "fuzz/fuzz.h"

enum { POINTS = 12, TRIANGLES = 10 };

/* A mesh as a caller may pass it: mostly valid, on a coarse grid, so that many
 * triangles touch. */
struct soup {
    drape_mesh mesh;
    double x[POINTS][3], x1[POINTS][3];
    int32_t tri[TRIANGLES][3], group[TRIANGLES];
    struct bank bank;
    bool sound; /* all of the mesh is valid */
};

static double coordinate(struct bytes *b, bool *sound)
{
    double x = pick(b, 96) == 95 ? draw_any(b) : 0.25 * pick(b, 5);
    x += pick(b, 4) == 3 ? draw_in(b, -1, 1) : 0;
    *sound = *sound && fabs(x) <= 0x1p60;
    return x;
}

static void draw_soup(struct bytes *b, struct soup *s, bool groups)
{
    memset(s, 0, sizeof *s);
    s->sound = true;
    int nv = 3 + (int)pick(b, POINTS - 2), nt = 1 + (int)pick(b, TRIANGLES);
    for (int k = 0; k < 3 * nv; k++) {
        s->x[k / 3][k % 3] = coordinate(b, &s->sound);
        s->x1[k / 3][k % 3] =
            pick(b, 2) ? coordinate(b, &s->sound) : s->x[k / 3][k % 3];
    }
    for (int k = 0; k < 3 * nt; k++) {
        bool any = pick(b, 96) == 95;
        int v = any ? draw_int(b) : (int)pick(b, (uint32_t)nv);
        s->tri[k / 3][k % 3] = v;
        s->group[k / 3] = (int32_t)pick(b, 3);
        s->sound = s->sound && v >= 0 && v < nv;
    }
    bank_open(&s->bank, (size_t)1 << 26);
    s->mesh = (drape_mesh){.nv = nv,
                           .nt = nt,
                           .x = (const double(*)[3])s->x,
                           .tri = (const int32_t(*)[3])s->tri,
                           .group = groups && pick(b, 2) ? s->group : NULL,
                           .threads = 1 + (int)pick(b, 2),
                           .allocator = bank_of(&s->bank)};
    if (pick(b, 16) == 15) {
        int64_t wrong = draw_int(b);
        s->mesh.nv = pick(b, 2) && wrong <= nv ? wrong : nv;
        s->mesh.nt = pick(b, 2) && wrong <= nt ? wrong : nt;
        s->sound = false; /* or still valid; any status is then accepted */
    }
}

/* In one input of eight, makes all allocations fail from one of the first 16
 * on. Returns whether this was chosen. */
static bool draw_short(struct bytes *b, struct bank *bank)
{
    if (pick(b, 8) != 7)
        return false;
    bank->from = pick(b, 16);
    bank->times = INT64_MAX;
    return true;
}

/* Counts intersecting pairs by one audit for each two triangles. */
static int64_t audit_two_by_two(const struct soup *s)
{
    int64_t sum = 0;
    for (int64_t i = 0; i < s->mesh.nt; i++)
        for (int64_t j = i + 1; j < s->mesh.nt; j++) {
            int32_t tri[2][3], group[2] = {s->group[i], s->group[j]};
            int64_t found = 0;
            memcpy(tri[0], s->tri[i], sizeof tri[0]);
            memcpy(tri[1], s->tri[j], sizeof tri[1]);
            drape_mesh two = s->mesh;
            two.nt = 2;
            two.tri = (const int32_t(*)[3])tri;
            two.group = s->mesh.group ? group : NULL;
            if (drape_audit(&two, 0, NULL, &found, NULL) != DRAPE_OK)
                return -1;
            sum += found;
        }
    return sum;
}

static const char *audit(struct bytes *b, struct soup *s)
{
    int32_t pair[64][2];
    int64_t found = -7, again = -7, degenerate = -7;
    int64_t capacity = pick(b, 65);
    bool lean = draw_short(b, &s->bank);
    memset(pair, 0x5a, sizeof pair);
    int status = drape_audit(&s->mesh, capacity, pair, &found, &degenerate);
    s->bank.from = INT64_MAX;
    EXPECT(s->bank.held == 0 && !s->bank.wrong);
    EXPECT(status == DRAPE_OK || status == DRAPE_EARG ||
           status == DRAPE_EDATA || (status == DRAPE_ENOMEM && lean));
    EXPECT(!s->sound || lean || status == DRAPE_OK);
    if (status != DRAPE_OK)
        return NULL;
    EXPECT(found >= 0 && degenerate >= 0 && degenerate <= s->mesh.nt);
    for (int64_t k = 0; k < 64; k++) {
        bool given = k < found && k < capacity;
        EXPECT(given || pair[k][0] == 0x5a5a5a5a);
        EXPECT(!given || (pair[k][0] >= 0 && pair[k][1] < s->mesh.nt &&
                          pair[k][0] < pair[k][1]));
    }
    s->mesh.threads = 3 - s->mesh.threads;
    EXPECT(drape_audit(&s->mesh, 0, NULL, &again, NULL) == DRAPE_OK);
    EXPECT(again == found && audit_two_by_two(s) == found);
    return NULL;
}

const char *fuzz_audit(const char *name, const uint8_t *data, size_t size)
{
    static uint32_t words[DRAW_WORDS];
    struct soup s;
    struct bytes b = draw_open(data, size, words);
    (void)name;
    draw_soup(&b, &s, true);
    const char *failed = audit(&b, &s);
    choices_free(&b);
    return failed;
}

static const char *ccd(struct bytes *b)
{
    double x[2][4][3], y[2][4][3], toi = -7, other = -7;
    bool sound = true;
    int kind = pick(b, 16) == 15 ? draw_int(b) : (int)pick(b, 2);
    for (int k = 0; k < 24; k++)
        x[k / 12][k / 3 % 4][k % 3] = coordinate(b, &sound);
    const double(*x0)[3] = (const double(*)[3])x[0];
    const double(*x1)[3] = (const double(*)[3])x[1];
    int hit = drape_ccd(kind, x0, x1, &toi);
    if (kind != 0 && kind != 1) {
        EXPECT(hit == DRAPE_EARG || !sound);
        return NULL;
    }
    EXPECT(sound ? hit == 0 || hit == 1 : hit <= 1);
    EXPECT(hit != 1 || (toi >= 0 && toi <= 1));
    /* the face's corners or the edges in another order; positions halved */
    static const int turn[2][4] = {{0, 2, 3, 1}, {2, 3, 1, 0}};
    bool exact = true;
    for (int k = 0; k < 24; k++) {
        double half = 0.5 * x[k / 12][turn[kind][k / 3 % 4]][k % 3];
        y[k / 12][k / 3 % 4][k % 3] = half;
        exact = exact && 2 * half == x[k / 12][turn[kind][k / 3 % 4]][k % 3];
    }
    int same = drape_ccd(kind, (const double(*)[3])y[0],
                         (const double(*)[3])y[1], &other);
    EXPECT(!sound || !exact || same == hit);
    EXPECT(!exact || same != 1 || hit != 1 || fabs(other - toi) <= 0x1p-29);
    return NULL;
}

const char *fuzz_ccd(const char *name, const uint8_t *data, size_t size)
{
    static uint32_t words[DRAW_WORDS];
    struct bytes b = draw_open(data, size, words);
    (void)name;
    const char *failed = ccd(&b);
    choices_free(&b);
    return failed;
}

struct touched {
    int64_t n, end; /* end: number of calls after which it asks to stop */
    uint64_t hash;
    const struct soup *soup;
    bool wrong; /* a query of the pair alone gives another answer */
};

static int touch(void *user, int kind, const int32_t v[4], double toi)
{
    struct touched *t = user;
    double x0[4][3], x1[4][3], alone = -1;
    for (int k = 0; k < 12; k++) {
        bool in = v[k / 3] >= 0 && v[k / 3] < t->soup->mesh.nv;
        t->wrong |= !in;
        x0[k / 3][k % 3] = in ? t->soup->x[v[k / 3]][k % 3] : 0;
        x1[k / 3][k % 3] = in ? t->soup->x1[v[k / 3]][k % 3] : 0;
    }
    t->wrong |= drape_ccd(kind, (const double(*)[3])x0, (const double(*)[3])x1,
                          &alone) != 1;
    t->wrong |= alone != toi;
    t->hash = hash_bytes(t->hash, v, 4 * sizeof *v);
    t->hash = hash_bytes(t->hash, &toi, sizeof toi);
    t->n++;
    return t->n == t->end;
}

static const char *frames(struct bytes *b, struct soup *s)
{
    struct touched t = {.hash = HASH_START, .soup = s};
    struct touched u = {.hash = HASH_START, .soup = s};
    int64_t asked[2] = {-7, -7};
    bool lean = draw_short(b, &s->bank);
    t.end = pick(b, 8) == 7 ? pick(b, 8) : 0;
    int status =
        drape_ccd_frames(&s->mesh, (const double(*)[3])s->x1, touch, &t, asked);
    s->bank.from = INT64_MAX;
    EXPECT(s->bank.held == 0 && !s->bank.wrong && !t.wrong);
    EXPECT(status == DRAPE_OK || status == DRAPE_EARG ||
           status == DRAPE_EDATA || (status == DRAPE_ENOMEM && lean) ||
           (status == DRAPE_EIO && t.end && t.n == t.end));
    EXPECT(!s->sound || lean || t.end || status == DRAPE_OK);
    if (status != DRAPE_OK)
        return NULL;
    EXPECT(asked[0] >= 0 && asked[1] >= 0 && t.n <= asked[0] + asked[1]);
    s->mesh.threads = 3 - s->mesh.threads;
    EXPECT(drape_ccd_frames(&s->mesh, (const double(*)[3])s->x1, touch, &u,
                            NULL) == DRAPE_OK);
    EXPECT(t.n == u.n && t.hash == u.hash);
    return NULL;
}

const char *fuzz_ccd_frames(const char *name, const uint8_t *data, size_t size)
{
    static uint32_t words[DRAW_WORDS];
    struct soup s;
    struct bytes b = draw_open(data, size, words);
    (void)name;
    draw_soup(&b, &s, false);
    const char *failed = frames(&b, &s);
    choices_free(&b);
    return failed;
}

/* Whether a function that fills a struct fills all of it, whatever was there
 * before. */
#define FILLS(type, fill)                                                      \
    do {                                                                       \
        type a_, b_;                                                           \
        memset(&a_, 0x5a, sizeof a_);                                          \
        memset(&b_, 0xa5, sizeof b_);                                          \
        fill(&a_);                                                             \
        fill(&b_);                                                             \
        EXPECT(memcmp(&a_, &b_, sizeof a_) == 0);                              \
    } while (0)

const char *fuzz_text(const char *name, const uint8_t *data, size_t size)
{
    static uint32_t words[DRAW_WORDS];
    struct bytes b = draw_open(data, size, words);
    int status = pick(&b, 2) ? draw_int(&b) : -(int)pick(&b, 12);
    const char *text = drape_status_text(status);
    choices_free(&b);
    (void)name;
    EXPECT(text && text[0] && !strchr(text, '\n'));
    EXPECT(text == drape_status_text(status) ||
           !strcmp(text, "unknown status"));
    EXPECT(drape_info() && strstr(drape_info(), DRAPE_VERSION));
    FILLS(drape_def, drape_default);
    FILLS(drape_cloth, drape_default_cloth);
    FILLS(drape_obstacle, drape_default_obstacle);
    return NULL;
}
