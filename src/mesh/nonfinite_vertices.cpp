// SPDX-License-Identifier: Apache-2.0
#include "mesh/nonfinite_vertices.h"

#include <cstdint>

namespace raycontact {

std::string not_finite(std::string what, std::string_view word) {
    const std::string lower = lower_case(std::string(word));
    const bool nan = lower.find("nan") != std::string::npos || lower.find("ind") != std::string::npos;
    if (!word.empty()) what.append(" ").append(in_quotes(word));
    return what + (nan ? " is not a number (NaN)" : " is not finite");
}

std::string left_out_nonfinite(std::size_t count) {
    return "left out " + std::to_string(count) + (count == 1 ? " vertex that is" : " vertices that are")
           + " not finite and that no triangle uses";
}

void NonfiniteVertices::add(std::size_t vertex, std::size_t line, std::string_view word) {
    if (entries_.empty() || entries_.back().vertex != vertex) entries_.push_back({vertex, line, word});
}

void NonfiniteVertices::finish(Mesh& mesh, const InputFile& file) const {
    if (entries_.empty() || mesh.triangles.empty()) return;
    std::vector<char> used(mesh.vertices.size(), 0);
    for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t v : triangle)
            if (v < used.size()) used[v] = 1; // else check_mesh() tells
    const std::size_t used_one = mesh.triangles[0][0];
    for (const auto& [vertex, line, word] : entries_) {
        if (used[vertex] != 0 && line == 0)
            file.fail("element 'vertex' " + std::to_string(vertex) + ": " + not_finite("a coordinate", word));
        if (used[vertex] != 0) file.fail_at(line, not_finite("coordinate", word));
        if (used_one < mesh.vertices.size()) mesh.vertices[vertex] = mesh.vertices[used_one];
    }
    mesh.repairs.push_back(left_out_nonfinite(entries_.size()));
}

} // namespace raycontact
