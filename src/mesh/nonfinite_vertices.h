// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh/input_file.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact {

/// An error message about a number that is not finite; without the word in a binary file.
std::string not_finite(std::string what, std::string_view word);
/// What repairs say of vertices that no triangle uses.
std::string left_out_nonfinite(std::size_t count);

/// The vertices of a file that are not finite: an error where a triangle uses one, else left out and counted. Exporters
/// write such vertices where a scan saw nothing.
class NonfiniteVertices {
public:
    /// The vertex stays at the origin until finish(). In a binary file line is 0; `word` must outlive this.
    void add(std::size_t vertex, std::size_t line, std::string_view word);
    /// When all vertices and triangles are read. Moves them to where another vertex is, so that no box grows.
    void finish(Mesh& mesh, const InputFile& file) const;

private:
    struct Entry {
        std::size_t vertex, line;
        std::string_view word;
    };
    std::vector<Entry> entries_;
};

} // namespace raycontact
