// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/clash.h>

#include <string>
#include <vector>

namespace raycontact::clash {

/// A table as spreadsheets read it (RFC 4180): a line of headers, then one a clash; what there is not is empty. unit:
/// of all lengths; empty: not known. groups: of the same clashes; where there are some the last column is the number of
/// each one's group, from 1.
std::string csv(const std::vector<AssemblyPart>& parts, const std::vector<Clash>& clashes, const std::string& unit,
                const std::vector<ClashGroup>& groups = {});

} // namespace raycontact::clash
