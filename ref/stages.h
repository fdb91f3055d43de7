/* SPDX-License-Identifier: Apache-2.0 */
/* Every stage's struct and entry point, in pipeline order. */
#ifndef REF_STAGES_H
#define REF_STAGES_H

#include "ref/audit.h"
#include "ref/bounds.h"
#include "ref/jacobi.h"
#include "ref/kinematics.h"
#include "ref/matrix.h"
#include "ref/narrow.h"
#include "ref/pcg.h"
#include "ref/product.h"
#include "ref/sum.h"
#include "ref/proximity.h"
#include "ref/impacts.h"
#include "ref/impulses.h"
#include "ref/contacts.h"
#include "ref/zones.h"
#include "ref/rollback.h"

#endif
