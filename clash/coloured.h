// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/clash.h>

#include <string>
#include <vector>

namespace raycontact::clash {

/// A binary glTF file of all parts: those of the clashes red, the others grey and half transparent, and a node for each
/// clash at its point, named "A x B"; its extras have the numbers of both parts. Throws InputError when the file would
/// exceed 4 GiB.
std::string coloured_glb(const std::vector<AssemblyPart>& parts, const std::vector<Clash>& clashes);

} // namespace raycontact::clash
