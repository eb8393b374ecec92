// SPDX-License-Identifier: Apache-2.0
#include "contacts/reduce.h"

#include "contacts/refine.h"
#include "free_all.h"
#include "mesh/vector.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace raycontact {

namespace {

constexpr double one_place = 0.01; // of the smaller body's size

constexpr std::uint32_t not_chosen = std::numeric_limits<std::uint32_t>::max();

ManifoldPoint point_of(const Contact& contact, double place) {
    return {0.5 * (contact.point_a + contact.point_b), contact.normal, double(contact.depth),
            std::numeric_limits<double>::infinity(), place};
}

// The length of a ray tells where the other body is, whichever face of it the contact is refined to.
bool is_same(const Contact& a, const Contact& b, Direction direction) {
    const bool by_ray = direction == Direction::refined && a.feature.kind == FeatureKind::vertex;
    return order_of(a) == order_of(b) && a.body_a == b.body_a && a.body_b == b.body_b && a.ray_length == b.ray_length
           && a.weight == b.weight && a.point() == b.point()
           && (by_ray || (a.normal == b.normal && a.depth == b.depth));
}

// Whether the last step kept it. Of contacts in their order: `old` goes with them.
bool was_kept(const Contact& contact, std::span<const Contact>::iterator& old, std::span<const Contact> previous) {
    while (old != previous.end() && order_of(*old) < order_of(contact)) ++old;
    return old != previous.end() && order_of(*old) == order_of(contact);
}

// Refines contacts of a pair until the deepest is known, and those that have an advantage as they were kept before.
void find_deepest(const Refiner& refiner, std::span<const Contact> previous, std::span<Contact> contacts) {
    std::vector<std::pair<float, std::uint32_t>> most; // a heap, the deepest first
    float deepest = 0;
    auto old = previous.begin();
    for (std::uint32_t i = 0; i < contacts.size(); ++i) {
        Contact& contact = contacts[i];
        if (was_kept(contact, old, previous) && Refiner::awaits(contact)) refiner.refine(contact);
        if (Refiner::awaits(contact))
            most.emplace_back(static_cast<float>(refiner.most_depth(contact)), i);
        else
            deepest = std::max(deepest, contact.depth);
    }
    std::ranges::make_heap(most);
    std::size_t left = most.size();
    for (; left > 0 && most[0].first > deepest; --left) {
        std::ranges::pop_heap(std::span(most).first(left));
        Contact& contact = contacts[most[left - 1].second];
        refiner.refine(contact);
        deepest = std::max(deepest, contact.depth);
    }
}

// Gives a pair's contacts the choice of the last step, if they are what the pair had.
bool choose_as_before(const ContactReducer::Last& last, Direction direction, std::span<const Contact> contacts,
                      std::span<std::uint32_t> ranks) {
    if (!last.has_settings) return false;
    const SlotPair pair = pair_of(contacts.front());
    const std::span<const Contact> kept = last.kept.of(pair), left_out = last.left_out.of(pair);
    if (kept.size() + left_out.size() != contacts.size()) return false;
    auto stays = kept.begin();
    auto goes = left_out.begin();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const bool chosen = stays != kept.end() && is_same(*stays, contacts[i], direction);
        if (!chosen && (goes == left_out.end() || !is_same(*goes, contacts[i], direction))) return false;
        ++(chosen ? stays : goes);
        ranks[i] = chosen ? 0 : not_chosen;
    }
    return true;
}

} // namespace

void ContactReducer::rank(std::vector<ManifoldPoint>& points, std::span<const PlacedBody> bodies,
                          const ContactStore& last, std::span<const Contact> contacts,
                          std::span<std::uint32_t> ranks) const {
    const auto [a, b] = pair_of(contacts.front());
    const double place = one_place * smaller_size(bodies[a], bodies[b]);
    points.clear();
    const std::span<const Contact> previous = last.of({a, b});
    auto old = previous.begin();
    for (const Contact& contact : contacts) {
        ManifoldPoint& point = points.emplace_back(point_of(contact, place));
        point.present = was_kept(contact, old, previous);
    }
    std::ranges::fill(ranks, not_chosen);
    std::uint32_t rank = 0;
    for (const std::uint32_t i : choose_contacts(points, contacts.size())) ranks[i] = rank++;
}

// First ranks, then depths, then the order of the contacts say who stays.
void ContactReducer::keep_budget(std::uint64_t most, std::span<const Contact> contacts) {
    std::uint64_t room = most;
    rest_.clear();
    for (std::uint32_t i = 0; i < contacts.size(); ++i) {
        if (ranks_[i] == 0) room -= std::min<std::uint64_t>(room, 1);
        if (ranks_[i] != 0 && ranks_[i] != not_chosen) rest_.push_back(i);
    }
    if (rest_.size() <= room) return;
    const auto first_out = rest_.begin() + static_cast<std::ptrdiff_t>(room);
    std::ranges::nth_element(rest_, first_out, {},
                             [&](std::uint32_t i) { return std::tuple(ranks_[i], -contacts[i].depth, i); });
    std::for_each(first_out, rest_.end(), [&](std::uint32_t i) { ranks_[i] = not_chosen; });
}

void ContactReducer::run(Executor& executor, const Settings& settings, std::span<const PlacedBody> bodies,
                         const Last& last, std::vector<Contact>& contacts) {
    clear();
    if (settings.max_contacts_per_pair == 0 && settings.max_contacts == 0) return;
    ranks_.resize(contacts.size());
    const RowSlices rows{contacts.size(), 256};
    const auto belongs = [&](std::size_t i) { return pair_of(contacts[i]) == pair_of(contacts[i - 1]); };
    const std::uint32_t most_of_pair =
        settings.max_contacts_per_pair == 0 ? not_chosen : settings.max_contacts_per_pair;
    rows.each(executor, belongs, [&](std::uint32_t, std::size_t begin, std::size_t end) {
        std::vector<ManifoldPoint> points;
        for (std::size_t next = begin; begin < end; begin = next) {
            while (++next < end && belongs(next)) {
            }
            const std::span ranks(ranks_.begin() + std::ptrdiff_t(begin), next - begin);
            const auto own = std::span(contacts).subspan(begin, next - begin);
            if (settings.direction == Direction::refined) {
                const auto [a, b] = pair_of(own.front());
                find_deepest(Refiner(bodies[a], bodies[b]), last.kept.of({a, b}), own);
            }
            // A budget is shared out by ranks.
            if (settings.max_contacts == 0 && choose_as_before(last, settings.direction, own, ranks)) continue;
            rank(points, bodies, last.kept, own, ranks);
            for (std::uint32_t& one : ranks)
                if (one >= most_of_pair) one = not_chosen;
        }
    });
    if (settings.max_contacts != 0) keep_budget(settings.max_contacts, contacts);
    divide(executor, rows, contacts);
}

// Into those that stay, and those left out.
void ContactReducer::divide(Executor& executor, const RowSlices& rows, std::vector<Contact>& contacts) {
    const auto alone = [](std::size_t) { return false; };
    slices_.assign(rows.count(), {});
    rows.each(executor, alone, [&](std::uint32_t slice, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            ++(ranks_[i] != not_chosen ? slices_[slice].kept : slices_[slice].left_out);
        }
    });
    std::size_t kept = 0, left_out = 0;
    for (Slice& slice : slices_) {
        kept += std::exchange(slice.kept, kept);
        left_out += std::exchange(slice.left_out, left_out);
    }
    kept_.resize(kept);
    left_out_.resize(left_out);
    rows.each(executor, alone, [&](std::uint32_t s, std::size_t begin, std::size_t end) {
        Slice& slice = slices_[s];
        for (std::size_t i = begin; i < end; ++i)
            (ranks_[i] != not_chosen ? kept_[slice.kept++] : left_out_[slice.left_out++]) = contacts[i];
    });
    contacts.swap(kept_);
}

void ContactReducer::trim() {
    free_all(ranks_, rest_, slices_, kept_);
    left_out_.shrink_to_fit();
}

void ContactReducer::clear() {
    left_out_.clear();
}

} // namespace raycontact
