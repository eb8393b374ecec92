// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <convert.h>
#include "round/round_contacts.h"

class btHeightfieldTerrainShape;

namespace raycontact::bullet {

/// `shape` is of kind round.
Round round_of(const btCollisionShape& shape);
/// Its longest way through, metres.
double size_of(const Round& round);

/// The triangles of a height field as it is now, by the names that Bullet has for them.
class FieldFacets : public FacetSource {
public:
    explicit FieldFacets(const btHeightfieldTerrainShape& field) : field_(&field) {}
    void near(const Vec3& low, const Vec3& high, std::vector<Facet>& out) const override;
    double size() const override;

private:
    const btHeightfieldTerrainShape* field_;
};

} // namespace raycontact::bullet
