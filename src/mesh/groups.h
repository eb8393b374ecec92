// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/assembly.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace raycontact {

/// The names that a file gives to runs of its triangles.
class Groups {
public:
    /// As OBJ calls what has no name.
    static constexpr const char* unnamed = "default";

    /// The triangles from `first` on have this name.
    void begin(std::string name, std::size_t first);
    /// How many different names there are that have some of so many triangles.
    std::size_t names(std::size_t triangles) const;

    /// A part for each name, in the order of their first triangles; or the whole mesh as the one part that there is,
    /// with the mesh's own name. Names that share a border, as patches of one solid do, are one part: where an edge is
    /// open in one of them and open in another, too. What is closed by itself has none, so it is a part of its own.
    /// Appends to `notes` the repairs of the mesh, and what was joined or is empty.
    std::vector<AssemblyPart> parts(Mesh&& mesh, std::vector<std::string>& notes) const;

private:
    std::vector<std::pair<std::string, std::size_t>> runs_;
};

} // namespace raycontact
