// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "arrays.h"

#include <raycontact/contact.h>

#include <memory>
#include <vector>

namespace raycontact::python {

/// The list of contacts as bytes, which raycontact/contacts.py reads by contact_layout(). The array keeps the list,
/// which the scene and its recorder read as well.
ReadOnlyArray bytes_of(std::shared_ptr<const std::vector<Contact>> contacts);

/// Of each field: name, NumPy type, length (0: a number), offset.
nb::list contact_layout();

} // namespace raycontact::python
