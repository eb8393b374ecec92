// SPDX-License-Identifier: Apache-2.0
#include <recording/layout.h>

#include "body_slots.h"
#include "json_depth.h"

#include <raycontact/error.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace raycontact::recording {

namespace {

using Json = nlohmann::ordered_json;

Bytes to_bytes(const Json& document) {
    const std::string text = document.dump(-1, ' ', false, Json::error_handler_t::replace);
    return {text.begin(), text.end()};
}

Json from_bytes(std::span<const unsigned char> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (json_depth(text) > 4) throw Damage("nests its JSON too deeply");
    return Json::parse(text);
}

template <class Value>
Json to_json(const Value& value) {
    return value;
}

template <class Value>
Json to_json(const std::optional<Value>& value) { // null: chosen by the library
    return value ? Json(*value) : Json(nullptr);
}

Json to_json(Speculative value) { // null as of an empty optional
    return value == Speculative::automatic ? Json(nullptr) : Json(value == Speculative::on);
}

void read_if_there(const Json& document, const char* key, Speculative& value) {
    if (const auto at = document.find(key); at != document.end() && !at->is_null())
        value = at->get<bool>() ? Speculative::on : Speculative::off;
}

template <class Value>
void read_if_there(const Json& document, const char* key, Value& value) {
    if (const auto at = document.find(key); at != document.end()) value = at->get<Value>();
}

template <class Value>
void read_if_there(const Json& document, const char* key, std::optional<Value>& value) {
    if (const auto at = document.find(key); at != document.end() && !at->is_null()) value = at->get<Value>();
}

/// Those that are numbers, under the names that recordings give them; older ones lack some.
template <class AnySettings, class Visit>
void each_number(AnySettings& settings, Visit&& visit) {
    auto& paper = settings.paper;
    visit("displacement_threshold", paper.displacement_threshold);
    visit("confidence", paper.confidence);
    visit("culling_distance", paper.culling_distance);
    visit("distance_extension", paper.distance_extension);
    visit("max_iterations", paper.max_iterations);
    visit("cast_lost_walks", paper.cast_lost_walks);
    visit("skip_outside", paper.skip_outside);
    visit("speculative", settings.speculative);
    visit("speculative_margin", settings.speculative_margin);
    visit("max_contacts_per_pair", settings.max_contacts_per_pair);
    visit("max_contacts", settings.max_contacts);
}

Settings read_settings(const Json& document) {
    Settings settings;
    settings.features = Features::vertices; // recordings from before edges could be in contact do not say
    try {
        settings.method = method_from(document.at("method").get<std::string>());
        settings.paper.caster = caster_from(document.at("caster").get<std::string>());
        settings.direction = direction_from(document.at("direction").get<std::string>());
        if (const auto at = document.find("features"); at != document.end())
            settings.features = features_from(at->get<std::string>());
    } catch (const InputError& error) {
        throw UnknownSetting(error.what());
    }
    settings.execution.devices = document.at("device").get<std::string>();
    settings.execution.threads = document.at("threads").get<std::uint32_t>();
    each_number(settings, [&](const char* key, auto& value) { read_if_there(document, key, value); });
    check_settings(settings);
    return settings;
}

} // namespace

Bytes encode_events(std::span<const BodyEvent> events) {
    Bytes to;
    for (const BodyEvent& event : events)
        for (const std::uint32_t word : {event.step, static_cast<std::uint32_t>(event.kind), event.body, event.shape})
            put(to, word);
    return to;
}

void apply_events(std::span<const unsigned char> payload, std::size_t shapes, std::vector<BodyEvent>& events,
                  std::vector<Body>& bodies) {
    ByteSource from(payload);
    while (from.left() > 0) {
        const auto step = from.get<std::uint32_t>(), kind = from.get<std::uint32_t>();
        const auto id = from.get<std::uint32_t>(), shape = from.get<std::uint32_t>();
        const bool in_order = events.empty() || events.back().step <= step;
        if (in_order && kind == BodyEvent::comes && id == bodies.size() && shape < shapes) {
            bodies.push_back({shape, step, Body::never, {}});
        } else if (in_order && kind == BodyEvent::goes && id < bodies.size() && bodies[id].end_step == Body::never) {
            bodies[id].end_step = step;
        } else {
            throw Damage("has bodies that come or go in a way that cannot be");
        }
        events.push_back({step, static_cast<BodyEvent::Kind>(kind), id, shape});
    }
}

void give_ids(std::uint32_t version, std::span<const BodyEvent> events, std::vector<Body>& bodies) {
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].id = {static_cast<std::uint32_t>(i), 0};
    if (version == 1) return;
    BodySlots slots;
    std::uint32_t step = 0;
    for (const BodyEvent& event : events) {
        if (event.step > step) slots.step_done(); // one or many: the rule asks for one
        step = event.step;
        BodyId& id = bodies[event.body].id;
        if (event.kind == BodyEvent::goes) {
            slots.take_back(id.slot);
        } else {
            slots.next();
            id = slots.give();
        }
    }
}

Bytes encode_info(const Info& info) {
    Settings settings = info.settings;
    settings.speculative = settings.is_speculative() ? Speculative::on : Speculative::off;
    Json document{{"format", "raycontact recording"},
                  {"version", format_version},
                  {"scene", info.scene},
                  {"seed", info.seed},
                  {"bodies", info.bodies},
                  {"dt", info.dt},
                  {"method", to_string(settings.method)},
                  {"caster", to_string(settings.paper.caster)},
                  {"direction", to_string(settings.direction)},
                  {"features", to_string(settings.features)},
                  {"device", settings.execution.devices},
                  {"threads", settings.execution.threads}};
    each_number(settings, [&](const char* key, const auto& value) { document[key] = to_json(value); });
    document["mesh_source"] = info.mesh_source;
    Bytes bytes = to_bytes(document);
    if (bytes.size() > most_text)
        throw InputError("recording: the scene's name and what its meshes are need more than "
                         + std::to_string(most_text) + " bytes; shorten them");
    return bytes;
}

Info decode_info(std::span<const unsigned char> payload, std::uint32_t version) {
    try {
        const Json document = from_bytes(payload);
        // No checksum covers the chunk's own.
        if (document.at("version").get<std::uint32_t>() != version) throw Damage("says another version than its chunk");
        Info info;
        info.scene = document.at("scene").get<std::string>();
        info.seed = document.at("seed").get<std::uint64_t>();
        info.bodies = document.at("bodies").get<std::uint32_t>();
        info.dt = document.at("dt").get<double>();
        info.settings = read_settings(document);
        info.mesh_source = document.at("mesh_source").get<std::string>();
        if (!std::isfinite(info.dt) || info.dt <= 0) throw Damage("has a time step that is not positive");
        return info;
    } catch (const Json::exception&) {
        throw Damage("does not describe a recording");
    } catch (const InputError& error) {
        throw Damage(std::string("has a setting that makes no sense (") + error.what() + ")");
    }
}

Bytes encode_end(std::uint32_t steps, std::string_view hash) {
    return to_bytes({{"steps", steps}, {"hash", hash}});
}

std::string decode_end(std::span<const unsigned char> payload, std::uint32_t steps) {
    try {
        const Json document = from_bytes(payload);
        auto hash = document.at("hash").get<std::string>();
        if (!is_hash(hash)) throw Damage("has a hash that is none");
        if (document.at("steps").get<std::uint32_t>() != steps) throw Damage("counts other steps than there are");
        return hash;
    } catch (const Json::exception&) {
        throw Damage("does not end a recording");
    }
}

bool is_hash(std::string_view text) {
    return text.size() == 16 && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

} // namespace raycontact::recording
