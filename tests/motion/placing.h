// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/motion/courses.h>
#include <tests/motion/floors.h>
#include <tests/motion/movers.h>

#include <string>
#include <vector>

namespace raycontact::scenes {

/// A scene on this floor that holds if its figures do.
Hold motion(std::string name, std::string means, const Floor& floor);
/// Velocities of so many metres a second in 12 directions, 30 degrees from one to the next, the first along x.
std::vector<Launch> star(double speed);
/// A mover for each launch, so many metres before the middle on its way and turned with it. They stand on a
/// ground whose top is z = 0, and `rise` metres for x > 0.
void add_star(Stack& stack, const Mover& mover, const std::vector<Launch>& launches, double before, double friction,
              double rise = 0);

} // namespace raycontact::scenes
