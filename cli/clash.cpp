// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include "cli/clash_clearance.h"
#include "cli/clash_path.h"
#include "cli/clash_tree.h"
#include "cli/length_unit.h"
#include "cli/number_option.h"
#include "cli/out_option.h"
#include "cli/program.h"
#include "cli/progress.h"
#include "cli/separation.h"
#include "cli/stop.h"
#include "cli/weld_option.h"

#include <clash/bcf.h>
#include <clash/coloured.h>
#include <clash/csv.h>
#include <output/out_file.h>

#include <raycontact/clash.h>
#include <raycontact/error.h>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace raycontact;
using Json = nlohmann::ordered_json;

/// Lengths are in the unit of the files.
struct Options {
    std::vector<std::string> files, against, exclude, clearance;
    double tolerance = 0;
    std::optional<double> ignore_touching, weld;
    std::string unit; ///< empty: not told
    bool components = false, volume = false, separation = false;
    std::uint32_t threads = 0;
    std::string out, csv, bcf, along, range;
    std::string group; ///< part, assembly or a level; empty: none
    bool json = false, check = false, tree = false;

    bool moves() const { return !along.empty() || !range.empty(); }

    LengthUnit length_unit() const { return unit.empty() ? length_units[0] : *raycontact::length_unit(unit); }
};

bool ends_in_3mf(const std::string& file) {
    std::string ending = std::filesystem::path(file).extension().string();
    std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return std::tolower(c); });
    return ending == ".3mf";
}

struct Result {
    std::vector<AssemblyPart> parts;
    ClashReport report;
    ClashPath path;                   ///< --along or --range
    PathClashReport on_path{};        ///< likewise
    std::vector<ClashGroup> groups{}; ///< --group
    std::size_t ignored = 0;

    std::vector<std::string> open() const {
        std::vector<std::string> names;
        for (const std::size_t part : report.open) names.push_back(parts[part].name);
        return names;
    }
    std::size_t without_depth() const {
        return static_cast<std::size_t>(std::ranges::count_if(report.clashes, [](const Clash& c) { return !c.depth; }));
    }
};

Json three(const Vec3& v) {
    return {v.x, v.y, v.z};
}

Json json_of(const Clash& c, const Result& result, const Options& options) {
    Json line{{"a", result.parts[c.a].name},
              {"b", result.parts[c.b].name},
              {"path_a", path_of(result.parts[c.a])},
              {"path_b", path_of(result.parts[c.b])},
              {"depth", c.depth ? Json(*c.depth) : Json()},
              {"point", three(c.point)},
              {"contacts", c.contacts},
              {"duplicate", c.kind == ClashKind::duplicate}};
    line["normal"] = c.normal != Vec3{} ? three(c.normal) : Json();
    line["kind"] = to_string(c.kind);
    line["distance"] = c.distance;
    line["point_a"] = three(c.point_a);
    line["point_b"] = three(c.point_b);
    line["open"] = Json::array();
    if (c.open_a) line["open"].push_back("a");
    if (c.open_b) line["open"].push_back("b");
    line["box"] = c.box ? Json{three(c.box->low), three(c.box->high)} : Json();
    if (options.separation) line["separation"] = c.separation ? separation_json(*c.separation) : Json();
    if (options.volume) line["volume"] = c.volume ? Json(*c.volume) : Json();
    if (!options.unit.empty()) line["unit"] = options.unit;
    return line;
}

Json json_of(const ClashGroup& group, const Result& result, const Options& options) {
    Json line{{"a", group.a},
              {"b", group.b.empty() ? Json() : Json(group.b)},
              {"count", group.clashes.size()},
              {"box", {three(group.box.low), three(group.box.high)}},
              {"clashes", Json::array()}};
    for (const std::size_t i : group.clashes)
        line["clashes"].push_back(json_of(result.report.clashes[i], result, options));
    return line;
}

/// One line a clash, or a group.
std::string json_lines(const Result& result, const Options& options) {
    std::string text;
    const auto add = [&](const Json& line) {
        text += line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    };
    if (options.group.empty())
        for (const Clash& c : result.report.clashes) add(json_of(c, result, options));
    else
        for (const ClashGroup& group : result.groups) add(json_of(group, result, options));
    return text;
}

std::string note_of(const Clash& c, const char* unit) {
    std::string note = c.kind == ClashKind::duplicate  ? "the same part in the same place"
                       : c.kind == ClashKind::inside   ? "one inside the other"
                       : c.kind == ClashKind::piercing ? "one through the other"
                                                       : "";
    if (c.open_a || c.open_b) {
        note += note.empty() ? "" : ", ";
        note += c.open_a && c.open_b ? "both are open" : c.open_a ? "the first is open" : "the second is open";
    }
    if (c.separation) note += (note.empty() ? "" : ", ") + separation_words(*c.separation, unit);
    return note.empty() ? note : "  (" + note + ")";
}

std::string depth_of(const Clash& c, const char* unit) {
    return c.kind == ClashKind::nearby ? fmt::format("{} {} apart", c.distance, unit)
           : !c.depth                  ? "no depth"
           : *c.depth > 0              ? fmt::format("{} {}", float(*c.depth), unit)
                                       : "touching";
}

std::string group_table(const Result& result, const char* unit) {
    std::string text;
    for (const ClashGroup& group : result.groups) {
        const std::size_t count = group.clashes.size();
        const std::string names = group.b.empty()      ? group.a + "  x  " + std::to_string(count) + " others"
                                  : group.a == group.b ? "within " + group.a
                                                       : group.a + "  x  " + group.b;
        const AxisBox& box = group.box;
        text +=
            fmt::format("{:>12}  {}  {} clash{}, in {}, {}, {} to {}, {}, {}\n",
                        depth_of(result.report.clashes[group.clashes[0]], unit), names, count, count == 1 ? "" : "es",
                        box.low.x, box.low.y, box.low.z, box.high.x, box.high.y, box.high.z);
    }
    return text;
}

std::string table(const Result& result, const char* unit) {
    std::string text;
    for (const Clash& c : result.report.clashes)
        text += fmt::format("{:>12}  {}  x  {}  at {}, {}, {}{}\n", depth_of(c, unit), path_of(result.parts[c.a]),
                            path_of(result.parts[c.b]), c.point.x, c.point.y, c.point.z, note_of(c, unit));
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
    const std::size_t clashes = result.report.clashes.size(), pairs = result.report.pairs;
    const std::size_t faults = result.report.faults.size();
    std::string text = fmt::format("{} clash{} among {} parts ({} pair{} of touching boxes)", clashes,
                                   clashes == 1 ? "" : "es", result.parts.size(), pairs, pairs == 1 ? "" : "s");
    if (!result.groups.empty())
        text += fmt::format(" in {} group{}", result.groups.size(), result.groups.size() == 1 ? "" : "s");
    if (result.ignored > 0) text += fmt::format(", {} ignored as touching", result.ignored);
    if (result.without_depth() > 0)
        text += fmt::format("; {} without a depth, as one of the parts is no sound solid (see raycontact mesh)",
                            result.without_depth());
    if (const auto open = result.open(); !open.empty())
        text += fmt::format("; open, so that nothing is inside: {}", some_of(open));
    if (faults > 0) text += fmt::format("; {} part{} not checked", faults, faults == 1 ? " was" : "s were");
    if (stop_signal() != 0) text += fmt::format("; cut short by {}", stop_name());
    return text + "\n";
}

/// Two names of a line, each as CSV has it: in quotes where it has a comma.
std::array<std::string, 2> two_names(const std::string& line, const std::string& where) {
    std::vector<std::string> names(1);
    bool in_quotes = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (c == '"' && in_quotes && i + 1 < line.size() && line[i + 1] == '"')
            names.back() += line[i++];
        else if (c == '"')
            in_quotes = !in_quotes;
        else if (c == ',' && !in_quotes)
            names.emplace_back();
        else
            names.back() += c;
    }
    if (in_quotes || names.size() != 2 || names[0].empty() || names[1].empty())
        throw InputError(where + ": is not two names with a comma between; put names with a comma in quotes");
    return {names[0], names[1]};
}

void read_excluded(const std::string& file, ClashOptions& how) {
    std::ifstream lines(file);
    if (!lines)
        throw InputError("--exclude " + file + ": cannot be read; give a file of pairs of names, or parent-child");
    std::string line;
    for (std::size_t number = 1; std::getline(lines, line); ++number) {
        if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3); // as spreadsheets write it
        if (line.ends_with('\r')) line.pop_back();
        if (line.empty() || line.starts_with('#')) continue;
        how.exclude.push_back(two_names(line, fmt::format("{}:{}", file, number)));
    }
    if (lines.bad() || !lines.eof()) throw InputError("--exclude " + file + ": cannot be read");
}

/// Brings parts of 3MF, which says its unit and is read in metres, to the unit of the others, and welds.
void prepare_parts(std::vector<AssemblyPart>& parts, const Options& options) {
    const double metres = options.length_unit().metres;
    std::map<std::shared_ptr<const Mesh>, std::shared_ptr<const Mesh>> made;
    for (AssemblyPart& part : parts) {
        const double scale = ends_in_3mf(part.file) ? 1 / metres : 1;
        if (scale == 1 && !options.weld) continue;
        auto& own = made[part.mesh];
        if (!own) {
            Mesh mesh = *part.mesh;
            for (Vec3& v : mesh.vertices) v = {scale * v.x, scale * v.y, scale * v.z};
            own = std::make_shared<const Mesh>(options.weld ? weld_mesh(mesh, *options.weld) : std::move(mesh));
        }
        part.mesh = own;
        Vec3& at = part.pose.translation;
        at = {scale * at.x, scale * at.y, scale * at.z};
    }
}

std::vector<AssemblyPart> load(const Options& options) {
    std::vector<std::string> left_out;
    std::vector<AssemblyPart> parts = load_parts({options.files.begin(), options.files.end()}, &left_out);
    if (options.weld || options.length_unit().metres != 1) prepare_parts(parts, options);
    if (options.components) parts = split_components(parts, &left_out);
    for (const std::string& line : left_out) std::cerr << line << '\n';
    return parts;
}

Result search(const Options& options) {
    ClashOptions how;
    how.against = options.against;
    for (const std::string& excluded : options.exclude) {
        if (excluded == "parent-child")
            how.exclude_parent_child = true;
        else
            read_excluded(excluded, how);
    }
    set_clearances(options.clearance, options.unit, how);
    how.tolerance = options.tolerance;
    how.volumes = options.volume;
    how.separations = options.separation;
    how.threads = options.threads;
    Result result;
    result.parts = load(options);
    if (result.parts.size() < 2)
        throw InputError(options.files[0]
                         + (options.components ? ": --components finds one part; give several files"
                                               : ": is one part; give several files, or one that has parts: nodes, "
                                                 "objects, groups or solids; --components splits parts further"));
    listen_for_stop();
    how.stop = [] { return stop_signal() != 0; };
    Progress progress("clash", 1000, "");
    how.progress = [&progress](double done) { progress.show(static_cast<std::uint32_t>(1000 * done)); };
    if (options.moves()) {
        result.path = options.range.empty() ? clash_path_along(options.along, result.parts)
                                            : clash_path_of_range(options.range, options.length_unit().name);
        result.on_path = find_path_clashes(result.parts, result.path.moving, result.path.moves, how);
    } else {
        result.report = find_clashes(result.parts, how);
    }
    progress.done();
    for (const auto& [part, fault] : options.moves() ? result.on_path.faults : result.report.faults)
        std::cerr << fmt::format("not checked: {}: {}\n", result.parts[part].name, fault);
    if (options.ignore_touching)
        result.ignored = std::erase_if(result.report.clashes, [&](const Clash& c) {
            // Depths are float32: a tenth is a little more.
            return c.kind != ClashKind::nearby && c.depth && *c.depth <= *options.ignore_touching * (1 + 1e-6);
        });
    if (!options.group.empty())
        result.groups = options.group == "part"
                            ? group_by_part(result.parts, result.report.clashes)
                            : group_by_assembly(result.parts, result.report.clashes,
                                                read_number<std::uint32_t>(options.group).value_or(0));
    return result;
}

void write(std::optional<output::OutFile>& file, const std::string& bytes) {
    file->write(bytes);
    file->keep(stop_signal() != 0);
}

void run_path(const Options& options) {
    for (const auto& [given, name] : {std::pair{!options.against.empty(), "--against"},
                                      {options.tolerance > 0, "--tolerance"},
                                      {options.ignore_touching.has_value(), "--ignore-touching"},
                                      {options.volume, "--volume"},
                                      {options.separation, "--separation"},
                                      {!options.group.empty(), "--group"},
                                      {!options.out.empty(), "--out"},
                                      {!options.csv.empty(), "--csv"},
                                      {!options.bcf.empty(), "--bcf"}})
        if (given) throw InputError(std::string(name) + " says nothing of parts that move; leave it out");
    const Result result = search(options);
    const std::string unit = options.length_unit().name;
    std::string summary = path_summary(result.on_path, result.parts, result.path, unit);
    if (stop_signal() != 0) summary += fmt::format("cut short by {}\n", stop_name());
    if (options.json) {
        std::cout << path_json(result.on_path, result.parts, result.path) << std::flush;
        std::cerr << summary;
    } else {
        std::cout << path_table(result.on_path, result.parts, result.path, unit) << summary << std::flush;
    }
    if (!options.check || stop_signal() != 0) return;
    if (!result.on_path.clashes.empty()) throw EndWith{found};
    if (!result.on_path.faults.empty()) throw std::runtime_error("--check: not all parts could be checked");
}

void run_clash(const Options& options) {
    if (options.tree) {
        const std::vector<AssemblyPart> parts = load(options);
        std::cout << (options.json ? tree_json(parts) : tree_text(parts)) << std::flush;
        return;
    }
    if (options.moves()) return run_path(options);
    if (!options.bcf.empty() && options.unit.empty())
        throw InputError("--bcf: has metres, and nothing says which unit the files have; give --unit m, mm, cm or in");
    auto out = claim(options.files, "--out", options.out, ".glb");
    auto csv = claim(options.files, "--csv", options.csv, ".csv");
    auto bcf = claim(options.files, "--bcf", options.bcf, ".bcfzip");
    const Result result = search(options);
    const LengthUnit unit = options.length_unit();
    if (options.json) {
        std::cout << json_lines(result, options) << std::flush;
        std::cerr << summary(result);
    } else {
        std::cout << (options.group.empty() ? table(result, unit.name) : group_table(result, unit.name))
                  << summary(result) << std::flush;
    }
    const std::vector<Clash>& clashes = result.report.clashes;
    if (out) write(out, clash::coloured_glb(result.parts, clashes));
    if (csv) write(csv, clash::csv(result.parts, clashes, options.unit, result.groups));
    if (bcf) {
        const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
        write(bcf, clash::bcf_zip(result.parts, clashes,
                                  {unit.metres, unit.name, fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now)),
                                   result.groups}));
    }
    if (!options.check || stop_signal() != 0) return;
    if (!clashes.empty()) throw EndWith{found};
    if (!result.report.faults.empty()) throw std::runtime_error("--check: not all parts could be checked");
}

} // namespace

void add_clash(CLI::App& app) {
    CLI::App* command = app.add_subcommand("clash", "Find the parts of an assembly that intersect, or are too near");
    auto options = std::make_shared<Options>();
    constexpr double most = 1e9;
    const auto with_3mf = [](const char* words) { return RAYCONTACT_READS_3MF ? words : ""; };
    command
        ->add_option("FILES", options->files,
                     fmt::format("mesh files; parts are nodes of glTF,{} objects or groups of OBJ, solids of STL",
                                 with_3mf(" objects that a 3MF places,")))
        ->required();
    // One word each, so that FILES may follow.
    command
        ->add_option("--against", options->against,
                     "test parts or files of this name (* and ? stand for any; with / what ends a path) against "
                     "all others, and no more; may be given again")
        ->type_name("SET")
        ->expected(1)
        ->take_all();
    command
        ->add_option("--exclude", options->exclude,
                     "leave out pairs: a file with two names or patterns a line, a comma "
                     "between; or parent-child, of the nodes of glTF; may be given again")
        ->type_name("PAIRS")
        ->expected(1)
        ->take_all();
    auto* along = command
                      ->add_option("--along", options->along,
                                   "move parts from pose to pose of this JSON file, and tell what they meet, when "
                                   "first, and how near they come to what they do not meet")
                      ->type_name("FILE");
    command
        ->add_option("--range", options->range,
                     "the same of a joint: NAME=turn:AXIS:POINT:FROM:TO with degrees, or NAME=slide:WAY:FROM:TO; each "
                     "of AXIS, POINT and WAY as x,y,z")
        ->type_name("JOINT")
        ->excludes(along);
    const auto add_length = [&](const char* option, auto& length, const char* help) {
        add_number(*command, option, length, help, 0.0, most)->type_name("LENGTH");
    };
    command
        ->add_option("--clearance", options->clearance,
                     "also find parts that are no farther apart than this; LENGTH:SET: those of which one is of this "
                     "name or pattern, LENGTH:SET:SET: and the other of that; may be given again: the largest counts")
        ->type_name("LENGTH")
        ->expected(1)
        ->take_all();
    add_length("--tolerance", options->tolerance, "depths and gaps up to this are touching");
    add_length("--ignore-touching", options->ignore_touching,
               "leave out clashes no deeper than this; 0: those that only touch. Those without a depth stay");
    command
        ->add_option("--unit", options->unit,
                     fmt::format("of the files, and so of all lengths: m, mm, cm or in{}",
                                 with_3mf("; 3MF says its own and is brought to this one")))
        ->type_name("UNIT")
        ->check([](const std::string& word) {
            if (length_unit(word)) return std::string();
            return "\"" + word + "\" is no unit; give m, mm, cm or in";
        });
    add_weld_option(*command, options->weld)->type_name("LENGTH");
    command->add_flag("--components", options->components,
                      "split parts into their connected components, each solid with its cavities");
    command->add_flag("--volume", options->volume, "also find the volume that two parts share (slow)");
    command->add_flag("--separation", options->separation,
                      "also find the translation that parts two parts (slow: seconds for large ones)");
    add_number(*command, "--threads", options->threads, "0: one for each core", 0u, 1024u);
    add_out(*command, "--out", options->out, "write all parts there as .glb, those that clash in red")
        ->type_name("FILE.glb");
    add_out(*command, "--csv", options->csv, "write the clashes there as a table")->type_name("FILE.csv");
    add_out(*command, "--bcf", options->bcf,
            "write the clashes there as topics of BIM Collaboration Format 2.1; needs --unit")
        ->type_name("FILE.bcfzip");
    command
        ->add_option("--group", options->group,
                     "print groups of clashes: part: those of one part; assembly: those of what is under one node "
                     "with what is under another; a number: the same of nodes that many below the root")
        ->type_name("part|assembly|N")
        ->check([](const std::string& word) {
            const auto level = read_number<std::uint32_t>(word);
            return word == "part" || word == "assembly" || (level && *level > 0)
                       ? std::string()
                       : "\"" + word + "\" is no group; give part, assembly or a number from 1 on";
        });
    auto* const tree = command->add_flag("--tree", options->tree,
                                         "print the parts and the nodes that they are under, and search nothing");
    command->add_flag("--json", options->json, "print one JSON line a clash on stdout");
    command->add_flag("--check", options->check, "exit status 3 where parts clash");
    for (const char* other :
         {"--against", "--exclude", "--along", "--range", "--clearance", "--tolerance", "--ignore-touching", "--volume",
          "--separation", "--group", "--out", "--csv", "--bcf", "--check"})
        tree->excludes(command->get_option(other));
    command->footer(
        "A clash has the depth of its deepest contact and that contact's point, which is in both parts. Parts touch\n"
        "if they share a point and nothing more. Where one of the parts is open, intersects itself or winds the wrong\n"
        "way somewhere, there may be no depth; these come after those with one. Parts stay where their files place "
        "them.\n"
        "Exit status: 0 fine, 1 the run failed, 2 bad usage or input, 3 clashes found (--check).");
    command->callback([options] { run_clash(*options); });
}
