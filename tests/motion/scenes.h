// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/motion/motion.h>

namespace raycontact::scenes {

std::vector<Hold> slides();  ///< on level ground, with friction and without; a conveyor
std::vector<Hold> seams();   ///< T-junctions of one mesh, bodies that are flush
std::vector<Hold> slopes();  ///< a bowl, waves: energy is kept
std::vector<Hold> rolls();   ///< wheels on floors and rails
std::vector<Hold> bounces(); ///< steps that are walls, balls between walls, falls with restitution

} // namespace raycontact::scenes
