// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/separation.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <string>

/// What --separation adds to a line of JSON.
inline nlohmann::ordered_json separation_json(const raycontact::Separation& found) {
    const auto three = [](const raycontact::Vec3& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
    return {{"distance", found.distance},
            {"normal", three(found.normal)},
            {"point_a", three(found.point_a)},
            {"point_b", three(found.point_b)}};
}

/// And to a line for a person, of meshes that intersect.
inline std::string separation_words(const raycontact::Separation& found, const std::string& unit) {
    const raycontact::Vec3& n = found.normal;
    return fmt::format("parted by {:.6g} {} along {:.4g}, {:.4g}, {:.4g}", -found.distance, unit, n.x, n.y, n.z);
}
