// SPDX-License-Identifier: Apache-2.0
#include "property/triplet.h"

#include "property/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <tuple>
#include <utility>

namespace raycontact::reference {

namespace {

auto key(const Contact& c) {
    return std::tuple(c.body_a, c.body_b, c.key());
}

bool same_lost(std::span<const LostContact> x, std::span<const LostContact> y) {
    return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const LostContact& c, const LostContact& d) {
        return std::tie(c.body_a, c.body_b, c.feature) == std::tie(d.body_a, d.body_b, d.feature);
    });
}

Settings with(Settings settings, Method method, std::optional<double> threshold) {
    settings.method = method;
    settings.paper.displacement_threshold = threshold;
    return settings;
}

} // namespace

double decisions_wanted() {
    const char* text = std::getenv("RAYCONTACT_DECISIONS");
    return text ? std::max(1e5, std::strtod(text, nullptr)) : 4e7;
}

std::uint64_t first_seed() {
    const char* text = std::getenv("RAYCONTACT_SEED");
    return text ? std::strtoull(text, nullptr, 10) << 32 : 0;
}

Settings some_settings(Random& random) {
    Settings settings;
    settings.execution.threads = 1;
    settings.paper.skip_outside = random.below(4) != 0; // now and then every ray is cast
    settings.direction = directions[random.below(static_cast<std::uint32_t>(std::size(directions)))];
    settings.features = random.below(4) == 0 ? Features::edges : Features::vertices;
    settings.speculative = random.below(4) == 0 ? Speculative::on : Speculative::off;
    return settings;
}

Settings soon_directed(Settings settings) {
    if (settings.direction == Direction::refined || settings.direction == Direction::weighted)
        settings.direction = Direction::reprojected;
    return settings;
}

void report(const char* what, const Counts& c, double wanted) {
    const std::uint64_t wrong = c.missed + c.invented + c.other;
    std::printf("[ counts   ] %s: %llu decisions in %llu steps of %llu scenes, %llu contacts; certified cast %.2f %%, "
                "%.1f %% of the pairs skipped; wrong %llu (%llu missed, %llu invented, %llu other)\n",
                what, static_cast<unsigned long long>(c.decisions), static_cast<unsigned long long>(c.steps),
                static_cast<unsigned long long>(c.episodes), static_cast<unsigned long long>(c.contacts),
                c.decisions ? 100.0 * static_cast<double>(c.cast) / static_cast<double>(c.decisions) : 0.0,
                c.pairs ? 100.0 * static_cast<double>(c.skipped) / static_cast<double>(c.pairs) : 0.0,
                static_cast<unsigned long long>(wrong), static_cast<unsigned long long>(c.missed),
                static_cast<unsigned long long>(c.invented), static_cast<unsigned long long>(c.other));
    EXPECT_EQ(wrong, 0u) << c.first;
    EXPECT_GE(static_cast<double>(c.decisions), wanted);
    EXPECT_GT(c.contacts, 0u);
}

Triplet::Triplet(const Settings& settings, double threshold, std::string what)
    : standard_(with(settings, Method::standard, {})), own_(with(settings, Method::certified, {})),
      told_(with(settings, Method::certified, threshold)), scenes_{&standard_, &own_, &told_}, what_(std::move(what)) {}

void Triplet::count(Counts& counts) {
    ++counts.steps;
    counts.decisions += standard_.stats().details.rays;
    counts.contacts += standard_.contacts().size();
    counts.cast += own_.stats().details.rays_cast;
    counts.pairs += 2 * own_.stats().pairs;
    counts.skipped += own_.stats().details.pairs_skipped;
    for (const Scene* scene : {&own_, &told_}) compare(*scene, counts);
    ++steps_;
}

void Triplet::compare(const Scene& scene, Counts& counts) const {
    const auto expected = standard_.contacts(), found = scene.contacts();
    const auto alike = [](const Contact& c, const Contact& d) { return c.is_new == d.is_new; };
    if (same_bits(expected, found) && std::equal(expected.begin(), expected.end(), found.begin(), alike)
        && same_lost(standard_.lost_contacts(), scene.lost_contacts()))
        return;
    std::size_t i = 0, j = 0;
    const std::uint64_t before = counts.missed + counts.invented + counts.other;
    while (i < expected.size() || j < found.size()) {
        if (j == found.size() || (i < expected.size() && key(expected[i]) < key(found[j]))) {
            ++counts.missed;
            describe("missed", expected[i++], scene, counts);
        } else if (i == expected.size() || key(found[j]) < key(expected[i])) {
            ++counts.invented;
            describe("invented", found[j++], scene, counts);
        } else {
            if (!same_bits(expected.subspan(i, 1), found.subspan(j, 1)) || !alike(expected[i], found[j])) {
                ++counts.other;
                describe("other numbers", found[j], scene, counts);
            }
            ++i, ++j;
        }
    }
    if (before == counts.missed + counts.invented + counts.other) ++counts.other; // lost contacts alone
}

void Triplet::describe(const char* how, const Contact& c, const Scene& scene, Counts& counts) const {
    if (!counts.first.empty()) return;
    const auto threshold = scene.settings().paper.displacement_threshold;
    char text[300];
    std::snprintf(text, sizeof text, "%s: %s, step %llu, threshold %g, bodies %u and %u, %s %u of %c, depth %g", how,
                  what_.c_str(), static_cast<unsigned long long>(steps_), threshold ? *threshold : -1.0, c.body_a.slot,
                  c.body_b.slot, c.feature.kind == FeatureKind::edges ? "edges" : "vertex", c.feature.source_index(),
                  c.feature.source == Side::a ? 'a' : 'b', static_cast<double>(c.depth));
    counts.first = text;
}

} // namespace raycontact::reference
