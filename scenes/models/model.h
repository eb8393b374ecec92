// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

#include <cstdint>
#include <string>
#include <string_view>

namespace raycontact::scenes {

/// A mesh for a scene: closed, manifold, outward, free of self-intersections, concave; largest box extent 1 m, centre
/// of volume at the origin, coordinates rounded to float32.
struct Model {
    Mesh mesh;
    std::string source;    ///< one sentence for a person: what it is and where it came from
    bool stand_in = false; ///< true when the kind that was asked for could not be made and another took its place
};

/// `kind`: "bunny", "hare", "knot", "gear", "torus", "star" or "sphere"; the mesh has exactly `triangles` triangles, an
/// even number. Counts: sphere from 8, torus from 18, gear from 48, knot from 60, hare and star from 400, all up to two
/// million; bunny from 60 to 60 000 where a sound reduction is found (902, 2130, 2166, 3456, 3458 are). The procedural
/// kinds are the same bits from every compiler. "bunny" is the Stanford bunny of Debian's package glmark2-data, reduced
/// at run time; where that is not possible a procedural mesh of the same count is returned, and `source` and `stand_in`
/// say so. Throws InputError for an unknown kind or a count it cannot have.
Model scene_model(std::string_view kind, std::uint32_t triangles);

/// A model's y axis points up; of the mesh that this returns it is the z axis.
Mesh stood_up(Mesh mesh);

} // namespace raycontact::scenes
