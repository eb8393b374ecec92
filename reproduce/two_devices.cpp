// SPDX-License-Identifier: Apache-2.0
#include <reproduce/experiments.h>
#include <reproduce/series.h>

#include <raycontact/device.h>

#include <fmt/format.h>

#include <algorithm>
#include <thread>

namespace raycontact::reproduce {

namespace {

struct Choice {
    std::vector<std::string> ids; ///< one or two
    bool gpus = false;
    std::string named;
};

/// Two GPUs, else two cores, else one core.
Choice devices() {
    Choice gpus;
    for (const DeviceInfo& device : list_devices())
        if (device.usable && device.type == "gpu" && gpus.ids.size() < 2) {
            gpus.ids.push_back(device.id);
            gpus.named += (gpus.named.empty() ? "" : " and ") + device.name;
        }
    gpus.gpus = true;
    if (gpus.ids.size() == 2) return gpus;
    if (std::thread::hardware_concurrency() > 1) return {{"cpu/0", "cpu/1"}, false, "two cores of the CPU"};
    return {{"cpu"}, false, "the CPU's only core"};
}

Settings on(const Plan& plan, const Choice& choice, std::size_t count) {
    Settings settings = as_in_the_paper(Method::iterative, plan.constants);
    settings.execution.schedule = Schedule::sticky; // section 4
    settings.execution.devices = choice.ids[0];
    if (count > 1) settings.execution.devices += "," + choice.ids[1];
    if (!choice.gpus) settings.execution.threads = static_cast<std::uint32_t>(count);
    return settings;
}

Json measure(const Workshop& shop, const std::string& scene, const Tick& tick) {
    const Choice choice = devices();
    const auto file = shop.recording(shop.base(scene));
    std::vector<Follow> follow;
    for (std::size_t count = 1; count <= choice.ids.size(); ++count)
        follow.push_back({file, on(shop.plan(), choice, count)});
    Json result{{"ms", Json::array({Json::array(), Json::array()})}, {"named", choice.named}, {"gpus", choice.gpus}};
    result["devices"] = choice.ids.size();
    side_by_side(follow, [&](std::uint32_t, std::span<Scene* const> scenes) {
        for (std::size_t k = 0; k < scenes.size(); ++k) result["ms"][k].push_back(scenes[k]->stats().narrow_ms);
        tick(1.0 / shop.plan().size(scene).steps);
    });
    return result;
}

Outcome show(const std::string& scene, const Json& found) {
    Outcome out;
    const bool rain = scene == "rain", two = found["devices"].get<int>() == 2;
    const std::string id = "devices.two." + scene, named = found["named"].get<std::string>();
    const double paper = rain ? 1.66 : 1.77;
    const auto one_ms = found["ms"][0].get<Series>(), two_ms = found["ms"][two ? 1 : 0].get<Series>();
    const double ratio = sum(one_ms) / std::max(sum(two_ms), 1e-9);
    const std::string why = "time of iterative along the " + scene + ", all steps, on " + named
                            + "; each pair stays where it came first (section 4). The paper: two GTX 580";
    out.numbers.push_back(two ? compared(id, paper, ratio, "times as fast", Better::higher, why)
                              : not_comparable(id, paper, ratio, "times as fast", why + ". There is one device here"));
    report::Plot plot{rain ? "Figure 15" : "Figure 14",
                      "ms",
                      fmt::format("On {}. The paper: two devices {} times as fast; here {:.2f}.", named, paper, ratio),
                      {line("one device", one_ms)},
                      report::over_steps(1.0 / 60)};
    if (two) plot.lines.push_back(line("two devices", two_ms));
    out.plots.push_back(plot);
    out.paragraphs = {"One device and two follow the same recording, step after step in turn. Without two GPUs a "
                      "device is one core of the CPU, and the host has as many threads as there are cores in use."};
    return out;
}

} // namespace

Experiment two_devices(const Workshop& shop, const std::string& scene) {
    Experiment e;
    const bool rain = scene == "rain";
    e.name = rain ? "fig15" : "fig14";
    e.title = fmt::format("{}: one device against two, {}", rain ? "Figure 15" : "Figure 14", scene);
    const Choice choice = devices();
    const Json settings{{"scene", scene},
                        {"one", to_json(on(shop.plan(), choice, 1))},
                        {"count", choice.ids.size()},
                        {"last", choice.ids.back()}};
    e.parts = {{"devices-" + scene, shop.key("devices", settings), Workshop::cost(shop.base(scene)),
                [&shop, scene](const Tick& tick) { return measure(shop, scene, tick); }}};
    e.show = [scene](const std::vector<Json>& found) { return show(scene, found[0]); };
    return e;
}

} // namespace raycontact::reproduce
