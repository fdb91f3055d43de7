/* SPDX-License-Identifier: Apache-2.0 */
/* Replaces the stages that the bare scene does not use by functions that end
 * the program. It is linked before the library, so that the library's own
 * stages are not linked. spec/accuracy.md §7 */
#include <stdlib.h>

#define NEVER(name)                                                            \
    void ref_##name##_32(void);                                                \
    void ref_##name##_32(void)                                                 \
    {                                                                          \
        abort();                                                               \
    }
NEVER(kinematics)
NEVER(wind)
NEVER(blocks)
NEVER(predict)
NEVER(rhs)
NEVER(update)
NEVER(history)
NEVER(matrix)
NEVER(product)
NEVER(jacobi)
NEVER(excess)
NEVER(coarsen)
NEVER(multigrid)
NEVER(pcg)
NEVER(refit)
NEVER(cones)
NEVER(front)
NEVER(walk)
NEVER(features)
NEVER(narrow)
NEVER(proximity)
NEVER(impacts)
NEVER(impulses)
NEVER(contacts)
NEVER(carry)
NEVER(coulomb)
NEVER(links)
NEVER(retain)
NEVER(zones)
NEVER(rollback)
