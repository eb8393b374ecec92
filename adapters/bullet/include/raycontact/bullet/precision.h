// SPDX-License-Identifier: Apache-2.0
// Included by the adapter's headers that name Bullet's types. btScalar is float, or double where
// BT_USE_DOUBLE_PRECISION is defined; user, adapter and Bullet must agree, or their functions have other names for the
// linker.
#pragma once

#ifdef BT_USE_DOUBLE_PRECISION
#define RAYCONTACT_BULLET_USED_IN_DOUBLE 1
#else
#define RAYCONTACT_BULLET_USED_IN_DOUBLE 0
#endif
#if RAYCONTACT_BULLET_DOUBLE != RAYCONTACT_BULLET_USED_IN_DOUBLE
#error "Is Bullet in double precision? Set RAYCONTACT_BULLET_DOUBLE (CMake), and BT_USE_DOUBLE_PRECISION only with it"
#endif
#undef RAYCONTACT_BULLET_USED_IN_DOUBLE
