// SPDX-License-Identifier: Apache-2.0
#include <scenes/peers/peer.h>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>

#include <map>

namespace raycontact::peers {

namespace {

/// A mesh as Bullet wants it; the arrays must outlive the shape.
struct GImpactMesh {
    explicit GImpactMesh(const Shape& shape) {
        for (const Vec3& v : shape.vertices())
            points.insert(points.end(), {btScalar(v.x), btScalar(v.y), btScalar(v.z)});
        for (const auto& t : shape.triangles())
            for (const std::uint32_t corner : t) corners.push_back(static_cast<int>(corner));
        arrays = std::make_unique<btTriangleIndexVertexArray>(
            static_cast<int>(corners.size() / 3), corners.data(), static_cast<int>(3 * sizeof(int)),
            static_cast<int>(points.size() / 3), points.data(), static_cast<int>(3 * sizeof(btScalar)));
        mesh = std::make_unique<btGImpactMeshShape>(arrays.get());
        mesh->setMargin(0); // the same question as everyone's: what penetrates
        mesh->updateBound();
    }
    std::vector<btScalar> points;
    std::vector<int> corners;
    std::unique_ptr<btTriangleIndexVertexArray> arrays;
    std::unique_ptr<btGImpactMeshShape> mesh;
};

/// Takes every contact, as Bullet's contactPairTest hands them to its callback; no reduction to four points.
class Gather : public btManifoldResult {
public:
    using btManifoldResult::btManifoldResult;
    void addContactPoint(const btVector3&, const btVector3&, btScalar depth) override {
        ++contacts;
        depth_sum -= static_cast<double>(depth);
    }
    std::uint64_t contacts = 0;
    double depth_sum = 0;
};

class GImpact : public Peer {
public:
    explicit GImpact(const Work& work) : dispatcher_(&configuration_) {
        btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
        for (const auto& shape : work.shapes) meshes_.push_back(std::make_unique<GImpactMesh>(*shape));
        for (const std::uint32_t shape : work.body_shape) {
            objects_.push_back(std::make_unique<btCollisionObject>());
            objects_.back()->setCollisionShape(meshes_[shape]->mesh.get());
        }
        info_.m_dispatchFunc = btDispatcherInfo::DISPATCH_DISCRETE;
    }
    ~GImpact() override {
        for (const auto& [pair, algorithm] : algorithms_) {
            algorithm->~btCollisionAlgorithm();
            dispatcher_.freeCollisionAlgorithm(algorithm);
        }
    }
    GImpact(const GImpact&) = delete;
    GImpact& operator=(const GImpact&) = delete;

    Found detect(const WorkStep& step) override {
        for (std::size_t body = 0; body < objects_.size(); ++body) {
            const Pose& pose = step.poses[body];
            const auto& r = pose.rotation;
            objects_[body]->setWorldTransform(btTransform(
                btMatrix3x3(btScalar(r[0]), btScalar(r[1]), btScalar(r[2]), btScalar(r[3]), btScalar(r[4]),
                            btScalar(r[5]), btScalar(r[6]), btScalar(r[7]), btScalar(r[8])),
                btVector3(btScalar(pose.translation.x), btScalar(pose.translation.y), btScalar(pose.translation.z))));
        }
        Found found;
        for (const Pair& pair : step.pairs) {
            const btCollisionObject* a = objects_[pair.first.slot].get();
            const btCollisionObject* b = objects_[pair.second.slot].get();
            const btCollisionObjectWrapper wrap_a(nullptr, a->getCollisionShape(), a, a->getWorldTransform(), -1, -1);
            const btCollisionObjectWrapper wrap_b(nullptr, b->getCollisionShape(), b, b->getWorldTransform(), -1, -1);
            btCollisionAlgorithm*& algorithm = algorithms_[pair];
            if (!algorithm)
                algorithm = dispatcher_.findAlgorithm(&wrap_a, &wrap_b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
            Gather gather(&wrap_a, &wrap_b);
            algorithm->processCollision(&wrap_a, &wrap_b, info_, &gather);
            found.contacts += gather.contacts;
            found.depth_sum += gather.depth_sum;
        }
        return found;
    }

private:
    btDefaultCollisionConfiguration configuration_;
    btCollisionDispatcher dispatcher_;
    btDispatcherInfo info_;
    std::vector<std::unique_ptr<GImpactMesh>> meshes_;
    std::vector<std::unique_ptr<btCollisionObject>> objects_;
    std::map<Pair, btCollisionAlgorithm*> algorithms_; ///< kept from step to step, as Bullet's pair cache does
};

} // namespace

Entrant gimpact() {
    Entrant entrant;
    entrant.name = "gimpact";
    entrant.what = "Bullet " + std::to_string(BT_BULLET_VERSION / 100) + "." + std::to_string(BT_BULLET_VERSION % 100)
                   + " btGImpactCollisionAlgorithm";
    entrant.make = [](const Work& work) { return std::make_unique<GImpact>(work); };
    return entrant;
}

} // namespace raycontact::peers
