// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

class btCollisionObject;
struct btContactSolverInfo;

namespace raycontact::bullet {

// What Bullet's solver is told of a point instead of its distance, so that it does what was asked. The positions stay
// true.

/// Gives the point what follows from the materials of its objects.
void combine_materials(btManifoldPoint& point, const btCollisionObject* a, const btCollisionObject* b);

/// Bullet takes gap and slop, by the length of the step, off the speed that restitution gives back; nothing of a depth
/// that no slop reaches. depth: such a one, metres. It is not undone.
void turn_round(btManifoldPoint& point, btScalar depth, btScalar seconds);

/// A point that is ahead, of bodies that turn: the solver takes its way for straight, along its velocity now; it is
/// told the gap that such a way closes as the arc closes the true one. Not where the bodies come nearer by more than
/// that without turning: such a hit changes how they turn.
void straighten(btManifoldPoint& point, const btCollisionObject& a, const btCollisionObject& b, btScalar seconds);

/// Of all points of soft objects, once the algorithms have run. Bullet undoes what is deeper than a threshold by moving
/// the body, without force, so a spring there would not carry; and it takes the slop off its depth. Such a point is
/// told as one that is hardly deep, with a spring so much stronger.
void keep_soft(btPersistentManifold& manifold, const btContactSolverInfo& solver, btScalar seconds);

/// A point that goes on without being found again is as its materials say.
void take_back(btManifoldPoint& point, const btCollisionObject* a, const btCollisionObject* b);

} // namespace raycontact::bullet
