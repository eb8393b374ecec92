// SPDX-License-Identifier: Apache-2.0
#include <leaf_pair.h>

#include <border.h>
#include <round.h>
#include <vectors.h>

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>

namespace raycontact::bullet {

namespace {

bool has_triangles(const Leaf& leaf) {
    return (leaf.kind == Kind::mesh || leaf.kind == Kind::field) && leaf.converted.shape != nullptr;
}

/// triangle: as Candidate::triangle.
PlaceName name_of_triangle(const Leaf& leaf, int triangle) {
    if (const auto& names = leaf.converted.names) {
        const auto at = static_cast<std::size_t>(triangle);
        return at < names->size() ? (*names)[at] : PlaceName{}; // what spans a hole has none
    }
    return bullet::name_of_triangle(*leaf.shape, triangle);
}

PlaceName name_of_feature(const Leaf& leaf, const PointKey& key) {
    if (key.feature == FeatureKind::edges) return name_of_triangle(leaf, key.vertex / 3);
    if (key.feature == FeatureKind::faces) return name_of_triangle(leaf, key.vertex);
    const Shape& shape = *leaf.converted.shape;
    const auto vertices = shape.vertex_index(); // ascending
    const auto at = std::ranges::lower_bound(vertices, static_cast<std::uint32_t>(key.vertex));
    if (at == vertices.end() || *at != static_cast<std::uint32_t>(key.vertex)) return {};
    const std::uint32_t triangle = shape.vertex_triangles()[static_cast<std::size_t>(at - vertices.begin())];
    if (triangle == Shape::no_triangle) return {};
    return name_of_triangle(leaf, static_cast<int>(shape.triangle_index()[triangle]));
}

} // namespace

bool unsupported(const btCollisionShape& a, const btCollisionShape& b) {
    const auto empty = [](const btCollisionShape& s) { return s.getShapeType() == EMPTY_SHAPE_PROXYTYPE; };
    return a.isConcave() && b.isConcave() && !empty(a) && !empty(b);
}

btScalar diagonal(const Leaf& leaf) {
    if (leaf.kind == Kind::plane) return BT_LARGE_FLOAT;
    if (leaf.kind == Kind::round) return btScalar(size_of(round_of(*leaf.shape)));
    if (!leaf.converted.shape) { // a height field that only balls meet
        btVector3 low, high;
        leaf.shape->getAabb(btTransform::getIdentity(), low, high);
        return (high - low).length();
    }
    const Vec3 a = leaf.converted.shape->box_min(), b = leaf.converted.shape->box_max();
    return to_bullet({b.x - a.x, b.y - a.y, b.z - a.z}).length();
}

Work LeafPair::work() const {
    // A flat hull has no mesh to stand for it, and a stretched ball is none.
    const auto kind = [](const Leaf& leaf) {
        if (leaf.kind == Kind::round && leaf.stretch != no_stretch) return Kind::other;
        return leaf.kind == Kind::convex && !leaf.converted.shape ? Kind::other : leaf.kind;
    };
    const Kind one = kind(leaf0), two = kind(leaf1);
    const auto either = [&](Kind k) { return one == k || two == k; };
    if (either(Kind::field) && either(Kind::round)) // a stretched field has no mesh
        return mesh().stretch == no_stretch ? Work::round : Work::bullet;
    if (either(Kind::mesh)) {
        if (either(Kind::plane)) return Work::plane;
        if (either(Kind::round)) return Work::round;
        if (either(Kind::convex) && is_two_sided()) return Work::two_sided;
        if (!either(Kind::other)) return Work::batch;
    }
    return unsupported(*leaf0.shape, *leaf1.shape) ? Work::nothing : Work::bullet;
}

bool LeafPair::is_two_sided() const {
    return convex == ConvexShapes::by_mesh && mesh().kind == Kind::mesh && mesh().is_fixed && mesh().converted.shape
           && !mesh().converted.shape->has_inside();
}

Candidate LeafPair::candidate(bool feature_of_mesh, int feature, const btVector3& on_mesh, const btVector3& on_other,
                              const btVector3& normal, btScalar distance) const {
    Candidate c;
    c.key = {child0, child1, feature_of_mesh == mesh_is_0() ? 0 : 1, feature};
    c.on0 = mesh_is_0() ? on_mesh : on_other;
    c.on1 = mesh_is_0() ? on_other : on_mesh;
    c.normal = mesh_is_0() ? normal : -normal;
    c.distance = distance;
    return c;
}

HalfSpace LeafPair::plane() const {
    const Leaf& plane = leaf0.kind == Kind::plane ? leaf0 : leaf1;
    return half_space(static_cast<const btStaticPlaneShape&>(*plane.shape), plane.pose, plane.stretch);
}

void LeafPair::add_plane(const HalfSpace& space, std::optional<btScalar> near_by, btScalar reach,
                         std::vector<Candidate>& out) const {
    static thread_local std::vector<PlaneContact> below;
    const Leaf& leaf = mesh();
    plane_contacts(leaf.converted, leaf.pose, space, near_by ? btMax(*near_by, leaf.way) : 0, below);
    const Pose next = to_pose(leaf.next);
    const auto will_touch = [&](const PlaneContact& f) {
        return depth_in(space, transform_point(next, leaf.converted.shape->vertices()[f.vertex])) >= 0;
    };
    for (const PlaneContact& f : below) {
        if (f.depth < -near_by.value_or(0) && !will_touch(f)) continue;
        const auto vertex = static_cast<int>(leaf.converted.shape->vertex_index()[f.vertex]);
        Candidate c = candidate(true, vertex, f.point, f.point + space.normal * f.depth, space.normal, -f.depth);
        c.speculative = f.depth <= 0;
        c.reach = reach;
        out.push_back(c);
    }
}

btScalar LeafPair::margin(const Settings& settings) const {
    return settings.speculative_margin ? btScalar(*settings.speculative_margin)
                                       : btScalar(speculative_share) * smaller_diagonal();
}

void add_rounds(std::span<const RoundPair> pairs, btScalar near_by, bool ahead) {
    static thread_local std::vector<RoundContact> found;
    static thread_local std::vector<Obstacle> obstacles;
    static thread_local std::vector<FieldFacets> fields; // obstacles point at them
    obstacles.clear();
    fields.clear();
    fields.reserve(pairs.size());
    for (const RoundPair& p : pairs) {
        const Leaf& mesh = p.pair.mesh();
        const bool is_field = mesh.kind == Kind::field;
        const Facets surface =
            is_field ? Facets(fields.emplace_back(static_cast<const btHeightfieldTerrainShape&>(*mesh.shape)))
                     : Facets(*mesh.converted.shape);
        obstacles.push_back(
            {surface, to_pose(mesh.pose), to_pose(mesh.next), is_field || p.pair.is_two_sided(),
             speculative_share * double(p.pair.smaller_diagonal())}); // flush, however wide the margin is
    }
    const Leaf& ball = pairs[0].pair.other();
    const Round round = round_of(*ball.shape);
    round_contacts(round, to_pose(ball.pose), ahead ? std::optional(to_pose(ball.next)) : std::nullopt, obstacles,
                   double(near_by), found);
    for (const RoundContact& f : found) {
        const auto& [pair, margin, out] = pairs[f.obstacle];
        const btVector3 point = to_bullet(f.point), normal = to_bullet(f.normal);
        const auto distance = btScalar(f.distance);
        Candidate c = pair.candidate(false, f.place, point, point + normal * distance, -normal, distance);
        c.triangle = static_cast<int>(f.triangle);
        (pair.mesh_is_0() ? c.name0 : c.name1) = {f.name[0], f.name[1]};
        c.reach = pair.smaller_diagonal();
        c.speculative = ahead && distance > 0;
        out->push_back(c);
    }
}

LeafPair::Passed LeafPair::passed(btScalar margin) const {
    const Leaf& passing = other();
    Passed found;
    btVector3 low, high;
    find_box(*passing.converted.shape, mesh().pose.inverseTimes(passing.pose), found.low, found.high);
    find_box(*passing.converted.shape, mesh().next.inverseTimes(passing.next), low, high);
    // The scene lets the last motion of what has no velocity go on.
    const auto unsaid = [](const Leaf& leaf) { return leaf.next == leaf.pose ? leaf.way : btScalar(0); };
    const btScalar reach = margin + unsaid(leaf0) + unsaid(leaf1);
    const btVector3 around(reach, reach, reach);
    found.low.setMin(low);
    found.high.setMax(high);
    found.low -= around;
    found.high += around;
    found.triangles = mesh().converted.in_bullet->overlapping(found.low, found.high);
    return found;
}

void LeafPair::add_borders(const Passed& passed, btScalar margin, btScalar reach, std::vector<Candidate>& out) const {
    static thread_local std::vector<std::uint32_t> edges;
    static thread_local std::vector<BorderContact> found;
    const BulletMesh& faces = *mesh().converted.in_bullet;
    const std::vector<bool>& is_free = faces.free_border().edges;
    edges.clear();
    for (const std::uint32_t t : passed.triangles)
        for (const int k : {0, 1, 2}) {
            const std::uint32_t edge = 3 * t + static_cast<std::uint32_t>(k);
            if (!is_free[edge]) continue;
            btVector3 least = faces.corner(t, k), most = least;
            least.setMin(faces.corner(t, k + 1));
            most.setMax(faces.corner(t, k + 1));
            if (TestAabbAgainstAabb2(least, most, passed.low, passed.high)) edges.push_back(edge);
        }
    if (edges.empty()) return;
    border_contacts(other(), mesh(), edges, double(margin), found);
    for (const BorderContact& f : found) {
        Candidate c = candidate(true, f.edge, f.point, f.point - f.normal * f.distance, f.normal, f.distance);
        c.key.feature = FeatureKind::edges;
        c.key.other = c.triangle = f.end; // whatever face it leaves by: else the last one's would be kept
        c.reach = reach;
        c.speculative = f.distance > 0;
        out.push_back(c);
    }
}

Candidate candidate_of(const Contact& contact, int child0, int child1, bool swapped) {
    Candidate c;
    const FeatureKind kind = contact.feature.kind;
    const int source = contact.feature.source == Side::a ? 0 : 1;
    c.key = {child0,
             child1,
             swapped ? 1 - source : source,
             static_cast<int>(contact.feature.source_index()),
             kind,
             static_cast<int>(names_both(kind) ? contact.feature.other_index() : 0)};
    c.triangle = static_cast<int>(contact.feature.other_index());
    c.on0 = to_bullet(swapped ? contact.point_b : contact.point_a);
    c.on1 = to_bullet(swapped ? contact.point_a : contact.point_b);
    c.normal = to_bullet(contact.normal);
    if (!swapped) c.normal = -c.normal;
    c.distance = btScalar(-contact.depth);
    c.speculative = contact.is_speculative();
    return c;
}

void name_places(Candidate& c, const Leaf& leaf0, const Leaf& leaf1) {
    const bool of_0 = c.key.vertex_body == 0;
    const int other = c.key.feature == FeatureKind::edges ? c.triangle / 3 : c.triangle;
    const PlaceName none; // a height field's are known
    if (has_triangles(leaf0) && c.name0 == none)
        c.name0 = of_0 ? name_of_feature(leaf0, c.key) : name_of_triangle(leaf0, other);
    if (has_triangles(leaf1) && c.name1 == none)
        c.name1 = of_0 ? name_of_triangle(leaf1, other) : name_of_feature(leaf1, c.key);
}

} // namespace raycontact::bullet
