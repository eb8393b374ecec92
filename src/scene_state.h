// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "body_slots.h"
#include "contacts/column_writer.h"
#include "contacts/touches.h"
#include "free_all.h"
#include "interruption.h"
#include "narrow_phase.h"
#include "next_poses.h"
#include "pair_finder.h"
#include "platform/system.h"
#include "pose_fault.h"
#include "saved_scene.h"
#include "shape/preparer.h"
#include "shape/shape_data.h"
#include "slot_changes.h"

#include <raycontact/error.h>
#include <raycontact/scene.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace raycontact {

// Names the generation only if it is not 0: before a slot is reused, users need not know of generations.
inline std::string name_of(BodyId body) {
    const std::string name = "body " + std::to_string(body.slot);
    return body.generation == 0 ? name : name + " (generation " + std::to_string(body.generation) + ")";
}

inline void refuse_faulty(const Pose& pose, BodyId body) {
    if (const char* fault = pose_fault(pose)) throw InputError(name_of(body) + ": " + fault);
}

// Their walks begin where a full test found something, and what a test finds depends on the grids.
inline bool follows_rays(Method method) {
    return method == Method::iterative || method == Method::predictive;
}

/// What a scene has, and its steps; Scene checks what it is given.
struct Scene::State {
    explicit State(const Settings& settings) : narrow(settings), preparer(settings.execution.threads) {}

    /// where: the function that was called, for the message.
    PlacedBody& existing(BodyId body, const char* where) {
        if (!slots.is_there(body)) refuse_missing(body, where);
        return bodies[body.slot];
    }

    [[noreturn]] void refuse_missing(BodyId body, const char* where) const {
        const BodySlot slot = body.slot;
        if (!body.valid()) throw InputError(std::string(where) + ": this id is empty; add() gives those of bodies");
        std::string text = std::string(where) + ": body " + std::to_string(slot) + " (generation "
                           + std::to_string(body.generation) + ") ";
        if (!slots.was_given(body)) throw InputError(text + "is not in the scene; add() gives the ids that are");
        text += "was removed";
        if (slots.is_taken(slot)) text += ", and its slot has " + name_of(slots.id_in(slot)) + " now";
        throw InputError(text + "; forget its id, or add it again and use the id that add() gives");
    }

    void set_pose(PlacedBody& body, BodySlot slot, const Pose& pose) {
        if (same_bits(body.pose, pose)) return;
        body.pose = pose;
        mark(slot);
    }

    /// Wakes the threads, which sleep between steps; for few pairs one thread is enough.
    void call_threads(std::size_t pair_count) {
        if (pair_count > 256) narrow.wake();
    }

    void set_filter(BodySlot slot, const BroadPhaseInput::Filter& filter) {
        if (finder.filter(slot) == filter) return;
        finder.set_filter(slot, filter);
        stepped = 0; // touches may end though no pair closes
    }

    void set_sensor(PlacedBody& body, bool is_sensor) {
        if (std::exchange(body.is_sensor, is_sensor) == is_sensor) return;
        narrow.set_sensor_count(sensors += is_sensor ? 1 : -1);
    }

    void count_round(const Shape& shape, int by) {
        if (shape.round() != nullptr) narrow.set_round_count(rounds += std::size_t(by));
    }

    void mark(BodySlot slot) noexcept {
        moved.mark(slot);
        finder.mark(slot);
    }
    void forget_moves() noexcept {
        moved.forget();
        finder.forget();
    }

    void pack_shapes() {
        if (!narrow.parts().pack_shapes()) return;
        for (PlacedBody& body : bodies)
            if (body.shape != nullptr) body.shape_index = narrow.parts().index_of(body.shape);
        forget_moves(); // whatever is kept of a body names its shape by that
    }

    void place_bodies() {
        pack_shapes();
        accelerate_shapes();
        moved.each_since(placed, narrow.parts().executor(), bodies.size(), [&](BodySlot i) {
            PlacedBody& body = bodies[i];
            if (body.shape == nullptr) return;
            body.centred = centred_pose(*body.shape, body.pose);
            if (!next.empty()) body.next = centred_pose(*body.shape, next[i]);
        });
    }

    // All shapes must be the same each time a run repeats, where contacts depend on what follows rays.
    void accelerate_shapes() {
        if (narrow.parts().plain_shapes() == 0) return;
        if (follows_rays(narrow.settings().method)) prepare_shapes();
        narrow.parts().accelerate_shapes();
    }

    void prepare_shapes() {
        for (const PlacedBody& body : bodies)
            if (body.shape != nullptr) body.shape->prepare(narrow.settings().execution.threads);
    }

    // Once a shape has met others in one step, more steps are likely to come in the next; not so where no pair is there
    // again, as in a search of pairs that are asked about once. Without memory or threads for it, they come without.
    void want_shapes() {
        if (narrow.parts().plain_shapes() == 0) return met_shapes.clear();
        const bool returns = pairs.count_kept() > 0;
        try {
            for (auto met = met_shapes.begin(); met != met_shapes.end();) {
                auto& [weak, wanted] = *met;
                const std::shared_ptr<const Shape> shape = weak.lock();
                if (!shape || (!wanted && !returns)) {
                    met = met_shapes.erase(met);
                    continue;
                }
                if (!wanted) preparer.want(shape);
                wanted = true;
                ++met;
            }
            for (const std::uint32_t pair : pairs.slots().changes().list()) {
                if (!pairs.slots().is_open(pair)) continue;
                const auto [a, b] = pairs.slots()[pair];
                for (const BodySlot slot : {a, b})
                    if (!bodies[slot].shape->is_prepared() && bodies[slot].shape->round() == nullptr)
                        met_shapes.try_emplace(bodies[slot].shape->weak_from_this(), false);
            }
        } catch (const std::exception&) {
        }
    }

    const WorldBoxes& up_to_date_boxes() {
        const std::lock_guard lock(refreshing);
        return finder.boxes(narrow, bodies, next);
    }

    /// The open pairs by id, as they are asked for.
    std::span<const Pair> name_pairs() {
        const std::lock_guard lock(refreshing);
        Executor& executor = narrow.parts().executor();
        const std::vector<SlotPair>& all = pairs.all(executor).pairs;
        if (!names_stand) named.resize(all.size());
        if (!names_stand)
            executor.each(all.size(), 4096, [&](std::uint32_t i) {
                named[i] = {slots.id_in(all[i].first), slots.id_in(all[i].second)};
            });
        names_stand = true;
        return named;
    }

    void check_pair(const Pair& pair, std::size_t i) const {
        for (const BodyId body : {pair.first, pair.second})
            if (!slots.is_there(body))
                refuse_missing(body, ("Scene::find_contacts, pair " + std::to_string(i)).c_str());
        if (pair.first == pair.second)
            throw InputError("Scene::find_contacts, pair " + std::to_string(i) + ": " + name_of(pair.first)
                             + " is paired with itself; pairs need two bodies");
    }

    // given: in any order, the two bodies of a pair either way round, duplicates allowed. False: those that are open.
    bool read_pairs(std::span<const Pair> given) {
        if (given_stand && std::ranges::equal(given, last_given)) return false;
        Executor& executor = narrow.parts().executor();
        std::atomic<bool> faulty = false;
        given_pairs.resize(given.size());
        executor.each(given.size(), 4096, [&](std::uint32_t i) {
            const auto& [a, b] = given[i];
            if (a == b || !slots.is_there(a) || !slots.is_there(b)) faulty = true;
            given_pairs[i] = std::minmax(a.slot, b.slot);
        });
        for (std::size_t i = 0; faulty && i < given.size(); ++i) check_pair(given[i], i);
        if (!std::ranges::is_sorted(given_pairs)) {
            sorter.run(executor, bodies.size(), given_pairs, sorted);
            given_pairs.swap(sorted);
        }
        given_pairs.erase(std::unique(given_pairs.begin(), given_pairs.end()), given_pairs.end());
        given_stand = false; // until set_pairs()
        last_given.assign(given.begin(), given.end());
        return true;
    }

    void set_pairs() {
        finder.drop_list();
        pairs.set_all(narrow.parts().executor(), given_pairs, true);
        given_stand = true;
    }

    /// A step that has begun and throws has no contacts.
    template <typename FindPairs>
    void all_or_nothing(FindPairs&& find_pairs) {
        narrow.prepare();
        try {
            look_ahead();
            const double broad_ms = find_pairs();
            if (pairs.compact(narrow.parts().executor())) moved.forget();
            if (pairs.have_changed()) names_stand = false;
            if (rests()) return rest(broad_ms);
            call_threads(pairs.slots().count());
            find_contacts(broad_ms);
        } catch (...) {
            const Interruptible to_its_end(nullptr);
            narrow.begin_anew();
            finder.trim();
            touches.rest();
            drop_pairs();
            throw;
        }
    }

    /// All begins anew.
    void drop_pairs() noexcept {
        forget_moves();
        pairs.clear();
        finder.drop_list();
        given_stand = names_stand = false;
    }

    /// Before the broad phase.
    void look_ahead() {
        next = {};
        if (!narrow.settings().is_speculative()) return;
        next = next_poses.update(narrow.parts().executor(), bodies, moved);
        for (const BodySlot slot : moved.list()) finder.mark(slot);
    }

    void end_step() {
        if (!next.empty()) next_poses.step_done(narrow.parts().executor(), bodies);
        slots.step_done();
    }

    /// Where nothing has changed since the last step, a method whose contacts follow from the poses finds what it
    /// found, but for what a device that was lost has to say.
    bool rests() {
        return moved.is_next(stepped) && moved.list().empty() && !pairs.have_changed()
               && !follows_rays(narrow.settings().method) && !narrow.parts().has_news();
    }

    void rest(double broad_ms) {
        const Interruptible to_its_end(nullptr);
        narrow.rest(stats);
        touches.rest();
        stats.broad_ms = broad_ms;
        end_step();
    }

    void find_contacts(double broad_ms) {
        place_bodies();
        narrow.step(bodies, moved, pairs, stats, broad_ms);
        const Interruptible to_its_end(nullptr); // it has contacts
        update_touches();
        end_step();
        stepped = moved.step_done();
        want_shapes();
        pairs.step_done();
        cut_to_slots();
        if (narrow.trimmed()) trim();
    }

    void update_touches() {
        const auto is_kept_apart = [&](const SlotPair& pair) {
            const bool meet = finder.filter(pair.first).lets_touch(finder.filter(pair.second));
            return !given_stand && (!meet || pairs.is_refused(pair));
        };
        touches.update(narrow.parts().executor(),
                       {bodies, next, moved, narrow.contacts(), narrow.sensed(), narrow.asked(pairs), is_kept_apart});
        stats.pair_bytes += touches.bytes();
    }

    std::vector<std::shared_ptr<const Shape>> list_shapes() const {
        std::vector<std::shared_ptr<const Shape>> list;
        std::unordered_set<const Shape*> listed;
        for (const PlacedBody& body : bodies)
            if (body.shape != nullptr && listed.insert(body.shape).second)
                list.push_back(body.shape->shared_from_this());
        return list;
    }

    SavedScene save(std::span<const std::shared_ptr<const Shape>> shapes) {
        SavedScene saved;
        std::unordered_map<const Shape*, std::uint32_t> places;
        for (const auto& shape : shapes) places.emplace(shape.get(), static_cast<std::uint32_t>(places.size()));
        for (BodySlot slot = 0; slot < bodies.size(); ++slot) {
            const PlacedBody& body = bodies[slot];
            if (body.shape == nullptr) continue;
            const BroadPhaseInput::Filter& filter = finder.filter(slot);
            saved.bodies.push_back({slot, places.at(body.shape), body.pose, body.centred, body.margin, user_data[slot],
                                    filter.groups, filter.mask, filter.is_static, body.is_sensor});
        }
        saved.slots = slots;
        saved.next_poses = next_poses;
        saved.pairs = pairs.all(narrow.parts().executor()).pairs;
        saved.contacts = narrow.save_contacts(moved);
        saved.touches.assign(touches.all().begin(), touches.all().end());
        saved.places.assign(touches.places().begin(), touches.places().end());
        if (follows_rays(narrow.settings().method)) saved.rays = narrow.save_rays(bodies);
        return saved;
    }

    /// Of a scene without bodies.
    void load(const SavedScene& saved, std::span<const std::shared_ptr<const Shape>> shapes) {
        BodySlots taken = saved.slots;
        const std::size_t room = taken.end();
        bodies.assign(room, {});
        user_data.assign(room, 0);
        moved.make_room(room);
        finder.make_room(room);
        for (const SavedBody& body : saved.bodies) {
            const std::shared_ptr<const Shape>& shape = shapes[body.shape];
            narrow.parts().add_shape(shape);
            finder.add_shape(*shape);
            PlacedBody& own = bodies[body.slot];
            own = {shape.get(),
                   narrow.parts().index_of(shape.get()),
                   taken.id_in(body.slot).generation,
                   body.pose,
                   body.centred,
                   body.centred,
                   body.margin};
            count_round(*shape, 1);
            set_sensor(own, body.is_sensor != 0);
            user_data[body.slot] = body.user_data;
            finder.set_filter(body.slot, {body.groups, body.mask, body.is_static != 0});
        }
        pack_shapes();
        if (follows_rays(narrow.settings().method)) accelerate_shapes();
        next_poses = saved.next_poses;
        pairs.set_all(narrow.parts().executor(), saved.pairs, true);
        narrow.load(bodies, moved, pairs, saved.contacts, saved.rays);
        touches.restore(saved.touches, saved.places);
        forget_moves();
        slots = std::move(taken);
    }
    /// After a load() that failed, which has given no ids.
    void drop_loaded() noexcept {
        for (BodySlot slot = 0; slot < bodies.size(); ++slot) {
            PlacedBody& body = bodies[slot];
            if (body.shape == nullptr) continue;
            finder.remove_body(slot, *body.shape);
            narrow.parts().remove_shape(body.shape);
            body = {};
        }
        narrow.set_sensor_count(sensors = 0);
        narrow.set_round_count(rounds = 0);
        next_poses.forget();
        narrow.begin_anew();
        touches.restore({}, {});
        drop_pairs();
    }

    void trim() {
        finder.trim();
        pairs.trim();
        touches.trim();
        last_given.shrink_to_fit();
        free_all(given_pairs, sorted, sorter, columns);
        platform::trim_heap(); // the allocator keeps what was freed in small pieces
    }

    // Frees memory once less than a quarter of it is in use.
    void cut_to_slots() {
        if (slots.end() >= bodies.size()) return;
        bodies.resize(slots.end());
        user_data.resize(slots.end());
        if (bodies.capacity() <= 4 * bodies.size() + 1024) return;
        bodies.shrink_to_fit();
        user_data.shrink_to_fit();
        moved.cut(slots.end());
        finder.cut(slots.end());
    }

    NarrowPhase narrow;
    BodySlots slots;
    std::vector<PlacedBody> bodies;       ///< by slot; without a shape once removed
    std::vector<std::uint64_t> user_data; ///< by slot
    SlotChanges moved;
    SlotChanges::Seen stepped = 0; ///< the last step that found contacts
    SlotChanges::Seen placed = 0;  ///< what place_bodies() has seen
    NextPoses next_poses;
    std::span<const Pose> next; ///< of the last step; empty without speculative contacts
    PairFinder finder;
    OpenPairs pairs;
    std::mutex refreshing;   ///< what is brought up to date between two steps, by several threads at once
    std::vector<Pair> named; ///< by id, if names_stand
    bool names_stand = false;
    std::vector<Pair> last_given; ///< of read_pairs()
    bool given_stand = false;     ///< those are open, and no body of theirs has been removed
    std::vector<SlotPair> given_pairs, sorted;
    PairSorter<SlotPair> sorter;
    ContactColumnWriter columns;
    Touches touches;
    std::size_t sensors = 0; ///< bodies
    std::size_t rounds = 0;  ///< likewise
    StepStats stats;
    std::map<std::weak_ptr<const Shape>, bool, std::owner_less<>> met_shapes; ///< not prepared; whether it is wanted
    Preparer preparer;                                                        ///< last: it ends first
};

} // namespace raycontact
