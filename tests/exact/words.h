// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/contact.h>

#include <cstdio>
#include <string>

namespace raycontact {

/// A contact on one line, for what a failed test prints.
inline std::string words_of(const Contact& c) {
    char text[200];
    std::snprintf(text, sizeof text, "%016llx triangle %u normal (%g, %g, %g) depth %.9g at (%.17g, %.17g, %.17g)",
                  static_cast<unsigned long long>(c.key()), c.feature.other_index(), double(c.normal.x),
                  double(c.normal.y), double(c.normal.z), double(c.depth), c.point().x, c.point().y, c.point().z);
    return text;
}

} // namespace raycontact
