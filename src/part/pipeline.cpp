// SPDX-License-Identifier: Apache-2.0
#include "part/pipeline.h"

#include "device/launch.h"
#include "free_all.h"

#include <algorithm>
#include <array>
#include <functional>

namespace raycontact {

namespace {

enum class Finds : std::uint8_t { standard, certified, coherent };

// `certified` needs memory that host and device share; on other devices it runs `standard`.
Finds finds(const Settings& settings, const DeviceTraits& traits) {
    if (settings.method == Method::standard) return Finds::standard;
    if (settings.method != Method::certified) return Finds::coherent;
    return traits.shares_memory ? Finds::certified : Finds::standard;
}
Finds finds(const Update& update) {
    return finds(update.settings, update.device.traits());
}

} // namespace

Answers answers(const Settings& settings, const DeviceTraits& traits) {
    switch (finds(settings, traits)) {
    case Finds::standard:
        return Answers::all;
    case Finds::certified:
        return Answers::some;
    case Finds::coherent:
        return Answers::asked;
    }
    return Answers::all;
}

bool needs_motion(const Settings& settings, const DeviceTraits& traits) {
    return finds(settings, traits) != Finds::standard;
}

void Pipeline::forget() {
    standard_.clear();
    certified_.clear();
    coherent_.clear();
    pairs_.clear();
    batch_.sums = {};
    batch_.totals = {};
    margins_seen_ = 0;
}

void Pipeline::trim() {
    standard_.trim();
    certified_.trim();
    coherent_.trim();
    edges_ = NearRays(edges_.sources());
    points_ = NearRays(points_.sources());
    free_all(batch_, inside_, margins_, margins_seen_, device_margins_, found_, pairs_found_, local_, near_,
             near_points_, speculative_, asked_, asked_slices_);
}

// Turns hits into contacts in the targets' frames: counts them and writes them.
void Pipeline::gather(const Update& update) {
    const ShapeStore::Arrays& arrays = update.arrays();
    const Array<kernels::LocalContact>& contacts = found_.room(update.device);
    batch_.outcomes.scan(update.device, batch_.count, batch_.totals, RayBatch::contact_sum, contacts.size());
    launch<KernelId::write_contacts>(update.device, items_of(batch_.totals, RayBatch::contact_sum, batch_.count.most),
                                     *batch_.pairs, arrays.headers, arrays.memory, batch_.rays, batch_.hits,
                                     batch_.outcomes.firsts(), contacts);
}

// Waits for all launches, then reads the sums, the contacts and the near edges. False if the contacts had too little
// room: there is enough now, and they must be written again.
bool Pipeline::read(const Update& update) {
    Device& device = update.device;
    std::array<Piece, 8> pieces{batch_.totals.piece(batch_.sums), found_.piece(),
                                casts_edges_ ? edges_.found().piece() : Piece{},
                                casts_points_ ? points_.found().piece() : Piece{}};
    if (finds(update) == Finds::coherent) std::ranges::copy(coherent_.results(), pieces.begin() + 4);
    if (casts_edges_) pieces.back() = inside_.piece();
    device.queue().read(pieces);
    check_sums(batch_.sums);
    return found_.take(device, batch_.sums[RayBatch::contact_sum].sums[0]);
}

void Pipeline::begin(const Update& update) {
    switch (finds(update)) {
    case Finds::standard:
        standard_.begin(update, batch_);
        break;
    case Finds::certified:
        certified_.cast(update, batch_);
        break;
    case Finds::coherent:
        coherent_.begin(update, batch_);
        break;
    }
    gather(update);
    const bool host = finds(update) == Finds::certified;
    casts_edges_ = update.settings.features == Features::edges && !host;
    casts_points_ = update.settings.is_speculative() && !host;
    if ((casts_edges_ || casts_points_) && finds(update) == Finds::coherent) pairs_.place(update, casts_points_);
    if (casts_points_) set_margins(update);
    if (casts_edges_) cast_near(update, edges_);
    if (casts_edges_) find_inside(update);
    if (casts_points_) cast_near(update, points_);
}

// Of slots without a pair they mean nothing. What changes a margin makes all begin anew (forget).
void Pipeline::set_margins(const Update& update) {
    const std::size_t before = margins_.size();
    margins_.resize(2 * std::size_t{update.open.end()});
    bool changed = margins_.size() != before;
    update.open.changes().each_since(margins_seen_, update.open.end(), [&](std::uint32_t slot) {
        if (!update.open.is_open(slot)) return;
        const auto [a, b] = update.open[slot];
        const double margin = speculative_margin(update.settings, update.bodies[a], update.bodies[b]);
        margins_[2 * slot] = margins_[2 * slot + 1] = static_cast<float>(1.000001 * margin);
        changed = true;
    });
    if (changed) device_margins_.write(update.device, margins_);
}

void Pipeline::cast_near(const Update& update, NearRays& rays) {
    const DevicePairs& pairs = pairs_of(update);
    if (casts_points_)
        rays.cast(update, pairs.placed(), pairs.next_placed(), {device_margins_, {}, {}}, batch_);
    else
        rays.cast(update, pairs.placed(), {}, {{}, {}, {}}, batch_);
}

void Pipeline::find_inside(const Update& update) {
    inside_.find(update, pairs_of(update).placed(), batch_.totals, RayBatch::inside_sum);
}

// All, on the device.
const DevicePairs& Pipeline::pairs_of(const Update& update) const {
    return finds(update) == Finds::standard ? standard_.pairs() : pairs_;
}

bool Pipeline::all_rays_had_room(const Update& update) {
    switch (finds(update)) {
    case Finds::standard:
        return standard_.had_room(update.device, batch_);
    case Finds::certified: // makes as much room as it needs
        return true;
    case Finds::coherent:
        return coherent_.had_room(update.device, batch_);
    }
    return true;
}

void Pipeline::cast_again(const Update& update) {
    if (finds(update) == Finds::standard)
        standard_.cast(update, batch_);
    else
        coherent_.cast(update, batch_);
}

Update Pipeline::end(const Update& asked) {
    for (;;) {
        const bool all_written = read(asked);
        const bool all_cast = all_rays_had_room(asked);
        const bool all_edges = !casts_edges_ || edges_.had_room(asked.device, batch_);
        const bool all_points = !casts_points_ || points_.had_room(asked.device, batch_);
        const bool all_inside = !casts_edges_ || inside_.take(asked.device, batch_.sums[RayBatch::inside_sum]);
        if (all_written && all_cast && all_edges && all_points && all_inside) break;
        if (!all_cast) cast_again(asked);
        gather(asked);
        if (!all_edges) cast_near(asked, edges_);
        if (!all_points) cast_near(asked, points_);
        if (!all_inside) find_inside(asked);
    }
    if (finds(asked) == Finds::coherent) coherent_.keep(batch_);
    const Update update = list_pairs(asked);
    const bool rays_by_slot = finds(update) == Finds::standard;
    const auto by_slot = [&](std::uint32_t i) { return pairs_found_.directed(i); };
    const auto directed = [&](std::uint32_t i) { return rays_by_slot ? by_slot(i) : batch_.directed[i]; };
    local_.set(update.executor, found_.values(), directed, update.pairs.size());
    find_speculative(update);
    if (casts_edges_) {
        near_.set(update.executor, edges_.found().values(), by_slot, update.pairs.size());
        inside_.mark(by_slot, update.pairs.size());
    }
    if (update.settings.features == Features::edges && !casts_edges_) certified_.find_edges(update, local_, batch_);
    list_asked(update);
    return update;
}

// A device answers for all pairs: of most of them it finds nothing.
Update Pipeline::list_pairs(const Update& asked) {
    if (finds(asked) != Finds::standard) {
        if (casts_edges_ || casts_points_) pairs_found_.set_places(asked.executor, asked.open, asked.slots);
        return asked;
    }
    const auto directed = [](const auto& found) { return found.pair; };
    pairs_found_.clear();
    pairs_found_.add(asked.executor, asked.open, found_.values(), directed);
    if (casts_points_) pairs_found_.add(asked.executor, asked.open, points_.found().values(), directed);
    if (casts_edges_) {
        pairs_found_.add(asked.executor, asked.open, edges_.found().values(), directed);
        pairs_found_.add(asked.executor, asked.open, inside_.found(), std::identity());
    }
    pairs_found_.list(asked.executor, asked.open, asked.bodies.size());
    return asked.about(pairs_found_.pairs());
}

// Of the vertices: those of edges wait for what vertices tell.
void Pipeline::find_speculative(const Update& update) {
    asked_.clear();
    if (!update.settings.is_speculative()) return speculative_.clear();
    if (casts_points_)
        near_points_.set(
            update.executor, points_.found().values(), [&](std::uint32_t i) { return pairs_found_.directed(i); },
            update.pairs.size());
    else
        certified_.find_points(update, batch_);
    list(update, [&](std::uint32_t i, std::vector<AskedPair>& asked) {
        if (!casts_points_ && certified_.has_points(i)) asked.push_back({i, false, certified_.points(i)});
        if (!casts_points_ || near_points_.first(2 * i) == near_points_.first(2 * i + 2)) return;
        asked.push_back({i, false, {near_points_.of(2 * i), near_points_.of(2 * i + 1)}});
    });
    speculative_.run(update, local_, asked_);
}

void Pipeline::list_asked(const Update& update) {
    asked_.clear();
    if (!update.asks_near()) return;
    const bool edges = update.settings.features == Features::edges;
    list(update, [&](std::uint32_t i, std::vector<AskedPair>& list) {
        const bool in_contact = local_.first(2 * i) != local_.first(2 * i + 2);
        const bool comes_near = !speculative_.of(i).empty();
        const bool apart = edges && !casts_edges_ && certified_.is_apart(i) && !in_contact;
        if (!comes_near && (!edges || apart)) return;
        const auto [first, second] = update.pairs[i];
        const PlacedBody &a = update.bodies[first], &b = update.bodies[second];
        AskedPair asked{i, false, {}};
        if (edges && !apart && !(in_contact && !hides_more(a, b, least_hidden))) {
            asked.near = casts_edges_ ? std::array{near_.of(2 * i), near_.of(2 * i + 1)} : certified_.near(i);
            if (!casts_edges_) asked.apart = certified_.apart(i);
            // Without edges a pair has nothing more to tell, but that one body is inside the other.
            const bool may_be_inside = !in_contact && (!casts_edges_ || inside_.has(i));
            asked.edges = may_be_inside || !asked.near[0].empty() || !asked.near[1].empty();
        }
        if (asked.edges || comes_near) list.push_back(asked);
    });
}

// What ask(i, list) adds for the pairs, in their order, on all threads.
template <class Ask>
void Pipeline::list(const Update& update, Ask&& ask) {
    constexpr std::size_t at_once = 1024;
    const std::size_t pairs = update.pairs.size(), slices = (pairs + at_once - 1) / at_once;
    if (asked_slices_.size() < slices) asked_slices_.resize(slices);
    const auto find = [&](std::uint32_t s, std::vector<AskedPair>& found) {
        for (std::size_t i = s * at_once; i < std::min(pairs, (s + 1) * at_once); ++i)
            ask(static_cast<std::uint32_t>(i), found);
    };
    if (slices == 1) return find(0, asked_);
    update.executor.each(slices, 1, [&](std::uint32_t s) {
        asked_slices_[s].clear();
        find(s, asked_slices_[s]);
    });
    for (const auto& found : std::span(asked_slices_).first(slices))
        asked_.insert(asked_.end(), found.begin(), found.end());
}

std::vector<std::byte> Pipeline::export_state(const Update& last, const PairList& pairs) {
    if (finds(last) != Finds::coherent) return {};
    return coherent_.export_state(last.device, last.open, pairs);
}

void Pipeline::import_state(const Update& last, const PairList& pairs, std::span<const std::byte> bytes) {
    if (!bytes.empty()) coherent_.import_state(last.device, pairs, bytes);
}

void Pipeline::list_kept_rays(const Update& last, std::vector<KeptRay>& rays) {
    if (finds(last) == Finds::coherent) coherent_.list_kept_rays(last.device, last.bodies, last.open, rays);
}

void Pipeline::count(const Update& last, StepStats& stats) const {
    stats.details.side_tests += batch_.sums[RayBatch::contact_sum].sums[1];
    stats.details.rays_cast += batch_.sums[RayBatch::contact_sum].sums[2];
    stats.pair_bytes += asked_.size() * sizeof(AskedPair);
    if (casts_edges_) stats.pair_bytes += edges_.bytes() + near_.all().size_bytes() + inside_.bytes();
    if (casts_points_) stats.pair_bytes += points_.bytes() + near_points_.all().size_bytes();
    switch (finds(last)) {
    case Finds::standard:
        return standard_.count(batch_, stats);
    case Finds::certified:
        return certified_.count(batch_, stats);
    case Finds::coherent:
        return coherent_.count(stats);
    }
}

} // namespace raycontact
