// SPDX-License-Identifier: Apache-2.0
#include "device/cpu/device.h"
#ifdef RAYCONTACT_CUDA
#include "device/cuda/device.h"
#endif
#include "device/device.h"
#include "device/device_id.h"
#ifdef RAYCONTACT_OPENCL
#include "device/opencl/device.h"
#endif

#include <raycontact/error.h>

#include <algorithm>
#include <cstdlib>
#include <string>

namespace raycontact {

namespace {

constexpr std::string_view automatic = "auto";

#ifdef RAYCONTACT_CUDA
std::unique_ptr<Device> open_cuda(std::string_view name, bool inexact) {
    return cuda::open(name, inexact);
}
#else
std::unique_ptr<Device> open_cuda(std::string_view name, bool) {
    throw InputError("device '" + std::string(name)
                     + "': this raycontact was not built with CUDA (configure with RAYCONTACT_CUDA=ON)");
}
#endif

#ifdef RAYCONTACT_OPENCL
std::unique_ptr<Device> open_opencl(std::string_view name, bool inexact) {
    return opencl::open(name, inexact);
}
#else
std::unique_ptr<Device> open_opencl(std::string_view name, bool) {
    throw InputError("device '" + std::string(name)
                     + "': this raycontact was not built with OpenCL (on Debian: apt-get install ocl-icd-opencl-dev "
                       "opencl-c-headers, then configure with RAYCONTACT_OPENCL=ON)");
}
#endif

std::vector<std::string> read_list(std::string_view list) {
    std::vector<DeviceId> given;
    std::vector<std::string> ids;
    const auto refuse = [&](const std::string& what) {
        throw InputError("devices: \"" + std::string(list) + "\" names " + what);
    };
    for (std::size_t begin = 0; begin <= list.size();) {
        const std::size_t end = std::min(list.find(',', begin), list.size());
        const DeviceId id = DeviceId::read(list.substr(begin, end - begin));
        for (const DeviceId& other : given) {
            if (id == other) refuse("a device twice; name each once");
            if (id.whole() == other.whole() && id.part.has_value() != other.part.has_value())
                refuse("a part beside its whole (" + id.whole() + "); name one or the other");
        }
        given.push_back(id);
        ids.push_back(id.text());
        begin = end + 1;
    }
    return ids;
}

// Every GPU this version can use, each card once: list_devices() has CUDA's before OpenCL's.
std::vector<std::string> every_gpu() {
    std::vector<std::string> ids, cards;
    for (const DeviceInfo& device : list_devices()) {
        if (!device.usable || device.type != "gpu") continue;
        if (!device.bus.empty() && std::ranges::find(cards, device.bus) != cards.end()) continue;
        cards.push_back(device.bus);
        ids.push_back(device.id);
    }
    return ids;
}

} // namespace

std::vector<DeviceInfo> list_devices() {
    std::vector<DeviceInfo> devices = {cpu::describe()};
#ifdef RAYCONTACT_CUDA
    for (DeviceInfo& info : cuda::describe()) devices.push_back(std::move(info));
#endif
#ifdef RAYCONTACT_OPENCL
    for (DeviceInfo& info : opencl::describe()) devices.push_back(std::move(info));
#endif
    return devices;
}

OpenDevice open_device(std::string_view name, std::uint32_t threads, bool inexact, const TaskSystem& tasks) {
    // For tests and measurements; every instruction set gives the same bits.
    const char* wanted = std::getenv("RAYCONTACT_INSTRUCTION_SET");
    const std::string_view instruction_set = wanted ? wanted : "";
    const auto on_cpu = [&](int core) {
        auto executor = std::make_unique<Executor>(threads, core, Executor::Priority::normal, tasks);
        auto device = cpu::open(*executor, instruction_set, name);
        return OpenDevice{std::move(executor), std::move(device)};
    };
    const DeviceId id = DeviceId::read(name);
    if (id.kind == "cpu") {
        if (!id.part) return on_cpu(-1);
        if (*id.part < usable_cores()) return on_cpu(usable_core(*id.part));
        throw InputError("device '" + id.text() + "': this machine has " + std::to_string(usable_cores()) + " cores; "
                         + use_one_of("cpu/", usable_cores()));
    }
    auto executor = std::make_unique<Executor>(threads, -1, Executor::Priority::normal, tasks);
    return {std::move(executor), id.kind == "cuda" ? open_cuda(name, inexact) : open_opencl(name, inexact)};
}

std::vector<std::string> chosen_devices(const Settings& settings) {
    const bool all = settings.execution.devices == "all";
    if (!all && settings.execution.devices != automatic) return read_list(settings.execution.devices);
    std::vector<std::string> gpus = every_gpu();
    if (gpus.empty()) return {"cpu"};
    if (all) return gpus;
    return {"cpu", gpus.front()};
}

std::vector<OpenDevice> open_devices(const Settings& settings) {
    const Execution& how = settings.execution;
    std::vector<OpenDevice> opened;
    if (how.devices == automatic) {
        opened.push_back(open_device("cpu", how.threads, false, how.tasks));
        return opened;
    }
    for (const std::string& id : chosen_devices(settings))
        opened.push_back(open_device(id, how.threads, how.inexact, how.tasks));
    return opened;
}

Opener gpu_opener(const Settings& settings) {
    const Execution& how = settings.execution;
    if (how.devices != automatic) return {};
    return [how]() -> std::optional<OpenDevice> {
        static const std::vector<std::string> gpus = every_gpu();
        if (gpus.empty()) return std::nullopt;
        return open_device(gpus.front(), how.threads, how.inexact, how.tasks);
    };
}

} // namespace raycontact
