/* SPDX-License-Identifier: Apache-2.0 */
/* Includes the struct and the function ref_X of every stage X. */
#ifndef TESTS_STAGES_H
#define TESTS_STAGES_H

#include "ref/base/sum.h"
#include "ref/broad/cones.h"
#include "ref/broad/extent.h"
#include "ref/broad/features.h"
#include "ref/broad/front.h"
#include "ref/broad/refit.h"
#include "ref/broad/travel.h"
#include "ref/broad/walk.h"
#include "ref/cloth/advance.h"
#include "ref/cloth/blocks.h"
#include "ref/cloth/cloth.h"
#include "ref/cloth/dynamics.h"
#include "ref/cloth/energy.h"
#include "ref/cloth/implicit.h"
#include "ref/cloth/springs.h"
#include "ref/cloth/wind.h"
#include "ref/contact/carry.h"
#include "ref/contact/contacts.h"
#include "ref/contact/coulomb.h"
#include "ref/contact/impacts.h"
#include "ref/contact/impulses.h"
#include "ref/contact/proximity.h"
#include "ref/contact/rollback.h"
#include "ref/contact/zones.h"
#include "ref/narrow/audit.h"
#include "ref/narrow/narrow.h"
#include "ref/solve/coarsen.h"
#include "ref/solve/jacobi.h"
#include "ref/solve/matrix.h"
#include "ref/solve/multigrid.h"
#include "ref/solve/pcg.h"
#include "ref/solve/product.h"
#include "ref/world/kinematics.h"

#include "ref/momentum/momentum.h"

#endif
