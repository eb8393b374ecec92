// SPDX-License-Identifier: Apache-2.0
#include "narrow_phase.h"

#include "contacts/refine.h"
#include "device/device.h"
#include "executor/row_slices.h"
#include "free_all.h"
#include "interruption.h"
#include "schedule/moving_pairs.h"

#include <algorithm>
#include <chrono>
#include <exception>
#include <iterator>
#include <string>
#include <tuple>
#include <utility>

namespace raycontact {

namespace {

using Clock = std::chrono::steady_clock;
double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

// Until a unit of load has been measured on each device: its cores stand for its speed.
std::vector<double> costs_of(Parts& parts) {
    std::vector<double> costs;
    for (std::size_t i = 0; i < parts.size(); ++i) costs.push_back(1.0 / std::max(1u, parts[i].device().cores));
    return costs;
}

} // namespace

NarrowPhase::NarrowPhase(const Settings& settings)
    : NarrowPhase(settings, open_devices(settings), gpu_opener(settings)) {}

NarrowPhase::NarrowPhase(const Settings& settings, std::vector<OpenDevice> opened, Opener open_other)
    : settings_(settings), parts_(std::move(opened)), balance_(settings.execution.schedule, costs_of(parts_)),
      assignment_(parts_.size()), open_other_(std::move(open_other)), found_(parts_.size()) {
    if (!open_other_) return;
    choice_.emplace();
    balance_.choose(in_use_);
    if (settings.execution.schedule == Schedule::counted)
        choice_->exclude(1, "schedule counted goes by no clock, so nothing is measured");
}

void NarrowPhase::set_settings(const Settings& settings) {
    const auto cost = [](const Settings& s) {
        return std::tuple(s.method, s.features, s.is_speculative(), s.speculative_margin, s.paper);
    };
    if (choice_ && cost(settings) != cost(settings_)) choice_->forget();
    settings_ = settings;
    parts_.forget();
    seen_ = 0;
    forget_loaded();
}

std::string NarrowPhase::device_choice() const {
    if (choice_) return choice_->text({parts_.device(0), parts_.size() > 1 ? parts_.device(1) : "a GPU"});
    std::string text;
    for (std::size_t i = 0; i < parts_.size(); ++i) text += (i > 0 ? "," : "") + parts_.device(i);
    return text + ": as given";
}

void NarrowPhase::wake() {
    if (!choice_) return parts_.wake();
    parts_.executor().wake();
    if (parts_.has(in_use_)) parts_[in_use_].executor().wake();
}

void NarrowPhase::begin_anew() noexcept {
    parts_.forget(); // what they kept may be wrong, and slots may get other bodies before the next step
    assignment_.forget();
    forget_contacts();
}

void NarrowPhase::forget_contacts() noexcept {
    contacts_.clear();
    left_out_.clear();
    sensed_.clear();
    seen_ = 0;
    forget_loaded();
}

// Where most bodies move, hardly a pair has what it had. A number of contacts that all pairs share is given to all
// anew.
bool NarrowPhase::asks_few(const SlotChanges& moved, std::size_t bodies) {
    if (!moved.is_next(seen_) || moved.list().size() >= bodies / 4 || settings_.max_contacts != 0) return false;
    for (std::size_t i = 0; i < parts_.size(); ++i)
        if (has_pairs(i) && parts_[i].answers(settings_) != Answers::some) return false;
    return true;
}

const PairList& NarrowPhase::list_asked(std::span<const PlacedBody> bodies, const SlotChanges& moved,
                                        OpenPairs& pairs) {
    Executor& executor = parts_.executor();
    asked_.resize(0);
    if (few_) pairs.list_of(executor, moved, asked_);
    round_pairs_.clear();
    if (round_count_ > 0) round_pairs_.list(executor, bodies, pairs, few_ ? &asked_ : nullptr);
    bool lists = false;
    for (std::size_t i = 0; i < parts_.size(); ++i)
        if (has_pairs(i) && parts_[i].answers(settings_) != Answers::all) lists = true;
    return !few_ && lists ? pairs.all(executor) : asked_;
}

void NarrowPhase::step(std::span<const PlacedBody> bodies, const SlotChanges& moved, OpenPairs& pairs, StepStats& stats,
                       double broad_ms) {
    const auto start = Clock::now();
    std::vector<DeviceWork> work = std::move(stats.details.work); // to reuse its memory
    stats = {};
    stats.details.work = std::move(work);
    stats.broad_ms = broad_ms;
    prepare();
    try {
        assignment_.assign(pairs, bodies, round_count_ > 0, balance_);
        if (const auto lost = parts_.take_lost(); !lost.empty()) give_away(lost, stats);
        if (choice_) choose_device(bodies, stats);
        for (std::size_t i = 0; i + 1 < parts_.size(); ++i) {
            const auto move = balance_.next_move();
            if (!move || !move_pairs(*move, bodies, stats)) break;
        }
        few_ = asks_few(moved, bodies.size());
        assignment_.ask(parts_.executor(), list_asked(bodies, moved, pairs));
        auto failed = parts_.run([&](std::size_t part) { find(part, bodies, moved); });
        assignment_.step_done();
        while (!failed.empty()) failed = replace(failed, stats);
        std::vector<Contact>& found = merge();
        Executor& executor = parts_.executor(); // of a part that is left
        round_pairs_.run(executor, settings_, bodies, found);
        take_sensed(bodies, found);
        face_contacts_.run(executor, settings_, bodies, found);
        const ContactStore::Asked asked = this->asked(pairs);
        reducer_.run(executor, settings_, bodies, {contacts_, left_out_, moved.is_next(seen_) || is_loaded_}, found);
        if (settings_.direction == Direction::refined) refine(executor, bodies, found);
        contacts_.replace(executor, asked, found);
        if (!left_out_.all().empty() || !reducer_.left_out().empty())
            left_out_.replace(executor, asked, reducer_.left_out());
        if (!sensed_.all().empty() || !of_sensors_.empty()) sensed_.replace(executor, asked, of_sensors_);
        seen_ = moved.now();
        forget_loaded();
    } catch (...) {
        const Interruptible to_its_end(nullptr);
        begin_anew();
        pairs.forget();
        throw;
    }

    count(pairs.slots().count(), stats);
    const ContactStore::Sums& sums = contacts_.sums();
    stats.contacts_reduced = left_out_.all().size();
    stats.contacts_new = sums.fresh;
    stats.contacts_lost = contacts_.lost().size();
    stats.contacts_speculative = sums.speculative;
    stats.contacts = contacts_.all().size() - sums.speculative;
    stats.details.ray_length = sums.ray_length;
    stats.depth_max = std::max(sums.depth_max, left_out_.sums().depth_max);
    trim(stats.pair_bytes);
    stats.narrow_ms = milliseconds_since(start);
}

void NarrowPhase::rest(StepStats& stats) {
    const auto start = Clock::now();
    prepare();
    contacts_.rest(parts_.executor());
    stats.contacts_new = stats.contacts_lost = stats.devices_lost = 0;
    stats.warnings.clear();
    StepDetails& details = stats.details;
    details = {.ray_length = details.ray_length, .work = std::move(details.work)};
    for (DeviceWork& work : details.work) work = {.device = std::move(work.device), .pairs = work.pairs};
    stats.narrow_ms = milliseconds_since(start);
}

// Once much less is kept for pairs than was, what a step makes anew is freed as well; again after the next step, which
// frees the lists of what was lost.
void NarrowPhase::trim(std::uint64_t pair_bytes) {
    constexpr std::uint64_t much = 16 << 20;
    most_bytes_ = std::max(most_bytes_, pair_bytes);
    if (most_bytes_ > 2 * pair_bytes + much) {
        most_bytes_ = pair_bytes;
        trims_ = 2;
    }
    trimmed_ = trims_ > 0;
    if (!trimmed_) return;
    --trims_;
    for (std::size_t i = 0; i < parts_.size(); ++i)
        if (parts_.has(i)) parts_[i].trim();
    for (Found& found : found_) found.contacts.shrink_to_fit();
    free_all(merged_, asked_);
    round_pairs_.trim();
    face_contacts_.trim();
    reducer_.trim();
    contacts_.trim();
    left_out_.trim();
    sensed_.trim();
}

void NarrowPhase::find(std::size_t number, std::span<const PlacedBody> bodies, const SlotChanges& moved) {
    const auto start = Clock::now();
    Part& part = parts_[number];
    const Pin pin(part.executor().core());
    const PairList& asked = assignment_.asked_of(number);
    part.begin(bodies, moved, {assignment_.open_on(number), asked.pairs, asked.slots}, settings_);
    part.end(found_[number].contacts);
    found_[number].ms = milliseconds_since(start);
}

// The others cast the pairs of failed parts in full. Returns the parts that failed in doing so.
std::vector<std::size_t> NarrowPhase::replace(const std::vector<std::size_t>& failed, StepStats& stats) {
    auto given = give_away(failed, stats);
    if (few_)
        for (PairList& list : given) list.keep_only(asked_.pairs);
    return parts_.run([&](std::size_t number) {
        if (given[number].size() > 0) parts_[number].take_over(given[number], found_[number].contacts);
    });
}

std::vector<PairList> NarrowPhase::give_away(const std::vector<std::size_t>& failed, StepStats& stats) {
    stats.devices_lost += failed.size();
    for (const std::size_t part : failed) {
        balance_.drop(part);
        found_[part].contacts.clear();
        if (choice_) choice_->exclude(part, parts_.device(part) + " failed");
    }
    return assignment_.give_away(failed, balance_);
}

void NarrowPhase::choose_device(std::span<const PlacedBody> bodies, StepStats& stats) {
    const std::size_t to = choice_->part();
    if (to == in_use_) return;
    // A new part learns in this step where the bodies are. From the next on it knows how fast they move, as the other.
    if (to == parts_.size()) return open_other();
    if (parts_.has(in_use_)) move_pairs({in_use_, to, 1}, bodies, stats);
    in_use_ = choice_->part(); // the same one, if the other has failed
    balance_.choose(in_use_);
}

// What does not open is not missed: the CPU has found all contacts so far.
void NarrowPhase::open_other() {
    const Interruptible to_its_end(nullptr);
    const auto give_up = [&](const std::exception& error) {
        choice_->exclude(1, "the GPU does not open");
        parts_.warn(std::string("devices \"auto\" goes on with the CPU alone, since the GPU does not open: ")
                    + error.what());
    };
    std::optional<OpenDevice> opened;
    try {
        opened = std::exchange(open_other_, {})();
    } catch (const std::exception& error) {
        return give_up(error);
    }
    if (!opened) return choice_->exclude(1, "there is no GPU");
    assignment_.add_part();
    found_.emplace_back();
    balance_.add(1.0 / std::max(1u, opened->device->info().cores));
    try {
        parts_.add(std::move(*opened)); // last: without it the rest means nothing
    } catch (const std::exception& error) {
        give_up(error);
    }
}

// A part that fails here has failed before the step: its pairs are new to the others.
bool NarrowPhase::move_pairs(const Balance::Move& move, std::span<const PlacedBody> bodies, StepStats& stats) {
    const auto start = Clock::now();
    MovingPairs chosen = choose_moving(assignment_.all_on(move.from), contacts_.all(), move.share);
    PairList& moving = chosen.pairs;
    std::vector<std::byte> state;
    auto failed = parts_.only(move.from, [&] { state = parts_[move.from].export_state(bodies, moving); });
    if (failed.empty()) {
        assignment_.move(moving, move.from, move.to);
        failed = parts_.only(move.to, [&] { parts_[move.to].import_state(bodies, moving, state); });
        if (!failed.empty()) { // they stay, as they are
            assignment_.move(moving, move.to, move.from);
            const auto more = parts_.only(move.from, [&] { parts_[move.from].import_state(bodies, moving, state); });
            failed.insert(failed.end(), more.begin(), more.end());
        }
    }
    if (failed.empty()) {
        stats.details.pairs_moved += moving.size();
        stats.details.bytes_moved += state.size();
        const double ms = milliseconds_since(start);
        balance_.record_move({move.from, move.to, chosen.share}, ms);
        if (choice_) choice_->record_move(ms);
    } else {
        give_away(failed, stats);
    }
    return failed.empty() && moving.size() > 0;
}

SavedContacts NarrowPhase::save_contacts(const SlotChanges& moved) const {
    const auto copy_of = [](std::span<const Contact> contacts) {
        return std::vector<Contact>(contacts.begin(), contacts.end());
    };
    return {copy_of(contacts_.all()), copy_of(left_out_.all()), copy_of(sensed_.all()),
            moved.is_next(seen_) || is_loaded_};
}

std::vector<SavedRays> NarrowPhase::save_rays(std::span<const PlacedBody> bodies) {
    if (!loaded_rays_.empty()) return loaded_rays_;
    std::vector<SavedRays> saved;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (!has_pairs(i)) continue;
        const PairList own = assignment_.all_on(i);
        std::vector<std::byte> state = parts_[i].export_state(bodies, own);
        if (!state.empty()) saved.push_back({own.pairs, std::move(state)});
    }
    return saved;
}

// All pairs begin on one part, since any has taken over rays from any other.
void NarrowPhase::load(std::span<const PlacedBody> bodies, const SlotChanges& moved, OpenPairs& pairs,
                       SavedContacts contacts, std::span<const SavedRays> rays) {
    Executor& executor = parts_.executor();
    parts_.forget();
    assignment_.forget();
    contacts_.restore(executor, std::move(contacts.kept));
    left_out_.restore(executor, std::move(contacts.left_out));
    sensed_.restore(executor, std::move(contacts.sensed));
    seen_ = 0;
    is_loaded_ = contacts.were_chosen;
    loaded_rays_.assign(rays.begin(), rays.end());
    if (rays.empty()) return;
    assignment_.assign(pairs, bodies, round_count_ > 0, balance_);
    const std::size_t to = first_part();
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (i == to || !parts_.has(i)) continue;
        PairList moving = assignment_.all_on(i);
        if (moving.size() > 0) assignment_.move(moving, i, to);
    }
    const PairList all = assignment_.all_on(to);
    Part& part = parts_[to];
    part.learn(bodies, moved);
    for (const SavedRays& own : rays) {
        PairList list;
        for (const SlotPair& pair : own.pairs) {
            const auto at = std::ranges::lower_bound(all.pairs, pair);
            const bool is_open = at != all.pairs.end() && *at == pair; // else a body was gone when it was saved
            list.add({pair, is_open ? all.slots[std::size_t(at - all.pairs.begin())] : NONE});
        }
        part.import_state(bodies, list, own.state);
    }
    pairs.step_done(); // the assignment knows them
}

std::vector<KeptRay> NarrowPhase::kept_rays(std::span<const PlacedBody> bodies) {
    std::vector<KeptRay> rays;
    for (std::size_t i = 0; i < parts_.size(); ++i)
        if (parts_.has(i)) parts_[i].list_kept_rays(bodies, rays);
    return rays;
}

// Each part has the contacts of its own pairs, in order: those of a pair come behind all of pairs before it, on any
// part.
std::vector<Contact>& NarrowPhase::merge() {
    std::size_t count = 0, parts = 0, any = 0;
    for (std::size_t i = 0; i < found_.size(); ++i) {
        count += found_[i].contacts.size();
        if (found_[i].contacts.empty()) continue;
        any = i;
        ++parts;
    }
    if (parts <= 1) return found_[any].contacts;
    merged_.resize(count);
    for (std::size_t part = 0; part < found_.size(); ++part) {
        const std::vector<Contact>& own = found_[part].contacts;
        const auto belongs = [&](std::size_t i) { return pair_of(own[i]) == pair_of(own[i - 1]); };
        RowSlices{own.size()}.each_row(parts_.executor(), belongs, [&](std::size_t begin, std::size_t end) {
            std::size_t to = begin;
            for (std::size_t other = 0; other < found_.size(); ++other) {
                const std::vector<Contact>& others = found_[other].contacts;
                if (other != part)
                    to += static_cast<std::size_t>(std::ranges::lower_bound(others, pair_of(own[begin]), {}, pair_of)
                                                   - others.begin());
            }
            std::copy(own.begin() + std::ptrdiff_t(begin), own.begin() + std::ptrdiff_t(end),
                      merged_.begin() + std::ptrdiff_t(to));
        });
    }
    return merged_;
}

void NarrowPhase::take_sensed(std::span<const PlacedBody> bodies, std::vector<Contact>& found) {
    of_sensors_.clear();
    if (sensor_count_ == 0) return;
    const auto is_sensed = [&](const Contact& contact) {
        return bodies[contact.body_a.slot].is_sensor || bodies[contact.body_b.slot].is_sensor;
    };
    std::ranges::copy_if(found, std::back_inserter(of_sensors_), is_sensed);
    std::erase_if(found, is_sensed);
}

void NarrowPhase::count(std::size_t pair_count, StepStats& stats) {
    stats.details.work.resize(parts_.size());
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        DeviceWork& work = stats.details.work[i];
        if (!parts_.has(i)) {
            work = {.device = parts_.device(i)};
            continue;
        }
        const double before = load_of(stats);
        parts_[i].count(stats);
        work = parts_[i].take_work();
        work.load = load_of(stats) - before;
        work.ms = found_[i].ms;
        balance_.record(i, work.load, work.ms);
    }
    balance_.end_step(pair_count);
    if (choice_ && stats.devices_lost == 0 && in_use_ == choice_->part())
        choice_->record(pair_count, found_[in_use_].ms + stats.broad_ms);
    stats.warnings = parts_.take_warnings();
}

} // namespace raycontact
