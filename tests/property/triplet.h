// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "reference/random.h"

#include <raycontact/scene.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace raycontact::reference {

// Scenes fed alike, and what their contacts have in common.

/// Rays the standard method is to decide in all: RAYCONTACT_DECISIONS; a hundred million unless told.
double decisions_wanted();

/// What RAYCONTACT_SEED adds to every seed.
std::uint64_t first_seed();

struct Counts {
    std::uint64_t episodes = 0, steps = 0;
    std::uint64_t decisions = 0;          ///< rays of the standard scenes; each certified scene has to come to the same
    std::uint64_t contacts = 0;           ///< of the standard scenes
    std::uint64_t cast = 0;               ///< rays cast by the first certified scene
    std::uint64_t pairs = 0, skipped = 0; ///< directed pairs of that scene
    std::uint64_t missed = 0, invented = 0, other = 0;
    std::string first; ///< of the wrong ones, in words
};

/// Prints the counts; a wrong contact, too few decisions and no contact at all fail the test.
void report(const char* what, const Counts& counts, double wanted);

/// A `displacement_threshold` to be told.
inline constexpr double thresholds[] = {0, 1e-6, 1e-4, 1e-2, 0.3, 100, 1e12};

/// One thread; direction, features and whether rays are skipped by chance: edges now and then, since they take longer.
Settings some_settings(Random& random);

/// These, but `reprojected` for `refined` and `weighted`, which decide nothing more and take seconds a step where fine
/// bodies lie deep in each other.
Settings soon_directed(Settings settings);

/// One scene by the standard method and two by the certified one, fed alike: one chooses what it keeps itself, the
/// other is told.
class Triplet {
public:
    Triplet(const Settings& settings, double threshold, std::string what);

    template <class Do>
    void each(Do&& change) {
        for (Scene* scene : scenes_) change(*scene);
    }

    /// A step of all three; wrong contacts of the certified ones are counted. `pairs`: as of Scene::find_contacts, or
    /// none.
    template <class... Pairs>
    void step(Counts& counts, const Pairs&... pairs) {
        each([&](Scene& scene) { scene.find_contacts(pairs...); });
        count(counts);
    }

private:
    void count(Counts& counts);
    void compare(const Scene& scene, Counts& counts) const;
    void describe(const char* how, const Contact& contact, const Scene& scene, Counts& counts) const;

    Scene standard_, own_, told_;
    Scene* scenes_[3];
    std::string what_;
    std::uint64_t steps_ = 0;
};

} // namespace raycontact::reference
