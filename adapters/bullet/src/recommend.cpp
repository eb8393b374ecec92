// SPDX-License-Identifier: Apache-2.0
#include <raycontact/bullet/recommend.h>

#include <raycontact/bullet/dispatcher.h>
#include <raycontact/error.h>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <cmath>

namespace raycontact::bullet {

void recommend(btDiscreteDynamicsWorld& world, const SolverSettings& settings) {
    if (!(std::isfinite(settings.slop) && settings.slop >= 0))
        throw InputError("SolverSettings::slop must be finite and not negative");
    if (!(settings.erp >= 0 && settings.erp <= 1)) throw InputError("SolverSettings::erp must be from 0 to 1");
    if (settings.iterations < 1) throw InputError("SolverSettings::iterations must be at least 1");
    if (auto* ours = dynamic_cast<CollisionDispatcher*>(world.getDispatcher())) ours->attach(world);
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_linearSlop = btScalar(settings.slop);
    info.m_erp2 = btScalar(settings.erp);
    info.m_numIterations = settings.iterations;
    info.m_splitImpulse = 1;
    info.m_splitImpulsePenetrationThreshold = 0; // Bullet's -0.04 leaves shallower contacts to bounce
    // Directions fixed by the normal: a friction impulse carried over means the same in the next step.
    info.m_solverMode |= SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
}

} // namespace raycontact::bullet
