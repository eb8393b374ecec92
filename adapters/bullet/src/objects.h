// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <convert.h>
#include <faults.h>
#include <kinematics.h>
#include <placement.h>
#include <raycontact/bullet/dispatcher.h>
#include <raycontact/scene.h>

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace raycontact::bullet {

/// One shape of an object that is not a compound; an object without compounds has one leaf.
struct Leaf {
    const btCollisionShape* shape = nullptr;
    btTransform local = btTransform::getIdentity(); ///< leaf frame in the object's frame
    Form form;                                      ///< at conversion
    Kind kind = Kind::other;
    Converted converted;          ///< mesh, field or convex
    Stretch stretch = no_stretch; ///< of what was converted: its transform is scaled
    BodyId body;                  ///< in the scene; of the same kinds
    Converted reversed;           ///< of an open mesh, wound the other way, where something met its back
    BodyId back;                  ///< that, in the scene
    btTransform pose = btTransform::getIdentity(); ///< in the world, rigid; of all kinds but `other`
    btVector3 low{0, 0, 0}, high{0, 0, 0}; ///< its box in the world, where it is in the scene; holds rounding, too
    btTransform next = btTransform::getIdentity(); ///< pose, or where a moving body is expected at the next dispatch
    btScalar way = 0;      ///< how far its points go until then, at most; also as the scene expects it
    bool is_fixed = false; ///< its object is static or kinematic
    bool flat = false;     ///< a convex shape without a mesh to stand for it
    bool unmet = false;    ///< a height field that no mesh has met: none is made of it, balls need none
    std::string fault;     ///< why it is left out; empty: it takes part
    bool unusable = false; ///< no mesh can be made of it, which is its fault; else its transform

    bool left_out() const { return !fault.empty(); }
};

/// A collision object as RayContact knows it: for as long as a pair holds its record, or until remove_body.
struct Object {
    std::vector<Leaf> leaves;
    btTransform pose = btTransform::getIdentity(); ///< in the world, rigid
    std::uint64_t version = 0;                     ///< changes when the leaves change
    std::uint64_t seen = 0;                        ///< dispatch in which poses were last handed over, or `never`
    bool stale = false;                            ///< refresh() was called
    std::string fault;                             ///< why all of it is left out: its transform; empty: it is not

    static constexpr std::uint64_t never = ~std::uint64_t{0};

    std::uint64_t expected = never; ///< dispatch in which the next pose was last asked for, or `never`
    btVector3 unhindered{0, 0, 0};  ///< the velocity that its forces alone would have given it by the one after that
    bool is_held = false;           ///< something kept it from that

    bool misplaced() const { return !fault.empty(); }
};

/// Of one dispatch.
struct Mended {
    std::uint64_t made_rigid = 0, scaled = 0; ///< leaves
    std::vector<const btCollisionObject*> left_out;
};

/// Whether leaves of this kind are bodies of the scene.
constexpr bool in_scene(Kind kind) {
    return kind == Kind::mesh || kind == Kind::field || kind == Kind::convex;
}

/// By what a leaf is stretched: rounding is there to save meshes.
inline const Stretch& stretch_of(Kind kind, const Placement& placement) {
    return kind == Kind::plane ? placement.unrounded : placement.stretch;
}

/// Calls visit(shape, local) for each leaf, depth first; `local` in the frame of the whole.
template <class Visit>
void each_leaf(const btCollisionShape& shape, const btTransform& local, Visit&& visit) {
    if (!shape.isCompound()) {
        visit(shape, local);
        return;
    }
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i)
        each_leaf(*compound.getChildShape(i), local * compound.getChildTransform(i), visit);
}

/// The objects in use and their bodies in the scene. Never iterated, so no address decides an order.
class Objects {
public:
    Objects(Scene& scene, ConvexShapes convex)
        : scene_(scene), convex_(convex), shapes_(scene.settings().execution.threads) {}

    /// The object's record. Makes a new one if needed, rebuilds its leaves if its shape has changed, and gives its
    /// poses to the scene once per `dispatch`. A leaf whose mesh or transform cannot be used is left out, which is a
    /// fault.
    std::shared_ptr<Object> refresh(const btCollisionObject& object, std::uint64_t dispatch);
    /// The same for a record that is known.
    void refresh(const btCollisionObject& object, Object& record, std::uint64_t dispatch);
    /// Before refresh(): whom it is about to meet.
    void meet(Object& record, const btCollisionObject& other) const;
    /// From the next refresh() on its height fields are meshes, as add_body() asks. False: nothing changes.
    static bool want_fields(Object& record);
    /// Null where nobody holds one.
    Object* find(const btCollisionObject& object) const;
    /// That a query may take, for the mesh that the dispatches have; no_stretch where none is known.
    const Stretch& kept_stretch_of(const btCollisionObject& object, std::size_t leaf,
                                   const btCollisionShape& shape) const;
    /// Holds the record until it is unpinned.
    void pin(const btCollisionObject& object, std::shared_ptr<Object> record);
    void unpin(const btCollisionObject& object);
    /// Also those that no pair needs now: the scene has their poses, and so has a recording.
    void refresh_pinned(std::uint64_t dispatch);

    /// Puts the back of an open mesh beside it into the scene, for shapes that faces stop on both sides.
    void add_back(Leaf& leaf);
    /// Where objects were, and how they moved.
    void forget();

    /// From now on refresh() also tells the scene where objects will be after so many seconds; 0: not.
    void look_ahead(btScalar seconds, std::uint64_t dispatch) {
        ahead_ = seconds;
        kinematics_.begin(dispatch, seconds);
    }

    /// Leaves an object out if its transform, or Bullet's next one, is not finite: Bullet disables it without a word,
    /// so no pair asks for it any more.
    void report_lost(const btCollisionObject& object, std::uint64_t dispatch);
    /// What leaves the object, or some of its leaves, out.
    static std::vector<Fault> faults_of(const btCollisionObject& object, const Object& record);
    /// Call it once a dispatch.
    void sweep() {
        shapes_.sweep();
        faults_.sweep([&](const btCollisionObject* object) { return records_.contains(object); });
    }

    ShapeCache& shapes() { return shapes_; }
    Faults& faults() { return faults_; }
    Mended& mended() { return mended_; }
    Kinematics& kinematics() { return kinematics_; }

private:
    bool unchanged(const btCollisionObject& object, const Object& record) const;
    void make_leaves(const btCollisionObject& object, Object& record);
    void drop_body(Leaf& leaf);
    void drop_bodies(Object& record);
    void place_object(const btCollisionObject& object, Object& record);
    void place_leaf(const btCollisionObject& object, Object& record, Leaf& leaf, const Placement& whole);
    void expect(const btCollisionObject& object, Object& record, std::uint64_t dispatch);

    Scene& scene_;
    ConvexShapes convex_;
    ShapeCache shapes_;
    Faults faults_;
    Mended mended_;
    Kinematics kinematics_;
    std::unordered_map<const btCollisionObject*, std::weak_ptr<Object>> records_;
    std::vector<std::pair<const btCollisionObject*, std::shared_ptr<Object>>> pinned_; ///< in the order of pin()
    std::uint64_t versions_ = 0;
    btScalar ahead_ = 0;
};

Pose to_pose(const btTransform& transform);
/// The box of a shape in the world, from its own box, a little larger than rounding can make it.
void find_box(const Shape& shape, const btTransform& pose, btVector3& low, btVector3& high);

} // namespace raycontact::bullet
