// SPDX-License-Identifier: Apache-2.0
// How well the schedules share pairs among 2 to 16 devices, by a simulation: the pairs of a recording, copied up to a
// million, each with a cost that was measured in a replay. Prints for each schedule the efficiency (all work / devices
// x the slowest device's, 1 is best) and what moves between devices in a step. `free` cuts each step's list of pairs
// into equal pieces: what keeping pairs where they are is worth.
#include "bench/commands.h"
#include "bench/options.h"
#include "schedule/assignment.h"
#include "schedule/moving_pairs.h"

#include <raycontact/error.h>
#include <recording/replay.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace raycontact::bench {

namespace {

// One step: pairs, sorted, and how many contacts each has.
struct Step {
    std::vector<SlotPair> pairs;
    std::vector<Contact> contacts;
    std::vector<std::uint32_t> counts; ///< of contacts, by pair
    double ms = 0;
};

struct Work {
    std::vector<Step> steps;
    double pair_ns = 0, contact_ns = 0; ///< what each costs `standard` on one thread
    double state_bytes = 0;             ///< kept by `iterative` for a pair
};

// Least squares: ms of a step = a x pairs + b x contacts.
void fit_costs(Work& work) {
    double pp = 0, pc = 0, cc = 0, pt = 0, ct = 0;
    for (const Step& step : work.steps) {
        const auto p = static_cast<double>(step.pairs.size()), c = static_cast<double>(step.contacts.size());
        pp += p * p, pc += p * c, cc += c * c, pt += p * step.ms, ct += c * step.ms;
    }
    const double determinant = pp * cc - pc * pc;
    work.pair_ns = 1e6 * (pt * cc - ct * pc) / determinant;
    work.contact_ns = 1e6 * (ct * pp - pt * pc) / determinant;
}

Work read_work(const std::string& file, std::uint32_t first, std::uint32_t last) {
    Work work;
    for (const Method method : {Method::standard, Method::iterative}) {
        recording::Reader reader(file);
        Settings settings;
        settings.features = Features::vertices;
        settings.method = method;
        settings.execution.devices = "cpu/0";
        recording::Follower follower(reader, settings);
        std::vector<Pose> poses;
        std::vector<Pair> pairs;
        for (std::uint32_t i = 0; i < std::min(last, reader.steps()); ++i) {
            reader.read_step(i, poses, pairs);
            follower.place(i, poses);
            const auto contacts = follower.scene().find_contacts(pairs);
            const StepStats& stats = follower.scene().stats();
            if (i < first) continue;
            if (method == Method::iterative) {
                work.state_bytes = double(stats.pair_bytes) / double(stats.pairs);
                continue;
            }
            Step& step = work.steps.emplace_back();
            step.ms = stats.narrow_ms;
            step.contacts.assign(contacts.begin(), contacts.end());
            std::size_t next = 0;
            for (const auto& [a, b] : follower.scene().pairs()) {
                const SlotPair pair(a.slot, b.slot);
                const std::size_t begin = next;
                while (next < contacts.size() && contacts[next].body_a == a && contacts[next].body_b == b) ++next;
                step.pairs.push_back(pair);
                step.counts.push_back(static_cast<std::uint32_t>(next - begin));
            }
        }
    }
    fit_costs(work);
    return work;
}

// `copies` of a step, whose bodies have slots of their own.
Step copied(const Step& step, std::uint32_t copies, BodySlot slots) {
    Step all;
    for (std::uint32_t k = 0; k < copies; ++k) {
        const BodySlot shift = k * slots;
        for (const auto& [a, b] : step.pairs) all.pairs.emplace_back(a + shift, b + shift);
        all.counts.insert(all.counts.end(), step.counts.begin(), step.counts.end());
        for (Contact contact : step.contacts) {
            contact.body_a.slot += shift;
            contact.body_b.slot += shift;
            all.contacts.push_back(contact);
        }
    }
    return all;
}

struct Result {
    double efficiency = 0, moved = 0; ///< pairs that change their device in a step, of a thousand
};

// speeds: how fast each device is; 1 as the one that the costs were measured on.
Result simulate(const Work& work, std::uint32_t copies, const std::vector<double>& speeds, const std::string& how) {
    const std::size_t devices = speeds.size();
    const std::vector<double> costs(devices, 1.0);
    Balance balance(how == "sticky" ? Schedule::sticky : Schedule::balanced, costs);
    Assignment assignment(devices);
    BodySlot slots = 0;
    for (const Step& step : work.steps)
        for (const auto& [a, b] : step.pairs) slots = std::max(slots, b + 1);
    double all_speeds = 0, ideal = 0, slowest = 0, moved = 0, opened = 0;
    for (const double speed : speeds) all_speeds += speed;
    OpenPairs pairs;
    Executor executor(1);
    std::vector<SlotPair> last_pairs;
    std::vector<std::size_t> last_parts;
    std::vector<Contact> last_contacts;
    for (const Step& recorded : work.steps) {
        const Step step = copied(recorded, copies, slots);
        const std::size_t count = step.pairs.size();
        std::vector<std::size_t> parts(count);
        pairs.set_all(executor, step.pairs);
        assignment.assign(pairs, {}, false, balance);
        for (std::size_t m = 0; how == "balanced" && m + 1 < devices; ++m) {
            const auto move = balance.next_move();
            if (!move) break;
            auto moving = choose_moving(assignment.all_on(move->from), last_contacts, move->share);
            assignment.move(moving.pairs, move->from, move->to);
            balance.record_move({move->from, move->to, moving.share}, 0);
        }
        const std::vector<std::uint32_t>& pair_slots = pairs.all(executor).slots;
        for (std::size_t i = 0; i < count; ++i)
            parts[i] = how == "free" ? i * devices / count : assignment.part_of(pair_slots[i]);
        assignment.step_done();
        pairs.step_done();

        std::vector<double> load(devices), ms(devices);
        for (std::size_t i = 0; i < count; ++i) {
            const double ns = work.pair_ns + work.contact_ns * step.counts[i];
            load[parts[i]] += ns / work.pair_ns;
            ms[parts[i]] += 1e-6 * ns / speeds[parts[i]];
            ideal += 1e-6 * ns / all_speeds;
        }
        slowest += *std::ranges::max_element(ms);
        for (std::size_t d = 0; d < devices; ++d) balance.record(d, load[d], ms[d]);
        balance.end_step(count);

        auto old = last_pairs.begin();
        for (std::size_t i = 0; i < count; ++i) {
            while (old != last_pairs.end() && *old < step.pairs[i]) ++old;
            if (old == last_pairs.end() || *old != step.pairs[i]) continue;
            opened += 1;
            moved += last_parts[std::size_t(old - last_pairs.begin())] != parts[i] ? 1 : 0;
        }
        last_pairs = step.pairs;
        last_parts = std::move(parts);
        last_contacts = step.contacts;
    }
    return {ideal / slowest, 1000 * moved / opened};
}

void run(const std::string& recording, std::uint32_t first, std::uint32_t last) {
    const Work work = read_work(recording, first, last);
    if (work.steps.empty()) throw InputError(recording + ": no steps in that range");
    const std::size_t most =
        std::ranges::max(work.steps, {}, [](const Step& s) { return s.pairs.size(); }).pairs.size();
    std::printf("%zu steps, at most %zu pairs; a pair costs %.0f ns and each contact %.0f ns more (standard, one "
                "thread); iterative keeps %.0f bytes a pair\n",
                work.steps.size(), most, work.pair_ns, work.contact_ns, work.state_bytes);
    std::printf("%8s %8s %9s %9s %11s %13s %13s\n", "pairs", "devices", "speeds", "schedule", "efficiency",
                "moved/1000", "kB moved/step");
    for (const std::size_t pairs : {10000, 100000, 1000000}) {
        const auto copies = static_cast<std::uint32_t>(std::max<std::size_t>(1, (pairs + most / 2) / most));
        for (const std::size_t devices : {2, 4, 8, 16})
            for (const bool mixed : {false, true}) {
                std::vector<double> speeds(devices, 1.0);
                for (std::size_t d = 0; mixed && d < devices; d += 2) speeds[d] = 3;
                for (const char* how : {"sticky", "balanced", "free"}) {
                    const Result result = simulate(work, copies, speeds, how);
                    std::printf("%8zu %8zu %9s %9s %11.3f %13.2f %13.1f\n", copies * most, devices,
                                mixed ? "3, 1, ..." : "equal", how, result.efficiency, result.moved,
                                result.moved / 1000 * double(copies * most) * work.state_bytes / 1000);
                    std::fflush(stdout);
                }
            }
    }
}

} // namespace

void add_balance(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("balance", "How well the schedules share pairs among 2 to 16 devices, by simulation");
    struct Options {
        std::string recording;
        std::uint32_t first = 0, last = ~0u;
    };
    auto o = std::make_shared<Options>();
    command->add_option("recording", o->recording, "poses and pairs (run --record)")
        ->required()
        ->type_name("RECORDING");
    add_number(*command, "first", o->first, "first step", 0u, ~0u);
    add_number(*command, "last", o->last, "and where it ends", 0u, ~0u);
    command->callback([o] { run(o->recording, o->first, o->last); });
}

} // namespace raycontact::bench
