// SPDX-License-Identifier: Apache-2.0
#include <tests/stacks/stack_world.h>

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/bullet/recommend.h>
#include <raycontact/error.h>
#include <raycontact/mass.h>
#include <scenes/models/machined.h>

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletDynamicsCommon.h>

namespace raycontact::scenes {

btVector3 to_bullet(const Vec3& v) {
    return btVector3(btScalar(v.x), btScalar(v.y), btScalar(v.z));
}

std::unique_ptr<btTriangleMesh> triangles_of(const Mesh& mesh) {
    auto out = std::make_unique<btTriangleMesh>();
    for (const Vec3& v : mesh.vertices) out->findOrAddVertex(to_bullet(v), false);
    for (const auto& t : mesh.triangles)
        out->addTriangleIndices(static_cast<int>(t[0]), static_cast<int>(t[1]), static_cast<int>(t[2]));
    return out;
}

namespace {

btTransform transform_of(const Pose& pose) {
    const auto& r = pose.rotation;
    return btTransform(btMatrix3x3(btScalar(r[0]), btScalar(r[1]), btScalar(r[2]), btScalar(r[3]), btScalar(r[4]),
                                   btScalar(r[5]), btScalar(r[6]), btScalar(r[7]), btScalar(r[8])),
                       to_bullet(pose.translation));
}

std::unique_ptr<btCollisionDispatcher> make_dispatcher(Finder finder, bool speculative,
                                                       btCollisionConfiguration& configuration) {
    if (finder == Finder::edges || finder == Finder::vertices) {
        Settings settings;
        settings.features = finder == Finder::edges ? Features::edges : Features::vertices;
        settings.execution.threads = 1;
        settings.speculative = speculative ? Speculative::on : Speculative::off;
        return std::make_unique<bullet::CollisionDispatcher>(&configuration, settings);
    }
    auto dispatcher = std::make_unique<btCollisionDispatcher>(&configuration);
    if (finder == Finder::gimpact) btGImpactCollisionAlgorithm::registerAlgorithm(dispatcher.get());
    return dispatcher;
}

} // namespace

Mesh ground_mesh(Ground ground) {
    Mesh mesh = solid_box({2 * ground_reach, 2 * ground_reach, 1});
    for (Vec3& v : mesh.vertices) v.z -= 0.5;
    if (ground == Ground::quad) {
        mesh.vertices.erase(mesh.vertices.begin(), mesh.vertices.begin() + 4);
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    }
    return mesh;
}

std::string_view to_string(Finder finder) {
    switch (finder) {
    case Finder::edges:
        return "edges";
    case Finder::vertices:
        return "vertices";
    case Finder::gimpact:
        return "gimpact";
    case Finder::convex:
        return "convex";
    case Finder::bvh:
        return "bvh";
    }
    return "";
}

std::string_view to_string(Ground ground) {
    switch (ground) {
    case Ground::plane:
        return "plane";
    case Ground::slab:
        return "slab";
    case Ground::box:
        return "box";
    case Ground::quad:
        return "quad";
    case Ground::none:
        return "none";
    }
    return "";
}

struct StackWorld::State {
    State(Finder finder, bool speculative)
        : dispatcher(make_dispatcher(finder, speculative, configuration)),
          world(dispatcher.get(), &broadphase, &solver, &configuration) {}
    ~State() {
        for (const auto& constraint : constraints) world.removeConstraint(constraint.get());
        for (const auto& body : bodies) world.removeRigidBody(body.get());
    }
    State(const State&) = delete;
    State& operator=(const State&) = delete;

    void add_ground(Ground ground);
    btCollisionShape& add_solid(const StackShape& shape, bool convex);
    btCollisionShape& add_fixed(const Mesh& mesh);
    void add_body(btCollisionShape& shape, btScalar mass, const btVector3& inertia, const StackBody& body);

    btDefaultCollisionConfiguration configuration;
    std::unique_ptr<btCollisionDispatcher> dispatcher;
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver solver;
    btDiscreteDynamicsWorld world;
    std::vector<std::unique_ptr<btTriangleMesh>> meshes;
    std::vector<std::shared_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    std::size_t first_body = 0; ///< 1 where there is a ground
    std::vector<std::unique_ptr<btTypedConstraint>> constraints;
};

btCollisionShape& StackWorld::State::add_fixed(const Mesh& mesh) {
    meshes.push_back(triangles_of(mesh));
    shapes.push_back(std::make_unique<btBvhTriangleMeshShape>(meshes.back().get(), true));
    return *shapes.back();
}

btCollisionShape& StackWorld::State::add_solid(const StackShape& shape, bool convex) {
    if (shape.own) {
        shapes.push_back(shape.own());
    } else if (convex && shape.box) {
        shapes.push_back(std::make_unique<btBoxShape>(to_bullet(*shape.box) / 2));
    } else if (convex) {
        auto hull = std::make_unique<btConvexHullShape>();
        for (const Vec3& v : shape.mesh.vertices) hull->addPoint(to_bullet(v), false);
        hull->recalcLocalAabb();
        shapes.push_back(std::move(hull));
    } else {
        meshes.push_back(triangles_of(shape.mesh));
        auto mesh = std::make_unique<btGImpactMeshShape>(meshes.back().get());
        mesh->setMargin(0);
        mesh->updateBound();
        shapes.push_back(std::move(mesh));
    }
    return *shapes.back();
}

void StackWorld::State::add_ground(Ground ground) {
    if (ground == Ground::none) return;
    StackBody body;
    if (ground == Ground::plane) {
        shapes.push_back(std::make_unique<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)));
    } else if (ground == Ground::box) {
        shapes.push_back(std::make_unique<btBoxShape>(to_bullet(Vec3{ground_reach, ground_reach, 0.5})));
        body.pose.translation.z = -0.5;
    } else {
        add_fixed(ground_mesh(ground));
    }
    add_body(*shapes.back(), 0, btVector3(0, 0, 0), body);
    first_body = 1;
}

void StackWorld::State::add_body(btCollisionShape& shape, btScalar mass, const btVector3& inertia,
                                 const StackBody& body) {
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, &shape, inertia);
    info.m_startWorldTransform = transform_of(body.pose);
    info.m_friction = btScalar(body.friction);
    info.m_linearDamping = info.m_angularDamping = btScalar(body.damping);
    info.m_rollingFriction = info.m_spinningFriction = btScalar(body.rolling);
    bodies.push_back(std::make_unique<btRigidBody>(info));
    if (mass > 0) bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(bodies.back().get());
}

StackWorld::StackWorld(const Stack& stack, Ground ground, Finder finder, const StackSolver& solver)
    : state_(std::make_unique<State>(finder, solver.speculative)) {
    const bool convex = finder == Finder::convex || finder == Finder::bvh;
    if (convex && !stack.convex()) throw InputError("StackWorld: not all bodies are convex");
    State& s = *state_;
    s.world.setGravity(btVector3(0, 0, btScalar(-stack.gravity)));
    btContactSolverInfo& info = s.world.getSolverInfo();
    info.m_numIterations = solver.iterations;
    if (solver.slop) info.m_linearSlop = btScalar(*solver.slop);
    if (solver.two_friction_directions)
        info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
    s.add_ground(ground);
    std::vector<Mass> masses;
    for (const StackShape& shape : stack.shapes) masses.push_back(mass_of(shape.mesh.vertices, shape.mesh.triangles));
    std::vector<btCollisionShape*> solid(stack.shapes.size()), fixed(stack.shapes.size());
    for (const StackBody& body : stack.bodies) {
        const StackShape& shape = stack.shapes[body.shape];
        // A box that is fixed is one for the convex finder, too.
        const bool as_mesh = body.fixed && !shape.own && !(finder == Finder::convex && shape.box);
        btCollisionShape*& made = (as_mesh ? fixed : solid)[body.shape];
        if (made == nullptr) made = as_mesh ? &s.add_fixed(shape.mesh) : &s.add_solid(shape, convex);
        const Mass& m = masses[body.shape];
        const double density = body.fixed ? 0 : body.density;
        const btVector3 inertia = btScalar(density) * to_bullet(Vec3{m.inertia[0], m.inertia[4], m.inertia[8]});
        s.add_body(*made, btScalar(density * m.volume), inertia, body);
    }
    if (solver.recommended) bullet::recommend(s.world, {.slop = solver.slop, .iterations = solver.iterations});
}

StackWorld::~StackWorld() = default;

void StackWorld::step(double seconds) {
    state_->world.stepSimulation(btScalar(seconds), 0);
}

btDiscreteDynamicsWorld& StackWorld::world() const {
    return state_->world;
}

btRigidBody& StackWorld::body(std::size_t index) const {
    return *state_->bodies[state_->first_body + index];
}

void StackWorld::keep(std::unique_ptr<btTypedConstraint> constraint) {
    state_->world.addConstraint(constraint.get(), true);
    state_->constraints.push_back(std::move(constraint));
}

Pose StackWorld::pose(std::size_t body) const {
    const btTransform& at = this->body(body).getWorldTransform();
    Pose pose;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            pose.rotation[3 * i + k] = double(at.getBasis()[static_cast<int>(i)][static_cast<int>(k)]);
    pose.translation = {double(at.getOrigin().x()), double(at.getOrigin().y()), double(at.getOrigin().z())};
    return pose;
}

std::vector<Pose> StackWorld::poses() const {
    std::vector<Pose> all;
    for (std::size_t i = 0; i + state_->first_body < state_->bodies.size(); ++i) all.push_back(pose(i));
    return all;
}

void StackWorld::print_points(std::FILE* out) const {
    const auto number = [&](const btCollisionObject* object) {
        for (std::size_t i = 0; i < state_->bodies.size(); ++i)
            if (state_->bodies[i].get() == object) return static_cast<int>(i) - static_cast<int>(state_->first_body);
        return -1;
    };
    for (int i = 0; i < state_->dispatcher->getNumManifolds(); ++i) {
        const btPersistentManifold& m = *state_->dispatcher->getManifoldByIndexInternal(i);
        for (int k = 0; k < m.getNumContacts(); ++k) {
            const btManifoldPoint& p = m.getContactPoint(k);
            std::fprintf(out, "%d-%d at %.4f %.4f %.4f normal %.4f %.4f %.4f distance %.7f impulse %.4g age %d",
                         number(m.getBody0()), number(m.getBody1()), double(p.m_positionWorldOnB.x()),
                         double(p.m_positionWorldOnB.y()), double(p.m_positionWorldOnB.z()),
                         double(p.m_normalWorldOnB.x()), double(p.m_normalWorldOnB.y()), double(p.m_normalWorldOnB.z()),
                         double(p.m_distance1), double(p.m_appliedImpulse), p.m_lifeTime);
            if (bullet::CollisionDispatcher::is_ours(p)) {
                const bullet::PointKey key = bullet::CollisionDispatcher::key(p);
                std::fprintf(out, " key %d:%d:%d:%u", key.vertex_body, static_cast<int>(key.feature), key.vertex,
                             key.other);
            }
            std::fprintf(out, "\n");
        }
    }
}

} // namespace raycontact::scenes
