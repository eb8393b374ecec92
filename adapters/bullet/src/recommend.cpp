// SPDX-License-Identifier: Apache-2.0
#include <raycontact/bullet/recommend.h>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

namespace raycontact::bullet {

void recommend(btDiscreteDynamicsWorld& world, const SolverSettings& settings) {
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
