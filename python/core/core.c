/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes and queries for the Python package: core.h. */
#include "python/core/core.h"
#include "app/base/app.h"
#include "app/write/stretch.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* What the app's code has to say, kept for the thread that called it. */
static _Thread_local struct said {
    char error[2048], notes[4096], told[4096];
} said;

/* The linker puts this in the place of `complain` (app/base/app.h), as setup.py
 * tells it: a library has no standard error of its own. */
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
int core_complain(int code, const char *format, ...);

int core_complain(int code, const char *format, ...)
{
    size_t length = code ? 0 : strlen(said.notes);
    char *to = code ? said.error : said.notes + length;
    size_t room = code ? sizeof said.error : sizeof said.notes - length;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(to, room, format, arguments);
    va_end(arguments);
    for (char *p = to; *p; p++)
        if ((unsigned char)*p < 32 || *p == 127)
            *p = '?';
    if (!code && length + strlen(to) + 2 < sizeof said.notes)
        strcat(to, "\n");
    return code;
}

static const char *tell(char *text)
{
    snprintf(said.told, sizeof said.told, "%s", text);
    *text = 0;
    return said.told;
}

const char *core_error(void)
{
    return tell(said.error);
}

const char *core_notes(void)
{
    return tell(said.notes);
}

int core_read(const char *text, size_t size, const char *file,
              struct scene **scene)
{
    *scene = malloc(sizeof **scene);
    if (!*scene)
        return complain(APP_FAILED, "out of memory");
    int status = scene_load_text(*scene, text, size, file);
    if (status == APP_OK)
        return status;
    core_free(*scene);
    *scene = NULL;
    return status;
}

void core_free(struct scene *scene)
{
    if (scene)
        scene_free(scene);
    free(scene);
}

int core_create(struct scene *scene, drape_world **world)
{
    static const struct overrides none = {NULL, -1, -1, -1, 0};
    if (scene->degenerate)
        complain(0, "%s: note: obstacles have %lld triangles without area",
                 scene->file, (long long)scene->degenerate);
    int status = scene_create(scene, &none, world);
    if (status == APP_OK)
        scene_idle(scene, &none);
    return status;
}

int core_stretch(const struct scene *scene, const drape_world *world,
                 double (*x)[3], int32_t (*tri)[3], double *most)
{
    int cloths = scene->def.n_cloths;
    struct part *part = calloc((size_t)cloths, sizeof *part);
    struct stretch *stretch = calloc((size_t)cloths, sizeof *stretch);
    int status = part && stretch ? APP_OK : APP_FAILED;
    if (status == APP_OK) {
        const struct mesh mesh = {drape_first_vertex(world, cloths),
                                  drape_first_triangle(world, cloths), x, tri};
        for (int k = 0; k < cloths; k++)
            part[k].nt = drape_first_triangle(world, k + 1) -
                         drape_first_triangle(world, k);
        stretch_look(stretch, scene->def.cloths, part, cloths, &mesh, 0);
        for (int k = 0; k < cloths; k++)
            most[k] = stretch[k].most;
    }
    free(part);
    free(stretch);
    return status == APP_OK ? status : complain(status, "out of memory");
}

int core_ccd(int kind, int64_t n, const double (*x0)[4][3],
             const double (*x1)[4][3], uint8_t *hit, double *toi, int64_t *bad)
{
    for (int64_t k = 0; k < n; k++) {
        int status = drape_ccd(kind, x0[k], x1[k], &toi[k]);
        *bad = k;
        if (status < 0)
            return status;
        hit[k] = status == 1;
    }
    return DRAPE_OK;
}

int core_touch_add(void *user, int kind, const int32_t v[4], double toi)
{
    core_touches *list = user;
    if (list->count == list->room) {
        int64_t room = list->room ? 2 * list->room : 64;
        struct core_touch *larger =
            realloc(list->touch, (size_t)room * sizeof *larger);
        if (!larger)
            return 1;
        list->touch = larger;
        list->room = room;
    }
    struct core_touch *touch = &list->touch[list->count++];
    *touch = (struct core_touch){.toi = toi, .kind = kind};
    memcpy(touch->v, v, sizeof touch->v);
    return 0;
}

void core_touches_free(core_touches *touches)
{
    free(touches->touch);
    *touches = (core_touches){0, 0, NULL};
}
