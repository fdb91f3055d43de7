/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of a frame by ray tracing with Embree. */
#include "app/render/picture.h"
#include "app/base/app.h"
#include "app/render/embree.h"
#include "app/render/paint.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <unistd.h>

enum { THREADS_MOST = 256, FLOOR_SAMPLES = 3 };
/* Roberts' sequence in four dimensions. */
static const float floor_step[4] = {0.8566749f, 0.7338919f, 0.6287067f,
                                    0.5385973f};

struct studio {
    const struct model *model;
    RTCScene scene;
    vec eye, right, up, ahead; /* right and up reach the picture's edges */
    vec sun;                   /* unit, towards the sun */
    vec light, floor;          /* of the sun; the floor's colour */
    float far;                 /* m, where the floor has faded away */
};

struct hit {
    float distance;
    vec at, face, normal; /* face and normal point to the viewer's side */
    vec colour;
    float gloss, sheen;
    bool floor;
};

static void paint(const struct model *m, uint32_t triangle, const float w[3],
                  bool outside, struct hit *hit)
{
    const struct surface *surface = &m->surface[m->paint[triangle]];
    hit->colour = from(surface->side[outside ? 0 : 1]);
    hit->gloss = surface->gloss;
    hit->sheen = surface->sheen;
    if (!surface->check)
        return;
    float uv[2] = {0, 0};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++)
            uv[k] += w[i] * m->uv[m->tri[triangle][i]][k];
    hit->colour = scale(hit->colour, weave(uv));
}

static struct RTCRayHit ray_from(vec p, vec d)
{
    struct RTCRayHit r;
    memset(&r, 0, sizeof r);
    r.ray.org_x = p.x;
    r.ray.org_y = p.y;
    r.ray.org_z = p.z;
    r.ray.dir_x = d.x;
    r.ray.dir_y = d.y;
    r.ray.dir_z = d.z;
    r.ray.tnear = 1e-5f;
    r.ray.tfar = INFINITY;
    r.ray.mask = 0xffffffffu;
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    return r;
}

static void look_at_triangle(const struct studio *s, struct RTCRayHit *r, vec d,
                             struct hit *hit)
{
    const struct model *m = s->model;
    const uint32_t *t = m->tri[r->hit.primID];
    const float w[3] = {1 - r->hit.u - r->hit.v, r->hit.u, r->hit.v};
    vec n = {0, 0, 0};
    for (int i = 0; i < 3; i++)
        n = add(n, scale(from(m->normal[t[i]]), w[i]));
    hit->face = unit(make(r->hit.Ng_x, r->hit.Ng_y, r->hit.Ng_z));
    hit->normal = unit(n);
    /* the normals of a flat sheet's triangles point down; its outside is up */
    bool outside = dot(hit->face, d) > 0;
    if (outside)
        hit->face = scale(hit->face, -1);
    if (dot(hit->normal, hit->face) < 0)
        hit->normal = scale(hit->normal, -1);
    hit->floor = false;
    paint(m, r->hit.primID, w, outside, hit);
}

static bool look(const struct studio *s, vec p, vec d, struct hit *hit)
{
    struct RTCRayHit r = ray_from(p, d);
    embree_intersect(s->scene, &r);
    float down = (s->model->floor - p.y) / d.y;
    bool floor = d.y < 0 && down > 0 && down < r.ray.tfar;
    if (!floor && r.hit.geomID == RTC_INVALID_GEOMETRY_ID)
        return false;
    hit->distance = floor ? down : r.ray.tfar;
    hit->at = add(p, scale(d, hit->distance));
    if (!floor) {
        look_at_triangle(s, &r, d, hit);
        return true;
    }
    hit->floor = true;
    hit->face = hit->normal = make(0, 1, 0);
    hit->colour = s->floor;
    hit->gloss = hit->sheen = 0;
    return true;
}

static bool dark(const struct studio *s, vec p, vec d)
{
    struct RTCRayHit r = ray_from(p, d);
    embree_occlude(s->scene, &r.ray);
    return r.ray.tfar < 0;
}

/* Maps a point of the unit square to a direction about n, with a density
 * proportional to the cosine. spread 1 covers the half-space, less than 1 a
 * cone.
 */
static vec about(vec n, float a, float b, float spread)
{
    vec side = fabsf(n.x) > 0.5f ? make(0, 1, 0) : make(1, 0, 0);
    vec t = unit(cross(n, side)), u = cross(n, t);
    float r = sqrtf(a) * spread, angle = 6.2831853f * b;
    float up = sqrtf(1 - r * r);
    return add(add(scale(t, r * cosf(angle)), scale(u, r * sinf(angle))),
               scale(n, up));
}

/* Light that leaves the hit towards the viewer; random: 4 in [0, 1). */
static vec shade(const struct studio *s, const struct hit *h, vec view,
                 const float random[4])
{
    vec at = add(h->at, scale(h->face, 2e-4f));
    vec light = {0, 0, 0}, bounce;
    vec sun = about(s->sun, random[0], random[1], 0.10f);
    float lit = dot(h->normal, sun);
    if (lit > 0 && dot(h->face, sun) > 0 && !dark(s, at, sun)) {
        vec half = unit(add(sun, view));
        float shine = powf(clamp(dot(h->normal, half)), 40) * h->gloss * 12;
        light = add(scale(h->colour, lit), make(shine, shine, shine));
        light = mul(light, s->light);
    }
    vec d = about(h->normal, random[2], random[3], 0.9999f);
    struct hit other;
    if (!look(s, at, d, &other))
        bounce = sky(d);
    else
        bounce = scale(other.colour, other.floor ? 0.75f : 0.40f);
    light = add(light, scale(mul(h->colour, bounce), 0.85f));
    /* sheen: protruding fibres reflect light at grazing angles */
    float rim = 1 - clamp(dot(h->normal, view));
    float sheen = h->sheen * rim * rim * rim;
    return add(light,
               scale(mul(bounce, mix(h->colour, make(1, 1, 1), 0.3f)), sheen));
}

static vec trace(const struct studio *s, vec d, const float random[4])
{
    struct hit hit;
    vec backdrop = sky(make(d.x, 0, d.z));
    if (!look(s, s->eye, d, &hit))
        return mix(backdrop, sky(d), clamp(d.y));
    if (!hit.floor)
        return shade(s, &hit, scale(d, -1), random);
    /* On the even floor the grain of the light shows, and its rays are short:
     * more of them. */
    vec light = {0, 0, 0};
    for (int k = 0; k < FLOOR_SAMPLES; k++) {
        float r[4];
        for (int i = 0; i < 4; i++) {
            float at = random[i] + (float)k * floor_step[i];
            r[i] = (at - floorf(at)) * 0.999999f;
        }
        light = add(light, shade(s, &hit, scale(d, -1), r));
    }
    light = scale(light, 1.0f / FLOOR_SAMPLES);
    float t = clamp(hit.distance / s->far);
    return mix(light, backdrop, t * t * (3 - 2 * t));
}

static void pixel(const struct studio *s, const struct shot *shot, int row,
                  int column, uint8_t *rgb)
{
    vec sum = {0, 0, 0};
    uint32_t number = (uint32_t)(row * shot->width + column);
    for (int k = 0; k < shot->samples; k++) {
        float r[6];
        randoms(number, k, r);
        float x = 2 * ((float)column + r[0]) / (float)shot->width - 1;
        float y = 1 - 2 * ((float)row + r[1]) / (float)shot->height;
        vec d = add(s->ahead, add(scale(s->right, x), scale(s->up, y)));
        sum = add(sum, trace(s, unit(d), r + 2));
    }
    sum = scale(sum, 1 / (float)shot->samples);
    rgb[0] = develop(sum.x);
    rgb[1] = develop(sum.y);
    rgb[2] = develop(sum.z);
}

/* Chooses a camera that sees the model's box from above and from the side. */
static void choose(const struct model *m, struct camera *c)
{
    static const double way[3] = {1.25, 0.85, 1.75};
    double reach = 0;
    for (int i = 0; i < 3; i++)
        reach = fmax(reach, m->hi[i] - m->lo[i]);
    for (int i = 0; i < 3; i++) {
        c->target[i] = (m->lo[i] + m->hi[i]) / 2;
        c->eye[i] = c->target[i] + way[i] * reach;
    }
}

/* Turns the camera about the vertical through its target. */
static void turn(struct camera *c, double degrees)
{
    double a = degrees * 0.017453292519943295, co = cos(a), si = sin(a);
    double x = c->eye[0] - c->target[0], z = c->eye[2] - c->target[2];
    c->eye[0] = c->target[0] + co * x + si * z;
    c->eye[2] = c->target[2] - si * x + co * z;
}

/* Sets up light and floor. The sun stands where it is told, else high, to the
 * left behind the camera. */
static void set_light(struct studio *s, const struct camera *c, vec right)
{
    float strength = (float)c->light;
    s->light = scale(make(1.75f, 1.62f, 1.42f), strength);
    s->floor =
        make(linear(c->floor[0]), linear(c->floor[1]), linear(c->floor[2]));
    vec back = scale(s->ahead, -0.55f);
    s->sun = unit(add(add(back, scale(right, -0.75f)), make(0, 1.0f, 0)));
    if (c->sun[0] != 0 || c->sun[1] != 0 || c->sun[2] != 0)
        s->sun =
            unit(make((float)c->sun[0], (float)c->sun[1], (float)c->sun[2]));
}

static void set_up(struct studio *s, const struct shot *shot)
{
    struct camera c = shot->camera;
    if (memcmp(c.eye, c.target, sizeof c.eye) == 0)
        choose(s->model, &c);
    if (shot->turned != 0)
        turn(&c, shot->turned);
    vec target =
        make((float)c.target[0], (float)c.target[1], (float)c.target[2]);
    s->eye = make((float)c.eye[0], (float)c.eye[1], (float)c.eye[2]);
    s->ahead = unit(sub(target, s->eye));
    s->far = 4 * sqrtf(dot(sub(target, s->eye), sub(target, s->eye)));
    float edge = tanf((float)c.fov * 0.00872664626f);
    vec right = unit(cross(s->ahead, make(0, 1, 0)));
    s->up = scale(cross(right, s->ahead), edge);
    s->right = scale(right, edge * (float)shot->width / (float)shot->height);
    set_light(s, &c, right);
}

static RTCScene build(RTCDevice device, const struct model *m)
{
    RTCScene scene = rtcNewScene(device);
    RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void *x =
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                sizeof *m->x, (size_t)m->nv);
    void *tri =
        rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof *m->tri, (size_t)m->nt);
    bool good = x && tri;
    if (good) {
        memcpy(x, m->x, (size_t)m->nv * sizeof *m->x);
        memcpy(tri, m->tri, (size_t)m->nt * sizeof *m->tri);
        rtcCommitGeometry(g);
        rtcAttachGeometry(scene, g);
    }
    rtcReleaseGeometry(g);
    if (good) {
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcCommitScene(scene);
        return scene;
    }
    rtcReleaseScene(scene);
    return NULL;
}

/* A picture in the making, which threads share. */
struct work {
    const struct studio *studio;
    const struct shot *shot;
    uint8_t *rgb;    /* [height][width][3] */
    atomic_int rows; /* that a thread has taken */
};

/* Takes rows until none is left. A pixel depends on its place alone, so it does
 * not matter which thread takes a row. */
static void *take_rows(void *user)
{
    struct work *w = user;
    const int width = w->shot->width;
    for (int row; (row = atomic_fetch_add(&w->rows, 1)) < w->shot->height;)
        for (int column = 0; column < width; column++)
            pixel(w->studio, w->shot, row, column,
                  w->rgb + 3 * ((size_t)row * (size_t)width + (size_t)column));
    return NULL;
}

/* The caller takes rows too, so a system without threads to spare only makes
 * the picture slower. */
static void take_all(struct work *w)
{
    pthread_t other[THREADS_MOST];
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    long threads = w->shot->threads ? w->shot->threads : cores;
    int n = 0;
    while (n < THREADS_MOST && n + 1 < threads &&
           pthread_create(&other[n], NULL, take_rows, w) == 0)
        n++;
    take_rows(w);
    while (n)
        pthread_join(other[--n], NULL);
}

int picture_take(const struct model *model, const struct shot *shot,
                 uint8_t *rgb)
{
    RTCDevice device = rtcNewDevice(NULL);
    struct studio s = {.model = model};
    s.scene = device ? build(device, model) : NULL;
    if (s.scene) {
        set_up(&s, shot);
        take_all(&(struct work){.studio = &s, .shot = shot, .rgb = rgb});
        rtcReleaseScene(s.scene);
    }
    if (device)
        rtcReleaseDevice(device);
    return s.scene ? APP_OK : complain(APP_FAILED, "render: Embree gave up");
}
