/* SPDX-License-Identifier: Apache-2.0 */
/* The records of bodies that were added: the definition of a body, then what it
 * points to, each filled up to whole words. spec/control/control.md §7 */
#include <string.h>

#include "ref/api/record.h"
#include "ref/base/hash.h"

enum { WORD = 8, CLOTH_PIECES = 5, PANEL_PIECES = 8, MESH_PIECES = 4 };

/* An array that a definition points to; at: NULL: it has none. */
struct piece {
    const void *at;
    size_t bytes;
};

static size_t round_up(size_t bytes)
{
    return (bytes + WORD - 1) / WORD * WORD;
}

int64_t record_mark(int64_t n)
{
    return (int64_t)(hash_mix(HASH_SEED, &n, sizeof n) >> 1);
}

static void cloth_pieces(const drape_cloth *c, struct piece p[CLOTH_PIECES])
{
    size_t n = (size_t)c->m * (size_t)c->n;
    size_t cells = (size_t)(c->m - 1) * (size_t)(c->n - 1);
    p[0] = (struct piece){c->x, n * sizeof *c->x};
    p[1] = (struct piece){c->velocity, n * sizeof *c->velocity};
    p[2] = (struct piece){c->hole, n};
    p[3] = (struct piece){c->cut, cells};
    /* an empty array is not a missing one: a world's fingerprint tells them
     * apart */
    p[4] = (struct piece){c->pins, (size_t)c->n_pins * sizeof *c->pins};
}

/* The record of a panel begins with both definitions. */
struct panel_head {
    drape_cloth cloth;
    drape_panel panel;
};

/* What a panel has behind the pieces of its cloth. */
static void panel_pieces(const drape_cloth *c, const drape_panel *panel,
                         struct piece p[PANEL_PIECES])
{
    size_t n = (size_t)c->m * (size_t)c->n;
    size_t cells = (size_t)(c->m - 1) * (size_t)(c->n - 1);
    cloth_pieces(c, p);
    p += CLOTH_PIECES;
    p[0] = (struct piece){panel->rest, n * sizeof *panel->rest};
    p[1] = (struct piece){panel->cell, cells};
    p[2] = (struct piece){panel->eases,
                          (size_t)panel->n_eases * sizeof *panel->eases};
}

static void mesh_pieces(const drape_obstacle *o, struct piece p[MESH_PIECES])
{
    size_t n = (size_t)o->n_vertices * sizeof *o->x;
    p[0] = (struct piece){o->x, n};
    p[1] = (struct piece){o->tri, (size_t)o->n_triangles * sizeof *o->tri};
    p[2] = (struct piece){o->frames ? o->frame : NULL, n * (size_t)o->frames};
    p[3] = (struct piece){o->frames ? o->frame_time : NULL,
                          (size_t)o->frames * sizeof *o->frame_time};
}

/* Writes a record of a definition with its pointers and its pieces. The words
 * behind the definition say which pieces there are. */
static void write_record(drape_world *world, enum record_kind kind,
                         const void *head, size_t size,
                         const struct piece *piece, int pieces)
{
    size_t bytes = round_up(size) + WORD * (size_t)pieces, at = round_up(size);
    if (!world->record)
        return;
    for (int k = 0; k < pieces; k++)
        bytes += piece[k].at ? round_up(piece[k].bytes) : 0;
    uint8_t *data = arena_take(&world->arena, ARENA_OTHER, (int64_t)bytes, 1);
    if (!data) {
        record_lose(world);
        return;
    }
    memcpy(data, head, size);
    for (int k = 0; k < pieces; k++, at += WORD) {
        uint64_t there = piece[k].at != NULL;
        memcpy(data + at, &there, sizeof there);
    }
    for (int k = 0; k < pieces; k++)
        if (piece[k].at && piece[k].bytes > 0) {
            memcpy(data + at, piece[k].at, piece[k].bytes);
            at += round_up(piece[k].bytes);
        }
    int64_t n = (int64_t)bytes;
    record_call(world, (struct record){.kind = kind,
                                       .at = record_mark(n),
                                       .n = n,
                                       .data = data,
                                       .bytes = bytes});
    arena_give(&world->arena, data);
}

void record_cloth(drape_world *world, const drape_cloth *cloth)
{
    struct piece p[PANEL_PIECES];
    struct panel_head head = {.cloth = *cloth};
    drape_cloth *c = &head.cloth;
    if (cloth->panel)
        panel_pieces(cloth, cloth->panel, p);
    else
        cloth_pieces(cloth, p);
    c->x = c->velocity = NULL;
    c->hole = c->cut = NULL;
    c->pins = NULL;
    c->panel = NULL;
    if (cloth->panel) {
        head.panel.n_eases = cloth->panel->n_eases;
        write_record(world, RECORD_PANEL, &head, sizeof head, p, PANEL_PIECES);
    } else {
        write_record(world, RECORD_CLOTH, c, sizeof *c, p, CLOTH_PIECES);
    }
}

void record_obstacle(drape_world *world, const drape_obstacle *obstacle)
{
    struct piece p[MESH_PIECES];
    drape_obstacle o;
    mesh_pieces(obstacle, p);
    memset(&o, 0, sizeof o); /* so that its padding has known bytes */
    o.n_vertices = obstacle->n_vertices;
    o.n_triangles = obstacle->n_triangles;
    o.friction = obstacle->friction;
    o.motion = obstacle->motion;
    o.frames = obstacle->frames;
    o.between = obstacle->between;
    o.frame_dt = obstacle->frame_dt;
    write_record(world, RECORD_MESH, &o, sizeof o, p, MESH_PIECES);
}

/* Finds the pieces in a record, whose sizes are given. False: the record has
 * another size than they need, or a word that says neither yes nor no. */
static bool find_pieces(const uint8_t *data, int64_t bytes, size_t size,
                        struct piece *piece, int pieces)
{
    size_t at = round_up(size) + WORD * (size_t)pieces;
    const uint8_t *flag = data + round_up(size);
    for (int k = 0; k < pieces; k++, flag += WORD) {
        uint64_t there;
        memcpy(&there, flag, sizeof there);
        if (there > 1)
            return false;
        piece[k].at = there ? data + at : NULL;
        at += there ? round_up(piece[k].bytes) : 0;
        if (at > (size_t)bytes)
            return false;
    }
    return at == (size_t)bytes;
}

/* Reads a cloth, or a panel where `panel` is not NULL. */
static int read_cloth(const uint8_t *data, int64_t bytes, drape_cloth *cloth,
                      drape_panel *panel)
{
    struct piece p[PANEL_PIECES];
    struct panel_head head = {0};
    size_t size = panel ? sizeof head : sizeof head.cloth;
    int pieces = panel ? PANEL_PIECES : CLOTH_PIECES;
    if ((size_t)bytes < round_up(size) + WORD * (size_t)pieces)
        return DRAPE_EMATCH;
    memcpy(&head, data, size);
    drape_cloth c = head.cloth;
    if (head.panel.n_eases < 0 || c.m < 2 || c.n < 2 || c.m > 32768 ||
        c.n > 32768 || c.n_pins < 0)
        return DRAPE_EMATCH;
    if (panel)
        panel_pieces(&c, &head.panel, p);
    else
        cloth_pieces(&c, p);
    if (!find_pieces(data, bytes, size, p, pieces))
        return DRAPE_EMATCH;
    c.x = (const double(*)[3])p[0].at;
    c.velocity = (const double(*)[3])p[1].at;
    c.hole = p[2].at;
    c.cut = p[3].at;
    c.pins = p[4].at;
    if (panel)
        *panel = (drape_panel){.rest = (const double(*)[2])p[5].at,
                               .cell = p[6].at,
                               .eases = p[7].at,
                               .n_eases = head.panel.n_eases};
    c.panel = panel;
    *cloth = c;
    return DRAPE_OK;
}

int record_cloth_of(const uint8_t *data, int64_t bytes, drape_cloth *cloth)
{
    return read_cloth(data, bytes, cloth, NULL);
}

int record_panel_of(const uint8_t *data, int64_t bytes, drape_cloth *cloth,
                    drape_panel *panel)
{
    return read_cloth(data, bytes, cloth, panel);
}

int record_obstacle_of(const uint8_t *data, int64_t bytes,
                       drape_obstacle *obstacle)
{
    struct piece p[MESH_PIECES];
    drape_obstacle o;
    if ((size_t)bytes < round_up(sizeof o) + WORD * MESH_PIECES)
        return DRAPE_EMATCH;
    memcpy(&o, data, sizeof o);
    if (o.n_vertices < 1 || o.n_vertices > INT32_MAX || o.n_triangles < 1 ||
        o.n_triangles > INT32_MAX || o.frames < 0 || o.frames > 1 << 24)
        return DRAPE_EMATCH;
    mesh_pieces(&o, p);
    if (!find_pieces(data, bytes, sizeof o, p, MESH_PIECES))
        return DRAPE_EMATCH;
    o.x = (const double(*)[3])p[0].at;
    o.tri = (const int32_t(*)[3])p[1].at;
    o.frame = (const double(*)[3])p[2].at;
    o.frame_time = p[3].at;
    *obstacle = o;
    return DRAPE_OK;
}
