// SPDX-License-Identifier: Apache-2.0
// Speculative contacts against the reference in double, by brute force: each vertex's straight way and its distance
// from every triangle, and each pair of edges (docs/speculative.md).
#include "property/shapes.h"
#include "reference/ray.h"
#include "reference/side.h"
#include "reference/solid_edges.h"
#include "reference/vector.h"

#include <raycontact/error.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>

using namespace raycontact;
using namespace raycontact::reference;

namespace {

Settings speculative_settings() {
    Settings settings;
    settings.devices = "cpu";
    settings.speculative = true;
    settings.features = Features::vertices;
    return settings;
}

Vec3 to_local(const Subject& subject, const Pose& pose, const Vec3& world) {
    return rotate_back(pose, world - pose.translation) - subject.solid.centre;
}
Vec3 to_world(const Subject& subject, const Pose& pose, const Vec3& local) {
    return rotate(pose, local + subject.solid.centre) + pose.translation;
}

// A move by up to `far` metres and a turn by up to some 0.4 times as much.
Pose moved(const Pose& pose, double far, Random& random) {
    const Vec3 axis = 0.2 * far * random.in_ball();
    const Pose turn = pose_from_quaternion({}, 1, axis.x, axis.y, axis.z);
    Pose next = pose;
    for (std::size_t j = 0; j < 3; ++j) {
        const Vec3 column = rotate(turn, {pose.rotation[j], pose.rotation[3 + j], pose.rotation[6 + j]});
        next.rotation[j] = column.x, next.rotation[3 + j] = column.y, next.rotation[6 + j] = column.z;
    }
    next.translation = pose.translation + far * random.in_ball();
    return next;
}

struct Flight {
    Placement now;
    Pose next_a, next_b;
};

std::vector<Flight> random_flights(std::size_t count, std::uint64_t seed, double far) {
    Random random(seed);
    auto subjects = pointers(closed_subjects());
    for (const Subject* open : pointers(open_subjects())) subjects.push_back(open);
    std::vector<Flight> flights;
    for (std::size_t i = 0; i < count; ++i) {
        Flight flight;
        flight.now = random_placement(subjects, random);
        flight.next_a = moved(flight.now.pose_a, far, random);
        flight.next_b = moved(flight.now.pose_b, far, random);
        flights.push_back(flight);
    }
    return flights;
}

std::vector<Placement> beginnings(const std::vector<Flight>& flights) {
    std::vector<Placement> placements(flights.size());
    std::ranges::transform(flights, placements.begin(), &Flight::now);
    return placements;
}

/// One body seen from another, in the other's frame about its centre, now and at the next step.
struct View {
    const Subject &source, &target;
    Pose now, then, target_now, target_then; ///< of the bodies, world

    Vec3 at_now(const Vec3& p) const { return to_local(target, target_now, to_world(source, now, p)); }
    Vec3 at_then(const Vec3& p) const { return to_local(target, target_then, to_world(source, then, p)); }
    Vec3 turned(const Vec3& n) const { return rotate_back(target_now, rotate(now, n)); }
    double size() const { return std::min(source.solid.diagonal, target.solid.diagonal); }
    /// The bound by which a pair hurries (docs/speculative.md).
    double way() const {
        double turn = 0;
        for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
            const Vec3 by = (at_then(axis) - at_then({})) - (at_now(axis) - at_now({}));
            turn += dot(by, by);
        }
        double reach = 0;
        for (const Vec3& v : source.solid.vertices) reach = std::max(reach, length(v));
        return length(at_then({}) - at_now({})) + std::sqrt(turn / 2) * reach;
    }
};

View view(const Flight& f, bool of_b) {
    const Placement& p = f.now;
    return of_b ? View{*p.b, *p.a, p.pose_b, f.next_b, p.pose_a, f.next_a}
                : View{*p.a, *p.b, p.pose_a, f.next_a, p.pose_b, f.next_b};
}

/// What a vertex, or an edge with another, is expected to have.
struct Expected {
    double gap = 0;
    Vec3 normal; ///< out of the target, its frame
    Vec3 point;  ///< of the source, the target's frame
};
/// By the numbers of the file: a vertex and 0, or two edges.
using Key = std::pair<std::uint32_t, std::uint32_t>;
struct Expectation {
    std::map<Key, Expected> sure;
    std::set<Key> doubtful; ///< close to where the answer changes
};

Vec3 nearest_of_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 along = b - a;
    return a + std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0) * along;
}

Vec3 nearest_of_triangle(const Solid& solid, std::uint32_t t, const Vec3& p) {
    const auto& [i, j, k] = solid.triangles[t];
    const Vec3 &a = solid.vertices[i], &b = solid.vertices[j], &c = solid.vertices[k], &n = solid.face_normals[t];
    const Vec3 q = p - dot(p - a, n) * n;
    if (dot(cross(b - a, q - a), n) >= 0 && dot(cross(c - b, q - b), n) >= 0 && dot(cross(a - c, q - c), n) >= 0)
        return q;
    Vec3 best = nearest_of_segment(p, a, b);
    for (const Vec3& other : {nearest_of_segment(p, b, c), nearest_of_segment(p, c, a)})
        if (length(p - other) < length(p - best)) best = other;
    return best;
}

class Vertices {
public:
    Vertices(const View& view, double margin) : view_(view), margin_(margin), caster_(view.target.solid) {}

    /// touching: vertices of the file in contact, which have no other.
    Expectation expect(const std::set<std::uint32_t>& touching) {
        Expectation found;
        const Solid& source = view_.source.solid;
        const double way = view_.way();
        for (std::size_t v = 0; v < source.vertices.size(); ++v) {
            const Key key{source.vertex_index[v], 0};
            if (touching.contains(key.first)) continue;
            const Vec3 p = view_.at_now(source.vertices[v]);
            bool sure = std::abs(way - margin_) > 1e-7;
            if (source.exits[v] > 0) { // others cast no ray and have no contact of any kind
                const auto one = ask(v, p, way > margin_, sure);
                if (one && sure) found.sure[key] = *one;
            }
            if (!sure) found.doubtful.insert(key);
        }
        return found;
    }

private:
    std::optional<Expected> ask(std::size_t v, const Vec3& p, bool moves, bool& sure) {
        const Solid& target = view_.target.solid;
        const double hair = 3e-7 * view_.size();
        if (moves) {
            const Vec3 to = view_.at_then(view_.source.solid.vertices[v]), direction = unit(to - p);
            const double way = length(to - p);
            const Hit hit = caster_.closest(p, direction), behind = caster_.closest(p, -direction);
            if (behind.distance < hair || hit.distance < hair || std::abs(hit.distance - way) < hair) sure = false;
            if (hit.triangle != Hit::none && hit.distance <= way && !hit.from_inside) {
                const Vec3& n = target.face_normals[hit.triangle];
                if (-dot(n, direction) < 1e-5) sure = false;
                return Expected{dot(p - target.vertices[target.triangles[hit.triangle][0]], n), n, p};
            }
        }
        double least = std::numeric_limits<double>::infinity();
        Vec3 at{};
        for (std::uint32_t t = 0; t < target.triangles.size(); ++t) {
            const Vec3 q = nearest_of_triangle(target, t, p);
            if (length(p - q) >= least) continue;
            least = length(p - q);
            at = q;
        }
        if (std::abs(least - margin_) < hair || least < 10 * hair) sure = false;
        if (least > margin_) return std::nullopt;
        const Vec3 n = unit(p - at);
        const double facing = dot(view_.turned(view_.source.solid.vertex_normals[v]), n);
        const double side = side_of(p, at);
        if (std::abs(facing) < 1e-4 || std::abs(side) < 0.1) sure = false;
        if (!(facing < 0) || !(side > 0)) return std::nullopt;
        return Expected{least, n, p};
    }

    // Positive outside; by what is nearest. Of closed targets exact.
    double side_of(const Vec3& p, const Vec3& at) const {
        const Solid& target = view_.target.solid;
        if (target.closed) return winding_number(target, p) < 0.5 ? 1 : -1;
        Vec3 sum{};
        for (std::uint32_t t = 0; t < target.triangles.size(); ++t)
            if (length(at - nearest_of_triangle(target, t, at)) < 1e-9 * target.diagonal)
                sum = sum + target.face_normals[t];
        return dot(unit(p - at), unit(sum));
    }

    const View& view_;
    double margin_;
    RayCaster caster_;
};

/// Of a's edges against b's, in b's frame.
class Edges {
public:
    Edges(const View& view, double margin, bool told)
        : view_(view), margin_(margin), least_(told ? 0.2 * view.size() : 0) {}

    Expectation expect(const std::set<Key>& touching) const {
        Expectation found;
        const auto own = edges_of(view_.source.solid), other = edges_of(view_.target.solid);
        const double way = view_.way();
        for (const Edge& e : own)
            for (const Edge& g : other) {
                const Key key{e.number, g.number};
                if (touching.contains(key) || !asked(e, view_.source.solid) || !asked(g, view_.target.solid)) continue;
                bool sure = std::abs(way - margin_) > 1e-7;
                const auto one = ask(e, g, way > margin_, sure);
                if (one && sure) found.sure[key] = *one;
                if (!sure) found.doubtful.insert(key);
            }
        return found;
    }

private:
    bool asked(const Edge& e, const Solid& solid) const {
        return e.sharp && !e.concave && length(solid.vertices[e.to] - solid.vertices[e.from]) > least_;
    }

    /// Of an edge at part t of the step.
    struct Segment {
        Vec3 from, along;
    };
    Segment place(const Edge& e, double t) const {
        const auto at = [&](std::uint32_t v) {
            const Vec3 p = view_.at_now(view_.source.solid.vertices[v]);
            return p + t * (view_.at_then(view_.source.solid.vertices[v]) - p);
        };
        return {at(e.from), at(e.to) - at(e.from)};
    }

    // By how much n leaves the arc of the normals of the edge's faces; along: as the first face runs about it.
    static double beyond(const Vec3& n, const Vec3& along, const Vec3& own, const Vec3* across) {
        const double first = dot(n, cross(own, unit(along)));
        return across ? std::max(first, -dot(n, cross(*across, unit(along)))) : std::max(first, -dot(n, own));
    }

    bool in_arcs(const Edge& e, const Edge& g, const Vec3& n, const Vec3& along, const Vec3& other, bool& sure) const {
        const Solid &source = view_.source.solid, &target = view_.target.solid;
        const Vec3 e0 = view_.turned(source.face_normals[e.faces[0]]);
        const Vec3 e1 = e.faces[1] == none ? Vec3{} : view_.turned(source.face_normals[e.faces[1]]);
        const double by_e = beyond(-n, along, e0, e.faces[1] == none ? nullptr : &e1);
        const double by_g = beyond(n, other, target.face_normals[g.faces[0]],
                                   g.faces[1] == none ? nullptr : &target.face_normals[g.faces[1]]);
        for (const double by : {by_e, by_g})
            if (std::abs(by - 0.1) < 1e-6) sure = false;
        return by_e <= 0.1 && by_g <= 0.1;
    }

    // The parts of both lines where they are nearest; false unless within both.
    static bool nearest(const Segment& e, const Segment& g, double& s, double& u, bool& sure) {
        const Vec3 n = cross(e.along, g.along), apart = g.from - e.from;
        const double whole = dot(n, n);
        if (std::sqrt(whole) < 2e-3 * length(e.along) * length(g.along)) {
            sure = false; // nearly parallel
            return false;
        }
        s = dot(cross(apart, g.along), n) / whole;
        u = dot(cross(apart, e.along), n) / whole;
        for (const double part : {s, s - 1, u, u - 1})
            if (std::abs(part) < 1e-6) sure = false;
        return s >= 0 && s <= 1 && u >= 0 && u <= 1;
    }

    double volume(const Edge& e, const Segment& g, double t) const {
        const Segment at = place(e, t);
        return dot(cross(at.along, g.along), g.from - at.from);
    }

    // In parts of the step, by steps and halving.
    std::vector<double> meetings(const Edge& e, const Segment& g) const {
        constexpr int steps = 200;
        std::vector<double> found;
        double before = volume(e, g, 0);
        for (int i = 0; i < steps; ++i) {
            double low = double(i) / steps, high = double(i + 1) / steps;
            const double after = volume(e, g, high);
            if ((before < 0) != (after < 0)) {
                for (int k = 0; k < 60; ++k) {
                    const double middle = 0.5 * (low + high);
                    ((volume(e, g, middle) < 0) == (before < 0) ? low : high) = middle;
                }
                found.push_back(0.5 * (low + high));
            }
            before = after;
        }
        return found;
    }

    std::optional<Expected> ask(const Edge& e, const Edge& g, bool moves, bool& sure) const {
        const Solid& target = view_.target.solid;
        const Segment now = place(e, 0), next = place(e, 1);
        const Segment other{target.vertices[g.from], target.vertices[g.to] - target.vertices[g.from]};
        const double hair = 3e-7 * view_.size();
        double s = 0, u = 0;
        const auto told = [&](const Vec3& n) {
            const Vec3 point = now.from + s * now.along;
            return Expected{std::max(0.0, dot(n, point - (other.from + u * other.along))), n, point};
        };
        for (const double t : moves ? meetings(e, other) : std::vector<double>()) {
            const Segment then = place(e, t);
            if (!nearest(then, other, s, u, sure)) continue;
            const Vec3 way = (next.from - now.from) + s * (next.along - now.along);
            Vec3 n = unit(cross(then.along, other.along));
            if (dot(n, way) > 0) n = -n;
            if (std::abs(dot(n, way)) < hair) sure = false;
            if (!in_arcs(e, g, n, then.along, other.along, sure)) continue;
            if (t < 1e-4 || t > 1 - 1e-4) sure = false;
            return told(n);
        }
        if (moves && std::abs(volume(e, other, 0)) < hair * length(cross(now.along, other.along))) sure = false;
        if (moves && std::abs(volume(e, other, 1)) < hair * length(cross(next.along, other.along))) sure = false;
        if (!nearest(now, other, s, u, sure)) return std::nullopt;
        Vec3 n = unit(cross(now.along, other.along));
        Vec3 out = target.face_normals[g.faces[0]];
        if (g.faces[1] != none) out = out + target.face_normals[g.faces[1]];
        if (dot(n, out) < 0) n = -n;
        const double gap = dot(n, (now.from + s * now.along) - (other.from + u * other.along));
        if (std::abs(gap) < hair || std::abs(gap - margin_) < hair) sure = false;
        if (!(gap >= 0 && gap <= margin_) || !in_arcs(e, g, n, now.along, other.along, sure)) return std::nullopt;
        return told(n);
    }

    const View& view_;
    double margin_, least_;
};

struct Counts {
    std::size_t same = 0, doubtful = 0;
};

/// side: whose vertices, or a for edges, seen from the other.
void compare(const Expectation& expected, std::span<const Contact> found, Feature feature, const View& view,
             VertexBody side, Counts& counts) {
    std::map<Key, const Contact*> got;
    for (const Contact& c : found)
        if (is_speculative(c) && c.feature == feature && c.vertex_body == side) {
            EXPECT_TRUE(got.emplace(Key{c.vertex, c.other()}, &c).second) << "twice: " << c.vertex;
        }
    for (const auto& [key, one] : expected.sure) {
        const auto at = got.find(key);
        if (at == got.end()) {
            ADD_FAILURE() << "missed: " << key.first << ", " << key.second << ", gap " << one.gap;
            continue;
        }
        const Contact& c = *at->second;
        const double sign = side == VertexBody::a ? -1 : 1;
        const Vec3 n = sign * rotate(view.target_now, one.normal);
        EXPECT_NEAR(double(c.depth), -one.gap, 1e-5 * view.size());
        EXPECT_EQ(c.ray_length, -c.depth);
        EXPECT_LT(length(to_world(view.target, view.target_now, one.point) - c.point), 1e-5 * view.size());
        if (one.gap > 1e-3 * view.size()) {
            const Vec3 its{double(c.normal[0]), double(c.normal[1]), double(c.normal[2])};
            EXPECT_LT(length(its - n), 1e-3) << key.first;
        }
        ++counts.same;
        got.erase(at);
    }
    for (const Key& key : expected.doubtful) counts.doubtful += got.erase(key);
    for (const auto& [key, contact] : got)
        ADD_FAILURE() << "invented: " << key.first << ", " << key.second << ", gap " << -contact->depth;
}

/// What touches, of a side: vertices, or two edges.
std::set<Key> touching(std::span<const Contact> contacts, Feature feature, VertexBody side) {
    std::set<Key> keys;
    for (const Contact& c : contacts)
        if (!is_speculative(c) && c.feature == feature && c.vertex_body == side) keys.emplace(c.vertex, c.other());
    return keys;
}

/// Steps once from all flights, and hands each pair's contacts to check(flight, contacts).
template <class Check>
void step(const std::vector<Flight>& flights, const Settings& settings, Check&& check) {
    Scene scene(settings);
    const auto pairs = add_all(scene, beginnings(flights));
    for (std::size_t i = 0; i < flights.size(); ++i) {
        scene.set_next_pose(pairs[i].first, flights[i].next_a);
        scene.set_next_pose(pairs[i].second, flights[i].next_b);
    }
    scene.step(pairs);
    const auto speculative = std::ranges::count_if(scene.contacts(), is_speculative);
    EXPECT_EQ(scene.stats().contacts_speculative, std::uint64_t(speculative));
    EXPECT_EQ(scene.stats().contacts, scene.contacts().size() - std::size_t(speculative));
    const auto parts = by_pair(scene.contacts(), flights.size());
    for (std::size_t i = 0; i < flights.size(); ++i) {
        SCOPED_TRACE(testing::Message() << "flight " << i);
        check(flights[i], parts[i]);
    }
}

double margin_of(const Settings& settings, const Flight& f) {
    if (settings.speculative_margin) return *settings.speculative_margin;
    return speculative_share * std::min(f.now.a->solid.diagonal, f.now.b->solid.diagonal);
}

void expect_vertices(const std::vector<Flight>& flights, const Settings& settings, Counts& counts) {
    step(flights, settings, [&](const Flight& f, std::span<const Contact> contacts) {
        for (const VertexBody side : {VertexBody::a, VertexBody::b}) {
            const View seen = view(f, side == VertexBody::b);
            std::set<std::uint32_t> vertices;
            for (const Key& key : touching(contacts, Feature::vertex, side)) vertices.insert(key.first);
            compare(Vertices(seen, margin_of(settings, f)).expect(vertices), contacts, Feature::vertex, seen, side,
                    counts);
        }
    });
}

TEST(Speculative, VerticesOnTheirWayAreThoseOfTheReference) {
    Counts counts;
    for (const Method method : {Method::certified, Method::standard}) {
        Settings settings = speculative_settings();
        settings.method = method;
        expect_vertices(random_flights(100, 1, 0.8), settings, counts);
    }
    std::printf("[ vertices ] %zu as expected, %zu doubtful\n", counts.same, counts.doubtful);
    EXPECT_GT(counts.same, 5000u);
    EXPECT_LT(counts.doubtful, counts.same / 100);
}

TEST(Speculative, VerticesWithinTheMarginAreThoseOfTheReference) {
    Counts counts;
    for (const std::optional<double> margin : {std::optional<double>(), std::optional<double>(0.05)}) {
        Settings settings = speculative_settings();
        settings.speculative_margin = margin;
        expect_vertices(random_flights(400, 2, 0.0005), settings, counts);
    }
    std::printf("[ vertices ] %zu as expected, %zu doubtful\n", counts.same, counts.doubtful);
    EXPECT_GT(counts.same, 1500u);
    EXPECT_LT(counts.doubtful, counts.same / 50);
}

TEST(Speculative, EdgesAreThoseOfTheReference) {
    Counts counts;
    Random random(3);
    std::vector<const Subject*> subjects; // coarse ones: every edge against every other
    for (const Subject* subject : pointers(closed_subjects()))
        if (subject->solid.triangles.size() < 200) subjects.push_back(subject);
    for (const auto& [margin, far] : {std::pair(std::optional<double>(), 0.6), std::pair(std::optional(0.06), 0.01)}) {
        Settings settings = speculative_settings();
        settings.features = Features::edges;
        settings.speculative_margin = margin;
        std::vector<Flight> flights;
        for (int i = 0; i < 2000; ++i) {
            Placement placed = random_placement(subjects, random);
            // Mostly a little apart.
            placed.pose_b.translation =
                placed.pose_b.translation + 0.4 * (placed.pose_b.translation - placed.pose_a.translation);
            const Pose next_a = moved(placed.pose_a, far, random), next_b = moved(placed.pose_b, far, random);
            flights.push_back({placed, next_a, next_b});
        }
        step(flights, settings, [&](const Flight& f, std::span<const Contact> contacts) {
            const View seen = view(f, false);
            const bool told =
                std::ranges::any_of(contacts, [](const Contact& c) { return c.feature == Feature::vertex; });
            const auto expected =
                Edges(seen, margin_of(settings, f), told).expect(touching(contacts, Feature::edges, VertexBody::a));
            compare(expected, contacts, Feature::edges, seen, VertexBody::a, counts);
        });
    }
    std::printf("[ edges    ] %zu as expected, %zu doubtful\n", counts.same, counts.doubtful);
    EXPECT_GT(counts.same, 300u);
    EXPECT_LT(counts.doubtful, counts.same / 10);
}

std::vector<Contact> touching_alone(std::span<const Contact> contacts) {
    std::vector<Contact> found;
    std::ranges::copy_if(contacts, std::back_inserter(found), [](const Contact& c) { return !is_speculative(c); });
    return found;
}

TEST(Speculative, ChangesNothingThatTouchesAndNoThreadChangesIt) {
    const auto flights = random_flights(60, 2, 0.8);
    for (const Method method : {Method::standard, Method::certified, Method::iterative, Method::predictive}) {
        SCOPED_TRACE(to_string(method));
        std::vector<Contact> all, without;
        for (const std::uint32_t threads : {0u, 1u, 4u}) {
            Settings settings = speculative_settings();
            settings.features = Features::edges;
            settings.method = method;
            settings.threads = std::max(1u, threads);
            settings.speculative = threads > 0;
            Scene scene(settings);
            const auto pairs = add_all(scene, beginnings(flights));
            for (std::size_t i = 0; i < flights.size(); ++i) {
                scene.set_next_pose(pairs[i].first, flights[i].next_a);
                scene.set_next_pose(pairs[i].second, flights[i].next_b);
            }
            const auto found = scene.step(pairs);
            ContactHash hash, hash_of_all(Direction::reprojected, true);
            hash.add(0, found);
            hash_of_all.add(0, found);
            EXPECT_EQ(hash.hex() == hash_of_all.hex(), threads == 0);
            if (threads == 0) without.assign(found.begin(), found.end());
            if (threads == 1) all.assign(found.begin(), found.end());
            EXPECT_TRUE(same_bits(touching_alone(found), without)) << threads;
            double ray_length = 0;
            for (const Contact& c : without) ray_length += double(c.ray_length);
            EXPECT_EQ(scene.stats().ray_length, ray_length);
            EXPECT_TRUE(threads == 0 || same_bits(found, all)) << threads;
        }
        EXPECT_GT(without.size(), 1000u);
        EXPECT_GT(all.size(), without.size() + 1000);
    }
}

// What touches is new when it did not touch before, whether or not it was seen coming; and lost when it no longer does.
TEST(Speculative, ATouchIsNewAndALiftIsLost) {
    const Subject& cube = closed_subjects()[6];
    const double size = cube.solid.diagonal;
    Scene scene(speculative_settings());
    scene.add(cube.shape);
    const BodyId body = scene.add(cube.shape);
    const double high = 2 * (cube.solid.box_max.z - cube.solid.box_min.z);
    const auto step_at = [&](double height) {
        const Pose pose{.translation = {0.1 * size, 0.05 * size, height}};
        scene.set_pose(body, pose);
        scene.set_next_pose(body, pose);
        scene.step();
    };
    double low = 0, gap = high; // where it only just touches, by halving
    for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (low + gap);
        step_at(middle);
        (scene.stats().contacts > 0 ? low : gap) = middle;
    }
    step_at(gap + 1e-3 * size);
    step_at(gap + 1e-3 * size);
    EXPECT_GT(scene.stats().contacts_speculative, 0u);
    EXPECT_EQ(scene.stats().contacts_new + scene.stats().contacts_lost, 0u);
    step_at(low - 1e-3 * size);
    EXPECT_GT(scene.stats().contacts, 0u);
    EXPECT_EQ(scene.stats().contacts_new, scene.stats().contacts);
    for (const Contact& c : scene.contacts()) EXPECT_TRUE(is_speculative(c) || c.is_new);
    const std::uint64_t touched = scene.stats().contacts;
    step_at(gap + 1e-3 * size);
    EXPECT_EQ(scene.lost_contacts().size(), touched);
    EXPECT_EQ(scene.stats().contacts, 0u);
}

// A body above its like, that the broad phase would not pair with it where they are.
TEST(Speculative, WithoutANextPoseTheLastMotionGoesOn) {
    const Subject& cube = closed_subjects()[6];
    Scene scene(speculative_settings());
    scene.add(cube.shape);
    const BodyId body = scene.add(cube.shape);
    const double size = cube.solid.diagonal;
    const auto step_at = [&](double height) {
        scene.set_pose(body, {.translation = {0.1 * size, 0.05 * size, height * size}});
        return scene.step().size();
    };
    EXPECT_EQ(step_at(2.7), 0u) << "it was never elsewhere";
    EXPECT_EQ(step_at(1.8), 0u) << "it comes to 0.9";
    EXPECT_GT(step_at(0.9), 0u) << "it comes to 0";
    EXPECT_EQ(scene.stats().contacts, 0u);
    const std::vector<Contact> expected(scene.contacts().begin(), scene.contacts().end());
    EXPECT_EQ(step_at(0.9), 0u) << "it stands still";
    EXPECT_EQ(step_at(1.8), 0u) << "it leaves";
    EXPECT_GT(step_at(0.9), 0u);
    step_at(2);
    EXPECT_EQ(step_at(0.9), 0u) << "farther than its own size: it was put there";
    step_at(0.9);
    scene.set_next_pose(body, {.translation = {0.1 * size, 0.05 * size, 0}});
    EXPECT_TRUE(same_bits(scene.step(), expected)) << "said, not guessed";
    EXPECT_TRUE(scene.step().empty()) << "it was said for one step";

    // A body that gets the slot of another does not inherit its way.
    scene.set_next_pose(body, {.translation = {0, 0, 0}});
    scene.remove(body);
    scene.step();
    scene.add(cube.shape, {.translation = {0, 0, 0.9 * size}});
    EXPECT_TRUE(scene.step().empty());
}

// Two bodies on either side of a third, at gaps of 1 and 4 % of their size.
TEST(Speculative, ABodyMayHaveAMarginOfItsOwn) {
    const Subject& prism = closed_subjects()[6];
    const double size = prism.solid.diagonal;
    const double wide = prism.solid.box_max.x - prism.solid.box_min.x;
    for (const Method method : {Method::standard, Method::certified}) {
        Settings settings = speculative_settings();
        settings.method = method;
        settings.features = Features::edges;
        Scene scene(settings);
        const BodyId middle = scene.add(prism.shape);
        const BodyId left = scene.add(prism.shape, {.translation = {-wide - 0.01 * size, 0, 0}});
        scene.add(prism.shape, {.translation = {wide + 0.04 * size, 0, 0}});
        const auto pairs_of = [&] {
            scene.step();
            std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
            for (const Contact& c : scene.contacts()) pairs.emplace(c.body_a, c.body_b);
            return pairs.size();
        };
        EXPECT_EQ(pairs_of(), 0u);
        scene.set_speculative_margin(left, 0.02 * size);
        EXPECT_EQ(pairs_of(), 1u);
        scene.set_speculative_margin(middle, 0.05 * size);
        EXPECT_EQ(pairs_of(), 2u) << "the larger counts";
        scene.set_speculative_margin(middle, std::nullopt);
        EXPECT_EQ(pairs_of(), 1u);
        EXPECT_THROW(scene.set_speculative_margin(left, -1), InputError);
        scene.remove(left);
        EXPECT_EQ(pairs_of(), 0u);
        scene.add(prism.shape, {.translation = {-wide - 0.01 * size, 0, 0}});
        EXPECT_EQ(pairs_of(), 0u) << "another body in its slot";
        EXPECT_THROW(scene.set_speculative_margin(left, 0.02), InputError);
    }
}

TEST(Speculative, BadMarginsAreRefused) {
    Settings settings = speculative_settings();
    for (const double bad :
         {-0.01, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        settings.speculative_margin = bad;
        EXPECT_THROW(Scene{settings}, InputError) << bad;
    }
}

TEST(Speculative, BadPosesAreRefused) {
    Scene scene(speculative_settings());
    const BodyId body = scene.add(closed_subjects()[0].shape);
    Pose bad;
    bad.translation.x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(scene.set_next_pose(body, bad), InputError);
    bad = {};
    bad.rotation[0] = 2;
    EXPECT_THROW(scene.set_next_pose(body, bad), InputError);
    scene.remove(body);
    EXPECT_THROW(scene.set_next_pose(body, {}), InputError);
}

} // namespace
