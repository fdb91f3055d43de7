/* SPDX-License-Identifier: Apache-2.0 */
/* The API's calls on a mesh and on a pair refuse wrong arguments. */
#include "tests/api/api.h"

/* Calls drape_audit, or drape_ccd_frames where touch is not NULL. */
static int ask(const struct api *a, const drape_mesh *mesh, drape_touch *touch)
{
    int64_t found;
    return touch ? drape_ccd_frames(mesh, a->at, touch, NULL, NULL)
                 : drape_audit(mesh, 0, NULL, &found, NULL);
}

/* A call gives back all memory that it takes, also where it gets too little. */
static const char *give_back(const struct api *a, drape_touch *touch)
{
    struct guest s;
    guest_make(&s, DRAPE_REF);
    drape_mesh m = a->mesh;
    m.allocator = s.def.allocator;
    int status = DRAPE_ENOMEM;
    for (int64_t most = 0; status == DRAPE_ENOMEM; most++) {
        s.host.calls = 0;
        s.host.most = most;
        status = ask(a, &m, touch);
        EXPECT(s.host.held == 0);
        ran(1);
    }
    EXPECT(status == DRAPE_OK && s.host.calls > 3);
    return NULL;
}

static const char *refuse_meshes(const struct api *a, drape_touch *touch)
{
    drape_mesh m = a->mesh;
    EXPECT(ask(a, &m, touch) == DRAPE_OK);
    const char *what = give_back(a, touch);
    if (what)
        return what;
    REFUSES(ask(a, NULL, touch));
    REFUSES_EACH(api_wide, m.nv, ask(a, &m, touch));
    m = a->mesh;
    REFUSES_EACH(api_wide, m.nt, ask(a, &m, touch));
    m = a->mesh;
    REFUSES_EACH(api_extremes, m.threads, ask(a, &m, touch));
    m = a->mesh;
    m.x = NULL;
    REFUSES(ask(a, &m, touch));
    m = a->mesh;
    m.tri = NULL;
    REFUSES(ask(a, &m, touch));
    m = a->mesh;
    m.allocator.allocate = a->input.g.def.allocator.allocate;
    REFUSES(ask(a, &m, touch));
    m.allocator.allocate = NULL;
    m.allocator.release = a->input.g.def.allocator.release;
    REFUSES(ask(a, &m, touch));
    for (int k = 0; k < EXTREMES; k++) {
        const int32_t tri[1][3] = {{0, 1, api_extremes[k]}};
        m = a->mesh;
        m.tri = tri;
        REFUSES(ask(a, &m, touch));
    }
    double x[4][3] = {{0}};
    m = a->mesh;
    m.x = (const double(*)[3])x;
    x[3][1] = (double)NAN;
    EXPECT(ask(a, &m, touch) == DRAPE_EDATA);
    x[3][1] = -0x1p61;
    EXPECT(ask(a, &m, touch) == DRAPE_EDATA);
    return NULL;
}

const char *api_call_audit(struct api *a)
{
    int64_t found, none;
    int32_t pair[1][2];
    REFUSES(drape_audit(&a->mesh, 1, NULL, &found, &none));
    REFUSES(drape_audit(&a->mesh, 1, pair, NULL, &none));
    REFUSES(drape_audit(&a->mesh, -1, pair, &found, &none));
    REFUSES(drape_audit(&a->mesh, INT64_MIN, pair, &found, &none));
    EXPECT(drape_audit(&a->mesh, INT64_MAX, pair, &found, NULL) == DRAPE_OK);
    return refuse_meshes(a, NULL);
}

const char *api_call_ccd(struct api *a)
{
    double toi;
    for (int kind = 0; kind < 2; kind++) {
        REFUSES(drape_ccd(kind, NULL, a->at, &toi));
        REFUSES(drape_ccd(kind, a->at, NULL, &toi));
        REFUSES(drape_ccd(kind, a->at, a->at, NULL));
    }
    int k;
    REFUSES_EACH(api_extremes, k, drape_ccd(k, a->at, a->at, &toi));
    const double x[4][3] = {{(double)NAN}};
    EXPECT(drape_ccd(0, a->at, x, &toi) == DRAPE_EDATA);
    return NULL;
}

static int go_on(void *user, int kind, const int32_t v[4], double toi)
{
    (void)user;
    (void)kind;
    (void)v;
    (void)toi;
    return 0;
}

const char *api_call_frames(struct api *a)
{
    int64_t n[2];
    drape_mesh m = a->mesh;
    REFUSES(drape_ccd_frames(&m, NULL, go_on, NULL, n));
    REFUSES(drape_ccd_frames(&m, a->at, NULL, NULL, n));
    m.group = a->tri[0];
    REFUSES(drape_ccd_frames(&m, a->at, go_on, NULL, n));
    return refuse_meshes(a, go_on);
}
