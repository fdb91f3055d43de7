/* SPDX-License-Identifier: Apache-2.0 */
/* Two triangles; the exact predicates are any sign. */
#include "ref/narrow/tritri.h"
/*@ assigns \result \from a[0..2], b[0..2], c[0..2], d[0..2];
  @ ensures -1 <= \result <= 1; */
int ref_orient3(const point a, const point b, const point c, const point d);
/*@ assigns \result \from a[0..2], b[0..2], c[0..2], u, v;
  @ ensures -1 <= \result <= 1; */
int ref_orient2(const point a, const point b, const point c, int u, int v);
#include "ref/narrow/tritri.c"
#include "eva/tritri.h"
int main(void)
{
    struct face t, s;
    any_ref_plane(&t);
    struct plane p = ref_plane(&t);
    any_ref_tritri(&t, &p, &s);
    p = ref_plane(&t);
    return ref_tritri(&t, &p, &s);
}
