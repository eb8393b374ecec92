// SPDX-License-Identifier: Apache-2.0
#include <raycontact/bullet/dispatcher.h>

#include <contact_finder.h>
#include <prefetch.h>
#include <query.h>
#include <raycontact/error.h>
#include <told.h>
#ifdef RAYCONTACT_RECORDING
#include <raycontact/recorder.h>
#endif

#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>
#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletDynamics/Dynamics/btDynamicsWorld.h>

#include <optional>
#include <string>

#ifndef RAYCONTACT_RECORDING
namespace raycontact {
struct RecorderOptions {};
struct Recorder {
    Recorder(const std::filesystem::path& file, const Scene&, const RecorderOptions&) {
        throw InputError(file.string()
                         + ": this RayContact was built without recordings; configure it with "
                           "-DRAYCONTACT_RECORDING=ON");
    }
    void record() {}
    void finish() {}
};
} // namespace raycontact
#endif

namespace raycontact::bullet {

namespace {

/// Whether RayContact handles two shapes; for most pairs two type checks decide.
bool for_us(const btCollisionShape& a, const btCollisionShape& b, ConvexShapes convex) {
    if (a.isConvex() && b.isConvex()) return false;
    const unsigned in_a = kinds_in(a, convex), in_b = kinds_in(b, convex);
    const auto both = [&](unsigned one, unsigned two) {
        return (in_a & one && in_b & two) || (in_b & one && in_a & two);
    };
    return both(bit(Kind::mesh), ~bit(Kind::other)) || both(bit(Kind::field), bit(Kind::round));
}

bool is_whole(const btCollisionObjectWrapper& wrap) {
    return wrap.getCollisionShape() == wrap.getCollisionObject()->getCollisionShape();
}

Settings with_defaults(Settings settings) {
    if (settings.speculative == Speculative::automatic) settings.speculative = Speculative::on;
    return settings;
}

const ManifoldSettings& checked(const ManifoldSettings& settings) {
    if (settings.keep_steps < 0 || settings.keep_steps > most_keep_steps)
        throw InputError("ManifoldSettings::keep_steps is " + std::to_string(settings.keep_steps) + "; give 0 to "
                         + std::to_string(most_keep_steps));
    return settings;
}

} // namespace

struct CollisionDispatcher::State {
    State(CollisionDispatcher& d, const Settings& settings, const ManifoldSettings& m, ConvexShapes c)
        : dispatcher(d), manifolds(m), convex(c), scene(settings), objects(scene, c), queries(settings, objects, c, d),
          finder(scene, manifolds, c, objects, stats) {
        objects.faults().set_callback(print);
    }

    /// Whether these are not the pairs of a step but those of one object, as a character asks about in the midst of a
    /// step. Without an attached world only ghosts tell.
    bool is_query(btOverlappingPairCache& cache) const {
        if (world != nullptr) return &cache != world_cache;
        for (int i = 0; i < cache.getNumOverlappingPairs(); ++i)
            for (const btBroadphaseProxy* proxy :
                 {cache.getOverlappingPairArray()[i].m_pProxy0, cache.getOverlappingPairArray()[i].m_pProxy1}) {
                auto* object = static_cast<btCollisionObject*>(proxy->m_clientObject);
                auto* ghost = dynamic_cast<btPairCachingGhostObject*>(object);
                if (ghost && ghost->getOverlappingPairCache() == &cache) return true;
            }
        return false;
    }

    // Before the pairs are visited: it may find more of them.
    void read_world(const btOverlappingPairCache* cache, const btDispatcherInfo& info, btDispatcher* asker) {
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

    /// Of a dynamic world that was attached.
    const btContactSolverInfo* solver_of(const btOverlappingPairCache* cache) const {
        if (world == nullptr || cache != world_cache) return nullptr;
        auto* dynamics = dynamic_cast<btDynamicsWorld*>(world);
        return dynamics ? &dynamics->getSolverInfo() : nullptr;
    }

    // Of two that do not move one may be disabled by Bullet, which is a fault.
    void leave_alone(const btCollisionObject& a, const btCollisionObject& b) {
        ++stats.pairs_left_alone;
        for (const btCollisionObject* object : {&a, &b})
            if (object->getActivationState() == DISABLE_SIMULATION) objects.report_lost(*object, dispatch);
    }

    void drop_algorithm(btBroadphasePair& pair) const {
        if (!pair.m_algorithm) return;
        BackToPool{&dispatcher}(pair.m_algorithm);
        pair.m_algorithm = nullptr;
    }

    bool is_ours(btBroadphasePair& pair) {
        const auto* a = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
        const auto* b = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
        const btCollisionShape& shape_a = *a->getCollisionShape();
        const btCollisionShape& shape_b = *b->getCollisionShape();
        const bool ours_now = for_us(shape_a, shape_b, convex);
        if (!ours_now && unsupported(shape_a, shape_b)
            && ((kinds_in(shape_a, convex) | kinds_in(shape_b, convex)) & bit(Kind::mesh)))
            ++stats.unsupported;
        return ours_now;
    }

    void ask(btBroadphasePair& pair, const btDispatcherInfo& info) {
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

    void visit(btBroadphasePair& pair, const btDispatcherInfo& info) {
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

    // Prefetches the state of some pairs ahead: it lies scattered in memory, and the solver has used the caches since.
    void fetch_ahead(std::size_t i) const {
        constexpr std::size_t algorithms = 12, states = 6;
        if (i + algorithms < ours.size()) prefetch(ours[i + algorithms]->m_algorithm);
        if (i + states >= ours.size()) return;
        PairAlgorithm* coming = PairAlgorithm::of(ours[i + states]->m_algorithm);
        if (coming && coming->state()) {
            const char* bytes = reinterpret_cast<const char*>(coming->state());
            for (std::size_t at = 0; at < sizeof(PairState); at += 64) prefetch(bytes + at);
        }
    }

    PairState& state_of(btBroadphasePair& pair, const btCollisionObject& a, const btCollisionObject& b) {
        PairAlgorithm* algorithm = PairAlgorithm::of(pair.m_algorithm);
        if (!algorithm) {
            drop_algorithm(pair);
            const btCollisionAlgorithmConstructionInfo info(&dispatcher, -1);
            algorithm = new (dispatcher.allocateCollisionAlgorithm(sizeof(PairAlgorithm))) PairAlgorithm(info);
            pair.m_algorithm = algorithm;
        }
        if (!algorithm->state()) {
            const auto record_a = objects.refresh(a, dispatch),
                       record_b = objects.refresh(b, dispatch); // in this order
            algorithm->set_state(std::make_unique<PairState>(dispatcher, touches, a, b, record_a, record_b));
        }
        return *algorithm->state();
    }

    void take(btBroadphasePair& pair, const btDispatcherInfo& info) {
        const auto* a = static_cast<const btCollisionObject*>(pair.m_pProxy0->m_clientObject);
        const auto* b = static_cast<const btCollisionObject*>(pair.m_pProxy1->m_clientObject);
        // Both asleep, or filtered: as in Bullet, manifolds stay and no work is done.
        const bool asked = dispatcher.getNearCallback() != btCollisionDispatcher::defaultNearCallback;
        if (!asked && !dispatcher.needsCollision(a, b)) return leave_alone(*a, *b);
        PairState& state = state_of(pair, *a, *b);
        objects.meet(*state.record0, *b);
        objects.meet(*state.record1, *a);
        objects.refresh(*a, *state.record0, dispatch);
        objects.refresh(*b, *state.record1, dispatch);
        state.check_versions();
        state.candidates.clear();
        if (state.record0->misplaced() || state.record1->misplaced()) return state.clear();
        work.push_back(&state);
        finder.take(state, info);
    }

    // In time for this step: Bullet's islands wake what touches a kinematic object, but solve it one step later where
    // it lies in a pile.
    void wake(const PairState& pair) {
        if (pair.candidates.empty()) return;
        const auto pushes = [&](const btCollisionObject& pusher, const btCollisionObject& other) {
            if (other.isActive() || !pusher.hasContactResponse() || !other.hasContactResponse()) return;
            if (objects.kinematics().next_of(pusher)) other.activate();
        };
        pushes(*pair.object0, *pair.object1);
        pushes(*pair.object1, *pair.object0);
    }

    CollisionDispatcher& dispatcher;
    ManifoldSettings manifolds;
    ConvexShapes convex;
    Scene scene;
    Objects objects;
    Queries queries;
    Touches touches;
    DispatcherStats stats;
    ContactFinder finder;
    std::uint64_t dispatch = 0;
    btCollisionWorld* world = nullptr;                   ///< that was attached; it may be gone
    const btOverlappingPairCache* world_cache = nullptr; ///< by which a dispatch shows that it is of that world
    bool asking = false;                                 ///< a near callback is at work
    std::vector<btBroadphasePair*> ours;                 ///< of this dispatch
    std::vector<PairState*> work;                        ///< this dispatch's pairs, in the broad phase's order
    std::optional<Recorder> recorder;
};

CollisionDispatcher::CollisionDispatcher(btCollisionConfiguration* configuration, const Settings& settings,
                                         const ManifoldSettings& manifolds, ConvexShapes convex)
    : btCollisionDispatcher(configuration),
      state_(std::make_unique<State>(*this, with_defaults(settings), checked(manifolds), convex)) {}

CollisionDispatcher::~CollisionDispatcher() = default;

void CollisionDispatcher::dispatchAllCollisionPairs(btOverlappingPairCache* cache, const btDispatcherInfo& info,
                                                    btDispatcher* dispatcher) {
    State& s = *state_;
    if (s.is_query(*cache)) {
        for (int i = 0; i < cache->getNumOverlappingPairs(); ++i) {
            btBroadphasePair& pair = cache->getOverlappingPairArray()[i];
            if (PairAlgorithm::of(pair.m_algorithm)) s.drop_algorithm(pair); // from before a world was attached
        }
        btCollisionDispatcher::dispatchAllCollisionPairs(cache, info, dispatcher);
        return;
    }
    ++s.dispatch;
    s.stats = {};
    s.ours.clear();
    s.work.clear();
    s.finder.begin();
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
    s.finder.run_rounds();
    s.finder.run_batch();
    if (s.recorder) s.recorder->record();
    s.stats.pairs = s.work.size();
    for (std::size_t i = 0; i < s.work.size(); ++i) {
        if (i + 8 < s.work.size()) prefetch(s.work[i + 8]);
        if (i + 4 < s.work.size()) s.work[i + 4]->patches.fetch_list();
        if (i + 2 < s.work.size()) s.work[i + 2]->patches.fetch();
        PairState& pair = *s.work[i];
        s.wake(pair);
        if (adds_are_told(*pair.object0, *pair.object1)) pair.name_places();
        pair.patches.update(pair.candidates, pair.record0->pose, pair.record1->pose, s.manifolds, s.stats);
        s.touches.update(pair, info.m_timeStep);
        if (s.scene.settings().is_speculative()) pair.tell_solver(info.m_timeStep); // after the callbacks
    }
    if (const btContactSolverInfo* solver = s.solver_of(cache))
        for (int i = 0; i < getNumManifolds(); ++i) keep_soft(*getManifoldByIndexInternal(i), *solver, info.m_timeStep);
    s.touches.done();
    s.stats.touching = s.touches.count();
    s.stats.shapes_made = s.objects.shapes().made() - made_before;
    s.stats.made_rigid = s.objects.mended().made_rigid;
    s.stats.scaled = s.objects.mended().scaled;
    s.stats.left_out = s.objects.mended().left_out;
    s.objects.faults().tell();
}

void CollisionDispatcher::attach(btCollisionWorld& world) {
    state_->world = &world;
    state_->world_cache = world.getPairCache();
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

BodyId CollisionDispatcher::add_body(const btCollisionObject& object) {
    if (object.getCollisionShape() == nullptr)
        throw InputError("CollisionDispatcher::add_body: the object has no shape; give it one first");
    Objects& objects = state_->objects;
    if (Object* known = objects.find(object)) known->seen = Object::never; // it may have moved since the last dispatch
    const std::shared_ptr<Object> record = objects.refresh(object, state_->dispatch);
    if (Objects::want_fields(*record)) objects.refresh(object, *record, state_->dispatch);
    if (std::vector<Fault> faults = objects.faults_of(object, *record); !faults.empty()) {
        objects.faults().take_back(&object);
        throw ObjectError(std::move(faults.front()));
    }
    for (const Leaf& leaf : record->leaves) {
        if (!leaf.body.valid()) continue;
        objects.pin(object, record);
        return leaf.body;
    }
    objects.unpin(object);
    throw InputError("CollisionDispatcher::add_body: the object has no mesh, nor a shape that one stands for; only "
                     "these need to be added");
}

void CollisionDispatcher::record(const std::filesystem::path& file) {
    record(file, {});
}
void CollisionDispatcher::record(const std::filesystem::path& file, const RecorderOptions& options) {
    state_->recorder.reset(); // it may be of the same file
    state_->recorder.emplace(file, state_->scene, options);
}
void CollisionDispatcher::finish_recording() {
    if (auto recorder = std::exchange(state_->recorder, std::nullopt)) recorder->finish(); // over even if it throws
}
void CollisionDispatcher::remove_body(const btCollisionObject& object) {
    state_->objects.unpin(object);
    state_->objects.faults().set(object, {}); // another may lie at its address next
}

void CollisionDispatcher::refresh(const btCollisionObject& object) {
    if (Object* record = state_->objects.find(object)) record->stale = true;
    if (object.getCollisionShape())
        each_leaf(*object.getCollisionShape(), btTransform::getIdentity(),
                  [&](const btCollisionShape& shape, const btTransform&) { state_->objects.shapes().forget(shape); });
}

void CollisionDispatcher::forget(btCollisionWorld& world) {
    State& s = *state_;
    const auto clean = [&](btOverlappingPairCache& cache) {
        for (int i = 0; i < cache.getNumOverlappingPairs(); ++i)
            cache.cleanOverlappingPair(cache.getOverlappingPairArray()[i], this);
    };
    clean(*world.getPairCache());
    for (int i = 0; i < world.getNumCollisionObjects(); ++i)
        if (auto* ghost = dynamic_cast<btPairCachingGhostObject*>(world.getCollisionObjectArray()[i]))
            clean(*ghost->getOverlappingPairCache());
    s.touches.forget();
    s.stats = {};
    s.objects.forget();
    // Without speculative contacts a scene forgets where bodies went.
    const Settings settings = s.scene.settings();
    Settings plain = settings;
    plain.speculative = Speculative::off;
    s.scene.set_settings(plain);
    for (int i = 0; i < 2; ++i) s.scene.find_contacts(std::span<const Pair>()); // the first has lost contacts
    s.scene.set_settings(settings);
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
