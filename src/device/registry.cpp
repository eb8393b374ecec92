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

#include <cstdlib>

namespace raycontact {

namespace {

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

OpenDevice open_device(std::string_view name, std::uint32_t threads, bool inexact) {
    // For tests and measurements; every instruction set gives the same bits.
    const char* wanted = std::getenv("RAYCONTACT_INSTRUCTION_SET");
    const std::string_view instruction_set = wanted ? wanted : "";
    if (threads > 1024) throw InputError("threads: " + std::to_string(threads) + " is too many; give at most 1024");
    const auto on_cpu = [&](int core) {
        auto executor = std::make_unique<Executor>(threads, core);
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
    auto device = id.kind == "cuda" ? open_cuda(name, inexact) : open_opencl(name, inexact);
    return {std::make_unique<Executor>(threads), std::move(device)};
}

} // namespace raycontact
