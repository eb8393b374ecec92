// SPDX-License-Identifier: Apache-2.0
#include <clash/csv.h>

#include <fmt/format.h>

#include <array>
#include <string_view>

namespace raycontact::clash {

namespace {

std::string cell(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

std::string number(const std::optional<double>& value) {
    return value ? fmt::format("{}", *value) : std::string();
}

std::string three(const Vec3& v) {
    return fmt::format("{},{},{}", v.x, v.y, v.z);
}

} // namespace

std::string csv(const std::vector<AssemblyPart>& parts, const std::vector<Clash>& clashes, const std::string& unit,
                const std::vector<ClashGroup>& groups) {
    std::string text =
        "a,b,kind,depth,distance,x,y,z,contacts,open,low_x,low_y,low_z,high_x,high_y,high_z,volume,separation,unit";
    text += groups.empty() ? "\r\n" : ",group\r\n";
    std::vector<std::size_t> group_of(clashes.size());
    for (std::size_t i = 0; i < groups.size(); ++i)
        for (const std::size_t clash : groups[i].clashes) group_of[clash] = i + 1;
    for (const Clash& c : clashes) {
        const std::string_view open = std::array{"", "a", "b", "a b"}[(c.open_a ? 1u : 0u) + (c.open_b ? 2u : 0u)];
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{}", cell(parts[c.a].name), cell(parts[c.b].name),
                            to_string(c.kind), number(c.depth), c.distance, three(c.point), c.contacts, open,
                            c.box ? three(c.box->low) + "," + three(c.box->high) : ",,,,,", number(c.volume),
                            number(c.separation ? std::optional(c.separation->distance) : std::nullopt), unit);
        text += groups.empty() ? "\r\n" : fmt::format(",{}\r\n", group_of[std::size_t(&c - clashes.data())]);
    }
    return text;
}

} // namespace raycontact::clash
