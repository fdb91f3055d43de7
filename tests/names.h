/* SPDX-License-Identifier: Apache-2.0 */
/* The tests' external names, one set a precision; see ref/names.h. Sorted. */
#ifndef TESTS_NAMES_H
#define TESTS_NAMES_H

#define fields_bounds REAL_NAME(fields_bounds)
#define fields_dot REAL_NAME(fields_dot)
#define fields_kinematics REAL_NAME(fields_kinematics)
#define fields_sum REAL_NAME(fields_sum)
#define gen_bounds REAL_NAME(gen_bounds)
#define gen_dot REAL_NAME(gen_dot)
#define gen_kinematics REAL_NAME(gen_kinematics)
#define gen_sum REAL_NAME(gen_sum)
#define pick_real REAL_NAME(pick_real)
#define pick_uniform REAL_NAME(pick_uniform)
#define pick_vec REAL_NAME(pick_vec)
#define prop_bounds REAL_NAME(prop_bounds)
#define prop_dot REAL_NAME(prop_dot)
#define prop_kinematics REAL_NAME(prop_kinematics)
#define prop_sum REAL_NAME(prop_sum)
#define stages_table REAL_NAME(stages_table)
#define test_motion_keys REAL_NAME(test_motion_keys)
#define tests_table REAL_NAME(tests_table)

#endif
