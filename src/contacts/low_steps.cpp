// SPDX-License-Identifier: Apache-2.0
#include "contacts/low_steps.h"

#include "contacts/write_contact.h"
#include "pairs/displacement.h"
#include "speculative/approach.h"

namespace raycontact {

LowSteps::LowSteps(const Settings& settings, const PlacedBody& source, const PlacedBody& target)
    : source_(source), target_(target), margin_(-1) {
    if (!settings.is_speculative() || settings.direction == Direction::ray || settings.direction == Direction::weighted)
        return;
    if (same_bits(source.next, source.centred) && same_bits(target.next, target.centred)) return;
    margin_ = speculative_margin(settings, source, target);
    const PairPlace now = place_pair(source.centred, target.centred, 0), next = place_pair(source.next, target.next, 0);
    now_ = now.pose;
    next_ = next.pose;
    const double reach = source.shape->data().reach;
    moves_ = displacement_bounds(now, next, reach, 0)[0] > margin_;
}

void LowSteps::step_over(Contact& contact, std::uint32_t vertex, std::uint32_t triangle) const {
    if (contact.depth > margin_) return;
    const ShapeData& target = target_.shape->data();
    const Vec3 point = source_.shape->data().point(vertex), from = transform_point(now_, point);
    const bool from_a = contact.feature.source == Side::a;
    const Vec3 out = rotated_back(target_.centred.rotation, (from_a ? -1.0 : 1.0) * Vec3(contact.normal));
    const Approaches approaches(target, {}, from, transform_point(next_, point), margin_,
                                1e-7 * smaller_size(source_, target_));
    const Approach best =
        approaches.least_change({triangle, out, -double(contact.depth)}, from + double(contact.depth) * out);
    if (best.face == triangle || !(best.gap < 0)) return;
    (from_a ? contact.feature.index_b : contact.feature.index_a) = target.mesh.triangle_index[best.face];
    write_direction(contact, rotated(target_.centred.rotation, best.normal), static_cast<float>(-best.gap));
}

} // namespace raycontact
