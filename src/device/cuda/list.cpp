// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/list.h"

#include "device/cuda/nvrtc.h"
#include "device/device_id.h"

#include <raycontact/error.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace raycontact::cuda {

namespace {

// Fills in what the driver tells, as far as it does.
void ask(Listed& listed) {
    enum Attribute { multiprocessors = 16, capability_major = 75, capability_minor = 76 };
    const auto attribute = [&](int which) {
        int value = 0;
        check(driver().cuDeviceGetAttribute(&value, which, listed.device), "cuDeviceGetAttribute");
        return value;
    };
    DeviceInfo& info = listed.info;
    std::array<char, 256> text{};
    check(driver().cuDeviceGetName(text.data(), text.size(), listed.device), "cuDeviceGetName");
    info.name = text.data();
    check(driver().cuDeviceGetPCIBusId(text.data(), text.size(), listed.device), "cuDeviceGetPCIBusId");
    info.bus = text.data();
    std::transform(info.bus.begin(), info.bus.end(), info.bus.begin(),
                   [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
    info.cores = static_cast<std::uint32_t>(attribute(multiprocessors));
    std::size_t bytes = 0;
    check(driver().cuDeviceTotalMem(&bytes, listed.device), "cuDeviceTotalMem");
    info.memory_bytes = bytes;
    listed.architecture = 10 * attribute(capability_major) + attribute(capability_minor);
}

Listed describe(int index, int driver_version, const std::string& no_compiler) {
    Listed listed;
    listed.driver_major = driver_version / 1000;
    DeviceInfo& info = listed.info;
    info.id = "cuda:" + std::to_string(index);
    info.kind = "cuda";
    info.type = "gpu";
    info.driver = "CUDA " + std::to_string(driver_version / 1000) + "." + std::to_string(driver_version % 1000 / 10);
    info.exact = true; // by the options of exact_source()
    info.why_not = no_compiler;
    try {
        check(driver().cuDeviceGet(&listed.device, index), "cuDeviceGet");
        ask(listed);
    } catch (const DeviceError& error) {
        info.why_not = error.what();
    }
    info.usable = info.why_not.empty();
    return listed;
}

std::string why_no_compiler(int driver_major) {
    try {
        const Nvrtc nvrtc(driver_major);
    } catch (const DeviceError& error) {
        return error.what();
    }
    return "";
}

} // namespace

Devices devices() {
    Devices devices;
    if (!driver().why_not.empty()) return {{}, driver().why_not};
    int version = 0, count = 0;
    try {
        check(driver().cuInit(0), "cuInit");
        check(driver().cuDriverGetVersion(&version), "cuDriverGetVersion");
        check(driver().cuDeviceGetCount(&count), "cuDeviceGetCount");
    } catch (const DeviceError& error) {
        return {{}, std::string("the CUDA driver does not start: ") + error.what()};
    }
    if (count == 0) return {{}, "the CUDA driver shows no device"};
    const std::string no_compiler = why_no_compiler(version / 1000);
    for (int i = 0; i < count; ++i) devices.found.push_back(describe(i, version, no_compiler));
    return devices;
}

Listed find(std::string_view id) {
    const std::string named = "device '" + std::string(id) + "': ";
    const std::size_t index = DeviceId::read(id).index;
    const Devices all = devices();
    if (all.found.empty()) throw InputError(named + all.why_none);
    if (index >= all.found.size()) throw InputError(named + "there is none; " + use_one_of("cuda:", all.found.size()));
    return all.found[index];
}

} // namespace raycontact::cuda
