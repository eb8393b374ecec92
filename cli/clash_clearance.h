// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/clash.h>

#include <string>
#include <vector>

namespace raycontact {

/// --clearance LENGTH, LENGTH:SET or LENGTH:SET:SET, which may be given again. A LENGTH is in the unit of the files, or
/// has a unit after it, "25mm". unit: of the files; empty: not told. Throws InputError.
void set_clearances(const std::vector<std::string>& given, const std::string& unit, ClashOptions& how);

} // namespace raycontact
