/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of stage contacts share. */
#ifndef TESTS_CONTACTS_H
#define TESTS_CONTACTS_H

#include "ref/contact/contacts.h"
#include "tests/base/harness.h"

/* The scratch that s needs for its nv and n, in the harness's memory. */
void contacts_scratch(struct bytes *b, struct contacts *s);

#endif
