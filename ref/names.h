/* SPDX-License-Identifier: Apache-2.0 */
/* One source, two precisions, one library: every external function of ref/
 * takes the suffix of the build's precision. One that is missing here fails
 * to link, as it is then defined twice. Sorted. */
#ifndef REF_NAMES_H
#define REF_NAMES_H

#ifndef REAL_BITS
#define REAL_BITS 32
#endif
#define REAL_PASTE_(name, bits) name##_##bits
#define REAL_PASTE(name, bits) REAL_PASTE_(name, bits)
#define REAL_NAME(name) REAL_PASTE(name, REAL_BITS)

#define big_add REAL_NAME(big_add)
#define big_det REAL_NAME(big_det)
#define big_exponent REAL_NAME(big_exponent)
#define big_make REAL_NAME(big_make)
#define big_mul REAL_NAME(big_mul)
#define big_negate REAL_NAME(big_negate)
#define big_small REAL_NAME(big_small)
#define big_sub REAL_NAME(big_sub)
#define big_times REAL_NAME(big_times)
#define chain_make REAL_NAME(chain_make)
#define closest_ee REAL_NAME(closest_ee)
#define closest_normal REAL_NAME(closest_normal)
#define closest_unit REAL_NAME(closest_unit)
#define closest_vf REAL_NAME(closest_vf)
#define exact_first REAL_NAME(exact_first)
#define filter_signs REAL_NAME(filter_signs)
#define filter_split REAL_NAME(filter_split)
#define keys_sort REAL_NAME(keys_sort)
#define kinematics_pose REAL_NAME(kinematics_pose)
#define motion_ee REAL_NAME(motion_ee)
#define motion_vf REAL_NAME(motion_vf)
#define narrow_ee REAL_NAME(narrow_ee)
#define narrow_vf REAL_NAME(narrow_vf)
#define poly_split REAL_NAME(poly_split)
#define poly_zero REAL_NAME(poly_zero)
#define ref_audit REAL_NAME(ref_audit)
#define ref_audit_box REAL_NAME(ref_audit_box)
#define ref_audit_nodes REAL_NAME(ref_audit_nodes)
#define ref_audit_order REAL_NAME(ref_audit_order)
#define ref_audit_sort REAL_NAME(ref_audit_sort)
#define ref_bounds REAL_NAME(ref_bounds)
#define ref_cloth_fill REAL_NAME(ref_cloth_fill)
#define ref_cloth_size REAL_NAME(ref_cloth_size)
#define ref_cloth_start REAL_NAME(ref_cloth_start)
#define ref_collinear REAL_NAME(ref_collinear)
#define ref_contacts REAL_NAME(ref_contacts)
#define ref_dot REAL_NAME(ref_dot)
#define ref_impacts REAL_NAME(ref_impacts)
#define ref_impulses REAL_NAME(ref_impulses)
#define ref_kinematics REAL_NAME(ref_kinematics)
#define ref_narrow REAL_NAME(ref_narrow)
#define ref_orient2 REAL_NAME(ref_orient2)
#define ref_orient2_whole REAL_NAME(ref_orient2_whole)
#define ref_orient3 REAL_NAME(ref_orient3)
#define ref_orient3_whole REAL_NAME(ref_orient3_whole)
#define ref_proximity REAL_NAME(ref_proximity)
#define ref_response_penetrate REAL_NAME(ref_response_penetrate)
#define ref_response_repel REAL_NAME(ref_response_repel)
#define ref_response_start REAL_NAME(ref_response_start)
#define ref_rollback REAL_NAME(ref_rollback)
#define ref_sum REAL_NAME(ref_sum)
#define ref_sum_finish REAL_NAME(ref_sum_finish)
#define ref_tritri REAL_NAME(ref_tritri)
#define ref_zones REAL_NAME(ref_zones)
#define root_locate REAL_NAME(root_locate)
#define root_sign REAL_NAME(root_sign)
#define world_ops REAL_NAME(world_ops)

#endif
