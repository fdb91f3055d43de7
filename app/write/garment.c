/* SPDX-License-Identifier: Apache-2.0 */
/* Writes the panels of a sewing pattern as they were cut: meshes and tables. */
#include "app/write/garment.h"
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/read/mesh.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

double garment_area_error(const struct garment_panel *panel)
{
    return panel->cut.area / panel->outline.area - 1;
}

/* A field of a CSV, by RFC 4180 §2. */
static void put_text(FILE *out, const char *text)
{
    text = text ? text : "";
    if (!strpbrk(text, ",\"\r\n")) {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', out);
        fputc(*text, out);
    }
    fputc('"', out);
}

static bool put_panels(const struct garment *g, FILE *out)
{
    fputs("panel,label,m,n,regular,moved,triangles,absent,particles,border,"
          "left_out,area_m2,cells_m2,area_error,outline_cells,darts_cells\n",
          out);
    for (int k = 0; k < g->pattern->panels; k++) {
        const struct garment_panel *p = &g->panel[k];
        const struct cut *c = &p->cut;
        put_text(out, p->panel->name);
        fputc(',', out);
        put_text(out, p->panel->label);
        fprintf(out, ",%d,%d,%lld,%lld,%lld,%lld,%lld,%lld,%lld", c->m, c->n,
                (long long)c->regular, (long long)c->moved,
                (long long)c->triangles, (long long)c->absent,
                (long long)c->particles, (long long)c->borders,
                (long long)c->parted);
        fprintf(out, ",%.9g,%.9g,%.3g,%.3g,%.3g\n", p->outline.area, c->area,
                garment_area_error(p), c->off, c->off_dart);
    }
    return true;
}

static bool put_edges(const struct garment *g, FILE *out)
{
    fputs("panel,edge,type,label,length_m,particles,seam\n", out);
    for (int k = 0; k < g->pattern->panels; k++) {
        const struct pattern_panel *panel = g->panel[k].panel;
        int *count = malloc((size_t)panel->edges * sizeof *count);
        if (!count)
            return false;
        garment_count(&g->panel[k], count);
        for (int e = 0; e < panel->edges; e++) {
            const struct pattern_edge *edge = &panel->edge[e];
            put_text(out, panel->name);
            fprintf(out, ",%d,%s,", e, pattern_types[edge->curve.type]);
            put_text(out, edge->label);
            fprintf(out, ",%.9g,%d,", curve_length(&edge->curve), count[e]);
            if (edge->stitch >= 0)
                fprintf(out, "%d", edge->stitch);
            fputc('\n', out);
        }
        free(count);
    }
    return true;
}

static bool put_seam(const struct garment *g, int k, FILE *out)
{
    const struct pattern_stitch *stitch = &g->pattern->stitch[k];
    struct cut_seam seam;
    double length[2];
    if (garment_seam(g, stitch, &seam) != APP_OK)
        return false;
    garment_lengths(g->pattern, stitch, length);
    fprintf(out, "%d", k);
    for (int s = 0; s < 2; s++) {
        fputc(',', out);
        put_text(out, g->pattern->panel[stitch->side[s].panel].name);
        fprintf(out, ",%d,%.9g", stitch->side[s].edge, length[s]);
    }
    fprintf(out, ",%.6g,%d,%d,%d,%.9g\n", length[0] / length[1], stitch->turned,
            garment_is_dart(g->pattern, stitch), seam.n,
            garment_gap(g, stitch, &seam));
    cut_seam_free(&seam);
    return true;
}

static bool put_seams(const struct garment *g, FILE *out)
{
    fputs("seam,panel_a,edge_a,length_a_m,panel_b,edge_b,length_b_m,ratio,"
          "right_wrong,dart,points,gap_m\n",
          out);
    for (int k = 0; k < g->pattern->stitches; k++)
        if (!put_seam(g, k, out))
            return false;
    return true;
}

/* Each point of each seam: a particle, and the two between which it is held. */
static bool put_points(const struct garment *g, FILE *out)
{
    fputs("seam,at,panel,edge,particle,onto_panel,onto_edge,onto_a,onto_b,part,"
          "length_m\n",
          out);
    for (int k = 0; k < g->pattern->stitches; k++) {
        const struct pattern_stitch *stitch = &g->pattern->stitch[k];
        struct cut_seam seam;
        if (garment_seam(g, stitch, &seam) != APP_OK)
            return false;
        const struct pattern_side *fine = &stitch->side[seam.fine];
        const struct pattern_side *onto = &stitch->side[!seam.fine];
        for (int p = 0; p < seam.n; p++) {
            const struct cut_point *point = &seam.point[p];
            fprintf(out, "%d,%.9g,%d,%d,%d,%d,%d,%d,%d,%.9g,%.9g\n", k,
                    point->at, fine->panel, fine->edge, point->particle,
                    onto->panel, onto->edge, point->onto[0], point->onto[1],
                    point->part, point->length);
        }
        cut_seam_free(&seam);
    }
    return true;
}

static bool put_picture(const struct garment *g, FILE *out)
{
    garment_draw(g, out);
    return true;
}

/* Appends a panel to the mesh, flat or placed. at: [m n] room for numbers */
static void append(const struct garment_panel *p, bool placed,
                   struct mesh *mesh, int32_t *at)
{
    const struct cut *cut = &p->cut;
    for (int64_t k = 0; k < (int64_t)cut->m * cut->n; k++) {
        if (cut->kind[k] == CUT_OUT)
            continue;
        at[k] = (int32_t)mesh->nv;
        double *x = mesh->x[mesh->nv++];
        x[0] = cut->x[k][0];
        x[1] = cut->x[k][1];
        x[2] = 0;
        if (placed)
            garment_stand(p, cut->x[k], x);
    }
    for (int64_t c = 0; c < (int64_t)(cut->m - 1) * (cut->n - 1); c++) {
        int32_t tri[2][3];
        int count = cut_triangles(cut, c, tri);
        for (int t = 0; t < count; t++, mesh->nt++)
            for (int i = 0; i < 3; i++)
                mesh->tri[mesh->nt][i] = at[tri[t][i]];
    }
}

/* Writes panels from `from` to before `to` as one mesh, flat or placed. */
static bool put_mesh(const struct garment *g, int from, int to, bool placed,
                     FILE *out)
{
    size_t nv = 1, nt = 1, most = 1;
    for (int k = from; k < to; k++) {
        const struct cut *c = &g->panel[k].cut;
        size_t all = (size_t)c->m * (size_t)c->n;
        nv += (size_t)c->particles;
        nt += (size_t)(2 * (c->regular + c->moved) + c->triangles);
        most = all > most ? all : most;
    }
    struct mesh mesh = {0};
    int32_t *at = malloc(most * sizeof *at);
    mesh.x = malloc(nv * sizeof *mesh.x);
    mesh.tri = malloc(nt * sizeof *mesh.tri);
    bool good = at && mesh.x && mesh.tri && nv < INT32_MAX;
    for (int k = from; k < to && good; k++)
        append(&g->panel[k], placed, &mesh, at);
    if (good)
        ply_put(out, &mesh, 64);
    free(at);
    free(mesh.x);
    free(mesh.tri);
    return good;
}

/* The files that every garment has. */
enum { FILES = 6 };
/* The name of file k of a garment: the tables, the picture, all panels, and
 * each of them. Of a panel's name only letters, digits, - and _ are kept. */
static void name_file(const struct garment *g, int k, char name[96])
{
    static const char *const names[] = {"panels.csv",  "edges.csv",
                                        "seams.csv",   "points.csv",
                                        "pattern.svg", "placed.ply"};
    if (k < FILES) {
        snprintf(name, 96, "%s", names[k]);
        return;
    }
    snprintf(name, 96, "%02d_%.60s.ply", k - FILES,
             g->pattern->panel[k - FILES].name);
    for (char *c = name; *c && strcmp(c, ".ply") != 0; c++)
        if (!isalnum((unsigned char)*c) && *c != '-')
            *c = '_';
}

static bool put(const struct garment *g, int k, FILE *out)
{
    static bool (*const table[])(const struct garment *, FILE *) = {
        put_panels, put_edges, put_seams, put_points, put_picture};
    if (k < FILES - 1)
        return table[k](g, out);
    if (k == FILES - 1)
        return put_mesh(g, 0, g->pattern->panels, true, out);
    return put_mesh(g, k - FILES, k - FILES + 1, false, out);
}

static int save(const struct garment *g, int k, const char *directory)
{
    struct file file;
    char name[96];
    name_file(g, k, name);
    if (!file_open(&file, directory, name))
        return APP_FAILED;
    if (put(g, k, file.stream))
        return file_close(&file) ? APP_OK : APP_FAILED;
    file_drop(&file);
    return complain(APP_FAILED, "%s/%s: out of memory", directory, name);
}

int garment_save(const struct garment *garment, const char *directory)
{
    if (!file_make_directory(directory))
        return APP_FAILED;
    int status = APP_OK, k = 0;
    for (; k < FILES + garment->pattern->panels && status == APP_OK; k++)
        status = save(garment, k, directory);
    for (k -= 2; k >= 0 && status != APP_OK; k--) {
        char name[96], path[FILE_PATH];
        name_file(garment, k, name);
        if (file_join(path, directory, name))
            remove(path);
    }
    return status;
}
