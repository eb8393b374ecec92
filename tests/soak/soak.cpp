// SPDX-License-Identifier: Apache-2.0
// soak SECONDS [FILE.svg] [clock]: one scene a device, for as long as is asked: bodies come and go, poses jump, methods
// change. Each round plays one of eight stories, then always the same one. That one's counted work must be the same in
// every round and its contacts on every device, too; memory must stay what it was. `clock`: so must the step time.
#include "property/shapes.h"
#include "reference/meshes.h"
#include "reference/random.h"

#include <raycontact/device.h>
#include <raycontact/error.h>
#include <report/plot.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <string>

#include <malloc.h>
#include <unistd.h>

using namespace raycontact;
using reference::Random;

namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t most_bodies = 40, stories = 8;
constexpr std::size_t contacts_at = 6; ///< in Work::counts
constexpr int steps_a_story = 96, sampled = 16;

/// What is counted, whatever the machine: contacts, and the work to find them.
struct Work {
    std::array<std::uint64_t, 8> counts{};
    std::string hash;
    bool operator==(const Work&) const = default;
};

struct Round {
    double seconds = 0, heap = 0, resident = 0; ///< since the start; MB in use; MB held
    double step_ms = 0;                         ///< median of the story that returns
};

double median(std::vector<double> values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double megabytes_in_use() {
    const auto info = mallinfo2();
    return static_cast<double>(info.uordblks + info.hblkhd) / 1e6;
}

double megabytes_resident() {
    std::ifstream file("/proc/self/statm");
    double all = 0, resident = 0;
    file >> all >> resident;
    return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

const std::vector<std::shared_ptr<const Shape>>& shapes() {
    static const std::vector<std::shared_ptr<const Shape>> made = [] {
        std::vector<std::shared_ptr<const Shape>> all;
        for (const Mesh& mesh :
             {reference::model_mesh("knot"), reference::model_mesh("gear"), reference::frame_mesh(),
              reference::l_prism_mesh(), reference::bumpy_octahedron_mesh(5), reference::bowl_mesh(5)})
            all.push_back(Shape::make(mesh));
        return all;
    }();
    return made;
}

class World {
public:
    explicit World(const std::string& devices) : settings_(settings_of(devices)), scene_(settings_) {}

    /// From an empty scene: the same seed, the same story. Adds to `times`, milliseconds, and to `wrong`.
    Work play(std::uint64_t seed, std::vector<double>& times, std::uint64_t& wrong) {
        for (const BodyId body : scene_.bodies()) scene_.remove(body);
        scene_.find_contacts();
        Random random(seed);
        change(random);
        for (int i = 0; i < 24; ++i) add(random);
        Work work;
        ContactHash hash;
        for (int step = 0; step < steps_a_story; ++step) {
            for (std::uint32_t events = random.below(3); events > 0; --events) happen(random);
            for (const BodyId body : scene_.bodies()) {
                if (random.below(4) == 0) continue;
                const Pose turn = reference::small_rotation(random.direction(), 0.01);
                Pose pose = relative_pose(turn, scene_.pose(body));
                const Vec3 by = random.in_ball(), at = scene_.pose(body).translation;
                pose.translation = {at.x + 0.02 * by.x, at.y + 0.02 * by.y, at.z + 0.02 * by.z};
                scene_.set_pose(body, pose);
            }
            const auto start = Clock::now();
            const auto contacts = scene_.find_contacts();
            times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
            hash.add(static_cast<std::uint32_t>(step), contacts);
            const StepStats& s = scene_.stats();
            const std::array<std::uint64_t, 8> counts{
                s.pairs,         s.details.rays,        s.details.rays_cast, s.details.vertices,
                s.details.walks, s.details.predictions, s.contacts,          s.contacts_lost};
            for (std::size_t i = 0; i < counts.size(); ++i) work.counts[i] += counts[i];
            if (step % sampled == sampled - 1 && !agrees_with_standard()) ++wrong;
        }
        work.hash = hash.hex();
        return work;
    }

private:
    static Settings settings_of(const std::string& devices) {
        Settings settings;
        settings.execution.devices = devices;
        settings.execution.threads = 2;
        settings.execution.schedule = Schedule::counted;
        settings.features = Features::vertices;
        return settings;
    }

    static Pose somewhere(Random& random) {
        Pose pose = random.rotation();
        const Vec3 at = random.in_ball();
        pose.translation = {2.5 * at.x, 2.5 * at.y, 2.5 * at.z};
        return pose;
    }

    void add(Random& random) {
        const auto& shape = shapes()[random.below(static_cast<std::uint32_t>(shapes().size()))];
        const Pose pose = somewhere(random);
        if (scene_.body_count() < most_bodies) scene_.add(shape, pose);
    }

    void change(Random& random) {
        constexpr Method methods[] = {Method::certified, Method::standard, Method::iterative, Method::predictive};
        settings_.method = methods[random.below(4)];
        settings_.direction =
            reference::directions[random.below(static_cast<std::uint32_t>(std::size(reference::directions)))];
        settings_.paper.caster = random.below(8) == 0 ? Caster::basic : Caster::bvh;
        settings_.features = random.below(8) == 0 ? Features::edges : Features::vertices;
        scene_.set_settings(settings_);
    }

    void happen(Random& random) {
        const auto bodies = scene_.bodies();
        const BodyId body = bodies[random.below(static_cast<std::uint32_t>(bodies.size()))];
        switch (random.below(8)) {
        case 0:
        case 1:
            return add(random);
        case 2:
        case 3:
            if (bodies.size() > 12) scene_.remove(body);
            return;
        case 4:
            return change(random);
        default:
            scene_.set_pose(body, somewhere(random));
        }
    }

    /// Against a scene that knows nothing; methods that may miss contacts are not asked.
    bool agrees_with_standard() const {
        if (settings_.method == Method::iterative || settings_.method == Method::predictive) return true;
        Settings settings = settings_;
        settings.method = Method::standard;
        settings.execution.devices = "cpu";
        return reference::same_bits(reference::contacts_of_fresh_scene(scene_, settings), scene_.contacts());
    }

    Settings settings_;
    Scene scene_;
};

std::string drawing(const std::vector<Round>& rounds) {
    report::Line heap{"in use", {}}, resident{"held from the system", {}}, step{"median step", {}};
    for (const Round& round : rounds) {
        heap.points.emplace_back(round.seconds, round.heap);
        resident.points.emplace_back(round.seconds, round.resident);
        step.points.emplace_back(round.seconds, round.step_ms);
    }
    report::Plot memory{"Memory", "MB", "at the end of each round", {heap, resident}};
    report::Plot time{"Step time", "ms", "of the story that returns in each round", {step}};
    memory.over = time.over = "seconds since the start (s)";
    return report::plot_svg({memory, time});
}

/// How far the last quarter is above (or below) the second, both by their medians, in percent.
double drift(const std::vector<Round>& rounds, double Round::*what) {
    const auto quarter = static_cast<std::ptrdiff_t>(rounds.size() / 4);
    const auto of = [&](auto first, auto last) {
        std::vector<double> values;
        for (; first != last; ++first) values.push_back((*first).*what);
        return median(values);
    };
    const double before = of(rounds.begin() + quarter, rounds.begin() + 2 * quarter + 1);
    if (!(before > 0)) return 0; // a sanitizer's allocator is not asked
    return 100 * (of(rounds.end() - quarter - 1, rounds.end()) / before - 1);
}

int soak(double seconds, const std::string& file, bool clock) {
    std::vector<std::string> names{"cpu"};
    for (const DeviceInfo& device : list_devices())
        if (device.usable && device.exact && device.id != "cpu" && !std::getenv("RAYCONTACT_SOAK_CPU"))
            names.push_back(device.id);
    std::deque<World> worlds;
    for (const std::string& name : names) {
        worlds.emplace_back(name);
        std::printf("device %s\n", name.c_str());
    }

    std::vector<Round> rounds;
    rounds.reserve(1 << 16); // what is noted must not look like a leak
    std::vector<double> times;
    times.reserve(2 * steps_a_story * names.size());
    std::vector<Work> first(worlds.size());
    std::uint64_t steps = 0, wrong = 0, unequal = 0;
    const auto start = Clock::now();
    const auto passed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
    // Two whole turns of the stories at least: one to warm up, one to compare.
    for (std::uint64_t i = 0; (passed() < seconds || i < 2 * stories) && rounds.size() < rounds.capacity(); ++i) {
        Round round;
        for (std::size_t w = 0; w < worlds.size(); ++w) {
            times.clear();
            worlds[w].play(2 + i % stories, times, wrong);
            times.clear();
            const Work work = worlds[w].play(1, times, wrong);
            if (w == 0) round.step_ms = median(times);
            if (i == 0) first[w] = work;
            unequal += work != first[w] || work.hash != first[0].hash;
            steps += 2 * steps_a_story;
        }
        round.seconds = passed();
        round.heap = megabytes_in_use();
        round.resident = megabytes_resident();
        if (i >= stories) rounds.push_back(round);
        if (i % 256 == 0)
            std::printf("%7.0f s  round %llu  %.3f MB in use, %.1f MB held, step %.3f ms\n", round.seconds,
                        static_cast<unsigned long long>(i), round.heap, round.resident, round.step_ms);
        std::fflush(stdout);
    }
    const double heap = drift(rounds, &Round::heap), step = drift(rounds, &Round::step_ms);
    const double peak = std::max_element(rounds.begin(), rounds.end(), [](const Round& p, const Round& q) {
                            return p.heap < q.heap;
                        })->heap;
    std::printf("%llu steps in %.0f s; last quarter against the second: memory in use %+.3f %%, held %+.3f %%, median "
                "step %+.1f %%; at most %.3f MB in use\n%llu rounds with other counted work or contacts than the "
                "first; %llu sampled steps with other contacts than standard\n",
                static_cast<unsigned long long>(steps), passed(), heap, drift(rounds, &Round::resident), step, peak,
                static_cast<unsigned long long>(unequal), static_cast<unsigned long long>(wrong));
    if (!file.empty() && !(std::ofstream(file) << drawing(rounds))) {
        std::fprintf(stderr, "soak: %s cannot be written\n", file.c_str());
        return 1;
    }
    bool flat = heap < 1 && wrong == 0 && unequal == 0 && first[0].counts[contacts_at] > 0;
    if (clock) flat = flat && step < 10;
    std::puts(flat ? "flat" : "NOT flat");
    return flat ? 0 : 1;
}

} // namespace

int main(int argc, char** argv) {
    const double seconds = argc > 1 ? std::atof(argv[1]) : 0;
    const bool clock = argc == 4 && std::string(argv[3]) == "clock";
    if (!(seconds > 0) || argc > 4 || (argc == 4 && !clock)) {
        std::fprintf(stderr, "usage: soak SECONDS [FILE.svg] [clock]\n");
        return 2;
    }
    try {
        return soak(seconds, argc > 2 ? argv[2] : "", clock);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "soak: %s\n", error.what());
        return 1;
    }
}
