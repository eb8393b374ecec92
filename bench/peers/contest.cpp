// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/contest.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

namespace raycontact::bench {

namespace {

struct Times {
    double cpu = 0, wall = 0; // microseconds
};

Times now() {
    timespec cpu{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &cpu);
    const auto wall = std::chrono::steady_clock::now().time_since_epoch();
    return {1e6 * static_cast<double>(cpu.tv_sec) + 1e-3 * static_cast<double>(cpu.tv_nsec),
            std::chrono::duration<double, std::micro>(wall).count()};
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

/// An entrant at work; times[run][visited step].
struct Runner {
    const Entrant* entrant = nullptr;
    std::unique_ptr<Peer> peer;
    Found found;
    std::vector<std::vector<Times>> times;
    std::uint64_t memory = 0;

    void run(const Work& work, bool first) {
        std::vector<Times>& row = times.emplace_back();
        for (std::uint32_t k = 0; k < work.steps.size(); k += entrant->every) {
            peer->prepare(work.steps[k]);
            const Times start = now();
            const Found one = peer->detect(work.steps[k]);
            const Times end = now();
            row.push_back({end.cpu - start.cpu, end.wall - start.wall});
            if (!first) continue;
            peer->note(k);
            found.rays += one.rays;
            found.contacts += one.contacts;
            found.depth_sum += one.depth_sum;
        }
    }

    /// Of the steps that an entrant given every `every`-th of them sees; median over the runs.
    double total(std::uint32_t every, double Times::*which) const {
        std::vector<double> totals;
        for (const auto& row : times) {
            double sum = 0;
            for (std::size_t i = 0; i < row.size(); ++i)
                if (i * entrant->every % every == 0) sum += row[i].*which;
            totals.push_back(sum);
        }
        return median(totals);
    }
};

/// The hashes of the steps that both saw are the same.
bool same_bits(const Runner& one, const Runner& other) {
    const auto a = one.peer->step_hashes(), b = other.peer->step_hashes();
    for (std::size_t i = 0; i < a.size(); ++i) {
        const std::size_t step = i * one.entrant->every;
        if (step % other.entrant->every == 0 && step / other.entrant->every < b.size()
            && a[i] != b[step / other.entrant->every])
            return false;
    }
    return true;
}

Result figures(const Work& work, const Runner& runner, const Runner* ours) {
    Result r;
    r.work = work.name;
    r.peer = runner.entrant->name;
    r.what = runner.entrant->what;
    r.rays_alone = runner.entrant->rays_alone;
    for (std::size_t k = 0; k < work.steps.size(); k += runner.entrant->every) {
        ++r.steps;
        r.pair_steps += work.steps[k].pairs.size();
    }
    const double cpu = runner.total(runner.entrant->every, &Times::cpu);
    const double pair_steps = static_cast<double>(std::max<std::uint64_t>(r.pair_steps, 1));
    r.us = cpu / pair_steps;
    r.wall_us = runner.total(runner.entrant->every, &Times::wall) / pair_steps;
    if (ours) {
        const double theirs = ours->total(runner.entrant->every, &Times::cpu);
        r.ratio = theirs > 0 ? cpu / theirs : 0;
        r.agrees = same_bits(runner, *ours);
    }
    r.rays = runner.found.rays;
    r.contacts = runner.found.contacts;
    r.depth_sum = runner.found.depth_sum;
    r.memory_bytes = runner.memory + runner.peer->shared_memory();
    if (const auto own = runner.peer->own_memory()) {
        r.memory_bytes = *own;
        r.memory_is_own_count = true;
    }
    r.hash = runner.peer->hash();
    return r;
}

} // namespace

std::uint64_t heap_in_use() {
#if defined(__GLIBC__)
    const struct mallinfo2 info = mallinfo2();
    return info.uordblks + info.hblkhd;
#else
    return 0;
#endif
}

std::vector<Result> contest(const Work& work, const std::vector<Entrant>& entrants, std::uint32_t runs,
                            const std::function<void(const std::string&)>& progress) {
    std::vector<Runner> runners;
    for (const Entrant& entrant : entrants) {
        if (!entrant.make) continue;
        progress(work.name + ": " + entrant.name + ", warming up");
        Runner& runner = runners.emplace_back();
        runner.entrant = &entrant;
        const std::uint64_t before = heap_in_use();
        runner.peer = entrant.make(work);
        // The first, a middle and the last of its steps: pages touched, arrays grown, algorithms made.
        const std::size_t count = (work.steps.size() + entrant.every - 1) / entrant.every;
        for (const std::size_t i : {std::size_t{0}, count / 2, count - 1}) {
            const WorkStep& step = work.steps[i * entrant.every];
            runner.peer->prepare(step);
            runner.peer->detect(step);
        }
        const std::uint64_t after = heap_in_use();
        runner.memory = after > before ? after - before : 0;
    }
    for (std::uint32_t run = 0; run < runs; ++run) {
        for (Runner& runner : runners) {
            progress(work.name + ": run " + std::to_string(run + 1) + " of " + std::to_string(runs) + ", "
                     + runner.entrant->name);
            runner.run(work, run == 0);
        }
    }
    std::vector<Result> results;
    for (const Runner& runner : runners) {
        const auto ours = std::find_if(runners.begin(), runners.end(), [&](const Runner& r) {
            return r.entrant->name == (runner.entrant->rays_alone ? "rays" : "bvh");
        });
        results.push_back(figures(work, runner, ours == runners.end() ? nullptr : &*ours));
    }
    return results;
}

} // namespace raycontact::bench
