/* SPDX-License-Identifier: Apache-2.0 */
/* Helper shared by the tests of stage contacts. */
#ifndef TESTS_CONTACTS_H
#define TESTS_CONTACTS_H

#include "ref/contact/contacts.h"
#include "tests/base/harness.h"

/* Takes the scratch that s needs for its nv and n from the harness. */
void contacts_scratch(struct bytes *b, struct contacts *s);

#endif
