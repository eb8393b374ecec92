// SPDX-License-Identifier: Apache-2.0
// Whether two random closed meshes collide, with edges, against an exact test. RAYCONTACT_PAIRS sets how many pairs;
// three thousand unless told.
#include "exact/oracle.h"
#include "exact/random_solids.h"
#include "exact/words.h"
#include "property/ray_sources.h"
#include "property/shapes.h"
#include "reference/random.h"
#include "reference/vector.h"

#include <raycontact/collide.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

using namespace raycontact;
using namespace raycontact::exact;
using namespace raycontact::reference;

namespace {

std::size_t pairs_wanted() {
    const char* text = std::getenv("RAYCONTACT_PAIRS");
    return text ? static_cast<std::size_t>(std::max(300.0, std::strtod(text, nullptr))) : 3000;
}

struct Body {
    std::shared_ptr<const Shape> shape;
    ExactBody exact, of_file;
    explicit Body(std::shared_ptr<const Shape> made)
        : shape(std::move(made)), exact(*shape), of_file(*shape, Positions::of_file) {}
    double size() const { return exact.diagonal(); }
};

std::vector<Body> make_bodies(Mesh (*make)(Random&), std::size_t count, std::uint64_t seed) {
    std::vector<Body> bodies;
    Random random(seed);
    while (bodies.size() < count) {
        auto shape = Shape::make(make(random));
        const MeshReport& report = shape->report();
        EXPECT_TRUE(report.outward && report.manifold && !report.self_intersecting) << shape->name();
        EXPECT_TRUE(report.repairs.empty()) << shape->name();
        bodies.emplace_back(std::move(shape));
    }
    return bodies;
}

struct PosedPair {
    const Body* a = nullptr;
    const Body* b = nullptr;
    Pose pose_a, pose_b;
    double apart = 0; ///< where known: they come apart if b moves by this, metres
    Pose relative() const { return centred_in(*a->shape, pose_a, *b->shape, pose_b); }
    bool collides() const { return collide(a->exact, b->exact, relative()); }
};

Pose times(const Pose& left, const Pose& right) {
    Pose pose;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            pose.rotation[3 * i + j] = 0;
            for (std::size_t k = 0; k < 3; ++k)
                pose.rotation[3 * i + j] += left.rotation[3 * i + k] * right.rotation[3 * k + j];
        }
    return pose;
}

// The middle of b's box is away from that of a by `offset`.
void place(PosedPair& pair, const Vec3& middle, const Vec3& offset) {
    pair.pose_a.translation = middle - rotate(pair.pose_a, pair.a->shape->centre());
    pair.pose_b.translation = middle + offset - rotate(pair.pose_b, pair.b->shape->centre());
}

PosedPair random_pair(const std::vector<Body>& as, const std::vector<Body>& bs, Random& random) {
    static const std::vector<Pose> turns = axis_rotations();
    PosedPair pair;
    pair.a = &as[random.below(static_cast<std::uint32_t>(as.size()))];
    pair.b = &bs[random.below(static_cast<std::uint32_t>(bs.size()))];
    pair.pose_a = random.rotation();
    pair.pose_b = random.rotation();
    const double kind = random.uniform();
    if (kind < 0.05)
        pair.pose_a = turns[random.below(24)], pair.pose_b = turns[random.below(24)];
    else if (kind < 0.1)
        pair.pose_b = times(pair.pose_a, turns[random.below(24)]); // parallel but for rounding
    const Vec3 middle = 5 * random.in_ball();
    const double size = pair.a->size() + pair.b->size();
    const double larger = std::max(pair.a->size(), pair.b->size());
    if (random.uniform() < 0.35) { // anywhere: apart, crossing, or one in the other
        place(pair, middle, 0.3 * size * random.in_ball());
        return pair;
    }
    // Near touching: b comes from afar, along a line through the box of a.
    const Vec3 way = random.direction();
    double in = 0, out = size;
    Vec3 aim = 0.3 * pair.a->size() * random.in_ball();
    place(pair, middle, aim);
    for (int tries = 0; !pair.collides(); ++tries) {
        if (tries == 10) return pair;
        aim = 0.3 * pair.a->size() * random.in_ball();
        place(pair, middle, aim);
    }
    const double closeness = 0.1 * std::pow(1e-5, random.uniform()) * larger;
    while (out - in > closeness) {
        const double at = 0.5 * (in + out);
        place(pair, middle, aim + at * way);
        (pair.collides() ? in : out) = at;
    }
    const bool inside = random.uniform() < 0.5;
    if (inside) pair.apart = out - in;
    place(pair, middle, aim + (inside ? in : out) * way);
    return pair;
}

struct Counts {
    std::uint64_t pairs = 0, colliding = 0, by_vertices = 0, missed = 0, invented = 0, excused = 0, contacts = 0;
    std::uint64_t intersects_wrong = 0;
    std::uint64_t shallow = 0, deep = 0; ///< pairs that come apart by 1e-3 of the smaller; contacts deeper than 0.1
    double worst = 0;                    ///< depth of a contact of a shallow pair in sizes of the smaller
    std::string first;                   ///< of the wrong ones, in words
    std::string deepest;                 ///< the pair of the worst, likewise
};

std::string words(const PosedPair& pair, std::size_t number) {
    std::string text = "pair " + std::to_string(number);
    const auto add = [&text](const char* who, const Body& body, const Pose& pose) {
        char part[400];
        const auto& r = pose.rotation;
        std::snprintf(part, sizeof part,
                      "\n  %s %s, %zu triangles, [%.17g,%.17g,%.17g,%.17g, %.17g,%.17g,%.17g,%.17g, "
                      "%.17g,%.17g,%.17g,%.17g, 0,0,0,1]",
                      who, body.shape->name().c_str(), body.shape->triangles().size(), r[0], r[1], r[2],
                      pose.translation.x, r[3], r[4], r[5], pose.translation.y, r[6], r[7], r[8], pose.translation.z);
        text += part;
    };
    add("a", *pair.a, pair.pose_a);
    add("b", *pair.b, pair.pose_b);
    return text;
}

std::string words(std::span<const Contact> contacts) {
    std::string text;
    for (const Contact& c : contacts.first(std::min<std::size_t>(contacts.size(), 12))) text += "\n  " + words_of(c);
    return text;
}

void judge(const PosedPair& pair, std::span<const Contact> contacts, std::size_t number, Counts& counts) {
    const double smaller = std::min(pair.a->size(), pair.b->size());
    const double larger = std::max(pair.a->size(), pair.b->size());
    for (const Contact& c : contacts) {
        const auto& n = c.normal;
        const float size = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
        EXPECT_NEAR(size, 1, 1e-5) << words(pair, number);
        EXPECT_TRUE(c.depth > 0 && double(c.depth) <= larger) << c.depth << ' ' << words(pair, number);
        EXPECT_TRUE(std::isfinite(c.point().x) && std::isfinite(c.point().y) && std::isfinite(c.point().z));
        if (pair.apart > 0 && pair.apart < 1e-3 * smaller) {
            if (double(c.depth) / smaller > counts.worst) {
                counts.worst = double(c.depth) / smaller;
                counts.deepest = words(pair, number) + words(contacts) + ", apart by " + std::to_string(pair.apart);
            }
            counts.deep += double(c.depth) > 0.1 * smaller;
        }
    }
    ++counts.pairs;
    counts.contacts += contacts.size();
    counts.shallow += pair.apart > 0 && pair.apart < 1e-3 * smaller;
    const Pose relative = pair.relative();
    const bool truth = collide(pair.a->exact, pair.b->exact, relative), found = !contacts.empty();
    counts.colliding += truth;
    // It decides of the file's positions. The truth about those is asked where it differs from that about contacts'
    // own.
    const bool meets = intersects(*pair.b->shape, pair.pose_b, *pair.a->shape, pair.pose_a);
    counts.intersects_wrong += meets != truth && meets != collide(pair.a->of_file, pair.b->of_file, relative);
    counts.by_vertices += std::any_of(contacts.begin(), contacts.end(),
                                      [](const Contact& c) { return c.feature.kind == FeatureKind::vertex; });
    if (truth == found) return;
    // Of a every vertex is moved inward by a perturbation, 1e-7 of the smaller, of b by three.
    const double touching = 5e-7 * smaller;
    if (truth ? comes_apart(pair.a->exact, pair.b->exact, relative, touching)
              : comes_together(pair.a->exact, pair.b->exact, relative, touching)) {
        ++counts.excused;
        return;
    }
    ++(truth ? counts.missed : counts.invented);
    std::string text = words(pair, number) + (truth ? " missed" : " invented");
    if (!truth) text += ", depth " + std::to_string(contacts[0].depth);
    for (const double by : {1e-5, 1e-4, 1e-3, 1e-2, 0.1})
        if (truth ? comes_apart(pair.a->exact, pair.b->exact, relative, by * larger)
                  : comes_together(pair.a->exact, pair.b->exact, relative, by * larger)) {
            text += ", changes by a move of " + std::to_string(by) + " of the larger";
            break;
        }
    if (counts.missed + counts.invented <= 5) counts.first += text + '\n';
}

void try_pairs(const char* what, const std::vector<Body>& as, const std::vector<Body>& bs, std::size_t wanted,
               std::uint64_t seed) {
    constexpr std::size_t block = 500;
    Counts counts;
    for (std::size_t first = 0; first < wanted; first += block) {
        const std::size_t k = first / block; // each way of asking in turn
        Settings settings;
        settings.features = Features::edges;
        settings.method = k % 2 == 0 ? Method::standard : Method::certified;
        settings.paper.caster = k / 2 % 2 == 0 ? Caster::bvh : Caster::basic;
        settings.execution.threads = 2;
        Scene scene(settings);
        const bool swapped = k / 4 % 2 != 0;
        std::vector<PosedPair> posed;
        std::vector<Pair> pairs;
        for (std::size_t i = first; i < std::min(wanted, first + block); ++i) {
            Random random(seed * 1000003 + i); // so that a pair can be made again alone
            PosedPair pair = random_pair(as, bs, random);
            if (swapped) {
                std::swap(pair.a, pair.b);
                std::swap(pair.pose_a, pair.pose_b);
            }
            const BodyId a = scene.add(pair.a->shape, pair.pose_a);
            pairs.emplace_back(a, scene.add(pair.b->shape, pair.pose_b));
            posed.push_back(pair);
        }
        const auto parts = by_pair(scene.find_contacts(pairs), pairs.size());
        for (std::size_t i = 0; i < posed.size(); ++i) judge(posed[i], parts[i], first + i, counts);
    }
    std::printf("[ counts   ] %s: %llu pairs, %llu colliding (%llu by vertices), %llu missed, %llu invented, %llu "
                "excused; %llu contacts; of %llu that come apart by 1e-3 of the smaller %llu contacts deeper than 0.1 "
                "of it, the worst %.3g\n",
                what, static_cast<unsigned long long>(counts.pairs), static_cast<unsigned long long>(counts.colliding),
                static_cast<unsigned long long>(counts.by_vertices), static_cast<unsigned long long>(counts.missed),
                static_cast<unsigned long long>(counts.invented), static_cast<unsigned long long>(counts.excused),
                static_cast<unsigned long long>(counts.contacts), static_cast<unsigned long long>(counts.shallow),
                static_cast<unsigned long long>(counts.deep), counts.worst);
    if (counts.worst > 0.1) std::printf("[ deep     ] %s\n", counts.deepest.c_str());
    std::fflush(stdout);
    EXPECT_EQ(counts.missed, 0u) << counts.first;
    EXPECT_EQ(counts.invented, 0u) << counts.first;
    EXPECT_EQ(counts.intersects_wrong, 0u);
    EXPECT_EQ(counts.deep, 0u) << counts.deepest;
    EXPECT_LE(counts.excused, counts.pairs / 100);
    EXPECT_GE(counts.colliding, counts.pairs * 2 / 5);
    EXPECT_LE(counts.colliding, counts.pairs * 3 / 5);
}

const std::vector<Body>& coarse() {
    static const auto bodies = make_bodies(coarse_solid, std::min<std::size_t>(1500, pairs_wanted() / 10), 1);
    return bodies;
}
const std::vector<Body>& fine() {
    static const auto bodies = make_bodies(fine_solid, std::min<std::size_t>(150, pairs_wanted() / 200 + 10), 2);
    return bodies;
}

TEST(exact, coarse_against_coarse) {
    try_pairs("coarse against coarse", coarse(), coarse(), pairs_wanted() / 2, 11);
}

TEST(exact, coarse_against_fine) {
    try_pairs("coarse against fine", coarse(), fine(), pairs_wanted() / 4, 12);
}

TEST(exact, fine_against_fine) {
    try_pairs("fine against fine", fine(), fine(), pairs_wanted() / 4, 13);
}

} // namespace
