/* SPDX-License-Identifier: Apache-2.0 */
/* Tries every way in which the rounds of a slice can go, on all scenes of up to
 * so many vertices and pairs, and checks spec/contact/response.md §7: nothing
 * is missed, it ends, and it ends clean. The rounds, rollback and the choice of
 * impacts are the code of ref/, which is included here; the stages that compute
 * are replaced by choices: which pairs touch at first, which vertices the
 * contacts move, which pairs touch when a vertex of theirs has moved.
 *
 * What the future depends on after a detection is the round, the pairs that
 * touch, the vertices rolled back, those in zones and the outcome. Where this
 * was seen before, a run stops. Scenes that are alike but for the numbers of
 * vertices and pairs are tried once.
 *
 * usage: response VERTICES PAIRS [PART PARTS]; says what it tried, or the first
 * fault */
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>

#include "ref/contact/failsafe.c"
#include "ref/contact/impacts.c"
#include "ref/contact/response.c"
#include "ref/contact/rollback.c"
#include "ref/contact/rounds.c"

enum { V = 6, P = 4, MOST_CHOICES = 256, ROUNDS = 16 };

struct scene {
    int pairs;
    uint8_t pair[P]; /* masks of four vertices */
    uint8_t free;    /* vertices */
    uint8_t started; /* pairs that touch at the start already */
    uint8_t
        stuck; /* pairs that touch once their free vertices are rolled back */
};

struct setting {
    int max_rounds, zone_rounds, roll_rounds;
    bool stop, generous; /* generous: broad returns pairs that it need not */
};

static const struct setting settings[] = {{2, 1, 1, false, false},
                                          {0, 0, 0, false, false},
                                          {1, 0, 2, false, true},
                                          {0, 2, 1, false, false},
                                          {1, 1, 0, true, false}};

/* A run's choices, the next of which is taken; those behind `known` are 0 at
 * first. */
static struct {
    int at[MOST_CHOICES], of[MOST_CHOICES], next, known;
} choices;

static int choose(int n)
{
    int k = choices.next++;
    if (n <= 1)
        return choices.next--, 0;
    if (k == choices.known) {
        if (k == MOST_CHOICES)
            abort();
        choices.at[k] = 0;
        choices.of[k] = n;
        choices.known++;
    }
    return choices.at[k];
}

/* The next run's choices; false if all have been tried. */
static bool turn_choices(void)
{
    choices.next = 0;
    while (choices.known > 0) {
        int k = choices.known - 1;
        if (++choices.at[k] < choices.of[k])
            return true;
        choices.known = k;
    }
    return false;
}

/* The run. */
static struct scene scene;
static const struct setting *setting;
static struct response s;
static vec x0[V], x1[V], v[V], u[V], last[V];
static real w[V];
static uint8_t touched[V], rolled[V];
static int32_t start[V + 1];
static uint64_t first[V];
static int32_t pairs_out[P][4];
static uint8_t kinds[P];
static int numbers[P]; /* which pair a candidate is */
static int touching;   /* mask of pairs that touch between x0 and x1 */
static int tangle;     /* vertices of zones */
static int rolls;      /* calls of rollback */
static real version;   /* a velocity that no vertex has had */
static jmp_buf enough;
static int64_t runs, states;

static void fail(const char *what)
{
    printf("FAILED response: %s: pairs", what);
    for (int p = 0; p < scene.pairs; p++)
        printf(" %02x", scene.pair[p]);
    printf(", free %02x, started %x, stuck %x, rounds %d %d %d; choices",
           scene.free, scene.started, scene.stuck, setting->max_rounds,
           setting->zone_rounds, setting->roll_rounds);
    for (int k = 0; k < choices.next; k++)
        printf(" %d", choices.at[k]);
    printf("\n");
    exit(1);
}

static int free_of(int p)
{
    return scene.pair[p] & scene.free;
}

static int mask_rolled(void)
{
    int mask = 0;
    for (int i = 0; i < V; i++)
        mask |= rolled[i] ? 1 << i : 0;
    return mask;
}

/* Lets each pair touch, or not, of which a vertex has moved since the last
 * call. */
static void let_touch(void)
{
    int moved = 0, back = mask_rolled();
    for (int i = 0; i < V; i++) {
        moved |= memcmp(&x1[i], &last[i], sizeof last[i]) ? 1 << i : 0;
        last[i] = x1[i];
    }
    if (moved & ~scene.free)
        fail("a prescribed vertex has moved");
    for (int p = 0; p < scene.pairs; p++) {
        if (!(scene.pair[p] & moved) || scene.started >> p & 1)
            continue;
        bool touches = (free_of(p) & ~back) ? choose(2) : scene.stuck >> p & 1;
        touching = (touching & ~(1 << p)) | touches << p;
    }
}

/* The backend: memory. */

static void clear(struct gpu *on, void *p, size_t bytes)
{
    (void)on;
    memset(p, 0, bytes);
}

static void copy(struct gpu *on, void *to, const void *from, size_t bytes)
{
    (void)on;
    if (bytes)
        memcpy(to, from, bytes);
}

static int status(struct gpu *on)
{
    (void)on;
    return DRAPE_OK;
}

static void trace(struct gpu *on, struct trace *t, const char *stage,
                  const void *out, size_t bytes)
{
    (void)on, (void)t, (void)stage, (void)out, (void)bytes;
}

/* Pools grow by what is needed and no more, and forget what they held. */
static int grow(struct gpu *on, struct pool *pool, enum arena_part part,
                int64_t need, size_t size, bool kept)
{
    (void)on, (void)part, (void)kept;
    free(pool->data);
    pool->data = malloc((size_t)need * size);
    memset(pool->data, 0xff, (size_t)need * size);
    pool->cap = need;
    return DRAPE_OK;
}

/* The stages that compute. */

/* The vertices of a pair. Pairs of the same four have them in different orders.
 */
static void put_vertices(int p, int32_t of[4])
{
    for (int i = 0, k = p; i < V; i++)
        if (scene.pair[p] >> i & 1)
            of[k++ % 4] = i;
}

static int pair_of(const int32_t of[4])
{
    int p = 0;
    for (int32_t own[4]; p < scene.pairs; p++) {
        put_vertices(p, own);
        if (!memcmp(own, of, sizeof own))
            break;
    }
    return p;
}

/* Pairs with a touched vertex; with `generous` others, too. */
static int find_pairs(void *user, const uint8_t *of, struct pairs *out)
{
    (void)user;
    int mask = 0;
    for (int i = 0; i < V; i++)
        mask |= !of || of[i] ? 1 << i : 0;
    let_touch();
    out->n = 0;
    for (int p = 0; p < scene.pairs; p++) {
        if (!(scene.pair[p] & mask) && !setting->generous)
            continue;
        put_vertices(p, pairs_out[out->n]);
        numbers[out->n] = p;
        kinds[out->n++] = (uint8_t)(p % 2);
    }
    out->pair = &pairs_out[0][0];
    out->kind = kinds;
    return DRAPE_OK;
}

static int narrow(struct gpu *on, struct narrow *n)
{
    (void)on;
    for (int64_t k = 0; k < n->n; k++) {
        int p = numbers[k];
        n->tier[k] = 1;
        n->toi[k] = !(touching >> p & 1) ? NARROW_MISS : p % 3 ? 1 : 0;
        if (scene.started >> p & 1)
            n->toi[k] = 0;
    }
    return DRAPE_OK;
}

/* Whether a pair touches at the start; the vertices' places are their numbers.
 */
static uint32_t at_start(const vec x[4])
{
    int32_t of[4];
    for (int k = 0; k < 4; k++)
        of[k] = (int32_t)x[k].x;
    return scene.started >> pair_of(of) & 1 ? 0 : NARROW_MISS;
}

uint32_t narrow_vf(const vec a[4], const vec b[4], int *tier)
{
    (void)b;
    *tier = 1;
    return at_start(a);
}

uint32_t narrow_ee(const vec a[4], const vec b[4], int *tier)
{
    return narrow_vf(a, b, tier);
}

/* What a detection must find: the pairs that touch and that a response can
 * part. */
static int must_hit(void)
{
    int mask = 0;
    for (int p = 0; p < scene.pairs; p++)
        if (touching >> p & 1 && free_of(p) && !(scene.started >> p & 1))
            mask |= 1 << p;
    return mask;
}

/* The states after a detection that were seen. */
enum { SLOTS = 1 << 16 };
static uint64_t seen[SLOTS];
static int64_t stamp;

static bool is_new(uint64_t state)
{
    uint64_t key = (uint64_t)stamp << 40 | state | 1ull << 39;
    uint64_t at = key * 0x9e3779b97f4a7c15ull >> 48;
    for (;; at = (at + 1) % SLOTS) {
        if (seen[at] == key)
            return false;
        if (seen[at] >> 40 != (uint64_t)stamp)
            break;
    }
    seen[at] = key;
    return true;
}

/* §7.1; and the end of a run whose future was tried. */
static int impacts(struct gpu *on, struct impacts *m)
{
    (void)on;
    int code = ref_impacts(m);
    if (code != DRAPE_OK)
        return code;
    int hit = 0;
    for (int64_t k = 0; k < m->found; k++)
        hit |= 1 << pair_of(m->hit + 4 * k);
    int must = must_hit(), rest = mask_rolled();
    for (int p = 0; p < scene.pairs; p++)
        if (must >> p & 1 && !(hit >> p & 1) && free_of(p) & ~rest)
            fail("a pair that touches is missed");
    if (s.rounds > ROUNDS)
        fail("it does not end");
    uint64_t state =
        (uint64_t)s.rounds | (uint64_t)touching << 5 | (uint64_t)hit << 9 |
        (uint64_t)rest << 13 | (uint64_t)tangle << 19 |
        (uint64_t)(s.outcome & DRAPE_TRAPPED ? 1 : 0) << 25 |
        (uint64_t)(s.contacts_solved ? 1 : 0) << 26 | (uint64_t)rolls << 27;
    if (choices.next == choices.known && !is_new(state))
        longjmp(enough, 1);
    states += choices.next == choices.known;
    return DRAPE_OK;
}

static int impulses(struct gpu *on, struct impulses *m)
{
    (void)on;
    m->found = m->n_active + m->n;
    return m->found > m->cap ? DRAPE_EFULL : DRAPE_OK;
}

/* Any free vertex may be in contact and be moved, for better or worse. */
static int contacts(struct gpu *on, struct contacts *c)
{
    (void)on;
    c->vertices = 0;
    for (int i = 0; i < V; i++) {
        if (!(scene.free >> i & 1) || c->vertices == c->n4)
            continue;
        int64_t k = c->vertices++;
        c->vertex[k] = i;
        c->moved[k] = (uint8_t)choose(2);
        if (c->moved[k])
            c->u[i].x = c->v[i].x = version++;
    }
    return DRAPE_OK;
}

static int zones(struct gpu *on, struct zones *z)
{
    (void)on;
    tangle = 0;
    for (int64_t k = 0; k < 4 * z->n; k++)
        tangle |= 1 << z->pair[k];
    tangle &= scene.free;
    z->vertices = 0;
    for (int i = 0; i < V; i++)
        if (tangle >> i & 1) {
            z->vertex[z->vertices++] = i;
            z->u[i].x = version++;
        }
    return DRAPE_OK;
}

static int rollback(struct gpu *on, struct rollback *r)
{
    (void)on;
    rolls++;
    return ref_rollback(r);
}

static const struct backend model = {.grow = grow,
                                     .copy = copy,
                                     .clear = clear,
                                     .pushes = 2,
                                     .status = status,
                                     .trace = trace,
                                     .narrow = narrow,
                                     .impacts = impacts,
                                     .impulses = impulses,
                                     .contacts = contacts,
                                     .zones = zones,
                                     .rollback = rollback,
                                     .rounds_start = ref_rounds_start,
                                     .rounds_advance = ref_rounds_advance,
                                     .rounds_touch = ref_rounds_touch,
                                     .rounds_settle = ref_rounds_settle};

static const uint16_t surface_of[V];
static const struct surface surface = {.thickness = 1};

/* The slice begins: each vertex has moved, and any pair may touch. */
static void begin(void)
{
    for (int i = 0; i < V; i++) {
        x0[i] = vec_make((real)i, 0, 0);
        x1[i] = last[i] = v[i] = vec_make((real)i, 1, 0);
        w[i] = scene.free >> i & 1 ? R(1.0) : R(0.0);
    }
    s.run = &model;
    s.nv = V;
    s.w = w;
    s.surfaces = (struct surfaces){1, surface_of, &surface};
    s.x0 = x0;
    s.x1 = x1;
    s.v = v;
    s.dt = s.range = s.stiffness = s.margin = 1;
    s.iterations = 1;
    s.max_rounds = setting->max_rounds;
    s.zone_rounds = setting->zone_rounds;
    s.roll_rounds = setting->roll_rounds;
    s.stop_before_zones = setting->stop;
    s.broad = find_pairs;
    s.u = u;
    s.touched = touched;
    s.rolled = rolled;
    s.start = start;
    s.first = first;
    version = 100;
    tangle = rolls = 0;
    if (response_start(&s) != DRAPE_OK)
        fail("it does not start");
    touching = scene.started;
    for (int p = 0; p < scene.pairs; p++)
        if (!(scene.started >> p & 1))
            touching |= (free_of(p) ? choose(2) : scene.stuck >> p & 1) << p;
}

/* §7.2, §7.3, §7.4 of a run that has ended. */
static void check_end(void)
{
    int back = mask_rolled(), count = 0;
    let_touch();
    for (int i = 0; i < V; i++) {
        count += scene.free >> i & 1;
        if (back >> i & 1 && (!(scene.free >> i & 1) || x1[i].x != x0[i].x ||
                              x1[i].y != x0[i].y || u[i].x != 0 || v[i].x != 0))
            fail("a vertex that was rolled back has moved");
    }
    if (rolls > 0 &&
        rolls > real_min((real)count, (real)setting->roll_rounds + 1) + 1)
        fail("rollback takes too many rounds");
    if (s.rounds > setting->max_rounds + setting->zone_rounds + rolls + 1)
        fail("there are too many rounds");
    bool trapped = s.outcome & DRAPE_TRAPPED;
    bool stopped = setting->stop && s.outcome & DRAPE_ZONES;
    if (!trapped && !stopped && touching)
        fail("it does not end clean");
    if (trapped && !touching)
        fail("it says trapped, and nothing touches");
    if (stopped && !must_hit())
        fail("it stops before zones, and nothing touches");
}

static void run_scene(void)
{
    for (size_t k = 0; k < sizeof settings / sizeof *settings; k++) {
        setting = &settings[k];
        stamp++;
        choices.known = choices.next = 0;
        do {
            runs++;
            if (setjmp(enough))
                continue;
            begin();
            if (response_penetrate(&s) != DRAPE_OK)
                fail("it ends with an error");
            check_end();
        } while (turn_choices());
    }
}

/* Scenes. A renaming of vertices that leaves the pairs is a symmetry. */

static uint8_t perm[720][V];
static int perms;

static void list_perms(int vertices, int k, uint8_t *now)
{
    if (k == vertices) {
        memcpy(perm[perms++], now, V);
        return;
    }
    for (int i = k; i < vertices; i++) {
        uint8_t a = now[k];
        now[k] = now[i];
        now[i] = a;
        list_perms(vertices, k + 1, now);
        now[i] = now[k];
        now[k] = a;
    }
}

static uint8_t renamed(const uint8_t *by, uint8_t mask)
{
    uint8_t to = 0;
    for (int i = 0; i < V; i++)
        to |= (uint8_t)((mask >> i & 1) << by[i]);
    return to;
}

/* A number for the pairs of a scene, each with what is said of it, whatever
 * their order. */
static uint64_t code_of(const struct scene *a, const uint8_t *by)
{
    uint64_t of[P] = {0}, code = 0;
    for (int p = 0; p < a->pairs; p++) {
        of[p] = (uint64_t)renamed(by, a->pair[p]) << 2 |
                (a->started >> p & 1) << 1 | (a->stuck >> p & 1);
        for (int q = p; q > 0 && of[q] < of[q - 1]; q--) {
            uint64_t b = of[q];
            of[q] = of[q - 1];
            of[q - 1] = b;
        }
    }
    for (int p = 0; p < a->pairs; p++)
        code = code << 8 | of[p];
    return code << 8 | renamed(by, a->free);
}

/* Whether no renaming of the scene comes before it. */
static bool is_first(const struct scene *a)
{
    uint64_t own = code_of(a, perm[0]);
    for (int k = 1; k < perms; k++)
        if (code_of(a, perm[k]) < own)
            return false;
    return true;
}

static int64_t scenes, part, parts;

/* All that can be said of the vertices and pairs of a scene. */
static void run_kinds(int vertices)
{
    for (int fixed = 0; fixed < 1 << vertices; fixed++) {
        scene.free = (uint8_t)(((1 << vertices) - 1) & ~fixed);
        int can = 0;
        for (int p = 0; p < scene.pairs; p++)
            can |= scene.pair[p] & fixed ? 1 << p : 0;
        for (int k = 0; k < 1 << (2 * scene.pairs); k++) {
            scene.stuck = (uint8_t)(k & ((1 << scene.pairs) - 1));
            scene.started = (uint8_t)(k >> scene.pairs);
            bool one = !(scene.started & (scene.started - 1));
            if (!one || scene.stuck & ~can || scene.stuck & scene.started)
                continue;
            if (!is_first(&scene) || scenes++ % parts != part)
                continue;
            run_scene();
        }
    }
}

static void run_pairs(int vertices, int most, int from)
{
    if (scene.pairs > 0) {
        struct scene bare = {.pairs = scene.pairs};
        memcpy(bare.pair, scene.pair, sizeof bare.pair);
        if (!is_first(&bare))
            return;
        run_kinds(vertices);
    }
    for (int mask = from; mask < 1 << vertices && scene.pairs < most; mask++)
        if (__builtin_popcount((unsigned)mask) == 4) {
            scene.pair[scene.pairs++] = (uint8_t)mask;
            run_pairs(vertices, most, mask);
            scene.pairs--;
        }
}

int main(int argc, char **argv)
{
    uint8_t all[V] = {0, 1, 2, 3, 4, 5};
    int vertices = argc > 1 ? atoi(argv[1]) : V,
        most = argc > 2 ? atoi(argv[2]) : P;
    part = argc > 4 ? atoi(argv[3]) : 0;
    parts = argc > 4 ? atoi(argv[4]) : 1;
    if (vertices < 4 || vertices > V || most < 1 || most > P || parts < 1)
        return 2;
    list_perms(vertices, 0, all);
    run_pairs(vertices, most, 0);
    printf("%lld scenes, %lld states, %lld runs\n", (long long)scenes,
           (long long)states, (long long)runs);
    return 0;
}
