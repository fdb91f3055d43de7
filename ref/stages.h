/* SPDX-License-Identifier: Apache-2.0 */
/* Every stage's struct and entry point, in pipeline order. */
#ifndef REF_STAGES_H
#define REF_STAGES_H

#include "ref/advance.h"
#include "ref/audit.h"
#include "ref/blocks.h"
#include "ref/cloth.h"
#include "ref/cones.h"
#include "ref/contacts.h"
#include "ref/dynamics.h"
#include "ref/energy.h"
#include "ref/extent.h"
#include "ref/features.h"
#include "ref/front.h"
#include "ref/impacts.h"
#include "ref/implicit.h"
#include "ref/impulses.h"
#include "ref/jacobi.h"
#include "ref/kinematics.h"
#include "ref/matrix.h"
#include "ref/multigrid.h"
#include "ref/narrow.h"
#include "ref/pcg.h"
#include "ref/penalty.h"
#include "ref/product.h"
#include "ref/proximity.h"
#include "ref/refit.h"
#include "ref/rollback.h"
#include "ref/springs.h"
#include "ref/sum.h"
#include "ref/travel.h"
#include "ref/walk.h"
#include "ref/warm.h"
#include "ref/wind.h"
#include "ref/zones.h"

#endif
