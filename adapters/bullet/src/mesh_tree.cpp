// SPDX-License-Identifier: Apache-2.0
#include <mesh_tree.h>
#include <vectors.h>

#include <raycontact/query.h>

#include <LinearMath/btAabbUtil2.h>

#include <utility>

namespace raycontact::bullet {

namespace {
constexpr std::size_t exact_bounds = 1024; ///< vertices; beyond that as many boxes
} // namespace

MeshTree::MeshTree(std::shared_ptr<const Shape> shape) : shape_(std::move(shape)), triangles_(shape_->triangles()) {
    vertices_.reserve(shape_->vertices().size());
    for (const Vec3& v : shape_->vertices()) vertices_.emplace_back(btScalar(v.x), btScalar(v.y), btScalar(v.z));
}

// The shape's tree is asked with a margin for the rounding of vertices to Bullet's numbers, which decide.
std::vector<std::uint32_t> MeshTree::overlapping(const btVector3& low, const btVector3& high) const {
    const Vec3 from = to_vec(low), to = to_vec(high);
    const double more = 1e-6 * shape_->radius();
    std::vector<std::uint32_t> found;
    triangles_in_box(*shape_, {from.x - more, from.y - more, from.z - more}, {to.x + more, to.y + more, to.z + more},
                     found);
    std::erase_if(found, [&](std::uint32_t t) {
        btVector3 least = vertex(triangle(t)[0]), most = least;
        for (std::size_t k = 1; k < 3; ++k) {
            least.setMin(vertex(triangle(t)[k]));
            most.setMax(vertex(triangle(t)[k]));
        }
        return !TestAabbAgainstAabb2(least, most, low, high);
    });
    return found;
}

void MeshTree::vertices_below(const btVector3& normal, btScalar offset, std::vector<std::uint32_t>& out) const {
    const double slack = 1e-6 * double(normal.length()) * shape_->radius();
    raycontact::vertices_below(*shape_, to_vec(normal), double(offset) + slack, out);
    std::erase_if(out, [&](std::uint32_t v) { return !(normal.dot(vertex(v)) < offset); });
}

const Extent& MeshTree::extent() const {
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

void MeshTree::bounds(const btTransform& transform, btVector3& low, btVector3& high) const {
    cache_.get(transform, low, high, [&](btVector3& from, btVector3& to) { extent().bounds(transform, from, to); });
}

void MeshTree::bounds_once(const btTransform& transform, btVector3& low, btVector3& high) const {
    extent().bounds(transform, low, high);
}

} // namespace raycontact::bullet
