/* SPDX-License-Identifier: Apache-2.0 */
/* Writes the contacts of a run. */
#include "app/write/contacts.h"
#include "app/base/app.h"
#include "app/base/file.h"
#include "app/base/text.h"

#include <stdlib.h>
#include <string.h>

int contacts_known(int integrator, const char *file)
{
    if (integrator >= DRAPE_BW)
        return APP_OK;
    return complain(APP_USAGE,
                    "%s: --contacts: an explicit integrator keeps no list of "
                    "contacts",
                    file);
}

static int ask(drape_world *world, drape_contact_list *list)
{
    int status = drape_contacts(world, list);
    if (status == DRAPE_OK)
        return APP_OK;
    return complain(APP_FAILED, "the contacts: %s", drape_status_text(status));
}

int contacts_add(struct impulses *list, drape_world *world)
{
    drape_contact_list now;
    list->bodies = drape_bodies(world, NULL);
    size_t columns = 1 + 3 * (size_t)list->bodies;
    int status = ask(world, &now);
    if (status != APP_OK)
        return status;
    if (list->count == list->room) {
        int64_t room = list->room ? 2 * list->room : 64;
        double *larger =
            realloc(list->row, (size_t)room * columns * sizeof *larger);
        if (!larger)
            return complain(APP_FAILED, "out of memory");
        list->row = larger;
        list->room = room;
    }
    double *row = list->row + (size_t)list->count++ * columns;
    row[0] = now.dt;
    memset(row + 1, 0, (columns - 1) * sizeof *row);
    if (now.impulse)
        memcpy(row + 1, now.impulse, (columns - 1) * sizeof *row);
    return APP_OK;
}

void contacts_free(struct impulses *list)
{
    free(list->row);
}

void contacts_put(FILE *out, const struct impulses *list, int64_t k)
{
    if (k < list->first || k >= list->first + list->count)
        return;
    size_t columns = 1 + 3 * (size_t)list->bodies;
    const double *row = list->row + (size_t)(k - list->first) * columns;
    fputs(", \"impulses\": {\"slice\": ", out);
    text_put_number(out, "%.17g", row[0]);
    fputs(", \"bodies\": [", out);
    for (size_t c = 1; c < columns; c++) {
        fputs(c == 1 ? "[" : c % 3 == 1 ? "], [" : ", ", out);
        text_put_number(out, "%.17g", row[c]);
    }
    fputs("]]}", out);
}

/* The properties of a contact, in the order of struct point. */
static const char head[] =
    "property double x\nproperty double y\nproperty double z\n"
    "property double nx\nproperty double ny\nproperty double nz\n"
    "property double gap\n"
    "property double impulse_x\nproperty double impulse_y\n"
    "property double impulse_z\n"
    "property double weight_0\nproperty double weight_1\n"
    "property double weight_2\nproperty double weight_3\n"
    "property int vertex_0\nproperty int vertex_1\n"
    "property int vertex_2\nproperty int vertex_3\n"
    "property int kind\nproperty int body_a\nproperty int body_b\n";
enum { DOUBLES = 14, INTS = 7, ROW = 8 * DOUBLES + 4 * INTS };

/* The point of contact on side A. */
static void locate(const drape_contact *c, const double (*x)[3],
                   double point[3])
{
    int n = c->kind == 0 ? 1 : 2;
    memset(point, 0, 3 * sizeof *point);
    for (int k = 0; k < n; k++)
        for (int i = 0; i < 3; i++)
            point[i] += c->weight[k] * x[c->vertex[k]][i];
}

/* Writes a number of `bytes` bytes, the lowest first. */
static unsigned char *put(unsigned char *to, uint64_t bits, int bytes)
{
    for (int k = 0; k < bytes; k++)
        *to++ = (unsigned char)(bits >> 8 * k);
    return to;
}

static void put_contact(FILE *out, const drape_contact *c, const double (*x)[3])
{
    double number[DOUBLES];
    int32_t whole[INTS];
    unsigned char row[ROW], *to = row;
    locate(c, x, number);
    memcpy(number + 3, c->normal, sizeof c->normal);
    number[6] = c->gap;
    memcpy(number + 7, c->impulse, sizeof c->impulse);
    memcpy(number + 10, c->weight, sizeof c->weight);
    memcpy(whole, c->vertex, sizeof c->vertex);
    whole[4] = c->kind;
    whole[5] = c->body[0];
    whole[6] = c->body[1];
    for (int k = 0; k < DOUBLES; k++) {
        uint64_t bits;
        memcpy(&bits, &number[k], sizeof bits);
        to = put(to, bits, 8);
    }
    for (int k = 0; k < INTS; k++)
        to = put(to, (uint32_t)whole[k], 4);
    fwrite(row, sizeof row, 1, out);
}

int contacts_save(drape_world *world, const char *directory, int k,
                  const double (*x)[3])
{
    struct file file;
    char name[64];
    drape_contact_list list;
    int status = ask(world, &list);
    if (status != APP_OK)
        return status;
    snprintf(name, sizeof name, "contacts_%04d.ply", k);
    if (!file_open(&file, directory, name))
        return APP_FAILED;
    fprintf(file.stream,
            "ply\nformat binary_little_endian 1.0\n"
            "comment contacts of drape: the point on side A, the normal from B "
            "to A, m; the impulse on A, N s\n"
            "comment slice %.17g\nelement vertex %lld\n%send_header\n",
            list.dt, (long long)list.n, head);
    for (int64_t i = 0; i < list.n; i++)
        put_contact(file.stream, &list.contact[i], x);
    return file_close(&file) ? APP_OK : APP_FAILED;
}
