// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/clash.h>

#include <string>
#include <vector>

namespace raycontact::clash {

/// A table as spreadsheets read it (RFC 4180): a line of headers, then one a clash; what there is not is empty. unit:
/// of all lengths; empty: not known.
std::string csv(const std::vector<AssemblyPart>& parts, const std::vector<Clash>& clashes, const std::string& unit);

} // namespace raycontact::clash
