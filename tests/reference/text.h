// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <cstdio>
#include <string>

namespace raycontact::reference {

/// As printf does.
template <class... Args>
std::string text(const char* format, Args... args) {
    char buffer[512];
    std::snprintf(buffer, sizeof buffer, format, args...);
    return buffer;
}

/// Bit for bit, to be pasted into a test.
inline std::string text(const Pose& pose) {
    std::string s = "{";
    for (const double r : pose.rotation) s += text("%a, ", r);
    const Vec3& t = pose.translation;
    return s + text("| %a, %a, %a}", t.x, t.y, t.z);
}

} // namespace raycontact::reference
