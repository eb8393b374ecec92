// SPDX-License-Identifier: Apache-2.0
#include <cast.h>

#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>

namespace raycontact::bullet {

namespace {

/// Cosine between a face and what is met, from which on it is the face: else it is an edge, as between two triangles of
/// one floor, over which a shape slides.
constexpr btScalar is_face = btScalar(0.95);

/// Bullet's cast of a convex shape against one triangle after another. All in the frame of the mesh.
class Cast final : public btTriangleConvexcastCallback {
public:
    Cast(const btConvexShape& shape, const btTransform& from, const btTransform& to, btScalar margin)
        : btTriangleConvexcastCallback(&shape, from, to, btTransform::getIdentity(), margin),
          way_(to.getOrigin() - from.getOrigin()) {
        m_hitFraction = 1;
        m_allowedPenetration = 0;
    }
    void processTriangle(btVector3* corners, int part, int index) override {
        face_ = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        const btScalar area = face_.length();
        if (!(area > 0)) return;
        face_ /= area;
        // Bullet's algorithm sees what a shape comes to by less than this.
        if (btFabs(face_.dot(way_)) > gContactBreakingThreshold)
            btTriangleConvexcastCallback::processTriangle(corners, part, index);
    }
    btScalar reportHit(const btVector3& normal, const btVector3&, btScalar fraction, int, int index) override {
        if (!(fraction > 0 && fraction < m_hitFraction)) return fraction; // at 0 it touches
        const btScalar cosine = normal.dot(face_);
        if (btFabs(cosine) < is_face) return fraction;
        const btVector3 out = cosine > 0 ? face_ : -face_;
        if (out.dot(way_) >= 0) return fraction;
        m_hitFraction = fraction;
        normal_ = out;
        triangle_ = static_cast<std::uint32_t>(index);
        return fraction;
    }
    bool hit() const { return m_hitFraction < 1; }
    const btVector3& normal() const { return normal_; }
    std::uint32_t triangle() const { return triangle_; }
    btScalar distance() const { return -m_hitFraction * way_.dot(normal_); }

private:
    btVector3 way_, face_{0, 0, 1}, normal_{0, 0, 1};
    std::uint32_t triangle_ = 0;
};

/// The middle of what lies farthest along a direction: of a face that looks there, of an edge, or a corner. Shape
/// frame.
btVector3 middle_of_support(const btConvexShape& shape, const btVector3& along) {
    constexpr btScalar tilt = btScalar(0.05);
    btVector3 one, two, sum(0, 0, 0);
    btPlaneSpace1(along, one, two);
    for (const btVector3& aside : {one + two, one - two, two - one, -one - two})
        sum += shape.localGetSupportingVertex((along + tilt * aside).normalized());
    return sum / 4;
}

} // namespace

std::optional<CastHit> cast_hit(const Leaf& convex, const Leaf& mesh) {
    const btTransform from = mesh.pose.inverseTimes(convex.pose), to = mesh.next.inverseTimes(convex.next);
    const btVector3 way = to.getOrigin() - from.getOrigin();
    if (!(way.length2() > gContactBreakingThreshold * gContactBreakingThreshold)) return std::nullopt;
    const auto& shape = static_cast<const btConvexShape&>(*convex.shape);
    Cast cast(shape, from, to, mesh.shape->getMargin());
    btVector3 low, high, low_then, high_then;
    shape.getAabb(from, low, high);
    shape.getAabb(to, low_then, high_then);
    low.setMin(low_then);
    high.setMax(high_then);
    const BulletMesh& in_bullet = *mesh.converted.in_bullet;
    for (const std::uint32_t t : in_bullet.overlapping(low, high)) {
        btVector3 corners[3] = {in_bullet.corner(t, 0), in_bullet.corner(t, 1), in_bullet.corner(t, 2)};
        cast.processTriangle(corners, 0, static_cast<int>(t));
    }
    if (!cast.hit()) return std::nullopt;
    CastHit hit;
    const btMatrix3x3& turned = mesh.pose.getBasis();
    hit.normal = turned * cast.normal();
    hit.point = convex.pose(middle_of_support(shape, -hit.normal * convex.pose.getBasis()));
    hit.distance = cast.distance();
    hit.triangle = static_cast<int>(mesh.converted.shape->triangle_index()[cast.triangle()]);
    return hit;
}

} // namespace raycontact::bullet
