// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/description.h>

#include <string>

namespace raycontact::scenes {

/// What the bodies of a scene are made of, for a person: "bolt.obj (...)", or how many there are of each mesh:
/// "2 x bolt.obj (...); 3 x nut.obj (...); standing still: 1 x tray.obj (...)". The grounds of scenes are left out.
std::string meshes_in_words(const SceneDescription& scene);

/// "bolt.obj (120 vertices and 236 triangles)"
std::string mesh_in_words(const std::string& name, const Shape& shape);

} // namespace raycontact::scenes
