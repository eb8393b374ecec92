// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "edges/feature_contact.h"
#include "edges/source_mesh.h"

#include <optional>

namespace raycontact {

/// Whether a component of the source lies in the target; needs surfaces that do not cross, and a closed target.
bool has_part_inside(const SourceMesh& placed);

/// The contact of a source of which a component lies wholly inside the target: its deepest vertex, the nearest face.
std::optional<FeatureContact> contact_of_inside(const SourceMesh& placed, VertexBody source);

} // namespace raycontact
