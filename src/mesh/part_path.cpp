// SPDX-License-Identifier: Apache-2.0
#include "mesh/part_path.h"

#include <raycontact/assembly.h>

namespace raycontact {

std::string joined(std::span<const std::string> names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : "/") + name;
    return text;
}

std::string path_of(const AssemblyPart& part) {
    if (part.under.empty()) return part.name;
    const std::string file = part.file + ":"; // load_parts() may have put it before the name
    const bool told = part.under.front() == part.file && part.name.starts_with(file);
    return joined(part.under) + "/" + (told ? part.name.substr(file.size()) : part.name);
}

} // namespace raycontact
