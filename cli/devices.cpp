// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include <raycontact/device.h>
#include <raycontact/settings.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

namespace {

using Json = nlohmann::ordered_json;

void print_json(const std::vector<raycontact::DeviceInfo>& devices) {
    Json list = Json::array();
    for (const auto& device : devices) {
        list.push_back({{"id", device.id},
                        {"kind", device.kind},
                        {"type", device.type},
                        {"bus", device.bus},
                        {"name", device.name},
                        {"driver", device.driver},
                        {"cores", device.cores},
                        {"memory_bytes", device.memory_bytes},
                        {"exact", device.exact},
                        {"usable", device.usable},
                        {"why_not", device.why_not}});
    }
    // Drivers choose their own names: what is not UTF-8 in them must not end the program.
    std::cout << list.dump(-1, ' ', false, Json::error_handler_t::replace) << '\n';
}

void print_table(const std::vector<raycontact::DeviceInfo>& devices) {
    for (const auto& device : devices) {
        std::cout << fmt::format(
            "{:<10} {}: {} ({}), {} cores, {:.1f} GiB, {}, {}\n", device.id, device.type, device.name, device.driver,
            device.cores, static_cast<double>(device.memory_bytes) / (1024.0 * 1024.0 * 1024.0),
            device.exact ? "exact" : "not exact", device.usable ? "usable" : "not usable: " + device.why_not);
    }
}

std::vector<std::string> chosen(const char* devices) {
    raycontact::Settings settings;
    settings.execution.devices = devices;
    return raycontact::chosen_devices(settings);
}

void print_choices() {
    const std::vector<std::string> candidates = chosen("auto");
    std::cout << "--devices auto "
              << (candidates.size() == 1
                      ? "is cpu: there is no GPU"
                      : fmt::format("begins with cpu, tries {} once steps take long enough, and goes on with the "
                                    "faster one",
                                    candidates.back()))
              << fmt::format("; all is {}\n", fmt::join(chosen("all"), ","));
}

} // namespace

void add_devices(CLI::App& app) {
    CLI::App* command = app.add_subcommand("devices", "List the devices of this machine");
    auto json = std::make_shared<bool>(false);
    command->add_flag("--json", *json, "print one JSON array on stdout");
    command->callback([json] {
        const auto devices = raycontact::list_devices();
        if (*json) return print_json(devices);
        print_table(devices);
        print_choices();
    });
}
