// SPDX-License-Identifier: Apache-2.0
// Floating-point baselines, FCL and libccd: their errors are counted; their
// answers are never trusted. oracle/README.md
#include "oracle/oracle.h"

#include <ccd/ccd.h>
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>

#include <limits>

namespace
{

fcl::Vector3d vector(const double p[3])
{
    return fcl::Vector3d(p[0], p[1], p[2]);
}

struct Hull {
    int n;
    const double (*p)[3];
};

// Returns the point of a hull that is farthest along a direction.
void support(const void *hull, const ccd_vec3_t *direction, ccd_vec3_t *point)
{
    const Hull *h = static_cast<const Hull *>(hull);
    double best = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < h->n; k++) {
        ccd_vec3_t p = {{h->p[k][0], h->p[k][1], h->p[k][2]}};
        double d = ccdVec3Dot(&p, direction);
        if (d > best) {
            best = d;
            *point = p;
        }
    }
}

// Returns an inner point of a hull: the mean of its points.
void center(const void *hull, ccd_vec3_t *point)
{
    const Hull *h = static_cast<const Hull *>(hull);
    ccdVec3Set(point, 0, 0, 0);
    for (int k = 0; k < h->n; k++) {
        ccd_vec3_t p = {{h->p[k][0], h->p[k][1], h->p[k][2]}};
        ccdVec3Add(point, &p);
    }
    ccdVec3Scale(point, 1.0 / h->n);
}

} // namespace

int orc_ccd_fcl(int kind, int solver, const double x0[4][3],
                const double x1[4][3], double *t)
{
    using Test = fcl::detail::Intersect<double>;
    fcl::Vector3d a[4], b[4], at;
    for (int k = 0; k < 4; k++) {
        // FCL takes the face first, then the vertex.
        int from = kind == 0 ? (k + 1) % 4 : k;
        a[k] = vector(x0[from]);
        b[k] = vector(x1[from]);
    }
    bool newton = solver == 0, hit;
    if (kind == 0)
        hit = Test::intersect_VF(a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3],
                                 t, &at, newton);
    else
        hit = Test::intersect_EE(a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3],
                                 t, &at, newton);
    if (!hit)
        *t = -1;
    return hit;
}

int orc_hull_ccd(int method, int na, const double (*a)[3], int nb,
                 const double (*b)[3])
{
    ccd_t ccd;
    CCD_INIT(&ccd);
    ccd.support1 = ccd.support2 = support;
    ccd.center1 = ccd.center2 = center;
    ccd.max_iterations = 1000;
    Hull p = {na, a}, q = {nb, b};
    return method == 0 ? ccdGJKIntersect(&p, &q, &ccd)
                       : ccdMPRIntersect(&p, &q, &ccd);
}
