// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/bullet/fault.h>
#include <raycontact/bullet/precision.h>
#include <raycontact/bullet/touch.h>
#include <raycontact/export.h>
#include <raycontact/scene.h>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <vector>

class btCollisionWorld;

namespace raycontact {
struct RecorderOptions;
}

namespace raycontact::bullet {

/// How contacts become manifold points.
struct ManifoldSettings {
    /// A pair's contacts are grouped into patches, one manifold each: normals within this cosine of the patch's ...
    btScalar patch_cosine = btScalar(0.8);
    /// ... and points within this part of the smaller body's box diagonal from the patch's centre.
    btScalar patch_reach = btScalar(0.25);
    /// A point whose contact is gone lives on for this many steps while its surfaces stay within the manifold's
    /// breaking threshold: a resting body must not lose its support for a moment. Without speculative contacts it often
    /// would, since only what penetrates is found. At most 255.
    int keep_steps = 8;
};

/// Who finds the contacts of a mesh with Bullet's convex shapes. Pairs of convex shapes are Bullet's in any case.
enum class ConvexShapes {
    /// By the mesh. An open one (without Shape::has_inside) of a static or kinematic object, as levels of games are,
    /// stops them on both sides of each face, however it is wound: on the side where the shape's centre is. Where its
    /// surface ends, it is an edge without thickness. Closed or moving ones: as `ours`.
    by_mesh,
    /// RayContact: balls and capsules in closed form; boxes, cylinders, cones, hulls and multi-spheres as meshes made
    /// once for each shape. Other convex shapes are left to Bullet. An open mesh stops them at the front of its faces.
    ours,
    bullet, ///< Bullet's own algorithms, a triangle at a time, with their margins
};

/// What the last dispatch did.
struct DispatcherStats {
    std::uint64_t pairs = 0; ///< pairs of objects that RayContact handled
    /// Of its pairs, those that it did not look at, since neither object is active, or a filter is between them: their
    /// manifolds stay as they are, and scene() does not have their contacts.
    std::uint64_t pairs_left_alone = 0;
    std::uint64_t touching = 0;   ///< pairs of objects that touch, those asleep too; see begun()
    std::uint64_t mesh_pairs = 0; ///< pairs of meshes, or their like, in its batch (a compound gives several)
    /// Pairs of a mesh and a plane; without speculative contacts also of a mesh and a box's face that it lies wholly
    /// over.
    std::uint64_t plane_pairs = 0;
    std::uint64_t round_pairs = 0; ///< pairs of a mesh or height field and a ball or capsule
    std::uint64_t other_pairs = 0; ///< left to Bullet's own algorithms
    /// Pairs of an open mesh and one of Bullet's convex shapes, that takes each face as two-sided
    /// (ConvexShapes::by_mesh); balls and capsules are in round_pairs. Those that are near a front, and those near a
    /// back, are in mesh_pairs, too.
    std::uint64_t two_sided_pairs = 0;
    /// Of mesh_pairs, those with an open mesh: it stops others at the front of its faces, and lets through what comes
    /// from behind. on_fault() is told once for each such mesh of a static or kinematic object.
    std::uint64_t one_sided_pairs = 0;
    std::uint64_t unsupported = 0;    ///< a mesh against a concave shape that nothing here handles: no contacts
    std::uint64_t contacts = 0;       ///< found, speculative ones and those of balls and capsules that are near, too
    std::uint64_t points = 0;         ///< kept as manifold points
    std::uint64_t points_matched = 0; ///< of those, points that were there in the step before (same key)
    std::uint64_t points_held = 0;    ///< points kept although their contact is gone (ManifoldSettings::keep_steps)
    std::uint64_t reduced_away = 0;   ///< contacts that no manifold point stands for
    std::uint64_t manifolds = 0;      ///< patches
    /// Meshes made of Bullet's shapes, because they met something for the first time: the dispatch waited for them
    /// (docs/performance.md has how long). add_body() has them made ahead.
    std::uint64_t shapes_made = 0;
    /// Shapes (each child of a compound) whose transform had drifted, as a product of many float matrices does: by at
    /// most 1e-3 of their size. The nearest rigid pose was taken.
    std::uint64_t made_rigid = 0;
    /// Shapes whose transform is scaled, sheared or mirrored: their mesh is made anew, scaled. Each other scale, in
    /// steps of about 1e-3, makes another; balls and capsules are left to Bullet.
    std::uint64_t scaled = 0;
    /// Objects of which a shape took no part: its transform is not finite or flat, a number of its own not
    /// finite, or no mesh can be made of it. Each such fault is told to on_fault() once.
    std::vector<const btCollisionObject*> left_out;
};

/// Names a manifold point's contact from step to step, unique within its two objects.
struct PointKey {
    int child0 = 0;      ///< index of the leaf shape, depth first, when body 0 is a compound; else 0
    int child1 = 0;      ///< likewise of body 1
    int vertex_body = 0; ///< 0: the feature belongs to the manifold's body 0; 1: to its body 1
    /// Index in its file, mesh interface or shape (a convex shape's mesh is our own); of edges and faces as
    /// ContactFeature::index_a. A ball's or capsule's: any number that stays.
    int vertex = 0;
    FeatureKind feature = FeatureKind::vertex; ///< what is in contact
    /// Of edges and faces that of the other body, as ContactFeature::index_b; of the border of an open mesh in a convex shape 0 or 1,
    /// an end of what is inside; of other features 0.
    int other = 0;
    friend bool operator==(const PointKey&, const PointKey&) = default;
};

/// Use it in place of btCollisionDispatcher. All pairs of triangle meshes (MeshShape, btGImpactMeshShape,
/// btBvhTriangleMeshShape, btScaledBvhTriangleMeshShape, also inside compounds) go to RayContact in one batch a step;
/// meshes against planes, height fields and convex shapes are handled here as well, and so are balls and capsules
/// against height fields; Bullet handles the rest. A near
/// callback of your own is asked about every pair; the batch has those for which it calls defaultNearCallback, or
/// findAlgorithm and processCollision. Call refresh() for a mesh or hull that was changed in place. Not thread-safe,
/// like Bullet's.
///
/// Unless Settings::speculative is false, meshes have speculative contacts, too (docs/internals/speculative.md): points
/// that do not touch yet. Their distance is positive, so Bullet's solver stops bodies at the surface. Of a point that
/// will bounce, and of a soft one (setContactStiffnessAndDamping) in an attached world, getDistance() is no gap once
/// the callbacks were called: the solver is told what makes it give back what restitution says, or carry by the spring.
/// The point's positions stay true.
class RAYCONTACT_API CollisionDispatcher : public btCollisionDispatcher {
public:
    /// Throws as Scene::Scene(), and InputError when keep_steps is out of range. Direction `weighted` gives Bullet the
    /// points of `ray`: a constraint has no weight (Lehericey et al. 2013, section 2.1). scene() has the weights.
    /// Settings::speculative that is empty means true here.
    explicit CollisionDispatcher(btCollisionConfiguration* configuration, const Settings& settings = {},
                                 const ManifoldSettings& manifolds = {}, ConvexShapes convex = ConvexShapes::by_mesh);
    ~CollisionDispatcher() override;

    /// Tells it its world, which Bullet does not. recommend() does so, too. Dispatches of that world then also find
    /// what lies on the way of its kinematic objects (docs/bullet.md), and report each object that Bullet has disabled
    /// for a transform that is not finite. Call it again for another world, before that one steps.
    void attach(btCollisionWorld& world);

    /// A step, if the pairs are those of the attached world; without one, unless they are a ghost's own. Other pairs
    /// are a query, as contactTest is: their algorithms have manifolds, and nothing else here or in the solver knows.
    /// No pose and no mesh throws: see DispatcherStats::made_rigid, scaled and left_out. Throws as
    /// Scene::find_contacts(), and as Recorder::record() while it records.
    void dispatchAllCollisionPairs(btOverlappingPairCache* cache, const btDispatcherInfo& info,
                                   btDispatcher* dispatcher) override;

    /// Bullet's near callbacks and queries ask here. For a pair that is ours: in a dispatch an algorithm that puts it
    /// into the batch, otherwise (contactTest and contactPairTest) one that finds its contacts at once, and throws as a
    /// dispatch.
    btCollisionAlgorithm* findAlgorithm(const btCollisionObjectWrapper* a, const btCollisionObjectWrapper* b,
                                        btPersistentManifold* manifold, ebtDispatcherQueryType type) override;

    /// Optional: makes the object's meshes now, so that no dispatch has to make them (what is left for the first one is
    /// in docs/performance.md), gives them their slots in scene(), and keeps both even when no pair needs them. So
    /// slots follow the caller's order. Returns the id of its first mesh. The object must be removed by remove_body
    /// before it is deleted. Throws ObjectError, which has the object, for one that a dispatch would leave out, and
    /// InputError for one without a shape or a mesh; std::runtime_error as Scene::add().
    BodyId add_body(const btCollisionObject& object);
    /// Undoes add_body(): its meshes stay in scene() only as long as pairs need them. Faults told of it are forgotten.
    void remove_body(const btCollisionObject& object);
    /// Converts the meshes of an object again at the next dispatch. Call it after writing to its mesh interface.
    void refresh(const btCollisionObject& object);

    /// What is kept of earlier dispatches is forgotten, so that the next one is like a first one: for a saved state of
    /// the world that is loaded, poses and velocities put back. All pairs of the world and of its ghosts lose their
    /// manifolds, with the impulses in them, those of Bullet's own algorithms too; nothing is told of them as ended.
    /// begun(), ended(), stats() and scene() are empty, no kinematic object is in motion. What stays: meshes that were
    /// made, objects given to add_body() with their ids, faults that were told, a recording. docs/bullet.md says what
    /// else a run needs to repeat to the bit. Not in a dispatch or callback. Throws as Scene::find_contacts().
    void forget(btCollisionWorld& world);

    /// Called at the end of the dispatch or query that found a fault, once for each as long as it lasts and the object
    /// stays in its world: added again it is told of again, and so is another object that has its address.
    /// (btAxisSweep3 gives numbers of proxies again, and objects that are only asked about have none: call
    /// remove_body() for an object that goes, or the new one may count as the old one for 600 dispatches.) It may throw
    /// (the others are told next time) and put another in its place. At first it prints a line on stderr; an empty
    /// function says nothing.
    void on_fault(std::function<void(const Fault&)> callback);

    /// Scene::prepare() for the meshes in scene(): those given to add_body(), and those that met something. Optional: a
    /// mesh is prepared beside the dispatches once it meets others a second time. Throws as Scene::prepare().
    void prepare();

    /// Pairs of objects that touch since the last dispatch, and those that no longer do; of all pairs that RayContact
    /// handles, balls and planes too. What falls asleep goes on touching. Objects that were removed cease at the next
    /// dispatch. Valid until then.
    std::span<const Touch> begun() const;
    /// Those that no longer touch.
    std::span<const Touch> ended() const;

    /// The batch: contacts(), speculative ones too, pairs() and stats() of the last dispatch. Pairs that sleep are in
    /// no batch: there their contacts are lost, and new when they wake. begun() and ended() know better.
    const Scene& scene() const;
    /// What the last dispatch did.
    const DispatcherStats& stats() const;

    /// Records the meshes from the next dispatch on, for `raycontact view` and `replay`; see Recorder. A mesh is in the
    /// recording while it is in scene(): add_body() keeps it there even when nothing is near it. options.dt: of a
    /// dispatch. Throws as Recorder::Recorder(), and InputError where RayContact was built without recordings.
    void record(const std::filesystem::path& file);
    /// The same with options, for which <raycontact/recorder.h> is needed.
    void record(const std::filesystem::path& file, const RecorderOptions& options);
    /// Ends the recording with its hash. Does nothing where there is none. Throws as Recorder::finish(); it is over all
    /// the same.
    void finish_recording();

    /// The contact of a point of RayContact's manifolds.
    static PointKey key(const btManifoldPoint& point);
    /// The point is one of those.
    static bool is_ours(const btManifoldPoint& point);

    struct RAYCONTACT_HIDDEN State;

private:
    std::unique_ptr<State> state_;
};

} // namespace raycontact::bullet
