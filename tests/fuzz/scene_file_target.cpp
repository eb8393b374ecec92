// SPDX-License-Identifier: Apache-2.0
// A scene file, as `raycontact run FILE.json` reads it; where it is small its first steps are run, too.
#include "cli/scene_file.h"
#include "fuzz/input.h"
#include "temporary_folder.h"
#include "tests/unit/mesh/formats.h"
#include "tests/unit/mesh/solids.h"

#include <scenes/simulation.h>

#include <nlohmann/json.hpp>

using namespace raycontact;

namespace {

/// Whether it asks for more than a fuzzer has time for: models and sources may be as large as the memory allows.
bool is_large(const nlohmann::json& value, const std::string& key = {}) {
    if (value.is_structured()) {
        for (const auto& item : value.items())
            if (is_large(item.value(), value.is_object() ? item.key() : key)) return true;
        return false;
    }
    if (key == "model" && value == "bunny") return true; // reduced anew each time
    return (key == "triangles" || key == "bodies" || key == "iterations") && value.is_number()
           && value.get<double>() > 200;
}

} // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const TemporaryFolder folder;
    static const auto mesh = folder.write("m.obj", test::as_obj(test::torus(6, 4, 1, 0.3)));
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    // A parser that knows no depth would end in the stack's overflow, and none of ours.
    if (std::count(text.begin(), text.end(), '[') + std::count(text.begin(), text.end(), '{') < 1000
        && is_large(nlohmann::json::parse(text, nullptr, false)))
        return 0;
    const auto file = folder.write("scene.json", text);
    fuzz::taken([&] {
        SceneFileOptions options;
        options.steps = 3;
        options.settings.execution.threads = 1;
        options.settings.execution.devices = "cpu";
        options.settings.features = size % 2 == 0 ? Features::vertices : Features::edges;
        scenes::SceneDescription scene = read_scene_file(file, options);
        if (scene.bodies.size() > 24) return;
        scenes::Simulation simulation(std::move(scene));
        for (int i = 0; i < 3; ++i) simulation.step();
    });
    return 0;
}
