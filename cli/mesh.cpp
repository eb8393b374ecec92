// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include "cli/cavities_option.h"
#include "cli/out_option.h"
#include "cli/program.h"
#include "cli/stop.h"
#include "cli/weld_option.h"

#include <raycontact/error.h>
#include <raycontact/mesh.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace raycontact;

struct MeshOptions {
    std::vector<std::string> files;
    bool json = false;
    bool as_is = false;
    bool strict = false;
    bool close = false;
    std::string write; ///< a file, or nothing
    std::optional<Nesting> nested;
    std::optional<double> weld; ///< metres
};

using Json = nlohmann::ordered_json;

/// A name may be of any bytes.
void print_json(const Json& line) {
    std::cout << line.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
}

/// Its own keys come after the file's name.
void print_json(const std::string& file, const MeshReport& report, const Verdict& verdict, std::optional<double> weld) {
    Json line{{"file", file}};
    line.update(Json::parse(to_json(report)));
    line["good"] = verdict.good;
    line["verdict"] = verdict.text;
    line["weld"] = weld ? Json(*weld) : Json();
    print_json(line);
}

std::string on_one_line(std::string text) {
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return text;
}

/// Most errors name the file first.
std::string without_name(const std::string& error, const std::string& name) {
    return error.starts_with(name + ": ") ? error.substr(name.size() + 2) : error;
}

/// Vertices and triangles, in the order of PreparedMesh; coordinates read back to the same bits.
std::string obj_of(const PreparedMesh& mesh) {
    std::string text;
    for (const auto& [x, y, z] : mesh.vertices) text += fmt::format("v {} {} {}\n", x, y, z);
    for (const auto& [a, b, c] : mesh.triangles) text += fmt::format("f {} {} {}\n", a + 1, b + 1, c + 1);
    return text;
}

/// All files are looked at, whatever is wrong with one. What is wrong is said one line each, the last of them by the
/// error that is thrown.
void check_meshes(const MeshOptions& options) {
    const bool several = options.files.size() > 1;
    if (several && !options.write.empty()) throw InputError("--write: give one mesh file, not several");
    std::optional<output::OutFile> out = claim(options.files, "--write", options.write, ".obj");
    std::string verdicts;
    std::vector<std::string> complaints;
    std::size_t bad = 0;
    std::string first_bad;
    for (const std::string& file : options.files) {
        const std::string shown = on_one_line(file);
        const auto add_verdict = [&](const std::string& text) {
            verdicts.append(shown).append(": ").append(text).append("\n");
        };
        try {
            Mesh mesh = load_mesh(file);
            if (options.weld) mesh = weld_mesh(std::move(mesh), *options.weld);
            const PreparedMesh prepared =
                prepare_mesh(mesh, {.repair = options.as_is ? Repair::as_is : Repair::allowed,
                                    .nesting = options.nested.value_or(Nesting::as_wound),
                                    .holes = options.close ? Holes::of_all : Holes::of_solids});
            if (out) {
                out->write(obj_of(prepared));
                out->keep(stop_signal() != 0);
            }
            const MeshReport& report = prepared.report;
            Verdict verdict = verdict_of(report);
            const std::optional<double> closing = closing_weld(prepared);
            if (closing)
                verdict.text += fmt::format("; its corners differ in their last digits: --weld {} closes it", *closing);
            if (options.json)
                print_json(file, report, verdict, closing);
            else
                std::cout << (several ? shown + "\n" : "") << to_text(report) << (several ? "\n" : "");
            add_verdict(verdict.text);
            if (verdict.good) continue;
            ++bad;
            if (first_bad.empty()) first_bad = shown;
        } catch (const InputError& error) {
            if (!several) throw;
            complaints.emplace_back(error.what());
            const std::string verdict = "refused: " + without_name(complaints.back(), shown);
            if (options.json) print_json({{"file", file}, {"good", false}, {"verdict", verdict}});
            add_verdict(verdict);
        }
    }
    if (!options.json) std::cout << verdicts;
    if (options.strict && bad > 0) {
        const std::string others = bad > 1 ? " and " + std::to_string(bad - 1) + " more" : "";
        complaints.push_back("--strict: not good for contacts: " + first_bad + others);
    }
    if (complaints.empty()) return;
    std::cout.flush();
    for (std::size_t i = 0; i + 1 < complaints.size(); ++i) complain("raycontact", complaints[i]);
    throw InputError(complaints.back());
}

} // namespace

void add_mesh(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("mesh", RAYCONTACT_READS_3MF ? "Check mesh files: OBJ, STL, PLY, OFF, glTF, GLB or 3MF"
                                                        : "Check mesh files: OBJ, STL, PLY, OFF, glTF or GLB");
    auto options = std::make_shared<MeshOptions>();
    command->add_option("FILE", options->files, "the mesh files; the last lines say what each is good for")->required();
    command->add_flag("--json", options->json, "print one JSON object a file and line on stdout");
    CLI::Option* as_is =
        command->add_flag("--as-is", options->as_is, "report the mesh as the file gives it, repair nothing");
    add_cavities_option(*command, options->nested)->excludes(as_is);
    add_weld_option(*command, options->weld)->excludes(as_is);
    command
        ->add_flag("--close", options->close,
                   "span holes of sheets, too, that are flat or smaller than a tenth of the diagonal; those of solids "
                   "are always spanned")
        ->excludes(as_is);
    add_out(*command, "--write", options->write,
            "write the mesh as its repairs leave it there; triangles that span holes come last")
        ->type_name("FILE.obj");
    command->add_flag("--strict", options->strict, "exit status 2 if a mesh is not good for contacts");
    command->callback([options] { check_meshes(*options); });
}
