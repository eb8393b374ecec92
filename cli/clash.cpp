// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include "cli/number_option.h"
#include "cli/out_option.h"
#include "cli/program.h"
#include "cli/progress.h"
#include "cli/stop.h"

#include <clash/coloured.h>
#include <clash/parts.h>
#include <clash/search.h>
#include <output/out_file.h>

#include <raycontact/error.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace raycontact;
using Json = nlohmann::ordered_json;

struct ClashOptions {
    std::vector<std::string> files;
    std::optional<double> ignore_touching; ///< metres
    std::uint32_t threads = 0;
    std::string out;
    bool json = false;
    bool check = false;
};

struct Result {
    std::vector<clash::Part> parts;
    std::size_t pairs = 0; ///< whose boxes touch
    std::vector<clash::Clash> clashes;
    std::size_t ignored = 0;

    std::size_t faults() const {
        return static_cast<std::size_t>(
            std::count_if(parts.begin(), parts.end(), [](const clash::Part& part) { return !part.fault.empty(); }));
    }
    std::vector<std::string> open() const {
        std::vector<std::string> names;
        for (const clash::Part& part : parts)
            if (part.shape && !part.shape->report().closed) names.push_back(part.name);
        return names;
    }
    std::size_t without_depth() const {
        return static_cast<std::size_t>(
            std::count_if(clashes.begin(), clashes.end(), [](const clash::Clash& c) { return !c.depth; }));
    }
};

/// One line a clash.
std::string json_lines(const Result& result) {
    std::string text;
    for (const clash::Clash& c : result.clashes) {
        Json line{{"a", result.parts[c.a].name},
                  {"b", result.parts[c.b].name},
                  {"depth", c.depth ? Json(*c.depth) : Json()},
                  {"point", {c.point.x, c.point.y, c.point.z}},
                  {"contacts", c.contacts},
                  {"duplicate", c.duplicate}};
        line["normal"] = c.contacts > 0 ? Json{c.normal.x, c.normal.y, c.normal.z} : Json();
        text += line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    }
    return text;
}

std::string table(const Result& result) {
    std::string text;
    for (const clash::Clash& c : result.clashes) {
        const std::string depth = !c.depth       ? "no depth"
                                  : *c.depth > 0 ? fmt::format("{} m", float(*c.depth))
                                                 : "touching";
        const clash::Part &a = result.parts[c.a], &b = result.parts[c.b];
        text += fmt::format("{:>12}  {}  x  {}  at {}, {}, {}{}\n", depth, a.name, b.name, c.point.x, c.point.y,
                            c.point.z, c.duplicate ? "  (the same part in the same place)" : "");
    }
    return text;
}

/// "a, b and 3 more".
std::string some_of(const std::vector<std::string>& names) {
    constexpr std::size_t most = 5;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), most); ++i) text += (i == 0 ? "" : ", ") + names[i];
    if (names.size() > most) text += fmt::format(" and {} more", names.size() - most);
    return text;
}

std::string summary(const Result& result) {
    std::string text = fmt::format("{} clash{} among {} parts ({} pair{} of touching boxes)", result.clashes.size(),
                                   result.clashes.size() == 1 ? "" : "es", result.parts.size(), result.pairs,
                                   result.pairs == 1 ? "" : "s");
    if (result.ignored > 0) text += fmt::format(", {} ignored as touching", result.ignored);
    if (result.without_depth() > 0)
        text += fmt::format("; {} without a depth, as one of the parts is no sound solid (see raycontact mesh)",
                            result.without_depth());
    if (const auto open = result.open(); !open.empty())
        text += fmt::format("; open, so that nothing is inside: {}", some_of(open));
    if (result.faults() > 0)
        text += fmt::format("; {} part{} not checked", result.faults(), result.faults() == 1 ? " was" : "s were");
    if (stop_signal() != 0) text += fmt::format("; cut short by {}", stop_name());
    return text + "\n";
}

Result search(const ClashOptions& options) {
    Result result;
    std::vector<std::string> left_out;
    result.parts = clash::load_parts({options.files.begin(), options.files.end()}, left_out);
    for (const std::string& line : left_out) std::cerr << line << '\n';
    if (result.parts.size() < 2)
        throw InputError(
            options.files[0]
            + ": is one part; give several files, or one that has parts: nodes, objects, groups or solids");
    const auto pairs = clash::touching_boxes(result.parts);
    result.pairs = pairs.size();
    listen_for_stop();
    const auto stop = [] { return stop_signal() != 0; };
    // Two tasks on one bar: shapes take most of the time.
    Progress progress("clash", 1000, "");
    const auto show = [&](double from, double to) {
        return [&progress, from, to](std::size_t done, std::size_t total) {
            progress.show(static_cast<std::uint32_t>(from + (to - from) * double(done) / double(total)));
        };
    };
    clash::make_shapes(result.parts, pairs, options.threads, show(0, 700), stop);
    for (const clash::Part& part : result.parts)
        if (!part.fault.empty()) std::cerr << fmt::format("not checked: {}: {}\n", part.name, part.fault);
    clash::SearchOptions how;
    how.threads = options.threads;
    how.progress = show(700, 1000);
    how.stop = stop;
    result.clashes = clash::find_clashes(result.parts, pairs, how);
    progress.done();
    if (options.ignore_touching)
        result.ignored = std::erase_if(result.clashes, [&](const clash::Clash& c) {
            // Depths are float32: a tenth is a little more.
            return c.depth && *c.depth <= *options.ignore_touching * (1 + 1e-6);
        });
    return result;
}

void check_out(const ClashOptions& options) {
    if (!options.out.ends_with(".glb")) throw InputError("--out " + options.out + ": give a name that ends in .glb");
    std::error_code none;
    for (const std::string& file : options.files)
        if (std::filesystem::equivalent(file, options.out, none))
            throw InputError("--out " + options.out + ": is one of the files to read; give another name");
}

void run_clash(const ClashOptions& options) {
    std::optional<output::OutFile> out;
    if (!options.out.empty()) {
        check_out(options);
        out.emplace(options.out);
    }
    const Result result = search(options);
    if (options.json) {
        std::cout << json_lines(result) << std::flush;
        std::cerr << summary(result);
    } else {
        std::cout << table(result) << summary(result) << std::flush;
    }
    if (out) {
        out->write(clash::coloured_glb(result.parts, result.clashes));
        out->keep(stop_signal() != 0);
    }
    if (!options.check || stop_signal() != 0) return;
    if (!result.clashes.empty()) throw EndWith{found};
    if (result.faults() > 0) throw std::runtime_error("--check: not all parts could be checked");
}

} // namespace

void add_clash(CLI::App& app) {
    CLI::App* command = app.add_subcommand("clash", "Find the parts of an assembly that intersect");
    auto options = std::make_shared<ClashOptions>();
    command
        ->add_option("FILES", options->files,
                     "mesh files; parts are nodes of glTF, objects or groups of OBJ, solids of a text STL")
        ->required();
    add_number(*command, "--ignore-touching", options->ignore_touching,
               "leave out clashes no deeper than this, metres; 0: those that only touch. Those without a depth stay",
               0.0, 1e9);
    add_number(*command, "--threads", options->threads, "0: one for each core", 0u, 1024u);
    add_out(*command, "--out", options->out, "write all parts there as .glb, those that clash in red")
        ->type_name("FILE.glb");
    command->add_flag("--json", options->json, "print one JSON line a clash on stdout");
    command->add_flag("--check", options->check, "exit status 3 where parts clash");
    command->footer(
        "A clash has the depth of its deepest contact and that contact's point, which is in both parts. Parts touch\n"
        "if they share a point and nothing more. Where one of the parts is open, intersects itself or winds the wrong\n"
        "way somewhere, there may be no depth; these come after those with one. Parts stay where their files place "
        "them.\n"
        "Exit status: 0 fine, 1 the run failed, 2 bad usage or input, 3 clashes found (--check).");
    command->callback([options] { run_clash(*options); });
}
