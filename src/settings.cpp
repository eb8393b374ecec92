// SPDX-License-Identifier: Apache-2.0
#include <raycontact/library_mode.h>
#include <raycontact/settings.h>

#include <raycontact/error.h>

#include "number_text.h"
#include "printable.h"

#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace raycontact {

#ifdef RAYCONTACT_MODE
const bool RAYCONTACT_MODE(library_built) = true;
#endif
namespace {
constexpr std::uint32_t most_iterations = 4096; // bounds a pair's cost; a million triangles are some 2000 across

constexpr std::array methods{std::pair{Method::standard, std::string_view("standard")},
                             std::pair{Method::iterative, std::string_view("iterative")},
                             std::pair{Method::predictive, std::string_view("predictive")},
                             std::pair{Method::certified, std::string_view("certified")}};
constexpr std::array casters{std::pair{Caster::basic, std::string_view("basic")},
                             std::pair{Caster::bvh, std::string_view("bvh")}};
constexpr std::array directions{std::pair{Direction::ray, std::string_view("ray")},
                                std::pair{Direction::weighted, std::string_view("weighted")},
                                std::pair{Direction::reprojected, std::string_view("reprojected")},
                                std::pair{Direction::refined, std::string_view("refined")}};
constexpr std::array features{std::pair{Features::vertices, std::string_view("vertices")},
                              std::pair{Features::edges, std::string_view("edges")}};
constexpr std::array schedules{std::pair{Schedule::balanced, std::string_view("balanced")},
                               std::pair{Schedule::sticky, std::string_view("sticky")},
                               std::pair{Schedule::counted, std::string_view("counted")}};

template <typename Table>
auto find(const Table& table, std::string_view word, const char* what) {
    std::string known;
    for (const auto& [value, name] : table) {
        if (name == word) return value;
        known += (known.empty() ? "" : ", ") + std::string(name);
    }
    throw InputError(std::string(what) + " " + in_quotes(word) + " is unknown to this version; use one of: " + known);
}

template <typename Table, typename Value>
std::string_view name_of(const Table& table, Value wanted) {
    for (const auto& [value, name] : table)
        if (value == wanted) return name;
    return "?";
}

template <typename Table, typename Value>
void need_known(const Table& table, Value value, const char* what) {
    if (name_of(table, value) == "?")
        throw InputError(std::string(what) + " is number " + std::to_string(static_cast<int>(value))
                         + ", which its enumeration does not have");
}

// Kernels form squares of lengths, and of confidence x length, in float32, which ends at 3e38.
constexpr double most_metres = 1e12, most_confidence = 1e6;

void need_length(const char* name, const std::optional<double>& metres) {
    if (metres && !(*metres >= 0 && *metres <= most_metres))
        throw InputError(std::string(name) + " must be a length from 0 to 1e12 metres, not " + text_of(*metres));
}

} // namespace

void check_settings(const Settings& settings) {
    need_known(methods, settings.method, "method");
    need_known(casters, settings.paper.caster, "caster");
    need_known(directions, settings.direction, "direction");
    need_known(features, settings.features, "features");
    need_known(schedules, settings.execution.schedule, "schedule");
    need_length("displacement_threshold", settings.paper.displacement_threshold);
    need_length("culling_distance", settings.paper.culling_distance);
    need_length("distance_extension", settings.paper.distance_extension);
    need_length("speculative_margin", settings.speculative_margin);
    if (!(settings.paper.confidence >= 1 && settings.paper.confidence <= most_confidence))
        throw InputError("confidence must be from 1 (paper equation 1) to 1e6, not "
                         + text_of(settings.paper.confidence));
    if (settings.paper.max_iterations == 0)
        throw InputError("max_iterations must be at least 1: a ray visits its own triangle first");
    if (settings.paper.max_iterations > most_iterations)
        throw InputError("max_iterations must be at most " + std::to_string(most_iterations) + ": longer walks circle");
    if (settings.paper.displacement_threshold && settings.paper.distance_extension
        && *settings.paper.distance_extension < *settings.paper.displacement_threshold)
        throw InputError("distance_extension (" + text_of(*settings.paper.distance_extension)
                         + " m) must not be below displacement_threshold ("
                         + text_of(*settings.paper.displacement_threshold)
                         + " m), or vertices could arrive unseen (paper section 3.1)");
}

Method method_from(std::string_view word) {
    return find(methods, word, "method");
}
Caster caster_from(std::string_view word) {
    return find(casters, word, "caster");
}
Direction direction_from(std::string_view word) {
    return find(directions, word, "direction");
}
Features features_from(std::string_view word) {
    return find(features, word, "features");
}
Schedule schedule_from(std::string_view word) {
    return find(schedules, word, "schedule");
}
std::string_view to_string(Method method) {
    return name_of(methods, method);
}
std::string_view to_string(Caster caster) {
    return name_of(casters, caster);
}
std::string_view to_string(Direction direction) {
    return name_of(directions, direction);
}
std::string_view to_string(Features which) {
    return name_of(features, which);
}
std::string_view to_string(Schedule schedule) {
    return name_of(schedules, schedule);
}

} // namespace raycontact
