// SPDX-License-Identifier: Apache-2.0
#include <contact_finder.h>

#include <raycontact/least_change.h>
#include <vectors.h>

#include <LinearMath/btAabbUtil2.h>

#include <algorithm>
#include <tuple>
#include <utility>

namespace raycontact::bullet {

namespace {

/// The middle of its box, in its own frame.
btVector3 centre_of(const Leaf& leaf) {
    return (to_bullet(leaf.converted.shape->box_min()) + to_bullet(leaf.converted.shape->box_max())) / 2;
}

} // namespace

void ContactFinder::take(PairState& state, const btDispatcherInfo& info) {
    const auto &leaves0 = state.record0->leaves, &leaves1 = state.record1->leaves;
    // The broad phase has tested the boxes of whole objects.
    const bool several = leaves0.size() > 1 || leaves1.size() > 1;
    for (int i = 0; i < static_cast<int>(leaves0.size()); ++i) {
        for (int j = 0; j < static_cast<int>(leaves1.size()); ++j) {
            const LeafPair pair{leaves0[static_cast<std::size_t>(i)], leaves1[static_cast<std::size_t>(j)], i, j,
                                convex_};
            if (pair.leaf0.left_out() || pair.leaf1.left_out()) continue;
            switch (pair.work()) {
            case Work::batch: {
                if (several && apart(pair)) break;
                note_open(state, pair);
                if (const auto face = face_between(pair)) {
                    add_plane(state, pair, *face);
                    break;
                }
                add_to_batch(state, pair, Sides::one);
                break;
            }
            case Work::two_sided:
                ++stats_.two_sided_pairs;
                add_two_sided(state, pair);
                break;
            case Work::plane:
                add_plane(state, pair, pair.plane());
                break;
            case Work::round: {
                ++stats_.round_pairs;
                const auto [found, is_first] = round_of_.try_emplace(&pair.other(), rounds_.size());
                if (is_first) rounds_.emplace_back();
                rounds_[found->second].push_back({pair, pair.margin(scene_.settings()), &state.candidates});
                break;
            }
            case Work::bullet:
                state.run_child(pair, info);
                break;
            case Work::nothing:
                ++stats_.unsupported;
                break;
            }
        }
    }
}

void ContactFinder::run_rounds() {
    for (const std::vector<RoundPair>& pairs : rounds_) {
        // Bullet's algorithms report what is near, too: a ball at rest keeps its contact.
        const btScalar threshold = gContactBreakingThreshold;
        const btCollisionShape& ball = *pairs[0].pair.other().shape;
        add_rounds(pairs, btMin(threshold, ball.getContactBreakingThreshold(threshold)),
                   scene_.settings().is_speculative());
    }
}

// Vertices reach an open mesh from beyond its box; other methods follow what is apart. Speculative contacts have what
// is nearer than the margin, or may come so near.
bool ContactFinder::apart(const LeafPair& pair) const {
    const Leaf &a = pair.leaf0, &b = pair.leaf1;
    const Settings& settings = scene_.settings();
    if (settings.method != Method::standard && settings.method != Method::certified) return false;
    if (!a.converted.shape->has_inside() || !b.converted.shape->has_inside()) return false;
    btScalar reach = 0;
    if (settings.is_speculative()) reach = a.way + b.way + pair.margin(settings);
    const btVector3 around(reach, reach, reach);
    return !TestAabbAgainstAabb2(a.low - around, a.high + around, b.low, b.high);
}

// The batch alone knows other directions, and what does not touch yet.
std::optional<HalfSpace> ContactFinder::face_between(const LeafPair& pair) const {
    const Leaf &mesh = pair.mesh(), &box = pair.other();
    const Settings& settings = scene_.settings();
    if (box.form.type != BOX_SHAPE_PROXYTYPE || settings.is_speculative()
        || settings.direction != Direction::reprojected || box.stretch != no_stretch)
        return std::nullopt;
    return only_face(mesh.converted, mesh.pose, static_cast<const btBoxShape&>(*box.shape), box.pose);
}

void ContactFinder::add_plane(PairState& state, const LeafPair& pair, const HalfSpace& space) {
    ++stats_.plane_pairs;
    const btScalar size = diagonal(pair.mesh());
    // Four points would do for what rests; in a fast fall one that is left out may go deep.
    if (scene_.settings().is_speculative())
        pair.add_plane(space, pair.margin(scene_.settings()), manifolds_.patch_reach * size, state.candidates);
    else
        pair.add_plane(space, std::nullopt, size, state.candidates);
}

void ContactFinder::note_open(const PairState& state, const LeafPair& pair) {
    const auto is_open = [](const Leaf& leaf) {
        return leaf.kind == Kind::mesh && !leaf.converted.shape->has_inside();
    };
    const bool open0 = is_open(pair.leaf0), open1 = is_open(pair.leaf1);
    if (open0 || open1) ++stats_.one_sided_pairs;
    if (open0 && pair.leaf1.kind != Kind::field) tell_one_sided(*state.object0, pair.child0, pair.leaf0);
    if (open1 && pair.leaf0.kind != Kind::field) tell_one_sided(*state.object1, pair.child1, pair.leaf1);
}

// Once for each mesh: many objects may share it. What moves and is open mostly lies on what is closed.
void ContactFinder::tell_one_sided(const btCollisionObject& object, int child, const Leaf& mesh) {
    if (!mesh.is_fixed) return;
    std::weak_ptr<const Shape>& known = told_one_sided_[mesh.converted.shape.get()];
    if (!known.expired()) return;
    known = mesh.converted.shape;
    std::erase_if(told_one_sided_, [](const auto& one) { return one.second.expired(); });
    objects_.faults().add(hint_of(object, child,
                                  "its mesh is open, so it stops other meshes at the front of its faces alone and lets "
                                  "them through from behind; close it, or turn its faces to where bodies are"));
}

void ContactFinder::add_to_batch(PairState& state, const LeafPair& pair, Sides sides) {
    const auto body_of = [&](const Leaf& leaf) {
        return sides == Sides::back && &leaf == &pair.mesh() ? leaf.back : leaf.body;
    };
    const BodyId a = body_of(pair.leaf0), b = body_of(pair.leaf1);
    const bool swapped = a.slot > b.slot, speculative = scene_.settings().is_speculative();
    batch_.push_back({swapped ? Pair{b, a} : Pair{a, b}, &state, pair.child0, pair.child1, swapped,
                      manifolds_.patch_reach * pair.smaller_diagonal(),
                      speculative ? pair.margin(scene_.settings()) : btScalar(BT_LARGE_FLOAT), sides});
}

// A convex shape is on one side of each face: where its centre is.
void ContactFinder::add_two_sided(PairState& state, const LeafPair& pair) {
    const Leaf &mesh = pair.mesh(), &convex = pair.other();
    const btScalar margin = scene_.settings().is_speculative() ? pair.margin(scene_.settings()) : btScalar(0);
    const LeafPair::Passed passed = pair.passed(margin);
    const std::vector<std::uint32_t>& near = passed.triangles;
    const BulletMesh& faces = *mesh.converted.in_bullet;
    const btVector3 centre = mesh.pose.invXform(convex.pose(centre_of(convex)));
    const auto is_front = [&](std::uint32_t t) {
        const btVector3 &a = faces.corner(t, 0), one = faces.corner(t, 1) - a, two = faces.corner(t, 2) - a;
        return one.cross(two).dot(centre - a) >= 0;
    };
    const auto fronts = std::ranges::count_if(near, is_front);
    if (fronts > 0 && fronts < std::ssize(near)) between_.push_back(&state);
    if (fronts > 0) add_to_batch(state, pair, Sides::front);
    if (fronts < std::ssize(near)) {
        auto& leaves = pair.mesh_is_0() ? state.record0->leaves : state.record1->leaves;
        objects_.add_back(leaves[static_cast<std::size_t>(pair.mesh_is_0() ? pair.child0 : pair.child1)]);
        add_to_batch(state, pair, Sides::back);
    }
    pair.add_borders(passed, margin, manifolds_.patch_reach * pair.smaller_diagonal(), state.candidates);
}

bool ContactFinder::is_on_side(Candidate& c, const Entry& entry) const {
    const LeafPair pair{entry.leaf0(), entry.leaf1(), entry.child0, entry.child1, convex_};
    const bool mesh_is_0 = pair.mesh_is_0(), of_mesh = (c.key.vertex_body == 0) == mesh_is_0;
    const btVector3 away = mesh_is_0 ? -c.normal : c.normal;
    if (!(away.dot(pair.other().pose(centre_of(pair.other())) - (mesh_is_0 ? c.on0 : c.on1)) > 0)) return false;
    const Shape& shape = *pair.mesh().converted.shape;
    const BulletMesh::FreeBorder& border = pair.mesh().converted.in_bullet->free_border();
    if (c.key.feature != FeatureKind::edges)
        return !of_mesh
               || !border.vertices[static_cast<std::size_t>(
                   std::ranges::lower_bound(shape.vertex_index(), static_cast<std::uint32_t>(c.key.vertex))
                   - shape.vertex_index().begin())];
    int& edge = of_mesh ? c.key.vertex : c.key.other;
    // Of corners 0, 1, 2 the back has 0, 2, 1.
    if (entry.sides == Sides::back) edge += 2 - 2 * (edge % 3);
    c.triangle = c.key.other;
    // The pieces of a triangle that was split at a T-junction have its number.
    const std::span<const std::uint32_t> numbers = shape.triangle_index();
    const auto [begin, end] = std::equal_range(numbers.begin(), numbers.end(), static_cast<std::uint32_t>(edge / 3));
    return std::none_of(begin, end, [&](const std::uint32_t& piece) {
        const auto t = static_cast<std::size_t>(&piece - numbers.data());
        return border.edges[3 * t + static_cast<std::size_t>(edge % 3)];
    });
}

// A feature of the mesh leaves the convex shape on one side, by less. A vertex of the shape may lie between a front and
// a back, as in a corner of walls: then the second is named by its face, too.
void ContactFinder::join_sides(PairState& state) {
    std::vector<Candidate>& found = state.candidates;
    const auto of_mesh = [&](const PointKey& k) {
        const Leaf& own = k.vertex_body == 0 ? state.record0->leaves[static_cast<std::size_t>(k.child0)]
                                             : state.record1->leaves[static_cast<std::size_t>(k.child1)];
        return own.kind == Kind::mesh;
    };
    const auto name = [](const PointKey& k) {
        return std::tuple(k.child0, k.child1, k.vertex_body, k.vertex, k.feature, k.other);
    };
    const auto in_order = [&](const Candidate& a, const Candidate& b) { // of equal names the shallower first
        return std::pair(name(a.key), -a.distance) < std::pair(name(b.key), -b.distance);
    };
    std::ranges::stable_sort(found, in_order);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        Candidate c = found[i];
        if (kept > 0 && found[kept - 1].key == c.key) {
            if (of_mesh(c.key) || c.key.feature != FeatureKind::vertex) continue;
            c.key.feature = FeatureKind::vertex_face;
            c.key.other = c.triangle;
        }
        found[kept++] = c;
    }
    found.erase(found.begin() + static_cast<std::ptrdiff_t>(kept), found.end());
}

Contact ContactFinder::with_least_change(const Contact& contact, const Entry& entry) const {
    const Leaf &leaf0 = entry.leaf0(), &leaf1 = entry.leaf1();
    if (!(leaf0.way + leaf1.way > entry.margin) || contact.is_speculative()) return contact;
    const auto moving = [&](const Leaf& leaf) {
        const bool back = entry.sides == Sides::back && leaf.back.valid();
        return MovingShape{*(back ? leaf.reversed : leaf.converted).shape, to_pose(leaf.pose), to_pose(leaf.next)};
    };
    const Leaf &a = entry.swapped ? leaf1 : leaf0, &b = entry.swapped ? leaf0 : leaf1;
    return least_change(contact, moving(a), moving(b), double(entry.margin));
}

// Contacts come sorted by pair: the batch is sorted the same way, by small keys, and both are walked once.
void ContactFinder::run_batch() {
    order_.clear();
    for (std::size_t i = 0; i < batch_.size(); ++i) {
        const auto [first, second] = batch_[i].pair;
        order_.emplace_back(Slots{first.slot, second.slot}, static_cast<std::uint32_t>(i));
    }
    std::sort(order_.begin(), order_.end());
    pairs_.clear();
    for (const auto& [slots, index] : order_) pairs_.push_back(batch_[index].pair);
    stats_.mesh_pairs = pairs_.size();
    auto at = order_.begin();
    for (const Contact& contact : scene_.find_contacts(pairs_)) {
        const Slots slots{contact.body_a.slot, contact.body_b.slot};
        while (at != order_.end() && at->first < slots) ++at;
        if (at == order_.end() || at->first != slots) continue;
        const Entry& entry = batch_[at->second];
        Candidate c = candidate_of(with_least_change(contact, entry), entry.child0, entry.child1, entry.swapped);
        if (entry.sides != Sides::one && !is_on_side(c, entry)) continue;
        c.reach = entry.reach;
        entry.state->candidates.push_back(c);
    }
    for (PairState* state : between_) join_sides(*state);
}

} // namespace raycontact::bullet
