// SPDX-License-Identifier: Apache-2.0
#include "settings_words.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <string>
#include <string_view>

namespace nb = nanobind;

namespace raycontact::python {

namespace {

/// None: `key` keeps its value.
template <typename Value>
void set_if(const nb::dict& words, const char* key, Value& value) {
    if (words.contains(key)) value = nb::cast<Value>(words[key]);
}
template <typename Value>
void set_word(const nb::dict& words, const char* key, Value& value, Value (*from)(std::string_view)) {
    if (words.contains(key)) value = from(nb::cast<std::string>(words[key]));
}

std::string word(std::string_view text) {
    return std::string(text);
}

} // namespace

Settings settings_from(const nb::dict& words, Settings s) {
    set_word(words, "method", s.method, &method_from);
    set_word(words, "direction", s.direction, &direction_from);
    set_word(words, "features", s.features, &features_from);
    if (words.contains("speculative")) {
        const auto given = nb::cast<std::optional<bool>>(words["speculative"]);
        s.speculative = !given ? Speculative::automatic : *given ? Speculative::on : Speculative::off;
    }
    set_if(words, "speculative_margin", s.speculative_margin);
    set_if(words, "max_contacts_per_pair", s.max_contacts_per_pair);
    set_if(words, "max_contacts", s.max_contacts);
    set_if(words, "devices", s.execution.devices);
    set_if(words, "threads", s.execution.threads);
    set_word(words, "schedule", s.execution.schedule, &schedule_from);
    set_if(words, "inexact", s.execution.inexact);
    set_word(words, "caster", s.paper.caster, &caster_from);
    set_if(words, "displacement_threshold", s.paper.displacement_threshold);
    set_if(words, "confidence", s.paper.confidence);
    set_if(words, "culling_distance", s.paper.culling_distance);
    set_if(words, "distance_extension", s.paper.distance_extension);
    set_if(words, "max_iterations", s.paper.max_iterations);
    set_if(words, "cast_lost_walks", s.paper.cast_lost_walks);
    set_if(words, "skip_outside", s.paper.skip_outside);
    return s;
}

nb::dict words_of(const Settings& s) {
    nb::dict words;
    words["method"] = word(to_string(s.method));
    words["direction"] = word(to_string(s.direction));
    words["features"] = word(to_string(s.features));
    words["speculative"] = s.is_speculative();
    words["speculative_margin"] = s.speculative_margin;
    words["max_contacts_per_pair"] = s.max_contacts_per_pair;
    words["max_contacts"] = s.max_contacts;
    words["devices"] = s.execution.devices;
    words["threads"] = s.execution.threads;
    words["schedule"] = word(to_string(s.execution.schedule));
    words["inexact"] = s.execution.inexact;
    words["caster"] = word(to_string(s.paper.caster));
    words["displacement_threshold"] = s.paper.displacement_threshold;
    words["confidence"] = s.paper.confidence;
    words["culling_distance"] = s.paper.culling_distance;
    words["distance_extension"] = s.paper.distance_extension;
    words["max_iterations"] = s.paper.max_iterations;
    words["cast_lost_walks"] = s.paper.cast_lost_walks;
    words["skip_outside"] = s.paper.skip_outside;
    return words;
}

} // namespace raycontact::python
