// SPDX-License-Identifier: Apache-2.0
// A command line, a word a line: every option of every subcommand is read as the program reads it, but nothing is run.
#include "cli/commands.h"
#include "cli/common_options.h"
#include "cli/run_scene.h"
#include "fuzz/input.h"

#include <raycontact/scene.h>

#include <algorithm>
#include <vector>

using namespace raycontact;

namespace {

struct Whole {};

/// Ends where the program would begin its work.
class Reader : public CLI::App {
public:
    using CLI::App::App;

private:
    void pre_callback() override { throw Whole(); }
};

void read(CLI::App& app, std::vector<std::string> words) {
    std::reverse(words.begin(), words.end()); // CLI11 takes them from the back
    try {
        app.parse(std::move(words));
    } catch (const CLI::ParseError&) { // the program prints it and ends with status 2
    } catch (const Whole&) {
    }
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::vector<std::string> words(1);
    for (const std::uint8_t c : fuzz::Bytes(data, size)) {
        if (c == '\n')
            words.emplace_back();
        else if (c != 0 && c != '\r') // 0 ends a word of a real command line; complain() makes a space of a return
            words.back() += static_cast<char>(c);
    }
    if (words.back().empty()) words.pop_back();
    if (words.size() > 40) return 0;
    // Whatever opens drivers is no affair of the options.
    for (const std::string& word : words)
        if (word.find("opencl") != std::string::npos || word.find("cuda") != std::string::npos) return 0;

    fuzz::taken([&] {
        Reader app("", "raycontact");
        app.set_version_flag("--version", "0");
        app.require_subcommand(0, 1);
        add_commands(app);
        read(app, words);
    });
    // And what follows: settings that fit together make a scene.
    fuzz::taken([&] {
        Reader app("", "raycontact");
        Settings settings;
        RunScene scene;
        add_scene_options(app, scene);
        add_common_options(app, settings);
        if (!words.empty()) read(app, {words.begin() + 1, words.end()});
        check_common_options(settings);
        settings.execution.threads = std::min(settings.execution.threads, 2u);
        if (settings.execution.devices == "auto") settings.execution.devices = "cpu";
        const Scene made(settings);
    });
    return 0;
}
