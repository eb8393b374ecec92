// SPDX-License-Identifier: Apache-2.0
#include "device/cpu/device.h"
#include "device/device.h"

#include <raycontact/error.h>

#include <charconv>
#include <cstdlib>

namespace raycontact {

std::vector<DeviceInfo> list_devices() {
    return {cpu::describe()};
}

OpenDevice open_device(std::string_view name, std::uint32_t threads) {
    // For tests and measurements: a narrower instruction set gives the same bits.
    const char* wanted = std::getenv("RAYCONTACT_INSTRUCTION_SET");
    const std::string_view instruction_set = wanted ? wanted : "";
    if (threads > 1024) throw InputError("threads: " + std::to_string(threads) + " is too many; give at most 1024");
    const auto on_cpu = [&](int core) {
        auto executor = std::make_unique<Executor>(threads, core);
        auto device = cpu::open(*executor, instruction_set);
        return OpenDevice{std::move(executor), std::move(device)};
    };
    if (name == "auto" || name == "all" || name == "cpu") return on_cpu(-1);
    if (name.starts_with("cpu/")) {
        const std::string_view part = name.substr(4);
        std::uint32_t core = 0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), core);
        if (error == std::errc() && end == part.data() + part.size() && core < usable_cores())
            return on_cpu(usable_core(core));
        throw InputError("device '" + std::string(name) + "': this machine has " + std::to_string(usable_cores())
                         + " cores; use cpu/0 to cpu/" + std::to_string(usable_cores() - 1));
    }
    throw InputError(
        "device '" + std::string(name)
        + "' is unknown or not usable in this version; use auto, cpu or cpu/k (`raycontact devices` lists them)");
}

} // namespace raycontact
