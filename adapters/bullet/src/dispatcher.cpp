// SPDX-License-Identifier: Apache-2.0
#include <raycontact/bullet/dispatcher.h>

#include <box_face.h>
#include <cast.h>
#include <pair.h>
#include <place_name.h>
#include <plane.h>
#include <prefetch.h>
#include <query.h>
#include <raycontact/error.h>
#include <round.h>
#include <vectors.h>
#include <work.h>
#include <world_recorder.h>

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAabbUtil2.h>

#include <algorithm>
#include <optional>
#include <string>
#include <unordered_map>

namespace raycontact::bullet {

namespace {

/// A pair as contacts name it.
using Slots = std::pair<std::uint32_t, std::uint32_t>;

/// Where the contacts of one pair in the batch belong.
struct BatchEntry {
    Pair pair;
    PairState* state;
    int child0, child1;
    bool swapped; ///< the scene's first body is the manifold's body 1
    btScalar reach;
};

// A plane has no end.
btScalar diagonal(const Leaf& leaf) {
    if (leaf.kind == Kind::plane) return BT_LARGE_FLOAT;
    const Vec3 a = leaf.converted.shape->box_min(), b = leaf.converted.shape->box_max();
    return btVector3(btScalar(b.x - a.x), btScalar(b.y - a.y), btScalar(b.z - a.z)).length();
}

constexpr unsigned convex_kinds = bit(Kind::convex) | bit(Kind::round);

/// Whether RayContact handles two shapes; for most pairs two type checks decide.
bool for_us(const btCollisionShape& a, const btCollisionShape& b, ConvexShapes convex) {
    if (a.isConvex() && b.isConvex()) return false;
    unsigned partners = bit(Kind::mesh) | bit(Kind::plane) | bit(Kind::field);
    if (convex != ConvexShapes::bullet) partners |= convex_kinds;
    const unsigned in_a = kinds_in(a), in_b = kinds_in(b);
    return ((in_a & bit(Kind::mesh)) && (in_b & partners)) || ((in_b & bit(Kind::mesh)) && (in_a & partners));
}

bool is_whole(const btCollisionObjectWrapper& wrap) {
    return wrap.getCollisionShape() == wrap.getCollisionObject()->getCollisionShape();
}

HalfSpace plane_between(const Leaf& a, const Leaf& b) {
    const Leaf& plane = a.kind == Kind::plane ? a : b;
    return half_space(static_cast<const btStaticPlaneShape&>(*plane.shape), plane.pose, plane.stretch);
}

Settings with_defaults(Settings settings) {
    settings.speculative = settings.speculative.value_or(true);
    return settings;
}

const ManifoldSettings& checked(const ManifoldSettings& settings) {
    if (settings.keep_steps < 0 || settings.keep_steps > most_keep_steps)
        throw InputError("ManifoldSettings::keep_steps is " + std::to_string(settings.keep_steps) + "; give 0 to "
                         + std::to_string(most_keep_steps));
    return settings;
}

btVector3 velocity_at(const btCollisionObject& object, const btVector3& point) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    return body ? body->getVelocityInLocalPoint(point - body->getCenterOfMassPosition()) : btVector3(0, 0, 0);
}

// As Bullet's solver asks, with its own m_restitutionVelocityThreshold; and what will touch before the next step.
bool bounces(const btManifoldPoint& point, const PairState& state, btScalar seconds) {
    if (!(point.m_combinedRestitution > 0)) return false;
    const btVector3 speed =
        velocity_at(*state.object0, point.m_positionWorldOnA) - velocity_at(*state.object1, point.m_positionWorldOnB);
    const btScalar approach = -speed.dot(point.m_normalWorldOnB);
    return approach > btScalar(0.2) && approach * seconds >= point.getDistance();
}

// Bullet takes gap and slop, by the length of the step, off the speed that restitution gives back; nothing of a depth
// that no slop reaches. The depth itself must not be undone.
void turn_round(btManifoldPoint& point, btScalar depth, btScalar seconds) {
    constexpr int both = BT_CONTACT_FLAG_HAS_CONTACT_ERP | BT_CONTACT_FLAG_HAS_CONTACT_CFM;
    if ((point.m_contactPointFlags & (both | BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING))
        == BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING) {
        // Bullet would pass over stiffness and damping now; and they lie where the two numbers go.
        point.m_contactCFM = 1
                             / btMax(seconds * point.m_combinedContactStiffness1 + point.m_combinedContactDamping1,
                                     btScalar(SIMD_EPSILON));
        point.m_contactPointFlags |= BT_CONTACT_FLAG_HAS_CONTACT_CFM;
    }
    point.m_contactERP = 0;
    point.m_contactPointFlags |= BT_CONTACT_FLAG_HAS_CONTACT_ERP;
    point.m_distance1 = -depth;
}

void turn_round_what_bounces(const PairState& state, btScalar seconds) {
    for (btPersistentManifold* manifold : state.patches.manifolds()) {
        for (int i = 0; i < manifold->getNumContacts(); ++i) {
            btManifoldPoint& point = manifold->getContactPoint(i);
            if (point.getDistance() < 0 || !bounces(point, state, seconds)) continue;
            const PointKey key = CollisionDispatcher::key(point);
            const bool found = std::ranges::any_of(state.candidates,
                                                   [&](const Candidate& c) { return c.speculative && c.key == key; });
            if (!found) continue; // held, or touching: as without speculative contacts
            const Leaf& leaf0 = state.record0.leaves[static_cast<std::size_t>(key.child0)];
            const Leaf& leaf1 = state.record1.leaves[static_cast<std::size_t>(key.child1)];
            turn_round(point, btMin(diagonal(leaf0), diagonal(leaf1)), seconds);
        }
    }
}

void name_places(PairState& state) {
    for (Candidate& c : state.candidates) {
        const Leaf& leaf0 = state.record0.leaves[static_cast<std::size_t>(c.key.child0)];
        const Leaf& leaf1 = state.record1.leaves[static_cast<std::size_t>(c.key.child1)];
        const bool of_0 = c.key.vertex_body == 0;
        const int other = c.key.feature == FeatureKind::edges ? c.triangle / 3 : c.triangle;
        c.name0 = of_0 ? name_of_feature(leaf0, c.key) : name_of_triangle(leaf0, other);
        c.name1 = of_0 ? name_of_triangle(leaf1, other) : name_of_feature(leaf1, c.key);
    }
}

} // namespace

struct CollisionDispatcher::State {
    State(CollisionDispatcher& d, const Settings& settings, const ManifoldSettings& m, ConvexShapes c)
        : dispatcher(d), manifolds(m), convex(c), scene(settings), objects(scene, c), queries(settings, objects, c, d) {
        objects.faults().set_callback(print);
    }

    void read_world(const btOverlappingPairCache* cache, const btDispatcherInfo& info, btDispatcher* asker);
    bool is_ours(btBroadphasePair& pair);
    void visit(btBroadphasePair& pair, const btDispatcherInfo& info);
    void ask(btBroadphasePair& pair, const btDispatcherInfo& info);
    void leave_alone(const btCollisionObject& a, const btCollisionObject& b);
    void drop_algorithm(btBroadphasePair& pair) const;
    void fetch_ahead(std::size_t i) const;
    void take(btBroadphasePair& pair, const btDispatcherInfo& info);
    PairState& state_of(btBroadphasePair& pair, const btCollisionObject& a, const btCollisionObject& b);
    void gather(PairState& state, const Object& a, const Object& b, const btDispatcherInfo& info);
    btScalar margin(const Leaf& a, const Leaf& b) const;
    bool apart(const Leaf& a, const Leaf& b) const;
    std::optional<HalfSpace> face_between(const Leaf& a, const Leaf& b) const;
    void add_plane(PairState& state, int leaf0, int leaf1, const Leaf& a, const Leaf& b, const HalfSpace& space);
    void note_open(const PairState& state, int leaf0, int leaf1, const Leaf& a, const Leaf& b);
    void tell_one_sided(const btCollisionObject& object, int child, const Leaf& mesh);
    void add_cast(PairState& state, int leaf0, int leaf1, const Leaf& a, const Leaf& b);
    void add_round(PairState& state, int leaf0, int leaf1, const Leaf& a, const Leaf& b);
    void wake(const PairState& pair);
    void sort_batch();
    void hand_out(std::span<const Contact> contacts);

    CollisionDispatcher& dispatcher;
    ManifoldSettings manifolds;
    ConvexShapes convex;
    Scene scene;
    Objects objects;
    Queries queries;
    Touches touches;
    DispatcherStats stats;
    std::uint64_t dispatch = 0;
    btCollisionWorld* world = nullptr;                   ///< that was attached; it may be gone
    const btOverlappingPairCache* world_cache = nullptr; ///< by which a dispatch shows that it is of that world
    bool asking = false;                                 ///< a near callback is at work
    std::vector<btBroadphasePair*> ours;                 ///< of this dispatch
    std::vector<PairState*> work;                        ///< this dispatch's pairs, in the broad phase's order
    std::vector<BatchEntry> batch;
    std::vector<std::pair<Slots, std::uint32_t>> order; ///< of the batch: pairs ascending, with their places in it
    std::vector<Pair> pairs;
    std::vector<PlaneContact> below;
    std::vector<RoundContact> near;
    std::unordered_map<const Shape*, std::weak_ptr<const Shape>> told_one_sided;
    std::unique_ptr<WorldRecorder> recorder; ///< null: nothing is recorded
};

CollisionDispatcher::CollisionDispatcher(btCollisionConfiguration* configuration, const Settings& settings,
                                         const ManifoldSettings& manifolds, ConvexShapes convex)
    : btCollisionDispatcher(configuration),
      state_(std::make_unique<State>(*this, with_defaults(settings), checked(manifolds), convex)) {}

CollisionDispatcher::~CollisionDispatcher() = default;

void CollisionDispatcher::dispatchAllCollisionPairs(btOverlappingPairCache* cache, const btDispatcherInfo& info,
                                                    btDispatcher* dispatcher) {
    State& s = *state_;
    ++s.dispatch;
    s.stats = {};
    s.ours.clear();
    s.work.clear();
    s.batch.clear();
    s.objects.mended() = {};
    s.touches.begin();
    const std::uint64_t made_before = s.objects.shapes().made();
    s.objects.sweep();
    s.objects.look_ahead(s.scene.settings().is_speculative() ? info.m_timeStep : 0, s.dispatch);
    s.read_world(cache, info, dispatcher);

    struct Visit final : btOverlapCallback {
        State& state;
        const btDispatcherInfo& info;
        Visit(State& s_, const btDispatcherInfo& i) : state(s_), info(i) {}
        bool processOverlap(btBroadphasePair& pair) override {
            state.visit(pair, info);
            return false;
        }
    } visit(s, info);
    cache->processAllOverlappingPairs(&visit, dispatcher, info);
    for (std::size_t i = 0; i < s.ours.size(); ++i) {
        s.fetch_ahead(i);
        s.take(*s.ours[i], info);
    }

    s.objects.refresh_pinned(s.dispatch);
    s.sort_batch();
    s.stats.pairs = s.work.size();
    s.stats.mesh_pairs = s.pairs.size();
    s.scene.find_contacts(s.pairs);
    if (s.recorder) s.recorder->step();
    s.hand_out(s.scene.contacts());
    for (PairState* state : s.work)
        if (adds_are_told(*state->object0, *state->object1)) name_places(*state);
    for (std::size_t i = 0; i < s.work.size(); ++i) {
        if (i + 8 < s.work.size()) prefetch(s.work[i + 8]);
        if (i + 4 < s.work.size()) s.work[i + 4]->patches.fetch_list();
        if (i + 2 < s.work.size()) s.work[i + 2]->patches.fetch();
        PairState& pair = *s.work[i];
        s.wake(pair);
        pair.patches.update(pair.candidates, pair.record0.pose, pair.record1.pose, s.manifolds, s.stats);
        s.touches.update(pair, info.m_timeStep);
        if (s.scene.settings().is_speculative()) turn_round_what_bounces(pair, info.m_timeStep); // after the callbacks
    }
    s.touches.done();
    s.stats.touching = s.touches.count();
    s.stats.shapes_made = s.objects.shapes().made() - made_before;
    s.stats.made_rigid = s.objects.mended().made_rigid;
    s.stats.scaled = s.objects.mended().scaled;
    s.objects.forget_mended();
    s.stats.left_out = s.objects.mended().left_out;
    s.objects.faults().tell();
}

void CollisionDispatcher::attach(btCollisionWorld& world) {
    state_->world = &world;
    state_->world_cache = world.getPairCache();
}

// Before the pairs are visited: it may find more of them.
void CollisionDispatcher::State::read_world(const btOverlappingPairCache* cache, const btDispatcherInfo& info,
                                            btDispatcher* asker) {
    if (world == nullptr || cache != world_cache) return;
    if (info.m_useContinuous) objects.kinematics().sweep(*world, asker);
    const btCollisionObjectArray& all = world->getCollisionObjectArray();
    for (int i = 0; i < all.size(); ++i) {
        const btCollisionObject& object = *all[i];
        // Bullet has disabled what is lost, unless a user forbids it.
        const int state = object.getActivationState();
        if (state == DISABLE_SIMULATION || state == DISABLE_DEACTIVATION) objects.report_lost(object, dispatch);
    }
}

// In time for this step: Bullet's islands wake what touches a kinematic object, but solve it one step later where it
// lies in a pile.
void CollisionDispatcher::State::wake(const PairState& pair) {
    if (pair.candidates.empty()) return;
    const auto pushes = [&](const btCollisionObject& pusher, const btCollisionObject& other) {
        if (other.isActive() || !pusher.hasContactResponse() || !other.hasContactResponse()) return;
        if (objects.kinematics().next_of(pusher)) other.activate();
    };
    pushes(*pair.object0, *pair.object1);
    pushes(*pair.object1, *pair.object0);
}

void CollisionDispatcher::State::drop_algorithm(btBroadphasePair& pair) const {
    if (!pair.m_algorithm) return;
    pair.m_algorithm->~btCollisionAlgorithm();
    dispatcher.freeCollisionAlgorithm(pair.m_algorithm);
    pair.m_algorithm = nullptr;
}

bool CollisionDispatcher::State::is_ours(btBroadphasePair& pair) {
    const auto* a = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
    const auto* b = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
    const btCollisionShape& shape_a = *a->getCollisionShape();
    const btCollisionShape& shape_b = *b->getCollisionShape();
    const bool ours_now = for_us(shape_a, shape_b, convex);
    if (!ours_now && unsupported(shape_a, shape_b) && ((kinds_in(shape_a) | kinds_in(shape_b)) & bit(Kind::mesh)))
        ++stats.unsupported;
    return ours_now;
}

void CollisionDispatcher::State::visit(btBroadphasePair& pair, const btDispatcherInfo& info) {
    if (is_ours(pair)) {
        // Bullet's own callback would do what take() does for all of them, faster.
        if (dispatcher.getNearCallback() == btCollisionDispatcher::defaultNearCallback)
            ours.push_back(&pair);
        else
            ask(pair, info);
        return;
    }
    ++stats.other_pairs;
    if (PairAlgorithm::of(pair.m_algorithm)) drop_algorithm(pair); // a shape was replaced
    dispatcher.getNearCallback()(pair, dispatcher, info);
}

// Of two that do not move one may be disabled by Bullet, which is a fault.
void CollisionDispatcher::State::leave_alone(const btCollisionObject& a, const btCollisionObject& b) {
    ++stats.pairs_left_alone;
    for (const btCollisionObject* object : {&a, &b})
        if (object->getActivationState() == DISABLE_SIMULATION) objects.report_lost(*object, dispatch);
}

void CollisionDispatcher::State::ask(btBroadphasePair& pair, const btDispatcherInfo& info) {
    if (!PairAlgorithm::of(pair.m_algorithm)) drop_algorithm(pair);
    struct Asking {
        bool& now;
        explicit Asking(bool& flag) : now(flag) { now = true; }
        ~Asking() { now = false; } // also if the callback throws
    };
    {
        const Asking while_called(asking);
        dispatcher.getNearCallback()(pair, dispatcher, info);
    }
    PairAlgorithm* algorithm = PairAlgorithm::of(pair.m_algorithm);
    if (!algorithm) return;
    if (algorithm->take_wanted()) {
        ours.push_back(&pair);
        return;
    }
    // Not wanted because both sleep: they keep theirs. Otherwise the callback refused the pair.
    const auto* a = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
    const auto* b = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
    if (dispatcher.needsCollision(a, b)) {
        if (algorithm->state()) algorithm->state()->clear();
        return;
    }
    leave_alone(*a, *b);
}

btCollisionAlgorithm* CollisionDispatcher::findAlgorithm(const btCollisionObjectWrapper* a,
                                                         const btCollisionObjectWrapper* b,
                                                         btPersistentManifold* manifold, ebtDispatcherQueryType type) {
    if (!for_us(*a->getCollisionShape(), *b->getCollisionShape(), state_->convex))
        return btCollisionDispatcher::findAlgorithm(a, b, manifold, type);
    btCollisionAlgorithmConstructionInfo info(this, -1);
    if (state_->asking && type == BT_CONTACT_POINT_ALGORITHMS && is_whole(*a) && is_whole(*b))
        return new (allocateCollisionAlgorithm(sizeof(PairAlgorithm))) PairAlgorithm(info);
    return new (allocateCollisionAlgorithm(sizeof(QueryAlgorithm))) QueryAlgorithm(info, state_->queries);
}

// Prefetches the state of some pairs ahead: it lies scattered in memory, and the solver has used the caches since.
void CollisionDispatcher::State::fetch_ahead(std::size_t i) const {
    constexpr std::size_t algorithms = 12, states = 6;
    if (i + algorithms < ours.size()) prefetch(ours[i + algorithms]->m_algorithm);
    if (i + states >= ours.size()) return;
    PairAlgorithm* coming = PairAlgorithm::of(ours[i + states]->m_algorithm);
    if (coming && coming->state()) {
        const char* bytes = reinterpret_cast<const char*>(coming->state());
        for (std::size_t at = 0; at < sizeof(PairState); at += 64) prefetch(bytes + at);
    }
}

void CollisionDispatcher::State::take(btBroadphasePair& pair, const btDispatcherInfo& info) {
    const auto* a = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
    const auto* b = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
    // Both asleep, or filtered: as in Bullet, manifolds stay and no work is done.
    const bool asked = dispatcher.getNearCallback() != btCollisionDispatcher::defaultNearCallback;
    if (!asked && !dispatcher.needsCollision(a, b)) return leave_alone(*a, *b);
    PairState& state = state_of(pair, *a, *b);
    objects.refresh(*a, state.record0, dispatch);
    objects.refresh(*b, state.record1, dispatch);
    state.check_versions(state.record0.version, state.record1.version);
    state.candidates.clear();
    if (state.record0.misplaced() || state.record1.misplaced()) return state.clear();
    work.push_back(&state);
    gather(state, state.record0, state.record1, info);
}

PairState& CollisionDispatcher::State::state_of(btBroadphasePair& pair, const btCollisionObject& a,
                                                const btCollisionObject& b) {
    PairAlgorithm* algorithm = PairAlgorithm::of(pair.m_algorithm);
    if (!algorithm) {
        drop_algorithm(pair);
        const btCollisionAlgorithmConstructionInfo info(&dispatcher, -1);
        algorithm = new (dispatcher.allocateCollisionAlgorithm(sizeof(PairAlgorithm))) PairAlgorithm(info);
        pair.m_algorithm = algorithm;
    }
    if (!algorithm->state()) {
        // A record made here has no pair yet; PairState, made next, acquires it.
        objects.refresh(a, dispatch);
        try {
            objects.refresh(b, dispatch);
        } catch (...) {
            objects.drop_unused(&a);
            throw;
        }
        algorithm->set_state(std::make_unique<PairState>(dispatcher, objects, touches, &a, &b));
    }
    return *algorithm->state();
}

void CollisionDispatcher::State::gather(PairState& state, const Object& a, const Object& b,
                                        const btDispatcherInfo& info) {
    // The broad phase has tested the boxes of whole objects.
    const bool several = a.leaves.size() > 1 || b.leaves.size() > 1;
    for (int i = 0; i < static_cast<int>(a.leaves.size()); ++i) {
        for (int j = 0; j < static_cast<int>(b.leaves.size()); ++j) {
            const Leaf& la = a.leaves[static_cast<std::size_t>(i)];
            const Leaf& lb = b.leaves[static_cast<std::size_t>(j)];
            if (la.left_out() || lb.left_out()) continue;
            switch (work_for(la, lb, convex)) {
            case Work::batch: {
                if (several && apart(la, lb)) break;
                note_open(state, i, j, la, lb);
                if (const auto face = face_between(la, lb)) {
                    add_plane(state, i, j, la, lb, *face);
                    break;
                }
                const bool swapped = la.body.slot > lb.body.slot;
                const Pair pair = swapped ? Pair{lb.body, la.body} : Pair{la.body, lb.body};
                const btScalar reach = manifolds.patch_reach * btMin(diagonal(la), diagonal(lb));
                batch.push_back({pair, &state, i, j, swapped, reach});
                break;
            }
            case Work::plane:
                add_plane(state, i, j, la, lb, plane_between(la, lb));
                break;
            case Work::round:
                add_round(state, i, j, la, lb);
                break;
            case Work::bullet:
                state.run_child(i, j, la, lb, info);
                add_cast(state, i, j, la, lb);
                break;
            case Work::nothing:
                ++stats.unsupported;
                break;
            }
        }
    }
}

btScalar CollisionDispatcher::State::margin(const Leaf& a, const Leaf& b) const {
    const btScalar share = btScalar(speculative_share) * btMin(diagonal(a), diagonal(b));
    const std::optional<double> metres = scene.settings().speculative_margin;
    return metres ? btScalar(*metres) : share;
}

// Vertices reach an open mesh from beyond its box; other methods follow what is apart. Speculative contacts have what
// is nearer than the margin, or may come so near.
bool CollisionDispatcher::State::apart(const Leaf& a, const Leaf& b) const {
    const Settings& settings = scene.settings();
    if (settings.method != Method::standard && settings.method != Method::certified) return false;
    if (!a.converted.shape->has_inside() || !b.converted.shape->has_inside()) return false;
    btScalar reach = 0;
    if (settings.is_speculative()) reach = a.way + b.way + margin(a, b);
    const btVector3 around(reach, reach, reach);
    return !TestAabbAgainstAabb2(a.low - around, a.high + around, b.low, b.high);
}

// The batch alone knows other directions, and what does not touch yet.
std::optional<HalfSpace> CollisionDispatcher::State::face_between(const Leaf& a, const Leaf& b) const {
    const bool box_is_0 = a.kind == Kind::convex;
    const Leaf& box = box_is_0 ? a : b;
    const Leaf& mesh = box_is_0 ? b : a;
    const Settings& settings = scene.settings();
    if (box.form.type != BOX_SHAPE_PROXYTYPE || settings.is_speculative()
        || settings.direction != Direction::reprojected || box.stretch != no_stretch)
        return std::nullopt;
    return only_face(mesh.converted, mesh.pose, static_cast<const btBoxShape&>(*box.shape), box.pose);
}

void CollisionDispatcher::State::add_plane(PairState& state, int leaf0, int leaf1, const Leaf& a, const Leaf& b,
                                           const HalfSpace& space) {
    ++stats.plane_pairs;
    const bool mesh_is_0 = a.kind == Kind::mesh;
    const Leaf& mesh = mesh_is_0 ? a : b;
    const btVector3& normal = space.normal;
    const bool speculative = scene.settings().is_speculative();
    const btScalar near_by = speculative ? margin(a, b) : 0;
    plane_contacts(mesh.converted, mesh.pose, space, speculative ? btMax(near_by, mesh.way) : 0, below);
    const Pose next = to_pose(mesh.next);
    const auto will_touch = [&](const PlaneContact& c) {
        return depth_in(space, transform_point(next, mesh.converted.shape->vertices()[c.vertex])) >= 0;
    };
    // Four points would do for what rests; in a fast fall one that is left out may go deep.
    const btScalar reach = speculative ? manifolds.patch_reach * diagonal(mesh) : diagonal(mesh);
    for (const PlaneContact& c : below) {
        if (c.depth < -near_by && !will_touch(c)) continue;
        const btVector3 on_plane = c.point + normal * c.depth;
        Candidate candidate;
        candidate.key = {leaf0, leaf1, mesh_is_0 ? 0 : 1,
                         static_cast<int>(mesh.converted.shape->vertex_index()[c.vertex])};
        candidate.on0 = mesh_is_0 ? c.point : on_plane;
        candidate.on1 = mesh_is_0 ? on_plane : c.point;
        candidate.normal = mesh_is_0 ? normal : -normal;
        candidate.distance = -c.depth;
        candidate.speculative = c.depth <= 0;
        candidate.reach = reach;
        state.candidates.push_back(candidate);
    }
}

void CollisionDispatcher::State::add_round(PairState& state, int leaf0, int leaf1, const Leaf& a, const Leaf& b) {
    ++stats.round_pairs;
    const bool mesh_is_0 = a.kind == Kind::mesh;
    const Leaf& mesh = mesh_is_0 ? a : b;
    const Leaf& ball = mesh_is_0 ? b : a;
    const Round round = round_before(mesh, ball, convex);
    // Bullet's algorithms report what is near, too: a ball at rest keeps its contact.
    const btScalar reach =
        btMin(gContactBreakingThreshold, ball.shape->getContactBreakingThreshold(gContactBreakingThreshold));
    round_contacts(mesh.converted, mesh.pose, round, ball.pose, reach, near);
    const std::size_t near_now = near.size();
    if (scene.settings().is_speculative())
        first_touches(mesh.converted, mesh.pose, mesh.next, round, ball.pose, ball.next, near);
    for (std::size_t i = 0; i < near.size(); ++i) {
        const RoundContact& c = near[i];
        const btVector3 on_ball = c.point + c.normal * c.distance;
        Candidate candidate;
        candidate.key = {leaf0, leaf1, mesh_is_0 ? 1 : 0, c.place};
        candidate.triangle = static_cast<int>(mesh.converted.shape->triangle_index()[c.triangle]);
        candidate.on0 = mesh_is_0 ? c.point : on_ball;
        candidate.on1 = mesh_is_0 ? on_ball : c.point;
        candidate.normal = mesh_is_0 ? -c.normal : c.normal;
        candidate.distance = c.distance;
        candidate.reach = btMin(diagonal(mesh), 2 * round.radius + (round.ends[1] - round.ends[0]).length());
        candidate.speculative = i >= near_now;
        state.candidates.push_back(candidate);
    }
}

// A body that moves by its own size in a step would be through an open mesh before Bullet's algorithm sees it.
void CollisionDispatcher::State::add_cast(PairState& state, int leaf0, int leaf1, const Leaf& a, const Leaf& b) {
    const bool mesh_is_0 = a.kind == Kind::mesh;
    const Leaf& mesh = mesh_is_0 ? a : b;
    const Leaf& shape = mesh_is_0 ? b : a;
    if (!is_two_sided(mesh, convex) || shape.kind != Kind::convex) return;
    ++stats.two_sided_pairs;
    if (!scene.settings().is_speculative()) return;
    const auto hit = cast_hit(shape, mesh);
    if (!hit) return;
    const btVector3 on_mesh = hit->point - hit->normal * hit->distance;
    Candidate candidate;
    candidate.key = {leaf0, leaf1, mesh_is_0 ? 1 : 0};
    candidate.triangle = hit->triangle;
    candidate.on0 = mesh_is_0 ? on_mesh : hit->point;
    candidate.on1 = mesh_is_0 ? hit->point : on_mesh;
    candidate.normal = mesh_is_0 ? -hit->normal : hit->normal;
    candidate.distance = hit->distance;
    candidate.reach = btMin(diagonal(mesh), diagonal(shape));
    candidate.speculative = true;
    state.candidates.push_back(candidate);
}

void CollisionDispatcher::State::note_open(const PairState& state, int leaf0, int leaf1, const Leaf& a, const Leaf& b) {
    const auto is_open = [](const Leaf& leaf) {
        return leaf.kind == Kind::mesh && !leaf.converted.shape->has_inside();
    };
    if (!is_open(a) && !is_open(b)) return;
    ++stats.one_sided_pairs;
    if (is_open(a) && b.kind != Kind::field) tell_one_sided(*state.object0, leaf0, a);
    if (is_open(b) && a.kind != Kind::field) tell_one_sided(*state.object1, leaf1, b);
}

// Once for each mesh: many objects may share it. What moves and is open mostly lies on what is closed.
void CollisionDispatcher::State::tell_one_sided(const btCollisionObject& object, int child, const Leaf& mesh) {
    if (!mesh.is_fixed) return;
    std::weak_ptr<const Shape>& known = told_one_sided[mesh.converted.shape.get()];
    if (!known.expired()) return;
    known = mesh.converted.shape;
    std::erase_if(told_one_sided, [](const auto& one) { return one.second.expired(); });
    objects.faults().add(hint_of(object, child,
                                 "its mesh is open, so it stops other meshes at the front of its faces alone and lets "
                                 "them through from behind; close it, or turn its faces to where bodies are"));
}

// Contacts come sorted by pair: sort the batch the same way, by small keys, and hand_out() walks both once.
void CollisionDispatcher::State::sort_batch() {
    order.clear();
    for (std::size_t i = 0; i < batch.size(); ++i) {
        const auto [first, second] = batch[i].pair;
        order.emplace_back(Slots{first.slot, second.slot}, static_cast<std::uint32_t>(i));
    }
    std::sort(order.begin(), order.end());
    pairs.clear();
    for (const auto& [slots, index] : order) pairs.push_back(batch[index].pair);
}

void CollisionDispatcher::State::hand_out(std::span<const Contact> contacts) {
    std::size_t at = 0;
    for (const Contact& c : contacts) {
        const Slots slots{c.body_a.slot, c.body_b.slot};
        while (at < order.size() && order[at].first < slots) ++at;
        if (at == order.size() || order[at].first != slots) continue;
        const BatchEntry* entry = &batch[order[at].second];
        Candidate candidate;
        const int source = c.feature.source == Side::a ? 0 : 1;
        candidate.key = {entry->child0,
                         entry->child1,
                         entry->swapped ? 1 - source : source,
                         static_cast<int>(c.feature.source_index()),
                         c.feature.kind,
                         static_cast<int>(c.feature.kind == FeatureKind::edges ? c.feature.index_b : 0)};
        candidate.triangle = static_cast<int>(c.feature.other_index());
        if (entry->swapped) {
            candidate.on0 = to_bullet(c.point_b);
            candidate.on1 = to_bullet(c.point_a);
            candidate.normal = normal_of(c);
        } else {
            candidate.on0 = to_bullet(c.point_a);
            candidate.on1 = to_bullet(c.point_b);
            candidate.normal = -normal_of(c);
        }
        candidate.distance = btScalar(-c.depth);
        candidate.speculative = c.is_speculative();
        candidate.reach = entry->reach;
        entry->state->candidates.push_back(candidate);
    }
}

BodyId CollisionDispatcher::add_body(const btCollisionObject& object) {
    if (object.getCollisionShape() == nullptr)
        throw InputError("CollisionDispatcher::add_body: the object has no shape; give it one first");
    Objects& objects = state_->objects;
    if (Object* known = objects.find(object)) known->seen = Object::never; // it may have moved since the last dispatch
    const Object& record = objects.refresh(object, state_->dispatch);
    if (std::vector<Fault> faults = objects.faults_of(object, record); !faults.empty()) {
        objects.faults().take_back(&object);
        objects.drop_unused(&object);
        throw ObjectError(std::move(faults.front()));
    }
    objects.pin(object, true);
    for (const Leaf& leaf : record.leaves) {
        if (leaf.body.valid()) return leaf.body;
    }
    objects.pin(object, false);
    throw InputError("CollisionDispatcher::add_body: the object has no mesh, nor a shape that one stands for; only "
                     "these need to be added");
}

void CollisionDispatcher::record(const std::filesystem::path& file) {
    state_->recorder.reset(); // it may be of the same file
    state_->recorder = std::make_unique<WorldRecorder>(file, state_->scene, nullptr);
}
void CollisionDispatcher::record(const std::filesystem::path& file, const RecorderOptions& options) {
    state_->recorder.reset(); // it may be of the same file
    state_->recorder = std::make_unique<WorldRecorder>(file, state_->scene, &options);
}
void CollisionDispatcher::finish_recording() {
    if (const auto recorder = std::move(state_->recorder)) recorder->finish(); // ends it even if it throws
}
void CollisionDispatcher::remove_body(const btCollisionObject& object) {
    state_->objects.pin(object, false);
    state_->objects.faults().set(object, {}); // another may lie at its address next
}

void CollisionDispatcher::refresh(const btCollisionObject& object) {
    if (Object* record = state_->objects.find(object)) record->stale = true;
    if (object.getCollisionShape())
        each_leaf(*object.getCollisionShape(), btTransform::getIdentity(),
                  [&](const btCollisionShape& shape, const btTransform&) { state_->objects.shapes().forget(shape); });
}

void CollisionDispatcher::on_fault(std::function<void(const Fault&)> callback) {
    state_->objects.faults().set_callback(std::move(callback));
}

void CollisionDispatcher::prepare() {
    state_->scene.prepare();
}

std::span<const Touch> CollisionDispatcher::begun() const {
    return state_->touches.begun();
}
std::span<const Touch> CollisionDispatcher::ended() const {
    return state_->touches.ended();
}

const Scene& CollisionDispatcher::scene() const {
    return state_->scene;
}
const DispatcherStats& CollisionDispatcher::stats() const {
    return state_->stats;
}

} // namespace raycontact::bullet
