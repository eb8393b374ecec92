// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include "cli/common_options.h"
#include "cli/number_option.h"
#include "cli/out_option.h"
#include "cli/progress.h"

#include <output/out_file.h>
#include <raycontact/error.h>
#include <report/counted.h>
#include <view/clashes.h>
#include <view/motion.h>
#include <view/view.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

extern char** environ;

namespace {

using namespace raycontact;
using Json = nlohmann::ordered_json;

struct ViewCommand {
    std::string file, out;
    bool no_open = false, json = false;
    std::optional<std::uint32_t> layer_every, every;
    Settings settings;
};

// Layers of about so many steps, and about so many poses, keep the page at a size that a browser opens at once.
constexpr std::uint32_t layer_steps = 60, most_poses = 800'000;

bool has_screen() {
    return std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr;
}

/// Whether the desktop took the file.
bool open_in_browser(const std::string& file) {
    std::string program = "xdg-open", argument = std::filesystem::absolute(file).string();
    char* arguments[] = {program.data(), argument.data(), nullptr};
    pid_t child = 0;
    if (posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ) != 0) return false;
    int status = 0;
    return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// The page to write.
output::OutFile claim_page(const ViewCommand& given, const std::string& what) {
    const std::filesystem::path source(given.file);
    const std::string out =
        given.out.empty() ? std::filesystem::path(source).replace_extension(".html").string() : given.out;
    std::error_code ignored;
    if (std::filesystem::equivalent(out, source, ignored))
        throw InputError("--out: " + out + " is " + what + " itself; name another file");
    output::OutFile file(out);
    name_left_overs(file.left_overs());
    return file;
}

void keep_and_open(output::OutFile& file, const view::View& page, const ViewCommand& given, const Json& json,
                   const std::string& words) {
    const std::string out = file.name().string();
    file.write(page.html);
    file.keep();
    if (given.json)
        std::cout << json.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
    else
        std::cout << words << '\n';
    if (given.no_open || given.json) return;
    if (!has_screen() || !open_in_browser(out))
        std::cerr << "open " << out << " in a browser (no desktop was found to open it with)\n";
}

void view_recording(const CLI::App& command, const ViewCommand& given) {
    recording::Reader reader(given.file);
    output::OutFile file = claim_page(given, "the recording");
    const std::string out = file.name().string();

    view::ViewOptions options;
    options.settings = recorded_unless_given(command, given.settings, reader.info().settings);
    options.layer_every = given.layer_every.value_or((reader.steps() + layer_steps - 1) / layer_steps);
    const auto bodies = static_cast<std::uint32_t>(reader.bodies().size());
    options.stride = given.every.value_or(view::stride_for(bodies, reader.steps(), most_poses));
    Progress progress("view", view::work_of(reader, options));
    options.progress = [&](std::uint32_t done) { progress.show(done); };
    const view::View page = make_view(reader, options);
    progress.done();

    constexpr double mega = 1e6;
    keep_and_open(file, page, given,
                  {{"file", out},
                   {"bytes", page.html.size()},
                   {"motion_bytes", page.motion_bytes},
                   {"shape_bytes", page.shape_bytes},
                   {"layer_bytes", page.layer_bytes},
                   {"bodies", bodies},
                   {"standing", page.standing},
                   {"steps", reader.steps()},
                   {"every", options.stride},
                   {"layers_every", options.layer_every},
                   {"contacts", page.contacts},
                   {"predictions", page.predictions},
                   {"method", to_string(options.settings.method)}},
                  fmt::format("{}: {:.1f} MB (poses {:.1f}, shapes {:.1f}, layers {:.1f}); {}, {}", out,
                              double(page.html.size()) / mega, double(page.motion_bytes) / mega,
                              double(page.shape_bytes) / mega, double(page.layer_bytes) / mega,
                              report::counted(bodies - page.standing, "moving body", "moving bodies"),
                              report::counted(reader.steps(), "step", "steps")));
}

void view_clashes(const ViewCommand& given) {
    const view::ClashFile clashes = view::read_clash_file(given.file);
    output::OutFile file = claim_page(given, "the file to show");
    const std::string out = file.name().string(), name = std::filesystem::path(given.file).filename().string();
    const view::View page = make_clash_view(clashes, name, {});
    keep_and_open(file, page, given,
                  {{"file", out},
                   {"bytes", page.html.size()},
                   {"shape_bytes", page.shape_bytes},
                   {"bodies", clashes.parts.size()},
                   {"clashes", clashes.marks.size()}},
                  fmt::format("{}: {:.1f} MB; {}, {}", out, double(page.html.size()) / 1e6,
                              report::counted(clashes.parts.size(), "part", "parts"),
                              report::counted(clashes.marks.size(), "clash", "clashes")));
}

} // namespace

void add_view(CLI::App& app) {
    CLI::App* command =
        app.add_subcommand("view", "Make one HTML file with a 3D view of a recording or of clashes, and open it in "
                                   "the browser");
    auto given = std::make_shared<ViewCommand>();
    command
        ->add_option("RECORDING", given->file,
                     "a file made by `raycontact run --record`, a Recorder or `raycontact clash --out`")
        ->required();
    add_out(*command, "--out", given->out, "the page to write; default: beside the recording, with the ending .html")
        ->type_name("FILE");
    add_number(*command, "--layers-every", given->layer_every,
               "find contacts, rays, normals and predictions in every N-th step, 0: none; default: about "
                   + std::to_string(layer_steps) + " steps",
               0u, 1'000'000u);
    add_number(*command, "--every", given->every,
               "keep the poses of every N-th step; default: every step, fewer in long recordings of many bodies", 1u,
               1'000'000u);
    command->add_flag("--no-open", given->no_open, "only write the file");
    command->add_flag("--json", given->json, "print one JSON object on stdout; opens nothing");
    add_common_options(*command, given->settings);
    command->footer("The layers are found anew, with the recording's method unless --method is given; predictions "
                    "need --method predictive.\nIn the address, #step=120&layers=contacts,rays&clear names a moment, "
                    "#clash=2 a clash.\n"
                    "Exit status: 0 fine, 1 the run failed, 2 bad usage or input.");
    command->callback([command, given] {
        if (view::is_clash_file(given->file))
            view_clashes(*given);
        else
            view_recording(*command, *given);
    });
}
