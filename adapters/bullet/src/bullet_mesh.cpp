// SPDX-License-Identifier: Apache-2.0
#include <bullet_mesh.h>
#include <vectors.h>

#include <raycontact/query.h>

#include <LinearMath/btAabbUtil2.h>

#include <algorithm>
#include <utility>

namespace raycontact::bullet {

namespace {
constexpr std::size_t exact_bounds = 1024;  ///< vertices; beyond that as many boxes
constexpr std::size_t most_boxes = 1 << 16; ///< kept: at most some 10 MB
/// Cosine from which on two triangles lie in one plane, and their distance there, of the edge's length.
constexpr btScalar flat = btScalar(0.9999), flush = btScalar(1e-3);

/// Not of length 1; whatever lies in its plane is.
btVector3 area_of(const BulletMesh& mesh, std::uint32_t t) {
    return (mesh.corner(t, 1) - mesh.corner(t, 0)).cross(mesh.corner(t, 2) - mesh.corner(t, 0));
}
} // namespace

BulletMesh::BulletMesh(std::shared_ptr<const Shape> shape) : shape_(std::move(shape)), triangles_(shape_->triangles()) {
    vertices_.reserve(shape_->vertices().size());
    for (const Vec3& v : shape_->vertices()) vertices_.push_back(to_bullet(v));
}

// The shape's tree is asked with a margin for the rounding of vertices to Bullet's numbers, which decide.
std::vector<std::uint32_t> BulletMesh::overlapping(const btVector3& low, const btVector3& high) const {
    const Vec3 from = to_vec(low), to = to_vec(high);
    const double more = 1e-6 * shape_->radius();
    std::vector<std::uint32_t> found;
    triangles_in_box(*shape_, {from.x - more, from.y - more, from.z - more}, {to.x + more, to.y + more, to.z + more},
                     found);
    std::erase_if(found, [&](std::uint32_t t) {
        btVector3 least = corner(t, 0), most = least;
        for (int k = 1; k < 3; ++k) {
            least.setMin(corner(t, k));
            most.setMax(corner(t, k));
        }
        return !TestAabbAgainstAabb2(least, most, low, high);
    });
    return found;
}

// Whether another triangle lies in the plane of one, just beyond the middle of its edge.
bool BulletMesh::goes_on(std::uint32_t t, int k) const {
    const btVector3 area = area_of(*this, t), along = corner(t, k + 1) - corner(t, k);
    const btScalar near = flush * along.length();
    const btVector3 beyond = (corner(t, k) + corner(t, k + 1)) / 2 + near * along.cross(area).normalized();
    const btVector3 around(near, near, near);
    return std::ranges::any_of(overlapping(beyond - around, beyond + around), [&](std::uint32_t other) {
        const btVector3 n = area_of(*this, other);
        const btScalar size = n.length();
        if (other == t || !(size > 0) || btFabs(n.dot(area)) < flat * size * area.length()) return false;
        bool inside = btFabs(n.dot(beyond - corner(other, 0))) <= near * size;
        for (int i = 0; inside && i < 3; ++i) {
            const btVector3 side = corner(other, i + 1) - corner(other, i);
            inside = n.cross(side).dot(beyond - corner(other, i)) >= -near / 100 * size * side.length();
        }
        return inside;
    });
}

// Those that lie on each other are neighbours, too.
const BulletMesh::FreeBorder& BulletMesh::free_border() const {
    std::call_once(border_made_, [this] {
        border_ = {std::vector<bool>(3 * triangles_.size()), std::vector<bool>(vertices_.size())};
        const auto neighbours = shape_->neighbours();
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            const btVector3 area = area_of(*this, t);
            if (!(area.length2() > 0)) continue;
            for (const int k : {0, 1, 2}) {
                const auto side = static_cast<std::size_t>(k);
                const std::uint32_t across = neighbours[t][side];
                const bool turns_back = across != Shape::no_triangle && lies_on(t, k, across);
                if ((across != Shape::no_triangle && !turns_back) || goes_on(t, k)) continue;
                border_.edges[3 * t + side] = true;
                border_.vertices[triangles_[t][side]] = border_.vertices[triangles_[t][(side + 1) % 3]] = true;
            }
        }
    });
    return border_;
}

// Whether a triangle that shares an edge of another lies in its plane on the same side of the edge.
bool BulletMesh::lies_on(std::uint32_t t, int k, std::uint32_t other) const {
    const btVector3 one = area_of(*this, t), two = area_of(*this, other), along = corner(t, k + 1) - corner(t, k);
    if (btFabs(one.dot(two)) < flat * one.length() * two.length()) return false;
    const btVector3 middle = (corner(other, 0) + corner(other, 1) + corner(other, 2)) / 3;
    return one.cross(along).dot(middle - corner(t, k)) > 0;
}

const Extent& BulletMesh::extent() const {
    std::call_once(made_, [this] {
        if (vertices_.size() <= exact_bounds) {
            extent_.reserve(vertices_.size());
            for (const btVector3& v : vertices_) extent_.add(v, btVector3(0, 0, 0));
            return;
        }
        const std::vector<AxisBox> boxes = covering_boxes(*shape_, exact_bounds);
        extent_.reserve(boxes.size());
        for (const auto& [from, to] : boxes) {
            const btVector3 low = to_bullet(from), high = to_bullet(to);
            const auto more = btScalar(1e-6 * shape_->radius()); // for their rounding
            extent_.add((low + high) * btScalar(0.5), (high - low) * btScalar(0.5) + btVector3(more, more, more));
        }
    });
    return extent_;
}

void BulletMesh::bounds(const btTransform& transform, btVector3& low, btVector3& high) const {
    const std::unique_lock turn(boxes_in_use_, std::try_to_lock); // who finds another at work makes its box itself
    if (turn) {
        if (const auto known = boxes_.find(&transform); known != boxes_.end() && known->second.transform == transform) {
            low = known->second.low;
            high = known->second.high;
            return;
        }
    }
    extent().bounds(transform, low, high);
    ++bounds_made_;
    if (!turn) return;
    if (boxes_.size() >= most_boxes) boxes_.clear(); // who is still there asks again in the next step
    boxes_[&transform] = {transform, low, high};
}

} // namespace raycontact::bullet
