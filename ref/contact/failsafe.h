/* SPDX-License-Identifier: Apache-2.0 */
/* The rounds of collision response that always end: zones, then rollback.
 * spec/contact/response.md */
#ifndef REF_FAILSAFE_H
#define REF_FAILSAFE_H

#include "ref/contact/response.h"

/* §5: the vertices of all hits since impulses ended move in zones. */
int failsafe_zones(struct response *s);

/* §6: the vertices of the hits go back; hits is how many did. */
int failsafe_rollback(struct response *s, int round);

#endif
