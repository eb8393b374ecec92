// SPDX-License-Identifier: Apache-2.0
#include <bench/peers/entrants.h>

#include <fcl/config.h>
#include <fcl/fcl.h>

#include <limits>

namespace raycontact::bench {

namespace {

using Model = ::fcl::BVHModel<::fcl::OBBRSSd>;

class Fcl : public Peer {
public:
    explicit Fcl(const Work& work) {
        std::vector<std::shared_ptr<Model>> models;
        for (const auto& shape : work.shapes) {
            std::vector<::fcl::Vector3d> points;
            for (const Vec3& v : shape->vertices()) points.emplace_back(v.x, v.y, v.z);
            std::vector<::fcl::Triangle> triangles;
            for (const auto& t : shape->triangles()) triangles.emplace_back(t[0], t[1], t[2]);
            auto model = std::make_shared<Model>();
            model->beginModel(static_cast<int>(triangles.size()), static_cast<int>(points.size()));
            model->addSubModel(points, triangles);
            model->endModel();
            models.push_back(std::move(model));
        }
        for (const std::uint32_t shape : work.body_shape)
            objects_.push_back(std::make_unique<::fcl::CollisionObjectd>(models[shape]));
        request_.enable_contact = true;
        request_.num_max_contacts = std::numeric_limits<std::uint32_t>::max();
    }

    Found detect(const WorkStep& step) override {
        for (std::size_t body = 0; body < objects_.size(); ++body) {
            const Pose& pose = step.poses[body];
            ::fcl::Matrix3d rotation;
            for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = pose.rotation[static_cast<std::size_t>(i)];
            objects_[body]->setTransform(rotation,
                                         ::fcl::Vector3d(pose.translation.x, pose.translation.y, pose.translation.z));
        }
        Found found;
        for (const Pair& pair : step.pairs) {
            result_.clear();
            ::fcl::collide(objects_[pair.first.slot].get(), objects_[pair.second.slot].get(), request_, result_);
            for (std::size_t i = 0; i < result_.numContacts(); ++i)
                found.depth_sum += result_.getContact(i).penetration_depth;
            found.contacts += result_.numContacts();
        }
        return found;
    }

private:
    std::vector<std::unique_ptr<::fcl::CollisionObjectd>> objects_;
    ::fcl::CollisionRequestd request_;
    ::fcl::CollisionResultd result_;
};

} // namespace

Entrant fcl() {
    return entrant_of<Fcl>("fcl", "FCL " FCL_VERSION " BVHModel<OBBRSS>, double, contacts on");
}

} // namespace raycontact::bench
