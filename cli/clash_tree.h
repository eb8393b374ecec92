// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/assembly.h>

#include <span>
#include <string>

namespace raycontact {

/// `clash --tree`: the nodes of the files and the parts under them, a line each.
std::string tree_text(std::span<const AssemblyPart> parts);
/// A line of JSON for each part.
std::string tree_json(std::span<const AssemblyPart> parts);

} // namespace raycontact
