// SPDX-License-Identifier: Apache-2.0
#include "contacts/round_pairs.h"

#include "contacts/contact_order.h"
#include "contacts/write_contact.h"
#include "executor/row_slices.h"
#include "free_all.h"
#include "round/two_rounds.h"

#include <algorithm>
#include <numbers>
#include <optional>

namespace raycontact {

namespace {

/// Contacts of one round body after the other.
class Meetings {
public:
    Meetings(const Settings& settings, std::span<const PlacedBody> bodies, std::vector<Contact>& out)
        : settings_(settings), bodies_(bodies), out_(out) {}

    /// others: of one body's pairs. Meshes are one surface, but for sensors, through which it goes.
    void find(BodySlot round, std::span<const BodySlot> others) {
        solid_.clear();
        for (const BodySlot other : others) {
            if (bodies_[other].shape->round() != nullptr)
                find_round(round, other);
            else if (bodies_[other].is_sensor)
                find_meshes(round, {&other, 1});
            else
                solid_.push_back(other);
        }
        if (!solid_.empty()) find_meshes(round, solid_);
    }

private:
    bool ahead() const { return settings_.is_speculative(); }
    Pose next_of(const PlacedBody& body) const {
        if (same_bits(body.centred, body.next)) return body.pose;
        const Pose& next = body.next;
        return {next.rotation, next.translation - rotated(next.rotation, body.shape->centre())};
    }
    double margin(BodySlot a, BodySlot b) const { return speculative_margin(settings_, bodies_[a], bodies_[b]); }
    /// What counts as flush, however wide the margin is: a higher step is a wall.
    double flush(BodySlot a, BodySlot b) const { return speculative_share * smaller_size(bodies_[a], bodies_[b]); }

    void find_round(BodySlot first, BodySlot second) {
        const auto [a, b] = std::minmax(first, second);
        const auto moving = [&](const PlacedBody& body) {
            return MovingRound{*body.shape->round(), body.pose, ahead() ? std::optional(next_of(body)) : std::nullopt};
        };
        two_round_contacts(moving(bodies_[a]), moving(bodies_[b]), ahead() ? margin(a, b) : 0, contacts_);
        for (const RoundContact& c : contacts_) add(a, b, c, ContactFeature::no_index);
    }

    void find_meshes(BodySlot slot, std::span<const BodySlot> others) {
        const PlacedBody& body = bodies_[slot];
        double reach = 0;
        obstacles_.clear();
        for (const BodySlot other : others) {
            const PlacedBody& mesh = bodies_[other];
            reach = std::max(reach, margin(slot, other));
            obstacles_.push_back({Facets(*mesh.shape), mesh.pose, ahead() ? next_of(mesh) : mesh.pose,
                                  !mesh.shape->has_inside(), flush(slot, other)});
        }
        round_contacts(*body.shape->round(), body.pose, ahead() ? std::optional(next_of(body)) : std::nullopt,
                       obstacles_, ahead() ? reach : 0, contacts_);
        for (const RoundContact& c : contacts_)
            if (c.is_later || c.distance <= margin(slot, others[c.obstacle]))
                add(slot, others[c.obstacle], c, c.triangle);
    }

    /// Of two round bodies the first is the source.
    void add(BodySlot round, BodySlot other, const RoundContact& found, std::uint32_t index) {
        const auto depth = static_cast<float>(-found.distance);
        if (!ahead() && !(depth > 0)) return;
        const bool is_a = round < other;
        const auto place = static_cast<std::uint32_t>(found.place);
        const ContactFeature feature{FeatureKind::round, is_a ? Side::a : Side::b, is_a ? place : index,
                                     is_a ? index : place};
        const auto [a, b] = std::minmax(round, other);
        write_contact(out_.emplace_back(), id_in(bodies_, a), id_in(bodies_, b), feature,
                      found.point + found.distance * found.normal, found.normal, depth, std::fabs(depth),
                      weight(*bodies_[round].shape->round(), bodies_[other].shape->round(), double(depth)));
        out_.back().is_new = false; // nothing is to be refined
    }

    float weight(const Round& round, const Round* other, double depth) const {
        if (settings_.direction != Direction::weighted) return 1;
        const double radius = other != nullptr ? std::min(round.radius, other->radius) : round.radius,
                     in = std::clamp(depth, 0.0, radius);
        return static_cast<float>(std::numbers::pi * in * (2 * radius - in));
    }

    const Settings& settings_;
    std::span<const PlacedBody> bodies_;
    std::vector<Contact>& out_;
    std::vector<BodySlot> solid_;
    std::vector<Obstacle> obstacles_;
    std::vector<RoundContact> contacts_;
};

} // namespace

void RoundPairs::list(Executor& executor, std::span<const PlacedBody> bodies, OpenPairs& pairs, PairList* few) {
    rounds_.clear();
    is_asked_.assign(bodies.size(), 0);
    const auto is_there = [&](BodySlot slot) { return slot < bodies.size() && bodies[slot].shape != nullptr; };
    const auto add = [&](BodySlot slot) {
        if (is_there(slot) && bodies[slot].shape->round() != nullptr && std::exchange(is_asked_[slot], 1) == 0)
            rounds_.push_back(slot);
    };
    if (few == nullptr) {
        for (BodySlot slot = 0; slot < bodies.size(); ++slot) add(slot);
        return pairs.list_of(executor, rounds_, is_asked_, pairs_);
    }
    // Two round bodies have nothing to do with what else either meets.
    const auto add_round = [&](const SlotPair& pair) {
        const auto [a, b] = pair;
        if (is_there(a) && is_there(b) && bodies[a].shape->round() != nullptr && bodies[b].shape->round() != nullptr)
            return;
        add(a), add(b);
    };
    std::ranges::for_each(few->pairs, add_round);
    std::ranges::for_each(pairs.closed(), add_round);
    pairs.list_of(executor, rounds_, is_asked_, of_rounds_);
    PairList all;
    pairs_.resize(0);
    for (std::size_t i = 0, k = 0; i < few->size() || k < of_rounds_.size();) {
        const bool is_own = k == of_rounds_.size() || (i < few->size() && few->pairs[i] <= of_rounds_.pairs[k]);
        const PairList& from = is_own ? *few : of_rounds_;
        const std::size_t at = is_own ? i++ : k++;
        if (all.size() > 0 && all.pairs.back() == from.pairs[at]) continue;
        all.add({from.pairs[at], from.slots[at]});
        if (is_round(bodies, from.pairs[at])) pairs_.add({from.pairs[at], from.slots[at]});
    }
    *few = std::move(all);
}

void RoundPairs::run(Executor& executor, const Settings& settings, std::span<const PlacedBody> bodies,
                     std::vector<Contact>& contacts) {
    if (pairs_.size() == 0) return;
    meetings_.clear();
    for (const auto& [a, b] : pairs_.pairs) {
        const bool a_is_round = bodies[a].shape->round() != nullptr;
        meetings_.push_back(a_is_round ? Meeting{a, b} : Meeting{b, a});
    }
    std::ranges::sort(meetings_);
    const RowSlices rows{meetings_.size(), 16};
    if (slices_.size() < rows.count()) slices_.resize(rows.count());
    for (std::vector<Contact>& slice : slices_) slice.clear();
    const auto belongs = [&](std::size_t i) { return meetings_[i].round == meetings_[i - 1].round; };
    rows.each(executor, belongs, [&](std::uint32_t s, std::size_t begin, std::size_t end) {
        Meetings finder(settings, bodies, slices_[s]);
        std::vector<BodySlot> others;
        while (begin < end) {
            const BodySlot round = meetings_[begin].round;
            others.clear();
            for (; begin < end && meetings_[begin].round == round; ++begin) others.push_back(meetings_[begin].other);
            finder.find(round, others);
        }
    });
    found_.clear();
    for (const std::vector<Contact>& slice : slices_) found_.insert(found_.end(), slice.begin(), slice.end());
    const auto before = [](const Contact& a, const Contact& b) { return order_of(a) < order_of(b); };
    std::ranges::sort(found_, before);
    const auto first = static_cast<std::ptrdiff_t>(contacts.size());
    contacts.insert(contacts.end(), found_.begin(), found_.end());
    std::inplace_merge(contacts.begin(), contacts.begin() + first, contacts.end(), before);
}

void RoundPairs::trim() {
    free_all(rounds_, is_asked_, pairs_, of_rounds_, meetings_, slices_, found_);
}

} // namespace raycontact
