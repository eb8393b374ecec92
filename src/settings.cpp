// SPDX-License-Identifier: Apache-2.0
#include <raycontact/settings.h>

#include <raycontact/error.h>

#include <array>
#include <utility>

namespace raycontact {

namespace {

constexpr std::array methods{std::pair{Method::standard, std::string_view("standard")}};
constexpr std::array casters{std::pair{Caster::basic, std::string_view("basic")},
                             std::pair{Caster::bvh, std::string_view("bvh")}};
constexpr std::array directions{std::pair{Direction::ray, std::string_view("ray")},
                                std::pair{Direction::reprojected, std::string_view("reprojected")}};

template <typename Table>
auto find(const Table& table, std::string_view word, const char* what) {
    std::string known;
    for (const auto& [value, name] : table) {
        if (name == word) return value;
        known += (known.empty() ? "" : ", ") + std::string(name);
    }
    throw InputError(std::string(what) + " '" + std::string(word)
                     + "' is unknown to this version; use one of: " + known);
}

template <typename Table, typename Value>
std::string_view name_of(const Table& table, Value wanted) {
    for (const auto& [value, name] : table)
        if (value == wanted) return name;
    return "?";
}

} // namespace

Method method_from(std::string_view word) {
    return find(methods, word, "method");
}
Caster caster_from(std::string_view word) {
    return find(casters, word, "caster");
}
Direction direction_from(std::string_view word) {
    return find(directions, word, "direction");
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

} // namespace raycontact
