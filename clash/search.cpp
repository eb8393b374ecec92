// SPDX-License-Identifier: Apache-2.0
#include <clash/search.h>

#include <clash/duplicates.h>

#include "executor/executor.h"

#include <raycontact/collide.h>
#include <raycontact/scene.h>

#include <algorithm>
#include <tuple>
#include <unordered_map>

namespace raycontact::clash {

namespace {

Clash clash_of(const PartPair& pair, std::span<const Contact> contacts) {
    Clash clash{pair.a, pair.b, 0, {}, {}, contacts.size()};
    for (const Contact& contact : contacts) {
        if (double(contact.depth) <= clash.depth) continue;
        clash.depth = double(contact.depth);
        const Vec3 a = point_on_a(contact), b = point_on_b(contact);
        clash.point = {0.5 * (a.x + b.x), 0.5 * (a.y + b.y), 0.5 * (a.z + b.z)};
        clash.normal = {double(contact.normal[0]), double(contact.normal[1]), double(contact.normal[2])};
    }
    return clash;
}

} // namespace

std::vector<Clash> find_clashes(const std::vector<Part>& parts, const std::vector<PartPair>& pairs,
                                const SearchOptions& options) {
    Settings settings;
    settings.method = Method::standard;
    settings.devices = "cpu";
    settings.threads = options.threads;
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
        scene.step(list);
        std::vector<Clash> found(some.size());
        std::vector<char> meets(some.size(), 0);
        executor.run(static_cast<std::uint32_t>(some.size()), 1, [&](std::uint32_t begin, std::uint32_t end) {
            for (std::uint32_t i = begin; i < end && !options.stop(); ++i) {
                found[i] = clash_of(some[i], scene.contacts(list[i].first, list[i].second));
                const Part &a = parts[some[i].a], &b = parts[some[i].b];
                if (are_duplicates(a, b)) {
                    found[i] = clash_of(some[i], collide(*a.shape, a.pose, *b.shape, moved_aside(b)));
                    found[i].duplicate = true;
                }
                meets[i] = found[i].contacts > 0;
                if (meets[i]) continue;
                const auto shared = common_point(*a.shape, a.pose, *b.shape, b.pose);
                if (shared) found[i].point = *shared;
                meets[i] = shared.has_value();
            }
        });
        for (std::size_t i = 0; i < some.size(); ++i)
            if (meets[i]) clashes.push_back(found[i]);
        options.progress(first + some.size(), asked.size());
    }
    std::sort(clashes.begin(), clashes.end(), [](const Clash& p, const Clash& q) {
        return std::tuple(-p.depth, p.a, p.b) < std::tuple(-q.depth, q.a, q.b);
    });
    return clashes;
}

} // namespace raycontact::clash
