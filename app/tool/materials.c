/* SPDX-License-Identifier: Apache-2.0 */
/* drape materials: lists the fabrics of app/scene/fabrics.def. */
#include "app/scene/fabrics.h"
#include "app/tool/options.h"

#include <drape.h>
#include <stdio.h>

int command_materials(int argc, char **argv)
{
    int status = options_none("materials", argc, argv);
    if (status != APP_OK)
        return status;
    printf("%-11s %8s %8s %8s %9s %9s %8s\n", "name", "density", "stretch",
           "shear", "bend", "thickness", "friction");
    printf("%-11s %8s %8s %8s %9s %9s\n", "", "kg/m2", "N/m", "N/m", "N m",
           "m");
    drape_material m = {0};
    const char *name, *what;
    for (int k = 0; (name = fabric_at(k, &m, &what)) != NULL; k++)
        printf("%-11s %8g %8g %8g %9.3g %9g %8g\n", name, m.density, m.stretch,
               m.shear, m.bend, m.thickness, m.friction);
    putchar('\n');
    for (int k = 0; (name = fabric_at(k, &m, &what)) != NULL; k++)
        printf("%-11s %s\n%-11s %s\n", name, what, "", fabric_source(k));
    return APP_OK;
}
