// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"
#include "reference/solid.h"

#include <raycontact/contact.h>
#include <raycontact/scene.h>
#include <raycontact/shape.h>

#include <memory>
#include <vector>

namespace raycontact::reference {

/// A shape of the library and what the reference makes of the same positions.
struct Subject {
    std::shared_ptr<const Shape> shape;
    Solid solid;
    explicit Subject(const Mesh& mesh);
};

/// A procedural mesh of scenes/models with 902 triangles: "knot", "gear", "torus" or "sphere".
Mesh model_mesh(const char* kind);

/// Knot, gear, bumpy torus and bumpy sphere of 902 triangles; bumpy octahedron, frame, L prism, tetrahedron.
const std::vector<Subject>& closed_subjects();
/// Bowl, sheet, and a box without a lid.
const std::vector<Subject>& open_subjects();

/// Two subjects so placed that their boxes overlap and mostly their surfaces do.
struct Placement {
    const Subject* a = nullptr;
    const Subject* b = nullptr;
    Pose pose_a, pose_b;
};
Placement random_placement(const std::vector<const Subject*>& subjects, Random& random);
std::vector<const Subject*> pointers(const std::vector<Subject>& subjects);

/// Bodies 2 i and 2 i + 1 of the scene are a and b of placement i; or b and a when swapped.
std::vector<Pair> add_all(Scene& scene, const std::vector<Placement>& placements, bool swapped = false);

/// The contacts of placement i out of all, which are sorted by body.
std::vector<std::span<const Contact>> by_pair(std::span<const Contact> contacts, std::size_t pairs);

inline constexpr Direction directions[] = {Direction::ray, Direction::weighted, Direction::reprojected,
                                           Direction::refined};

/// What a scene with these settings that has seen nothing finds for the bodies, poses and pairs of the last step.
std::vector<Contact> contacts_of_fresh_scene(const Scene& scene, const Settings& settings);

/// The same contacts, bit for bit.
bool same_bits(std::span<const Contact> x, std::span<const Contact> y);

} // namespace raycontact::reference
