// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tests/stacks/stack_world.h>

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace raycontact::scenes {

/// A number that a scene asks about beside those that all have, and the bounds within which it holds.
struct Figure {
    std::string name, unit;
    double value = 0;
    double least = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();

    bool holds() const { return value >= least && value <= most; } // what is not a number does not
};

/// What a scene does in a run beside letting go, and what it watches.
class Course {
public:
    virtual ~Course() = default;
    virtual void begin(StackWorld&) {}
    virtual void before_step(StackWorld&, double /*dt*/) {}
    virtual void after_step(const StackWorld&, double /*time*/) {}
    /// Bodies that are where nothing leads but through another body.
    virtual int passed(const std::vector<Pose>&) const { return 0; }
    virtual std::vector<Figure> figures() const { return {}; }
};

/// A scene that a user expects to hold. Lengths and speeds are parts of the size of its bodies.
struct Hold {
    std::string name;
    std::string means; ///< when it holds, one line
    Stack stack;
    std::function<std::unique_ptr<Course>()> course = [] { return std::make_unique<Course>(); };
    Ground ground = Ground::slab;
    double seconds = 20, hertz = 60;
    double size = 1;                      ///< metres, of the smallest body that moves
    std::optional<double> slop = 0.001;   ///< metres, of the recommended solver; none: what recommend() chooses
    std::optional<double> deepest = 0.02; ///< at most, of the sampled steps; none: nobody looks
    std::optional<double> rest = 5e-3;    ///< 1/s: the speed below which all are at the end, none: they go on
    std::optional<double> drift;          ///< at most, from where they were put
    int sample = 6;                       ///< steps from one exact look to the next
};

/// In the order in which docs/internals/bullet-measurements.md has them.
std::vector<Hold> all_holds();

} // namespace raycontact::scenes
