/* SPDX-License-Identifier: Apache-2.0 */
/* Draws the panels of a sewing pattern as SVG, side by side. */
#include "app/write/garment.h"

#include <math.h>

/* mm */
static const double margin = 30;

/* A page: panels stand in rows of about the same width. */
struct page {
    const struct garment *garment;
    FILE *out;
    double width, height; /* mm */
    double at[2], row;    /* the place of the next panel; height of its row */
    double from[2];       /* mm on the page where the panel's 0, 0 is */
};

/* Puts a panel of that size behind the others, or begins a new row. */
static void step(struct page *page, const struct outline *o, double width)
{
    double size[2] = {1e3 * (o->hi[0] - o->lo[0]), 1e3 * (o->hi[1] - o->lo[1])};
    if (page->at[0] > margin && page->at[0] + size[0] > width) {
        page->at[0] = margin;
        page->at[1] += page->row + margin;
        page->row = 0;
    }
    page->from[0] = page->at[0] - 1e3 * o->lo[0];
    page->from[1] = page->at[1] + 1e3 * o->hi[1];
    page->at[0] += size[0] + margin;
    page->row = fmax(page->row, size[1]);
    page->width = fmax(page->width, page->at[0]);
    page->height = page->at[1] + page->row + margin;
}

static double width_of(const struct garment *g)
{
    double area = 0;
    for (int k = 0; k < g->pattern->panels; k++) {
        const struct outline *o = &g->panel[k].outline;
        area += (1e3 * (o->hi[0] - o->lo[0]) + margin) *
                (1e3 * (o->hi[1] - o->lo[1]) + margin);
    }
    return 1.3 * sqrt(area) + margin;
}

/* A point on the page; the page's y points down. */
static void put_point(const struct page *page, const char *before,
                      const double x[2])
{
    fprintf(page->out, "%s%.2f %.2f", before, page->from[0] + 1e3 * x[0],
            page->from[1] - 1e3 * x[1]);
}

static void put_curve(const struct page *page, const struct curve *curve)
{
    double radius = 1e3 * plane_length(curve->a[0] - curve->c[0],
                                       curve->a[1] - curve->c[1]);
    switch (curve->type) {
    case CURVE_LINE:
        put_point(page, "L", curve->b);
        break;
    case CURVE_QUADRATIC:
        put_point(page, "Q", curve->c);
        put_point(page, " ", curve->b);
        break;
    case CURVE_CUBIC:
        put_point(page, "C", curve->c);
        put_point(page, " ", curve->d);
        put_point(page, " ", curve->b);
        break;
    case CURVE_POLYLINE:
        for (int k = 1; k <= curve->points + 1; k++)
            put_point(page, "L", curve_corner(curve, k));
        break;
    case CURVE_ARC:
        fprintf(page->out, "A%.3f %.3f 0 %d %d ", radius, radius,
                fabs(curve->turn) > acos(-1), curve->turn < 0);
        put_point(page, "", curve->b);
        break;
    }
}

/* All cells from kind `from` to `to` as one path. */
static void put_cells(const struct page *page, const struct cut *cut, int from,
                      int to, const char *colour)
{
    fprintf(page->out,
            "<path fill=\"%s\" stroke=\"#fff\" "
            "stroke-width=\"%.3g\" d=\"",
            colour, 60 * cut->h);
    for (int64_t c = 0; c < (int64_t)(cut->m - 1) * (cut->n - 1); c++) {
        int32_t p[4];
        if (cut->cell[c] < from || cut->cell[c] > to)
            continue;
        int count = cut_corners(cut, c, p);
        for (int k = 0; k < count; k++)
            put_point(page, k ? "L" : "M", cut->x[p[k]]);
        fputs("Z\n", page->out);
    }
    fputs("\"/>\n", page->out);
}

/* Regular cells, a row of them at a time, under a pattern of lines. */
static void put_regular(const struct page *page, int panel,
                        const struct cut *cut)
{
    double h = 1e3 * cut->h;
    fprintf(page->out,
            "<pattern id=\"grid%d\" patternUnits=\"userSpaceOnUse\" "
            "x=\"%.2f\" y=\"%.2f\" width=\"%g\" height=\"%g\"><rect "
            "width=\"%g\" height=\"%g\" fill=\"#cfd8e3\"/><path d=\"M0 0H%gM0 "
            "0V%g\" stroke=\"#fff\" stroke-width=\"%.3g\"/></pattern>\n"
            "<path fill=\"url(#grid%d)\" d=\"",
            panel, page->from[0] + 1e3 * cut->at[0],
            page->from[1] - 1e3 * cut->at[1], h, h, h, h, h, h, 0.1 * h, panel);
    for (int j = 0; j + 1 < cut->n; j++)
        for (int i = 0, k; i + 1 < cut->m; i = k + 1) {
            const uint8_t *cell = cut->cell + (int64_t)(cut->m - 1) * j;
            for (k = i; k + 1 < cut->m && cell[k] == CUT_REGULAR;)
                k++;
            if (k == i)
                continue;
            const double x[2] = {cut->at[0] + cut->h * i,
                                 cut->at[1] + cut->h * j};
            put_point(page, "M", x);
            fprintf(page->out, "h%.2fv%.2fh%.2fz\n", (k - i) * h, -h,
                    -(k - i) * h);
        }
    fputs("\"/>\n", page->out);
}

/* A text of the file: what XML does not allow becomes a question mark. */
static void put_text(const struct page *page, const double x[2], double size,
                     const char *text)
{
    fprintf(page->out, "<text font-size=\"%g\"", size);
    put_point(page, " transform=\"translate(", x);
    fputs(")\">", page->out);
    for (; *text; text++) {
        const char *as = *text == '<'   ? "&lt;"
                         : *text == '>' ? "&gt;"
                         : *text == '&' ? "&amp;"
                                        : NULL;
        if (as)
            fputs(as, page->out);
        else
            fputc((unsigned char)*text < 32 || *text == 127 ? '?' : *text,
                  page->out);
    }
    fputs("</text>\n", page->out);
}

/* The edges: sewn ones in their seam's colour and with its number. */
static void put_edges(const struct page *page, const struct garment_panel *p)
{
    for (int k = 0; k < p->panel->edges; k++) {
        const struct pattern_edge *edge = &p->panel->edge[k];
        int seam = edge->stitch;
        /* neighbours in number get hues that are far apart */
        fprintf(page->out,
                "<path fill=\"none\" stroke=\"hsl(%d,%d%%,40%%)\" "
                "stroke-width=\"%g\" d=\"",
                seam < 0 ? 0 : seam * 137 % 360, seam < 0 ? 0 : 90,
                seam < 0 ? 0.8 : 2.0);
        put_point(page, "M", edge->curve.a);
        put_curve(page, &edge->curve);
        fputs("\"/>\n", page->out);
        if (seam < 0)
            continue;
        char name[16];
        double x[2];
        snprintf(name, sizeof name, "%d", seam);
        curve_point(&edge->curve, 0.5, x);
        put_text(page, x, 12, name);
    }
}

static void put_panel(const struct page *page, int k)
{
    const struct garment_panel *p = &page->garment->panel[k];
    const struct outline *o = &p->outline;
    double x[2] = {o->lo[0], o->lo[1] - 0.018};
    put_regular(page, k, &p->cut);
    put_cells(page, &p->cut, CUT_RISING, CUT_FALLING, "#8fb8de");
    put_cells(page, &p->cut, CUT_WITHOUT, CUT_WITHOUT + 3, "#f2b36b");
    put_edges(page, p);
    put_text(page, x, 14, p->panel->name);
}

void garment_draw(const struct garment *garment, FILE *out)
{
    struct page page = {.garment = garment, .out = out, .at = {margin, margin}};
    double width = width_of(garment);
    for (int k = 0; k < garment->pattern->panels; k++)
        step(&page, &garment->panel[k].outline, width);
    fprintf(out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %.0f "
            "%.0f\" width=\"%.0f\" height=\"%.0f\" font-family=\"sans-serif\">"
            "\n<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n",
            page.width, page.height, page.width, page.height);
    page.at[0] = page.at[1] = margin;
    page.row = 0;
    for (int k = 0; k < garment->pattern->panels; k++) {
        step(&page, &garment->panel[k].outline, width);
        put_panel(&page, k);
    }
    fputs("</svg>\n", out);
}
