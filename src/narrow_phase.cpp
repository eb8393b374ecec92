// SPDX-License-Identifier: Apache-2.0
#include "narrow_phase.h"

#include "device/device.h"
#include "platform/system.h"
#include "schedule/moving_pairs.h"

#include <algorithm>
#include <chrono>
#include <exception>
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

void NarrowPhase::step(std::span<const PlacedBody> bodies, const MovedBodies& moved, std::span<const SlotPair> pairs,
                       std::vector<Contact>& contacts, StepStats& stats, double broad_ms) {
    const auto start = Clock::now();
    std::vector<DeviceWork> work = std::move(stats.details.work); // to reuse its memory
    stats = {};
    stats.details.work = std::move(work);
    stats.broad_ms = broad_ms;
    try {
        if (const auto lost = parts_.take_lost(); !lost.empty()) give_away(lost, stats);
        assignment_.assign(pairs, balance_);
        if (choice_) choose_device(bodies, stats);
        for (std::size_t i = 0; i + 1 < parts_.size(); ++i) {
            const auto move = balance_.next_move();
            if (!move || !move_pairs(*move, bodies, stats)) break;
        }
        const bool alone = parts_.left() == 1;
        const auto has_all = [&](std::size_t part) { return alone || (choice_ && part == in_use_); };
        auto failed = parts_.run(
            [&](std::size_t part) { find(part, bodies, moved, has_all(part) ? contacts : found_[part].contacts); });
        const bool shared = !alone && (!choice_ || std::ranges::find(failed, in_use_) != failed.end());
        while (!failed.empty()) failed = replace(failed, stats);
        if (shared) merge(contacts);
        reducer_.run(parts_.executor(), settings_, bodies, changes_, contacts);
        changes_.mark(parts_.executor(), contacts);
    } catch (...) {
        parts_.forget(); // the step failed half-way: what it kept may be wrong
        contacts.clear();
        reducer_.clear();
        throw;
    }

    count(pairs.size(), stats);
    stats.contacts_reduced = reducer_.left_out().size();
    stats.details.contacts_merged = reducer_.merged();
    const Changes::Sums& sums = changes_.sums();
    stats.contacts_new = sums.fresh;
    stats.contacts_lost = changes_.lost().size();
    stats.contacts_speculative = sums.speculative;
    stats.contacts = contacts.size() - sums.speculative;
    stats.details.ray_length = sums.ray_length;
    stats.depth_max = sums.depth_max;
    for (const Contact& contact : reducer_.left_out())
        stats.depth_max = std::max(stats.depth_max, double(contact.depth));
    trim(stats.pair_bytes, contacts);
    stats.narrow_ms = milliseconds_since(start);
}

void NarrowPhase::rest(StepStats& stats) {
    const auto start = Clock::now();
    changes_.rest();
    stats.contacts_new = stats.contacts_lost = stats.devices_lost = 0;
    stats.warnings.clear();
    StepDetails& details = stats.details;
    details = {
        .ray_length = details.ray_length, .contacts_merged = details.contacts_merged, .work = std::move(details.work)};
    for (DeviceWork& work : details.work) work = {.device = std::move(work.device), .pairs = work.pairs};
    stats.narrow_ms = milliseconds_since(start);
}

// Once much less is kept for pairs than was, what a step makes anew is freed as well. The allocator keeps what was
// freed in small pieces: it goes back to the system, and again after the next step, which frees the lists of what was
// lost.
void NarrowPhase::trim(std::uint64_t pair_bytes, std::vector<Contact>& contacts) {
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
    changes_.trim();
    reducer_.trim();
    contacts.shrink_to_fit();
    platform::trim_heap();
}

void NarrowPhase::find(std::size_t number, std::span<const PlacedBody> bodies, const MovedBodies& moved,
                       std::vector<Contact>& contacts) {
    const auto start = Clock::now();
    Part& part = parts_[number];
    const Pin pin(part.executor().core());
    part.begin(bodies, moved, assignment_.pairs_of(number), settings_);
    part.end(contacts);
    found_[number].ms = milliseconds_since(start);
}

// The others cast the pairs of failed parts in full. Returns the parts that failed in doing so.
std::vector<std::size_t> NarrowPhase::replace(const std::vector<std::size_t>& failed, StepStats& stats) {
    const auto given = give_away(failed, stats);
    return parts_.run([&](std::size_t number) {
        if (!given[number].empty()) parts_[number].take_over(given[number], found_[number].contacts);
    });
}

std::vector<std::vector<SlotPair>> NarrowPhase::give_away(const std::vector<std::size_t>& failed, StepStats& stats) {
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
    const auto moving = choose_moving(assignment_.pairs_of(move.from), found_[move.from].contacts, move.share);
    std::vector<std::byte> state;
    auto failed = parts_.only(move.from, [&] { state = parts_[move.from].export_state(bodies, moving.pairs); });
    if (failed.empty()) failed = parts_.only(move.to, [&] { parts_[move.to].import_state(bodies, state); });
    if (failed.empty()) {
        assignment_.move(moving.pairs, move.to);
        stats.details.pairs_moved += moving.pairs.size();
        stats.details.bytes_moved += state.size();
        const double ms = milliseconds_since(start);
        balance_.record_move({move.from, move.to, moving.share}, ms);
        if (choice_) choice_->record_move(ms);
    } else {
        give_away(failed, stats);
    }
    assignment_.make_lists();
    return failed.empty() && !moving.pairs.empty();
}

std::vector<KeptRay> NarrowPhase::kept_rays(std::span<const PlacedBody> bodies) {
    std::vector<KeptRay> rays;
    for (std::size_t i = 0; i < parts_.size(); ++i)
        if (parts_.has(i)) parts_[i].list_kept_rays(bodies, rays);
    return rays;
}

// Each part has the contacts of its own pairs, in order.
void NarrowPhase::merge(std::vector<Contact>& contacts) {
    contacts.clear();
    rest_.clear();
    for (const Found& found : found_)
        if (!found.contacts.empty()) rest_.emplace_back(found.contacts);
    while (!rest_.empty()) {
        std::span<const Contact>& first =
            *std::ranges::min_element(rest_, {}, [](const auto& own) { return pair_of(own.front()); });
        const SlotPair pair = pair_of(first.front());
        std::size_t count = 1;
        while (count < first.size() && pair_of(first[count]) == pair) ++count;
        contacts.insert(contacts.end(), first.begin(), first.begin() + static_cast<std::ptrdiff_t>(count));
        first = first.subspan(count);
        if (first.empty()) rest_.erase(rest_.begin() + (&first - rest_.data()));
    }
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
