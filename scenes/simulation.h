// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/bullet/mesh_shape.h>
#include <raycontact/scene.h>
#include <scenes/description.h>
#include <scenes/run_watch.h>

#include <btBulletDynamicsCommon.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace raycontact::scenes {

/// A scene that runs: every contact between meshes is RayContact's; Bullet does the broad phase and the response
/// (sequential impulses), with deactivation off. The same description gives the same numbers, times apart.
class Simulation {
public:
    /// Throws InputError for settings this machine cannot use.
    explicit Simulation(SceneDescription description);
    Simulation(const Simulation&) = delete;
    Simulation& operator=(const Simulation&) = delete;

    /// One step of SceneDescription::dt, with the bodies that come in it. Throws InputError for a body without a mass.
    void step();

    const SceneDescription& description() const { return description_; }
    std::uint32_t body_count() const; ///< of bodies that move and come within the planned steps
    /// Contacts, poses and pairs of the last step; a body's slot is its place in the description.
    const Scene& scene() const { return dispatcher_.scene(); }
    std::span<const Contact> contacts() const { return scene().contacts(); }
    const StepStats& stats() const { return scene().stats(); }
    const std::vector<Pose>& poses() const { return poses_; } ///< of the bodies that have come, after the last step
    std::uint32_t steps() const { return watch_.steps(); }    ///< done so far
    const RunLog& log() const { return watch_.log(); }        ///< everything a report needs but the summary
    Health health() const { return watch_.health(); }
    std::string hash() const { return watch_.hash(); } ///< ContactHash of all steps so far

private:
    /// Of the bodies of one shape and density.
    struct Inertia {
        double density = -1;
        btScalar mass = 0;
        btVector3 moments{0, 0, 0};
    };

    std::unique_ptr<btRigidBody> make_body(btCollisionShape& shape, const btTransform& pose, const Inertia& inertia);
    const Inertia& inertia_of(const BodyStart& start);
    void add_body(const BodyStart& start);
    void add_bodies_of_step();

    SceneDescription description_;
    // What is in the world is deleted after it.
    std::vector<std::unique_ptr<bullet::MeshShape>> shapes_;
    std::vector<Inertia> inertias_; ///< of each shape, for the density last asked for
    btStaticPlaneShape plane_shape_;
    std::unique_ptr<btRigidBody> plane_;
    std::vector<std::unique_ptr<btRigidBody>> bodies_; ///< that have come, in the description's order
    std::vector<Pose> poses_;                          ///< of these
    btDefaultCollisionConfiguration configuration_;
    bullet::CollisionDispatcher dispatcher_;
    btDbvtBroadphase broadphase_;
    btSequentialImpulseConstraintSolver solver_;
    btDiscreteDynamicsWorld world_;
    RunWatch watch_;
};

} // namespace raycontact::scenes
