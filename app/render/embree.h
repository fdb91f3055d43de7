/* SPDX-License-Identifier: Apache-2.0 */
/* Embree 3 or 4: EMBREE is the version that the Makefile has found. They differ
 * in their headers' folder and in how a ray is traced. */
#ifndef APP_RENDER_EMBREE_H
#define APP_RENDER_EMBREE_H

#if defined(EMBREE) && EMBREE == 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/* Finds the nearest hit of a ray. */
static inline void embree_intersect(RTCScene scene, struct RTCRayHit *ray)
{
#if RTC_VERSION_MAJOR >= 4
    rtcIntersect1(scene, ray, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, ray);
#endif
}

/* Sets ray->tfar below 0 if the ray hits anything. */
static inline void embree_occlude(RTCScene scene, struct RTCRay *ray)
{
#if RTC_VERSION_MAJOR >= 4
    rtcOccluded1(scene, ray, NULL);
#else
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, ray);
#endif
}

#endif
