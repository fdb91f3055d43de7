/* SPDX-License-Identifier: Apache-2.0 */
/* The contacts of the last slice, for the caller. spec/control/control.md §8 */
#ifndef REF_LIST_H
#define REF_LIST_H

#include "ref/world/state.h"

/* Does what drape_contacts says, and drape_contacts_device if `there`. */
int list_contacts(struct world *w, bool there, drape_contact_list *list);

#endif
