/* SPDX-License-Identifier: Apache-2.0 */
/* gpu/'s external names, one set a precision; see ref/names.h. Sorted. */
#ifndef GPU_NAMES_H
#define GPU_NAMES_H

#include "ref/names.h"

#define gpu_advance REAL_NAME(gpu_advance)
#define gpu_audit REAL_NAME(gpu_audit)
#define gpu_blocks REAL_NAME(gpu_blocks)
#define gpu_coarsen REAL_NAME(gpu_coarsen)
#define gpu_cones REAL_NAME(gpu_cones)
#define gpu_contacts REAL_NAME(gpu_contacts)
#define gpu_dot REAL_NAME(gpu_dot)
#define gpu_energy REAL_NAME(gpu_energy)
#define gpu_excess REAL_NAME(gpu_excess)
#define gpu_features REAL_NAME(gpu_features)
#define gpu_front REAL_NAME(gpu_front)
#define gpu_history REAL_NAME(gpu_history)
#define gpu_impacts REAL_NAME(gpu_impacts)
#define gpu_impulses REAL_NAME(gpu_impulses)
#define gpu_jacobi REAL_NAME(gpu_jacobi)
#define gpu_kinematics REAL_NAME(gpu_kinematics)
#define gpu_matrix REAL_NAME(gpu_matrix)
#define gpu_multigrid REAL_NAME(gpu_multigrid)
#define gpu_narrow REAL_NAME(gpu_narrow)
#define gpu_pcg REAL_NAME(gpu_pcg)
#define gpu_penalty REAL_NAME(gpu_penalty)
#define gpu_predict REAL_NAME(gpu_predict)
#define gpu_product REAL_NAME(gpu_product)
#define gpu_proximity REAL_NAME(gpu_proximity)
#define gpu_refit REAL_NAME(gpu_refit)
#define gpu_rhs REAL_NAME(gpu_rhs)
#define gpu_rollback REAL_NAME(gpu_rollback)
#define gpu_springs REAL_NAME(gpu_springs)
#define gpu_sum REAL_NAME(gpu_sum)
#define gpu_sum_finish REAL_NAME(gpu_sum_finish)
#define gpu_update REAL_NAME(gpu_update)
#define gpu_walk REAL_NAME(gpu_walk)
#define gpu_wind REAL_NAME(gpu_wind)
#define gpu_zones REAL_NAME(gpu_zones)
#define world_ops_gpu REAL_NAME(world_ops_gpu)

#endif
