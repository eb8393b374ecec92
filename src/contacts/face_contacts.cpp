// SPDX-License-Identifier: Apache-2.0
#include "contacts/face_contacts.h"

#include "contacts/contact_order.h"
#include "contacts/write_contact.h"
#include "executor/row_slices.h"
#include "free_all.h"
#include "query/overlap_patches.h"
#include "shape/around.h"

#include <algorithm>
#include <unordered_set>

namespace raycontact {

namespace {

/// Regions of a pair that have contacts of faces.
class Spoken {
public:
    explicit Spoken(const OverlapPatches& patches) : surfaces_(patches.surfaces()) {
        for (const OverlapPatch& patch : patches.patches()) regions_.insert(patch.region);
    }
    /// Whether contacts of faces stand for one that the rays and edges of a pair have.
    bool stands_for(const Contact& contact, const std::array<const ShapeData*, 2>& shapes) const {
        const auto spoken = [&](std::size_t side, std::uint32_t face) {
            const InnerFace* const inner = surfaces_.at(side, face);
            return inner == nullptr || regions_.contains(inner->region);
        };
        const auto of_pieces = [&](std::size_t side, std::uint32_t triangle, auto&& ask) {
            const auto& numbers = shapes[side]->mesh.triangle_index;
            const auto [begin, end] = std::equal_range(numbers.begin(), numbers.end(), triangle);
            return std::all_of(begin, end, [&](const std::uint32_t& number) {
                return ask(static_cast<std::uint32_t>(&number - numbers.data()));
            });
        };
        const ContactFeature& feature = contact.feature;
        if (feature.kind == FeatureKind::edges) {
            const auto stands = [&](std::size_t side, std::uint32_t edge) {
                return of_pieces(side, edge / 3, [&](std::uint32_t face) { return spoken(side, face); });
            };
            return stands(0, feature.index_a) && stands(1, feature.index_b);
        }
        const std::size_t side = feature.source == Side::a ? 0 : 1;
        const auto& vertices = shapes[side]->mesh.vertex_index;
        const auto at = std::ranges::lower_bound(vertices, feature.source_index());
        const auto vertex = static_cast<std::uint32_t>(at - vertices.begin());
        return !any_triangle_at(*shapes[side], vertex,
                                [&](std::uint32_t face, std::uint32_t) { return !spoken(side, face); });
    }

private:
    const InnerSurfaces& surfaces_;
    std::unordered_set<std::uint32_t> regions_;
};

/// Of pieces of one triangle that are told by one name: the sum of what they press, and of their areas.
void join(std::vector<Contact>& contacts, std::size_t first) {
    const auto force = [](const Contact& c) {
        const Vec3 normal = c.normal;
        return double(c.depth) * double(c.weight) * normal;
    };
    std::size_t kept = first;
    for (std::size_t i = first; i < contacts.size(); ++i) {
        if (kept == first || contacts[kept - 1].key() != contacts[i].key()) {
            contacts[kept++] = contacts[i];
            continue;
        }
        Contact& c = contacts[kept - 1];
        const Vec3 sum = force(c) + force(contacts[i]);
        if (!(length(sum) > 0)) continue; // they cancel out
        const double own = length(force(c)), other = length(force(contacts[i])),
                     area = double(c.weight) + double(contacts[i].weight);
        const auto middle = [](const Contact& of) { return 0.5 * (of.point_a + of.point_b); };
        const Vec3 at = (1 / (own + other)) * (own * middle(c) + other * middle(contacts[i]));
        const double depth = length(sum) / area;
        const Vec3 normal = unit(sum);
        write_contact(c, c.body_a, c.body_b, c.feature, at + 0.5 * depth * normal, -1.0 * normal,
                      static_cast<float>(depth), static_cast<float>(depth), static_cast<float>(area));
    }
    contacts.resize(kept);
}

/// Adds what a pair has, which had `row`.
void replace(OverlapPatches& patches, std::span<const PlacedBody> bodies, std::span<const Contact> row,
             std::vector<Contact>& contacts) {
    const auto [body_a, body_b] = std::pair(row.front().body_a, row.front().body_b);
    const PlacedBody &a = bodies[body_a.slot], &b = bodies[body_b.slot];
    const bool touches = std::ranges::any_of(
        row, [](const Contact& c) { return !c.is_speculative() && c.feature.kind != FeatureKind::round; });
    if (!touches || !a.shape->has_inside() || !b.shape->has_inside() || !patches.find(a, b, false)) {
        contacts.insert(contacts.end(), row.begin(), row.end());
        return;
    }
    const std::array shapes{&a.shape->data(), &b.shape->data()};
    const Spoken spoken(patches);
    const std::size_t first = contacts.size();
    for (const Contact& contact : row)
        if (contact.is_speculative() || !spoken.stands_for(contact, shapes)) contacts.push_back(contact);
    const std::size_t first_face = contacts.size();
    for (const FaceOverlap& overlap : patches.faces()) {
        const Vec3 normal = rotated(b.centred.rotation, patches.patches()[overlap.patch].normal);
        const double depth = overlap.volume / overlap.area;
        const ContactFeature feature{FeatureKind::faces, Side::a, shapes[0]->mesh.triangle_index[overlap.faces[0]],
                                     shapes[1]->mesh.triangle_index[overlap.faces[1]]};
        const Vec3 middle = transform_point(b.centred, overlap.middle);
        write_contact(contacts.emplace_back(), body_a, body_b, feature, middle + 0.5 * depth * normal, -1.0 * normal,
                      static_cast<float>(depth), static_cast<float>(depth), static_cast<float>(overlap.area));
    }
    const auto key = [](const Contact& c) { return c.key(); };
    std::stable_sort(contacts.begin() + static_cast<std::ptrdiff_t>(first_face), contacts.end(),
                     [&](const Contact& p, const Contact& q) { return key(p) < key(q); });
    join(contacts, first_face);
    std::inplace_merge(contacts.begin() + static_cast<std::ptrdiff_t>(first),
                       contacts.begin() + static_cast<std::ptrdiff_t>(first_face), contacts.end(),
                       [&](const Contact& p, const Contact& q) { return key(p) < key(q); });
}

} // namespace

void FaceContacts::run(Executor& executor, const Settings& settings, std::span<const PlacedBody> bodies,
                       std::vector<Contact>& contacts) {
    if (settings.direction != Direction::weighted || settings.features != Features::edges) return;
    const RowSlices rows{contacts.size(), 64};
    const auto belongs = [&](std::size_t i) { return pair_of(contacts[i]) == pair_of(contacts[i - 1]); };
    slices_.resize(rows.count());
    for (std::vector<Contact>& slice : slices_) slice.clear();
    rows.each(executor, belongs, [&](std::uint32_t s, std::size_t begin, std::size_t end) {
        OverlapPatches patches;
        for (std::size_t next = begin; begin < end; begin = next) {
            while (++next < end && belongs(next)) {
            }
            replace(patches, bodies, std::span<const Contact>(contacts).subspan(begin, next - begin), slices_[s]);
        }
    });
    contacts.clear();
    for (const std::vector<Contact>& slice : slices_) contacts.insert(contacts.end(), slice.begin(), slice.end());
}

void FaceContacts::trim() {
    free_all(slices_);
}

} // namespace raycontact
