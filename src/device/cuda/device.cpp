// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/device.h"

#include "device/cuda/image.h"
#include "device/cuda/launcher.h"
#include "device/cuda/program.h"
#include "device/cuda/staging.h"
#include "device/device_id.h"
#include "device/gpu/launches.h"
#include "device/gpu/run_probe.h"

#include <raycontact/error.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>

namespace raycontact::cuda {

namespace {

struct Listed {
    DeviceNumber device = 0;
    int architecture = 0; // 90 for a compute capability of 9.0
    int driver_major = 0; // the newest CUDA whose programs the driver takes
    DeviceInfo info;
};

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

// The devices that the driver shows, in its order.
struct Devices {
    std::vector<Listed> found;
    std::string why_none; // empty if there are some
};

Devices devices() {
    Devices devices;
    if (const std::string why_not = driver().why_not(); !why_not.empty()) return {{}, why_not};
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

class DriverDevice : public Device, private Queue {
public:
    /// The context is current.
    DriverDevice(const Listed& listed, const std::shared_ptr<const Context>& context, const std::string& image)
        : info_(listed.info), context_(context), program_(context, image), launcher_(context, info_.cores),
          staging_(context), scan_sums_(context, gpu::scan_sums_bytes(program_.scan_group())) {
        const gpu::Probed probed =
            gpu::run_probe(*this, true, [&](const char* name, kernels::uint count, std::span<const Argument> given) {
                Arguments arguments(count, given);
                launcher_.over_items(program_.entry(name), name, count, arguments);
            });
        probed.judge(info_);
        traits_.has_double = probed.exact_double;
    }

    void launch_all() {
        gpu::launch_all(*this, [&](KernelId id) { return program_.kernel(id) != nullptr; });
    }

    const DeviceInfo& info() const override { return info_; }
    const DeviceTraits& traits() const override { return traits_; }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override {
        const Current current(*context_);
        return std::make_unique<DeviceBuffer>(context_, bytes);
    }
    Queue& queue() override { return *this; }

private:
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override {
        const Current current(*context_);
        staging_.write(address_of(&to) + offset, from, bytes);
    }
    void read(std::span<const Piece> pieces) override {
        const Current current(*context_);
        staging_.read(pieces, [this] { wait(); });
    }
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override {
        const Current current(*context_);
        check(driver().cuMemcpyDtoDAsync(address_of(&to), address_of(&from), bytes, context_->stream()),
              "cuMemcpyDtoDAsync");
    }
    void launch(KernelId id, Count count, std::span<const Argument> given) override {
        const FunctionHandle kernel = program_.kernel(id);
        if (!kernel) throw std::logic_error("a kernel that this device cannot run");
        const Current current(*context_);
        Arguments arguments(count, given);
        launcher_.over_items(kernel, gpu::name_of(id),
                             std::size_t{count.most} * (is_over_vertices(id) ? VERTEX_LANES : 1), arguments);
    }
    kernels::uint scan(const ScanOf& scan) override {
        const Current current(*context_);
        return gpu::run_scan(
            scan, scan_sums_, program_.scan_group(),
            [&](std::size_t kernel, std::size_t groups, const Count& count, std::span<const Argument> given) {
                Arguments arguments(count, given);
                launcher_.in_groups(program_.scan_kernel(kernel), gpu::scan_kernels[kernel], program_.scan_group(),
                                    groups, arguments);
            });
    }
    void finish() override {
        const Current current(*context_);
        wait();
    }
    double busy_ms() const override { return launcher_.busy_ms(); }

    void wait() {
        launcher_.finish();
        staging_.all_copied();
    }

    DeviceInfo info_;
    DeviceTraits traits_;
    std::shared_ptr<const Context> context_;
    Program program_;
    Launcher launcher_;
    Staging staging_;
    DeviceBuffer scan_sums_; ///< the last member: it waits before the others go
};

} // namespace

std::vector<DeviceInfo> describe() {
    std::vector<DeviceInfo> infos;
    for (const Listed& listed : devices().found) infos.push_back(listed.info);
    return infos;
}

std::unique_ptr<Device> open(std::string_view id, bool inexact, const std::function<void(Source&)>& change) {
    const Listed listed = find(id);
    return gpu::open(listed.info, listed.info.usable, inexact, [&] {
        Source source = exact_source();
        if (change) change(source);
        const std::string image =
            image_for(Nvrtc(listed.driver_major), source, listed.architecture, listed.driver_major);
        const auto context = std::make_shared<const Context>(listed.device);
        const Current current(*context);
        return std::make_unique<DriverDevice>(listed, context, image);
    });
}

} // namespace raycontact::cuda
