/* SPDX-License-Identifier: Apache-2.0 */
/* What the Python package calls beside spec/drape.h: the tool's reader of
 * scenes and its writer of runs, and loops that are slow in Python. cffi reads
 * the lines behind CORE_BEGIN, so they hold declarations only. */
#ifndef PYTHON_CORE_CORE_H
#define PYTHON_CORE_CORE_H

#include "app/scene/cloth.h"
#include "app/scene/scene.h"

/* CORE_BEGIN */

/* Returns what this thread's last failed call said, and forgets it; then what
 * the calls before noted, a line each. Empty: nothing. */
const char *core_error(void);
const char *core_notes(void);

/* Reads a scene from a text of `size` bytes, ended by 0, which messages call
 * `file`. Returns the tool's exit code, 0: *scene is the caller's, who ends it
 * by core_free. */
int core_read(const char *text, size_t size, const char *file,
              struct scene **scene);
void core_free(struct scene *scene);
/* Makes the scene's world under its memory limit. Returns the tool's exit code.
 * The scene must outlive the world. */
int core_create(struct scene *scene, drape_world **world);

/* Sets most[k] to the largest length of a side of a cell of cloth k by its
 * length at rest (app/write/stretch.h), with all vertices at x and the
 * triangles of drape_read_triangles. Returns the tool's exit code. */
int core_stretch(const struct scene *scene, const drape_world *world,
                 double (*x)[3], int32_t (*tri)[3], double *most);

/* app/scene/fabrics.h */
const char *fabric_at(int k, drape_material *out, const char **what);

enum core_kind { CORE_CLOTH, CORE_OBSTACLE };
/* Puts a drape_cloth or drape_obstacle that the scene's world got behind the
 * others of its kind, with the name and the look of the last one of `from`, or
 * NULL. Returns the tool's exit code. */
int core_add(struct scene *scene, enum core_kind kind, const void *body,
             const struct scene *from);
/* Takes a body, numbered as in drape_remove, out of a scene. */
void core_remove(struct scene *scene, int body);

/* What a piece of a log is, in the pieces in which drape_replay reads it: data
 * of the call before, or the head of a call. *body: of a call that removes a
 * body, its number. The piece behind the head of a call that adds a cloth or an
 * obstacle begins with its drape_cloth or drape_obstacle. */
enum core_log {
    CORE_LOG_DATA,
    CORE_LOG_CALL, /* that changes no list of bodies */
    CORE_LOG_CLOTH,
    CORE_LOG_OBSTACLE,
    CORE_LOG_REMOVE
};
enum core_log core_log_piece(const void *piece, size_t bytes, int64_t *body);

/* The files of a run, as `drape run` writes them (app/write/output.h). */
typedef struct core_run core_run;
/* What a run has and does beside its frames; each 0 or 1. */
typedef struct core_run_how {
    int obj, contacts, force;
} core_run_how;
/* Claims the folder for the run of a new world. Returns the tool's exit code,
 * 0: the caller ends *run by core_run_close. */
int core_run_open(struct scene *scene, drape_world *world, const char *folder,
                  const core_run_how *how, core_run **run);
/* Writes the world's state as frame k; adds the report of its last step. */
int core_run_frame(core_run *run, drape_world *world, int k);
int core_run_add(core_run *run, drape_world *world,
                 const drape_step_report *report);
/* Writes the point cache of the frames 0 … last and report.json, which calls
 * the run's end `end`, and releases the folder and the memory. NULL as `end`:
 * writes nothing. */
int core_run_close(core_run *run, drape_world *world, int last,
                   const char *end);

/* drape_ccd of n queries: hit[k] is 1 and toi[k] set, or 0. Returns DRAPE_OK,
 * or the status of the first query that was refused, whose number is *bad. */
int core_ccd(int kind, int64_t n, const double (*x0)[4][3],
             const double (*x1)[4][3], uint8_t *hit, double *toi, int64_t *bad);

/* The pairs that drape_ccd_frames reports, in its order. */
typedef struct core_touches {
    int64_t count, room;
    struct core_touch {
        double toi;
        int32_t kind, v[4];
        int32_t unused;
    } * touch;
} core_touches;
/* Appends a pair; user is the list. Not 0: memory ran out. */
int core_touch_add(void *user, int kind, const int32_t v[4], double toi);
void core_touches_free(core_touches *touches);

/* Makes the stream `later` wait for all that is on `stream` now: CUDA streams
 * of the current device. Returns 0, or CUDA's error; -1: built without CUDA. */
int core_stream_wait(void *stream, void *later);

/* A tensor of DLPack that shares `data`, [n][3]. owner is a PyObject that is
 * released with the tensor; read_only is told where `versioned` is set. NULL:
 * no memory. core_tensor_end is the destructor of its capsule. */
void *core_tensor(void *data, int64_t n, int code, int bits, int device_type,
                  int device, int versioned, void *owner);
void core_tensor_end(void *capsule);

/* CORE_END */

#endif
