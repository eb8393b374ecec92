// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/peers/results.h>

#include <raycontact/settings.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace raycontact::bench {

/// What a device's data sheet promises.
struct Peak {
    double gb_per_s = 4800; ///< of its memory
    double tflops = 67;     ///< float32, a fused multiply-add counted as two
};

struct RooflineOptions {
    std::vector<Method> methods = {Method::standard, Method::iterative, Method::predictive};
    Caster caster = Caster::bvh;
    Peak peak;
};

/// Rays of one kind, in all counted steps; what they took is a mean of a ray.
struct RayKind {
    std::string name;  ///< cast: in full (with its predictive ray, if there is one); update: walked only
    double a_step = 0; ///< rays
    double nodes = 0, blocks = 0, faces = 0; ///< visited
    double operations = 0;                   ///< see RayCost
    double loaded = 0;                       ///< bytes: what memory must deliver if nothing is kept
    double sectors = 0;                      ///< bytes: the same if a ray keeps what it has read, and other rays do not
};
/// The means by the names that the JSON gives them.
inline constexpr std::pair<const char*, double RayKind::*> ray_figures[] = {
    {"nodes", &RayKind::nodes},           {"blocks", &RayKind::blocks},       {"faces", &RayKind::faces},
    {"operations", &RayKind::operations}, {"bytes_loaded", &RayKind::loaded}, {"bytes_in_sectors", &RayKind::sectors}};

/// A method's ray kernel.
struct RooflineRow {
    Method method = Method::standard;
    std::vector<RayKind> kinds;
    double unique = 0;  ///< bytes a step: what memory must deliver if all rays keep what one has read
    double written = 0; ///< bytes a step
    /// Microseconds a step on a device that reaches its peak: bytes if every ray reads for itself, bytes each once,
    /// operations.
    double floor_sectors = 0, floor_unique = 0, floor_operations = 0;
    bool agrees = true; ///< the counting kernels gave the bits of the CPU's
};

/// Counts by running the kernels' own text with numbers that count, on every ray of the work.
std::vector<RooflineRow> count_roofline(const Work& work, const RooflineOptions& options, const Progress& tell);

std::string table(const Work& work, const RooflineOptions& options, const std::vector<RooflineRow>& rows);
Json json(const Work& work, const RooflineOptions& options, const std::vector<RooflineRow>& rows);

} // namespace raycontact::bench
