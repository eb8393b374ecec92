// SPDX-License-Identifier: Apache-2.0
#include <raycontact/bullet/recommend.h>

#include <convert.h>
#include <raycontact/bullet/dispatcher.h>
#include <raycontact/error.h>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <cmath>

namespace raycontact::bullet {

namespace {

double size_of(const btCollisionShape& shape) {
    btVector3 low, high;
    shape.getAabb(btTransform::getIdentity(), low, high);
    // Bullet adds the margin to these; to a small body it adds more than that has.
    const bool has_margin = shape.isConcave() || shape.getShapeType() == CONVEX_HULL_SHAPE_PROXYTYPE;
    const btVector3 edges = high - low;
    return double(edges[edges.maxAxis()]) - (has_margin ? 2 * double(shape.getMargin()) : 0);
}

/// Of the smallest body that moves; empty where none does.
std::optional<double> smallest_in(const btDiscreteDynamicsWorld& world) {
    std::optional<double> smallest;
    const btCollisionObjectArray& objects = world.getCollisionObjectArray();
    for (int i = 0; i < objects.size(); ++i) {
        if (objects[i]->isStaticOrKinematicObject() || !objects[i]->hasContactResponse()) continue;
        const double size = size_of(*objects[i]->getCollisionShape());
        if (std::isfinite(size) && size > 0 && (!smallest || size < *smallest)) smallest = size;
    }
    return smallest;
}

} // namespace

void recommend(btDiscreteDynamicsWorld& world, const SolverSettings& settings) {
    if (settings.slop && !(std::isfinite(*settings.slop) && *settings.slop >= 0))
        throw InputError("SolverSettings::slop must be finite and not negative");
    if (settings.size && !(std::isfinite(*settings.size) && *settings.size > 0))
        throw InputError("SolverSettings::size must be finite and above 0");
    if (!(settings.erp >= 0 && settings.erp <= 1)) throw InputError("SolverSettings::erp must be from 0 to 1");
    if (settings.iterations < 1) throw InputError("SolverSettings::iterations must be at least 1");
    auto* ours = dynamic_cast<CollisionDispatcher*>(world.getDispatcher());
    double slop = 0.001;
    if (settings.slop) {
        slop = *settings.slop;
    } else if (const auto size = settings.size ? settings.size : smallest_in(world)) {
        const bool speculative = !ours || ours->scene().settings().is_speculative();
        slop = (speculative ? 0.001 : 0.005) * *size;
    }
    if (ours) ours->attach(world);
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_linearSlop = btScalar(slop);
    info.m_erp2 = btScalar(settings.erp);
    info.m_numIterations = settings.iterations;
    info.m_splitImpulse = 1;
    // Bullet's -0.04 leaves shallower contacts to bounce. Not 0: what a soft contact is told as (told.h) is between.
    info.m_splitImpulsePenetrationThreshold = -4 * SIMD_EPSILON * btMax(info.m_linearSlop, btScalar(1e-5));
    // Contacts keep their keys, so what carried in the last step carries in this one. Bullet's 0.85 drops a part of
    // each load in every step, and iterations have to bring it down a whole chain again.
    info.m_warmstartingFactor = 1;
    // Directions fixed by the normal: a friction impulse carried over means the same in the next step.
    info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
}

} // namespace raycontact::bullet
