// SPDX-License-Identifier: Apache-2.0
// Whatever happened to a scene, in whatever order, what it reports is true: by the standard and the certified method
// the contacts of a fresh scene, by the others contacts that a ray in double finds too.
#include "prepared_shape.h"
#include "property/crowds.h"
#include "property/shapes.h"
#include "reference/margins.h"
#include "reference/meshes.h"
#include "reference/vector.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

using Key = std::tuple<BodyId, BodyId, std::uint64_t>;

/// The order of contacts; a slot, as a contact names it, finds the body that is there.
struct BySlot {
    bool operator()(BodyId a, BodyId b) const { return a.slot < b.slot; }
};

template <class AnyContact>
Key key(const AnyContact& c) {
    return {c.body_a, c.body_b, c.key()};
}

struct Guest {
    const Subject* subject = nullptr;
    Pose pose;
};

struct Counts {
    std::uint64_t steps = 0, contacts = 0, same = 0, genuine = 0, came = 0, went = 0, refused = 0;
    std::uint64_t successors = 0; ///< bodies in the slot of one before
    std::uint64_t wrong = 0, false_hits = 0, false_pairs = 0, false_changes = 0;
    std::uint64_t missed_by_others = 0, of_standard = 0; ///< by the methods that may miss some
    std::uint64_t lies = 0, believed = 0; ///< contacts with the wrong triangle, to see what the judge is worth
};

// The ray of the contact's vertex meets that triangle, from inside, within its exit distance: all within rounding.
bool is_genuine(const Contact& c, const Guest& a, const Guest& b) {
    const bool of_a = c.feature.source == Side::a;
    const Guest &source = of_a ? a : b, &target = of_a ? b : a;
    const Solid &s = source.subject->solid, &t = target.subject->solid;
    const auto v = static_cast<std::size_t>(
        std::find(s.vertex_index.begin(), s.vertex_index.end(), c.feature.source_index()) - s.vertex_index.begin());
    const auto f =
        static_cast<std::size_t>(std::find(t.triangle_index.begin(), t.triangle_index.end(), c.feature.other_index())
                                 - t.triangle_index.begin());
    if (v == s.vertices.size() || f == t.triangles.size()) return false;
    const double size = std::max(s.diagonal, t.diagonal), rounding = 1e-5 * size;
    const Vec3 shift = (source.pose.translation - target.pose.translation)
                       + (rotate(source.pose, s.centre) - rotate(target.pose, t.centre));
    const Vec3 origin = rotate_back(target.pose, rotate(source.pose, s.vertices[v]) + shift);
    const Vec3 direction = unit(rotate_back(target.pose, rotate(source.pose, -s.vertex_normals[v])));
    const auto length_of_ray = static_cast<double>(c.ray_length);

    // The hit lies on the triangle: an own little solid of one triangle tells how far off it is.
    const auto& [i, j, k] = t.triangles[f];
    const Solid triangle = make_surface("hit", {t.vertices[i], t.vertices[j], t.vertices[k]}, {{0, 1, 2}});
    if (!(length_of_ray >= 0)) return false;
    if (distance_to_surface(triangle, origin + length_of_ray * direction) > rounding) return false;
    if (dot(direction, t.face_normals[f]) < -1e-4) return false;
    if (s.exit_margins[v] > 1e-5 && length_of_ray > s.exits[v] + rounding) return false;

    // And what is said about it is that of this hit.
    const Vec3 normal = rotate(target.pose, t.face_normals[f]);
    const Vec3 said{static_cast<double>(c.normal.x), static_cast<double>(c.normal.y), static_cast<double>(c.normal.z)};
    const Vec3 ray = rotate(target.pose, direction);
    const double sign = of_a ? -1 : 1;
    const bool along_face = length(said - sign * normal) < 1e-4, along_ray = length(said - sign * ray) < 1e-4;
    const Vec3 point = transform_point(source.pose, source.subject->shape->vertices()[v]);
    const bool weighted = std::fabs(c.weight - s.vertex_areas[v]) < 1e-6 * s.vertex_areas[v];
    return (along_face || along_ray) && (c.weight == 1 || (weighted && along_ray)) && c.depth >= 0
           && length(c.point() - point) < 1e-6 * size;
}

std::vector<Subject> make_subjects() {
    std::vector<Subject> subjects;
    for (const Mesh& mesh : {bumpy_octahedron_mesh(5), frame_mesh(), l_prism_mesh(), tetrahedron_mesh(), bowl_mesh(5),
                             sheet_mesh(5), grid_box_mesh(4), box_mesh({4, 4, 0.5})})
        subjects.emplace_back(mesh);
    return subjects;
}

class Story {
public:
    Story(const std::vector<Subject>& subjects, std::uint64_t seed, Counts& counts)
        : subjects_(subjects), random_(seed), counts_(counts), scene_(settings_of(Method::certified)) {
        for (int i = 0; i < 8; ++i) add();
    }

    void play(int steps) {
        for (int i = 0; i < steps; ++i) {
            for (std::uint32_t events = random_.below(3); events > 0; --events) happen();
            move();
            step();
        }
    }

private:
    static Settings settings_of(Method method) {
        Settings settings;
        settings.execution.threads = 1;
        settings.method = method;
        return settings;
    }

    Pose somewhere() {
        Pose pose = random_.rotation();
        pose.translation = 1.3 * random_.in_ball();
        return pose;
    }

    BodyId someone() {
        auto it = guests_.begin();
        std::advance(it, random_.below(static_cast<std::uint32_t>(guests_.size())));
        return it->first;
    }

    void add() {
        Guest guest;
        guest.subject = &subjects_[random_.below(static_cast<std::uint32_t>(subjects_.size()))];
        guest.pose = somewhere();
        const BodyId id = scene_.add(guest.subject->shape, guest.pose);
        EXPECT_FALSE(guests_.contains(id)) << "a slot was given twice";
        counts_.successors += id.generation > 0;
        guests_[id] = guest;
    }

    void move() {
        for (auto& [id, guest] : guests_) {
            const std::uint32_t how = random_.below(8);
            if (how == 0) continue;
            const double by = std::pow(10.0, random_.uniform(-6, -1.5));
            const Vec3 axis = random_.direction();
            Pose next = composed(small_rotation(axis, by), guest.pose);
            next.translation = guest.pose.translation + by * random_.in_ball();
            if (how == 1) next = rounded_to_float(next);
            guest.pose = next;
            scene_.set_pose(id, guest.pose);
        }
    }

    void happen() {
        switch (random_.below(8)) {
        case 0:
            if (guests_.size() < 12) add();
            break;
        case 1:
            if (guests_.size() > 4) {
                const BodyId gone = someone();
                scene_.remove(gone);
                guests_.erase(gone);
                gone_.push_back(gone);
            }
            break;
        case 2: {
            const BodyId id = someone();
            guests_[id].pose = somewhere();
            scene_.set_pose(id, guests_[id].pose);
            break;
        }
        case 3:
            refuse();
            break;
        case 4:
            given_ = random_.below(2) != 0;
            break;
        default:
            change_settings();
        }
    }

    void refuse() {
        const BodyId id = someone();
        Pose bad = somewhere();
        (random_.below(2) ? bad.rotation[random_.below(9)] : bad.translation.y) =
            std::numeric_limits<double>::quiet_NaN();
        try {
            scene_.set_pose(id, bad);
            ++counts_.wrong;
        } catch (const InputError& error) {
            ++counts_.refused;
            EXPECT_NE(std::string(error.what()).find("body " + std::to_string(id.slot)), std::string::npos)
                << error.what();
        }
        EXPECT_EQ(scene_.pose(id), guests_[id].pose);
    }

    void change_settings() {
        Settings changed = scene_.settings();
        constexpr Method methods[] = {Method::standard, Method::iterative, Method::predictive, Method::certified};
        if (random_.below(2)) changed.method = methods[random_.below(4)];
        if (random_.below(2)) changed.features = random_.below(2) ? Features::edges : Features::vertices;
        if (random_.below(2))
            changed.direction = directions[random_.below(static_cast<std::uint32_t>(std::size(directions)))];
        if (random_.below(3) == 0) changed.paper.caster = random_.below(2) ? Caster::bvh : Caster::basic;
        if (random_.below(3) == 0) changed.paper.skip_outside = random_.below(2) != 0;
        if (random_.below(2)) {
            changed.paper.displacement_threshold.reset();
            if (random_.below(2)) changed.paper.displacement_threshold = std::pow(10.0, random_.uniform(-7, 1));
            changed.paper.confidence = random_.uniform(1, 4);
            changed.paper.max_iterations = 1 + random_.below(30);
            changed.paper.cast_lost_walks = random_.below(2) != 0;
            changed.paper.culling_distance.reset();
            if (random_.below(3) == 0) changed.paper.culling_distance = random_.uniform(0, 0.2);
        }
        scene_.set_settings(changed);
    }

    void step() {
        std::vector<Pair> asked;
        if (given_)
            for (const auto& [a, guest_a] : guests_)
                for (const auto& [b, guest_b] : guests_)
                    if (BySlot()(a, b) && random_.below(4) != 0) asked.emplace_back(a, b);
        const std::span<const Contact> found = given_ ? scene_.find_contacts(asked) : scene_.find_contacts();
        if (given_) {
            EXPECT_TRUE(std::equal(asked.begin(), asked.end(), scene_.pairs().begin(), scene_.pairs().end()));
        }
        ++counts_.steps;
        counts_.contacts += found.size();
        expect_changes(found);
        expect_pairs(found);
        for (const BodyId gone : gone_) EXPECT_THROW(scene_.pose(gone), InputError);

        for (const auto& [id, guest] : guests_) EXPECT_EQ(scene_.pose(id), guest.pose);
        Settings settings = scene_.settings();
        const Method method = settings.method;
        settings.method = Method::standard;
        const std::vector<Contact> expected = contacts_of_fresh_scene(scene_, settings);
        if (method == Method::standard || method == Method::certified) {
            if (same_bits(expected, found))
                counts_.same += found.size();
            else
                ++counts_.wrong;
            return;
        }
        for (const Contact& c : found) {
            if (c.feature.kind != FeatureKind::vertex) continue;    // they follow from the vertices that were found
            if (settings.direction == Direction::refined) continue; // it names another face than the ray met
            if (settings.features == Features::edges && c.ray_length == c.depth) continue; // edges saw it, no ray
            if (is_genuine(c, guests_[c.body_a], guests_[c.body_b])) {
                ++counts_.genuine;
                Contact lie = c;
                ++(c.feature.source == Side::a ? lie.feature.index_b : lie.feature.index_a);
                ++counts_.lies;
                counts_.believed += is_genuine(lie, guests_[c.body_a], guests_[c.body_b]);
                continue;
            }
            if (++counts_.false_hits == 1)
                ADD_FAILURE() << to_string(method) << ", step " << counts_.steps << ": vertex "
                              << c.feature.source_index() << " does not meet triangle " << c.feature.other_index()
                              << ", ray " << c.ray_length;
        }
        std::set<Key> keys;
        for (const Contact& c : found) keys.insert(key(c));
        for (const Contact& c : expected) {
            if (c.feature.kind != FeatureKind::vertex) continue;
            ++counts_.of_standard;
            counts_.missed_by_others += !keys.contains(key(c));
        }
    }

    // New and lost are the two differences of sets, whatever the method.
    void expect_changes(std::span<const Contact> found) {
        std::set<Key> now;
        std::uint64_t came = 0;
        for (const Contact& c : found) {
            now.insert(key(c));
            came += c.is_new;
            counts_.false_changes += c.is_new == before_.contains(key(c));
        }
        std::set<Key> lost;
        for (const LostContact& c : scene_.lost_contacts()) lost.insert(key(c));
        std::set<Key> expected;
        std::set_difference(before_.begin(), before_.end(), now.begin(), now.end(),
                            std::inserter(expected, expected.end()));
        counts_.false_changes += lost != expected || lost.size() != scene_.lost_contacts().size();
        counts_.false_changes += now.size() != found.size(); // a key twice
        counts_.false_changes += scene_.stats().contacts_new != came || scene_.stats().contacts_lost != lost.size();
        counts_.came += came;
        counts_.went += lost.size();
        before_.swap(now);
    }

    void expect_pairs(std::span<const Contact> found) {
        const auto pairs = scene_.pairs();
        for (const Contact& c : found) {
            const bool exist = guests_.contains(c.body_a) && guests_.contains(c.body_b);
            const bool asked = std::any_of(pairs.begin(), pairs.end(),
                                           [&](const Pair& pair) { return pair == Pair(c.body_a, c.body_b); });
            counts_.false_pairs += !exist || !asked;
        }
    }

    const std::vector<Subject>& subjects_;
    Random random_;
    Counts& counts_;
    Scene scene_;
    std::map<BodyId, Guest, BySlot> guests_;
    std::vector<BodyId> gone_;
    std::set<Key> before_;
    bool given_ = false;
};

TEST(coherence, whatever_happens) {
    const std::vector<Subject> subjects = make_subjects();
    Counts c;
    for (std::uint64_t seed = 0; seed < 60; ++seed) Story(subjects, seed, c).play(100);
    std::printf("[ counts   ] %llu steps, %llu contacts: %llu as of a fresh scene, %llu true by a ray in double; %llu "
                "came, %llu went; %llu bad poses refused; the methods that may miss some missed %llu of %llu; %llu of "
                "%llu lies "
                "believed\n",
                static_cast<unsigned long long>(c.steps), static_cast<unsigned long long>(c.contacts),
                static_cast<unsigned long long>(c.same), static_cast<unsigned long long>(c.genuine),
                static_cast<unsigned long long>(c.came), static_cast<unsigned long long>(c.went),
                static_cast<unsigned long long>(c.refused), static_cast<unsigned long long>(c.missed_by_others),
                static_cast<unsigned long long>(c.of_standard), static_cast<unsigned long long>(c.believed),
                static_cast<unsigned long long>(c.lies));
    EXPECT_EQ(c.wrong, 0u);
    EXPECT_EQ(c.false_hits, 0u);
    EXPECT_EQ(c.false_pairs, 0u);
    EXPECT_EQ(c.false_changes, 0u);
    EXPECT_LT(c.believed, c.lies / 100);
    EXPECT_GT(c.same, 10000u);
    EXPECT_GT(c.genuine, 10000u);
    EXPECT_GT(c.came, 1000u);
    EXPECT_GT(c.went, 1000u);
    EXPECT_GT(c.refused, 100u);
    EXPECT_GT(c.successors, 100u);
}

// With a threshold of 0 every pair that moves is tested in full, but for those known to be farther apart than they
// moved: so nothing may be missed.
TEST(coherence, a_pair_is_skipped_no_longer_than_it_may) {
    std::uint64_t contacts = 0, looks = 0, ordered = 0;
    constexpr Course ways[] = {Course::approach, Course::drift, Course::approach, Course::mixed, Course::approach};
    for (std::uint64_t i = 0; i < 70; ++i) {
        Random random(900 + i);
        const Kind kind = kinds[i % std::size(kinds)];
        const auto& stock = crowd_shapes(kind, 1);
        std::vector<std::shared_ptr<const Shape>> shapes;
        for (std::size_t b = 0; b < 10; ++b) shapes.push_back(stock[b % stock.size()]);
        const std::vector<Pose> homes = touching_poses(shapes, random.uniform(0, 0.3), random);
        Settings settings;
        settings.features = Features::vertices;
        settings.execution.threads = 1;
        settings.method = Method::standard;
        Scene standard(settings);
        settings.method = i % 2 ? Method::predictive : Method::iterative;
        settings.paper.displacement_threshold = 0;
        Scene follower(settings);
        std::vector<Mover> movers;
        for (std::size_t b = 0; b < shapes.size(); ++b) {
            standard.add(shapes[b]);
            follower.add(shapes[b]);
            movers.emplace_back(ways[i % std::size(ways)], homes[b],
                                length(shapes[b]->box_max() - shapes[b]->box_min()), random);
        }
        for (int step = 0; step < 100; ++step) {
            for (std::uint32_t body = 0; body < movers.size(); ++body) {
                const Pose pose = movers[body].next(random);
                standard.set_pose({body}, pose);
                follower.set_pose({body}, pose);
            }
            const auto named = [](std::span<const Contact> list) {
                std::set<std::pair<Key, std::uint32_t>> names;
                for (const Contact& c : list) names.insert({key(c), c.feature.other_index()});
                return names;
            };
            ASSERT_EQ(named(standard.find_contacts()), named(follower.find_contacts()))
                << name_of(kind) << ", " << to_string(settings.method) << ", step " << step;
            contacts += standard.contacts().size();
            looks += follower.stats().details.pairs_full;
            ordered += 2 * follower.stats().pairs;
        }
    }
    std::printf("[ counts   ] %llu contacts; %llu of %llu directed pairs looked at\n",
                static_cast<unsigned long long>(contacts), static_cast<unsigned long long>(looks),
                static_cast<unsigned long long>(ordered));
    EXPECT_GT(contacts, 10000u);
    EXPECT_GT(ordered - looks, 10000u);
}

// Pairs of bodies that touch, `count` of them, far from each other.
std::vector<Pair> add_couples(Scene& scene, std::uint32_t count) {
    static const auto shape = prepared_shape(bumpy_octahedron_mesh(10));
    std::vector<Pair> pairs;
    for (std::uint32_t i = 0; i < count; ++i) {
        Pose pose;
        pose.translation = {10.0 * i, 0, 0};
        const BodyId first = scene.add(shape, pose);
        pose.translation.y = 0.95;
        pairs.emplace_back(first, scene.add(shape, pose));
    }
    return pairs;
}

TEST(coherence, memory_follows_the_pairs_that_overlap) {
    for (const Method method : {Method::certified, Method::iterative, Method::predictive}) {
        Settings settings;
        settings.features = Features::vertices;
        settings.execution.threads = 1;
        settings.method = method;
        std::vector<std::uint64_t> bytes;
        for (const std::uint32_t count : {10u, 40u}) {
            Scene scene(settings);
            const std::vector<Pair> pairs = add_couples(scene, count);
            for (int step = 0; step < 3; ++step) {
                // By a little: of what stands still no rays are kept.
                for (const auto& [first, second] : pairs) {
                    Pose pose = scene.pose(second);
                    pose.translation.z += 1e-6;
                    scene.set_pose(second, pose);
                }
                scene.find_contacts();
            }
            EXPECT_EQ(scene.pairs().size(), count);
            EXPECT_GT(scene.stats().contacts, 0u);
            bytes.push_back(scene.stats().pair_bytes);

            // Opened and closed many times over, it is no more.
            for (int round = 0; round < 20; ++round) {
                scene.find_contacts(std::span<const Pair>{});
                EXPECT_LE(scene.stats().pair_bytes, 256u) << to_string(method);
                scene.find_contacts(pairs);
            }
            EXPECT_LE(scene.stats().pair_bytes, 2 * bytes.back() + 256) << to_string(method);
            for (const auto& [first, second] : pairs) scene.remove(second);
            scene.find_contacts();
            EXPECT_LE(scene.stats().pair_bytes, 256u) << to_string(method);
        }
        std::printf("[ counts   ] %s keeps %llu bytes for 10 touching pairs, %llu for 40\n",
                    std::string(to_string(method)).c_str(), static_cast<unsigned long long>(bytes[0]),
                    static_cast<unsigned long long>(bytes[1]));
        if (method == Method::certified) {
            EXPECT_GT(bytes[0], 0u);
        }
        EXPECT_LE(bytes[1], 5 * bytes[0]) << to_string(method);
        EXPECT_GE(bytes[1], 3 * bytes[0]) << to_string(method);
    }
}

// Where no threshold is set, `predictive` follows no pair that is fast: it leaves them to `certified`, and takes them
// back.
TEST(coherence, predictive_leaves_fast_pairs_to_certified) {
    Settings settings;
    settings.features = Features::vertices;
    settings.execution.threads = 1;
    settings.method = Method::standard;
    Scene standard(settings);
    settings.method = Method::predictive;
    Scene predictive(settings);
    const std::vector<Pair> pairs = add_couples(standard, 6);
    add_couples(predictive, 6);
    // The first pair is always slow, so that fast ones are some of many.
    std::vector<double> apart(pairs.size(), 0.9), way(pairs.size(), 1);
    std::uint64_t compared = 0, walks_of_all = 0, walks_of_one = 0;
    for (int step = 0; step < 200; ++step) {
        const bool fast = step / 20 % 2 == 1;
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            apart[i] += way[i] * (fast && i > 0 ? 0.015 + 0.001 * double(i) : 0.0004);
            if (apart[i] < 0.8 || apart[i] > 0.95) way[i] = apart[i] > 0.9 ? -1 : 1;
            Pose pose;
            pose.translation = {10.0 * double(i), apart[i], 0};
            standard.set_pose(pairs[i].second, pose);
            predictive.set_pose(pairs[i].second, pose);
        }
        const auto of_fast = [&](std::span<const Contact> contacts) {
            std::vector<Contact> of;
            for (const Contact& c : contacts)
                if (c.body_a != pairs[0].first) of.push_back(c);
            return of;
        };
        const std::vector<Contact> expected = of_fast(standard.find_contacts(pairs)),
                                   found = of_fast(predictive.find_contacts(pairs));
        if (step % 20 < 2) continue; // a pair that sped up is followed until it has come as far as it was to be
        (fast ? walks_of_one : walks_of_all) += predictive.stats().details.walks;
        if (!fast) continue;
        ASSERT_TRUE(same_bits(expected, found)) << "step " << step;
        compared += found.size();
    }
    std::printf("[ counts   ] %llu contacts of fast pairs; %llu rays followed of six slow pairs, %llu of one\n",
                static_cast<unsigned long long>(compared), static_cast<unsigned long long>(walks_of_all),
                static_cast<unsigned long long>(walks_of_one));
    EXPECT_GT(compared, 1000u);
    EXPECT_GT(walks_of_one, 100u);
    EXPECT_GT(walks_of_all, 4 * walks_of_one);
}

} // namespace
