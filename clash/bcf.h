// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/clash.h>

#include <string>
#include <vector>

namespace raycontact::clash {

/// How clashes are told to people.
struct BcfOptions {
    double metres = 1;                ///< that the unit of the parts is long; BCF has metres
    std::string unit = "m";           ///< its name, for descriptions
    std::string date;                 ///< of creation, "2026-01-31T12:00:00Z"
    std::vector<ClashGroup> groups{}; ///< of the same clashes: each topic has the names of its group as a label
};

/// A zip file of BIM Collaboration Format 2.1: of each clash a topic, with a viewpoint whose camera looks at its point.
/// A topic's identifier follows from the names of its parts, so that it stays from run to run. Throws
/// std::runtime_error where the zip cannot be made.
std::string bcf_zip(const std::vector<AssemblyPart>& parts, const std::vector<Clash>& clashes,
                    const BcfOptions& options);

} // namespace raycontact::clash
