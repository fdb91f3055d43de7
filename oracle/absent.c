/* SPDX-License-Identifier: Apache-2.0 */
/* Stubs that are built in place of the oracles whose libraries are not
 * installed. Tests check orc_present and skip. oracle/README.md */
#include "oracle/oracle.h"
#include "oracle/rational.h"

int orc_present(void)
{
    return 0;
}

int orc_ccd_gmp(int kind, const double x0[4][3], const double x1[4][3],
                uint32_t *toi)
{
    (void)kind, (void)x0, (void)x1, (void)toi;
    return -1;
}

int orc_ccd_cgal(int kind, const double x0[4][3], const double x1[4][3],
                 uint32_t *toi)
{
    (void)kind, (void)x0, (void)x1, (void)toi;
    return -1;
}

int orc_ccd_fcl(int kind, int solver, const double x0[4][3],
                const double x1[4][3], double *t)
{
    (void)kind, (void)solver, (void)x0, (void)x1, (void)t;
    return -1;
}

int orc_hull_ccd(int method, int na, const double (*a)[3], int nb,
                 const double (*b)[3])
{
    (void)method, (void)na, (void)a, (void)nb, (void)b;
    return -1;
}

int64_t orc_self_pairs(int64_t nv, const double (*x)[3], int64_t nt,
                       const int32_t (*tri)[3], const int32_t *group,
                       int64_t cap, int32_t (*pair)[2], int64_t *degenerate)
{
    (void)nv, (void)x, (void)nt, (void)tri, (void)group, (void)cap;
    (void)pair, (void)degenerate;
    return -1;
}

int64_t orc_self_pmp(int64_t nv, const double (*x)[3], int64_t nt,
                     const int32_t (*tri)[3], int64_t cap, int32_t (*pair)[2],
                     int64_t *degenerate)
{
    (void)nv, (void)x, (void)nt, (void)tri, (void)cap, (void)pair;
    (void)degenerate;
    return -1;
}

int orc_orient3(const double a[3], const double b[3], const double c[3],
                const double d[3])
{
    (void)a, (void)b, (void)c, (void)d;
    return -1;
}

int orc_triangles(const double t[3][3], const double s[3][3], int shared)
{
    (void)t, (void)s, (void)shared;
    return -1;
}

int orc_distance(int kind, const double x[4][3], double r)
{
    (void)kind, (void)x, (void)r;
    return -1;
}
