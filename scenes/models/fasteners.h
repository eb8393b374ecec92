// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/mesh.h>

namespace raycontact::scenes {

// A bolt and a nut with a coarse thread, in their true size: metres, the axis is z. As they are, the nut sits on the
// bolt's thread, with 0.1 mm of air between their radii.

Mesh bolt(); ///< 40 mm long, its head's lower side at z = 0
Mesh nut();  ///< 9 mm high, about the bolt at z = 22 to 31 mm

} // namespace raycontact::scenes
