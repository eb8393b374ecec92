// SPDX-License-Identifier: Apache-2.0
#include "cli/common_options.h"

#include "cli/number_option.h"

#include <raycontact/device.h>
#include <raycontact/error.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <optional>
#include <utility>
#include <vector>

using raycontact::InputError;

namespace {

/// As check_settings names them, and as a user does.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> spelt{
    {{"displacement_threshold", "--displacement-threshold"},
     {"confidence", "--confidence"},
     {"culling_distance", "--culling-distance"},
     {"distance_extension", "--distance-extension"},
     {"max_iterations", "--max-iterations"},
     {"speculative_margin", "--speculative"}}};

std::string with_options(std::string text) {
    for (const auto& [setting, option] : spelt) {
        for (std::size_t at = 0; (at = text.find(setting, at)) != std::string::npos; at += option.size())
            text.replace(at, setting.size(), option);
    }
    return text;
}

double read_real(const std::string& word, const std::string& wanted) {
    const std::optional<double> value = read_number<double>(word);
    if (!value) throw InputError("\"" + word + "\" is not " + wanted);
    return *value;
}

/// A name whose bad values are InputErrors already, so that one sentence reaches the user, with the option in front.
template <class Read>
void add_word(CLI::App& command, const std::string& option, const std::string& help, const std::string& shown,
              const std::string& otherwise, Read read) {
    command
        .add_option_function<std::string>(
            option,
            [option, read](const std::string& word) {
                try {
                    read(word);
                } catch (const InputError& error) {
                    const std::string text = error.what();
                    throw InputError(text.starts_with("--") ? text : option + ": " + text);
                }
            },
            help)
        ->type_name(shown)
        ->default_str(otherwise);
}

/// One setting, judged at once as if it stood alone: a value that no other could mend names its own option.
template <class Value, class Read>
void add_setting(CLI::App& command, raycontact::PaperOptions& options, Value raycontact::PaperOptions::*member,
                 const std::string& option, const std::string& help, const std::string& shown,
                 const std::string& otherwise, Read read) {
    add_word(command, option, help, shown, otherwise, [&options, member, read](const std::string& word) {
        raycontact::Settings alone;
        alone.paper.*member = read(word);
        check_common_options(alone);
        options.*member = alone.paper.*member;
    });
}

void add_length(CLI::App& command, raycontact::PaperOptions& options,
                std::optional<double> raycontact::PaperOptions::*member, const std::string& option,
                const std::string& help) {
    const auto read = [](const std::string& word) -> std::optional<double> {
        if (word == "auto") return std::nullopt;
        return read_real(word, "a length: give metres, such as 0.01, or auto");
    };
    add_setting(command, options, member, option, help, "METRES|auto", "auto", read);
}

} // namespace

void add_common_options(CLI::App& command, raycontact::Settings& settings) {
    using namespace raycontact;
    constexpr std::uint32_t most = std::numeric_limits<std::uint32_t>::max();
    add_word(command, "--method",
             "how rays are kept from step to step: certified (what cannot touch yet is left alone; the contacts of "
             "standard), standard (every ray in full, every step), iterative (last step's contacts are followed), "
             "predictive (so are vertices about to touch)",
             "WORD", std::string(to_string(settings.method)),
             [&](const std::string& word) { settings.method = method_from(word); });
    add_word(command, "--caster", "how a ray meets a mesh: basic (every triangle) or bvh; same bits from both", "WORD",
             std::string(to_string(settings.paper.caster)),
             [&](const std::string& word) { settings.paper.caster = caster_from(word); });
    add_word(
        command, "--direction",
        "what normal and depth are made of: ray, weighted (for springs: contacts of faces, or of vertices alone as "
        "ray, with areas in m^2 as weights), reprojected (along the normal of the face that was hit) or refined (to "
        "the nearest face)",
        "WORD", std::string(to_string(settings.direction)),
        [&](const std::string& word) { settings.direction = direction_from(word); });
    add_word(command, "--features",
             "what can be in contact: vertices (the paper's rule) or edges (vertices and edges, so that no two closed "
             "meshes intersect unnoticed)",
             "WORD", std::string(to_string(settings.features)),
             [&](const std::string& word) { settings.features = features_from(word); });
    add_length(command, settings.paper, &PaperOptions::displacement_threshold, "--displacement-threshold",
               "metres a pair may move before it is tested in full again; auto: chosen for each pair");
    add_setting(command, settings.paper, &PaperOptions::confidence, "--confidence",
                "predictive: how far ahead a vertex is followed, in displacement thresholds, at least 1", "C",
                fmt::format("{:g}", settings.paper.confidence), [](const std::string& word) {
                    return read_real(word, "a number: give displacement thresholds, such as 2");
                });
    add_length(command, settings.paper, &PaperOptions::culling_distance, "--culling-distance",
               "predictive: the same in metres; auto: confidence x displacement threshold");
    add_length(command, settings.paper, &PaperOptions::distance_extension, "--distance-extension",
               "predictive: metres by which the bounds are widened whose vertices are looked at, at least the "
               "displacement threshold; auto: the culling distance");
    add_setting(command, settings.paper, &PaperOptions::max_iterations, "--max-iterations",
                "iterative, predictive: triangles a ray may visit when it is followed, 1 to 4096", "N",
                std::to_string(settings.paper.max_iterations), [](const std::string& word) {
                    const std::optional<std::uint32_t> number = read_number<std::uint32_t>(word);
                    if (!number) throw InputError("\"" + word + "\" is not a number of triangles: give 1 to 4096");
                    return *number;
                });
    command.add_flag("--walk-casts,!--no-walk-casts", settings.paper.cast_lost_walks,
                     "predictive: cast a ray in full (the default) or give it up where following it ends "
                     "nowhere");
    add_number(command, "--max-contacts-per-pair", settings.max_contacts_per_pair,
               "of each pair keep the contacts that stand for all, no more than this; 0: all", 0u, most);
    add_number(command, "--max-contacts", settings.max_contacts,
               "the same for a whole step; each pair keeps its deepest; 0: all", 0u, most);
    add_word(command, "--devices",
             "auto (the CPU or the first GPU, whichever is faster when both are tried), all (every GPU), or a list of "
             "devices as `raycontact devices` names them, which share the pairs; cpu/k and opencl:i/k are one core "
             "alone",
             "LIST", settings.execution.devices, [&](const std::string& word) {
                 Settings alone;
                 alone.execution.devices = word;
                 chosen_devices(alone); // refuses a faulty list
                 settings.execution.devices = word;
             });
    add_word(command, "--schedule",
             "with several devices: balanced (pairs move where one has too much to do), sticky (a pair stays where it "
             "came first), counted (balanced by counts alone, without a clock)",
             "WORD", std::string(to_string(settings.execution.schedule)),
             [&](const std::string& word) { settings.execution.schedule = schedule_from(word); });
    command.add_flag("--inexact", settings.execution.inexact,
                     "also use a device that rounds otherwise, whose contacts may differ from all others'");
    add_number(command, "--threads", settings.execution.threads,
               "threads of the host, 0: one per core; changes no result", 0u, 1024u);
}

void add_speculative_option(CLI::App& command, raycontact::Settings& settings) {
    add_word(command, "--speculative",
             "contacts before anything touches, so that bodies stop at surfaces: auto (a margin for each pair), a "
             "margin in metres, or off (docs/internals/speculative.md)",
             "auto|METRES|off", settings.is_speculative() ? "auto" : "off", [&](const std::string& word) {
                 raycontact::Settings alone;
                 alone.speculative = word != "off" ? raycontact::Speculative::on : raycontact::Speculative::off;
                 if (word != "off" && word != "auto")
                     alone.speculative_margin = read_real(word, "a margin: give metres, such as 0.01, auto or off");
                 check_common_options(alone);
                 settings.speculative = alone.speculative;
                 settings.speculative_margin = alone.speculative_margin;
             });
}

void check_common_options(const raycontact::Settings& settings) {
    try {
        raycontact::check_settings(settings);
    } catch (const InputError& error) {
        throw InputError(with_options(error.what()));
    }
}

void warn_if_coarse(const raycontact::Shape& shape, const raycontact::Settings& settings) {
    // In diagonals of the mesh's box: less than the sides of a box, more than a mesh of a few hundred triangles has.
    constexpr double longest_fine_edge = 0.25;
    if (settings.features != raycontact::Features::vertices) return;
    const raycontact::Vec3 low = shape.box_min(), high = shape.box_max();
    const double part = shape.longest_edge() / std::hypot(high.x - low.x, high.y - low.y, high.z - low.z);
    if (part <= longest_fine_edge) return;
    std::cerr << fmt::format("{}: coarse for --features vertices: an edge is {:.0f} % of its size long and can cross "
                             "another mesh unseen; --features edges sees it\n",
                             shape.name(), 100 * part);
}

raycontact::Settings recorded_unless_given(const CLI::App& command, const raycontact::Settings& given,
                                           const raycontact::Settings& recorded) {
    raycontact::Settings settings = given;
    const auto keep = [&](const char* option, auto member) {
        if (command.count(option) == 0) settings.*member = recorded.*member;
    };
    const auto keep_paper = [&](const char* option, auto member) {
        if (command.count(option) == 0) settings.paper.*member = recorded.paper.*member;
    };
    using raycontact::PaperOptions;
    using raycontact::Settings;
    keep("--method", &Settings::method);
    keep_paper("--caster", &PaperOptions::caster);
    keep("--direction", &Settings::direction);
    keep("--features", &Settings::features);
    keep_paper("--displacement-threshold", &PaperOptions::displacement_threshold);
    keep_paper("--confidence", &PaperOptions::confidence);
    keep_paper("--culling-distance", &PaperOptions::culling_distance);
    keep_paper("--distance-extension", &PaperOptions::distance_extension);
    keep_paper("--max-iterations", &PaperOptions::max_iterations);
    keep_paper("--walk-casts", &PaperOptions::cast_lost_walks);
    keep("--max-contacts-per-pair", &Settings::max_contacts_per_pair);
    keep("--max-contacts", &Settings::max_contacts);
    settings.paper.skip_outside = recorded.paper.skip_outside; // no option changes it
    check_common_options(settings);
    return settings;
}
