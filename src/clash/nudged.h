// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "clash/parts.h"

#include <raycontact/scene.h>

#include <span>
#include <vector>

namespace raycontact::clash {

/// As parts of the smaller size: depths up to noise are made by rounding, where faces coincide. Those up to shallow may
/// be, where a part ends among coinciding faces.
constexpr double noise = 1e-6, shallow = 2e-3;

/// Two parts whose faces may coincide.
struct ShallowPair {
    const Part* a = nullptr;
    const Part* b = nullptr;
    BodyId body_a;      ///< of a in the scene, in its place
    double depth = 0.0; ///< as they are placed
};

/// Where faces of two parts coincide, contacts say little of a depth: a bolt that fits its hole exactly and a part that
/// another fills look alike. So one is nudged by 2 noise, four ways. Returns, for each pair, the contacts of the nudge
/// that leaves the least depth, if that is far more than the nudge and than the depth without; else none. `scene` has
/// the bodies of the parts alone; those of nudged parts share their shapes, and are gone after its next step.
std::vector<std::vector<Contact>> contacts_when_nudged(Scene& scene, std::span<const ShallowPair> pairs);

} // namespace raycontact::clash
