// SPDX-License-Identifier: Apache-2.0
#include <clash/search.h>

#include <clash/duplicates.h>
#include <clash/nudged.h>

#include "executor/executor.h"

#include <raycontact/collide.h>
#include <raycontact/scene.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace raycontact::clash {

namespace {

Clash clash_of(const PartPair& pair, std::span<const Contact> contacts) {
    Clash clash{pair.a, pair.b, 0, {}, {}, contacts.size(), false};
    for (const Contact& contact : contacts) {
        if (double(contact.depth) <= *clash.depth) continue;
        clash.depth = double(contact.depth);
        clash.point = contact.point();
        clash.normal = contact.normal;
    }
    return clash;
}

/// What a pair's contacts tell.
struct Answer {
    std::optional<Clash> clash; ///< none: they share no point
    double depth = 0;           ///< of the contacts
    bool may_coincide = false;  ///< so that contacts_when_nudged() decides
};

Answer answer_of(const PartPair& pair, const Part& a, const Part& b, std::span<const Contact> contacts) {
    // Contacts of two open parts tell of sheets behind each other, which may be apart.
    const bool sheets = !a.shape->has_inside() && !b.shape->has_inside();
    Answer answer{clash_of(pair, contacts), 0, false};
    Clash& clash = *answer.clash;
    const double depth = *clash.depth, size = smaller_size(a, b);
    answer.depth = depth;
    std::optional<Vec3> shared;
    if (sheets || depth <= noise * size) shared = common_point(*a.shape, a.pose, *b.shape, b.pose);
    if (!shared && (sheets || contacts.empty())) return {};
    const bool duplicate = are_duplicates(a, b);
    // Where all faces coincide, rounding draws the loops, and their depth is any.
    if (duplicate) answer.depth = 0;
    answer.may_coincide = answer.depth <= shallow * size && a.shape->has_inside() && b.shape->has_inside();
    if (depth <= noise * size) {
        const Vec3 point = shared ? *shared : clash.point;
        clash = clash_of(pair, {});
        clash.point = point;
    }
    clash.duplicate = duplicate;
    return answer;
}

/// Where faces may coincide, nudges tell. pairs: those of the answers, as bodies of the scene.
void decide_shallow(Scene& scene, const std::vector<Part>& parts, std::span<const Pair> pairs,
                    std::span<Answer> answers) {
    std::vector<ShallowPair> asked;
    std::vector<Clash*> clashes;
    for (std::size_t i = 0; i < answers.size(); ++i) {
        if (!answers[i].may_coincide) continue;
        Clash& clash = *answers[i].clash;
        asked.push_back({&parts[clash.a], &parts[clash.b], pairs[i].first, answers[i].depth});
        clashes.push_back(&clash);
    }
    const auto nudged = contacts_when_nudged(scene, asked);
    for (std::size_t i = 0; i < nudged.size(); ++i) {
        if (nudged[i].empty()) continue;
        const bool duplicate = clashes[i]->duplicate;
        *clashes[i] = clash_of({clashes[i]->a, clashes[i]->b}, nudged[i]);
        clashes[i]->duplicate = duplicate;
    }
}

/// Parts without a contact touch if both are sound: closed, wound outward and not self-intersecting. Otherwise, and
/// where the search is stopped before that is known, they have no depth. Looks into each mesh once.
void drop_unknown_depths(std::vector<Clash>& clashes, const std::vector<Part>& parts, Executor& executor,
                         const std::function<bool()>& stop) {
    std::unordered_map<const Mesh*, std::size_t> places;
    std::vector<const Part*> asked;
    for (const Clash& clash : clashes)
        for (const std::size_t i : {clash.a, clash.b})
            if (clash.contacts == 0 && places.try_emplace(parts[i].mesh.get(), asked.size()).second)
                asked.push_back(&parts[i]);
    std::vector<char> sound(asked.size(), 0);
    const std::uint32_t of_one = executor.threads_of_each(asked.size());
    const auto is_good = [&](const Mesh& mesh) {
        return verdict_of(prepare_mesh(mesh, Repair::allowed, Nesting::as_wound, Check::full, of_one).report).good;
    };
    executor.run(static_cast<std::uint32_t>(asked.size()), 1, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::uint32_t i = begin; i < end && !stop(); ++i)
            sound[i] = asked[i]->shape->report().closed && is_good(*asked[i]->mesh);
    });
    const auto is_sound = [&](std::size_t part) { return sound[places.at(parts[part].mesh.get())] != 0; };
    for (Clash& clash : clashes)
        if (clash.contacts == 0 && !(is_sound(clash.a) && is_sound(clash.b))) clash.depth.reset();
}

} // namespace

std::vector<Clash> find_clashes(const std::vector<Part>& parts, const std::vector<PartPair>& pairs,
                                const SearchOptions& options) {
    Settings settings;
    settings.method = Method::standard;
    settings.execution.devices = "cpu";
    settings.execution.threads = options.threads;
    Scene scene(settings);
    std::unordered_map<std::size_t, BodyId> bodies;
    std::vector<PartPair> asked;
    for (const PartPair& pair : pairs)
        if (parts[pair.a].shape && parts[pair.b].shape) asked.push_back(pair);
    // In the parts' order, so that normals run from a to b.
    std::vector<std::size_t> used;
    for (const auto& [a, b] : asked) used.insert(used.end(), {a, b});
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const std::size_t part : used) bodies.emplace(part, scene.add(parts[part].shape, parts[part].pose));

    std::vector<Clash> clashes;
    Executor executor(options.threads);
    constexpr std::size_t at_once = 256;
    for (std::size_t first = 0; first < asked.size() && !options.stop(); first += at_once) {
        const std::span some = std::span(asked).subspan(first, std::min(at_once, asked.size() - first));
        std::vector<Pair> list;
        list.reserve(some.size());
        for (const auto& [a, b] : some) list.emplace_back(bodies.at(a), bodies.at(b));
        scene.find_contacts(list);
        std::vector<Answer> answers(some.size());
        executor.run(static_cast<std::uint32_t>(some.size()), 1, [&](std::uint32_t begin, std::uint32_t end) {
            for (std::uint32_t i = begin; i < end && !options.stop(); ++i)
                answers[i] = answer_of(some[i], parts[some[i].a], parts[some[i].b],
                                       scene.contacts(list[i].first, list[i].second));
        });
        decide_shallow(scene, parts, list, answers);
        for (const Answer& answer : answers)
            if (answer.clash) clashes.push_back(*answer.clash);
        options.progress(first + some.size(), asked.size());
    }
    drop_unknown_depths(clashes, parts, executor, options.stop);
    std::sort(clashes.begin(), clashes.end(), [](const Clash& p, const Clash& q) {
        const auto rank = [](const Clash& c) { return -c.depth.value_or(1e-300); }; // any depth is more
        return std::tuple(rank(p), p.a, p.b) < std::tuple(rank(q), q.a, q.b);
    });
    return clashes;
}

} // namespace raycontact::clash
