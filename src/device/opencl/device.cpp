// SPDX-License-Identifier: Apache-2.0
#include "device/opencl/device.h"

#include "device/opencl/arguments.h"
#include "device/opencl/list.h"
#include "device/opencl/probe.h"
#include "device/opencl/scan.h"

#include <raycontact/error.h>

#include <stdexcept>

namespace raycontact::opencl {

namespace {

Context make_context(cl_device_id device) {
    cl_int status = CL_SUCCESS;
    Context context(clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status));
    check(status, "clCreateContext");
    return context;
}

// The arguments of a launch over no items.
template <typename Function>
struct Nothing;
template <typename... Parameters>
struct Nothing<void (*)(kernels::Range, kernels::uint, Parameters...)> {
    static constexpr Argument arguments[] = {{nullptr, 0, !std::is_pointer_v<Parameters>}...};
};

class DriverDevice : public Device, private Queue {
public:
    DriverDevice(const Listed& listed, const Source& source)
        : info_(listed.info), context_(make_context(listed.id)), program_(context_.get(), listed.id, source),
          block_items_(VERTEX_LANES / source.vertices_at_once), launcher_(context_.get(), listed.id),
          scan_(program_, context_.get(), listed.id) {
        const Probed probed = probe(launcher_, program_, source, context_.get());
        if (info_.exact && !probed.differs.empty()) {
            info_.exact = info_.usable = false;
            info_.why_not = probed.differs + " that it computed are not the host's; its contacts would differ";
        }
        traits_.has_double = probed.exact_double;
    }

    // Some drivers compile a kernel at its first launch; that must not happen during a step.
    void launch_all() {
#define RAYCONTACT_KERNEL(name)                                                                                        \
    if (program_.kernel(KernelId::name)) launch(KernelId::name, 0, Nothing<Prototype<KernelId::name>::type>::arguments);
#define RAYCONTACT_CPU_KERNEL(name)
#include "kernels/kernels.def"
#undef RAYCONTACT_KERNEL
#undef RAYCONTACT_CPU_KERNEL
        for (const std::size_t most : {std::size_t{0}, std::size_t{SCAN_AT_ONCE} + 1})
            scan({.count = {nullptr, 0, most}, .columns = 0});
        finish();
    }

    const DeviceInfo& info() const override {
        return info_;
    }
    const DeviceTraits& traits() const override {
        return traits_;
    }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override {
        return std::make_unique<DeviceBuffer>(context_.get(), bytes);
    }
    Queue& queue() override {
        return *this;
    }

private:
    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override {
        check(
            clEnqueueWriteBuffer(launcher_.queue(), memory_of(&to), CL_TRUE, offset, bytes, from, 0, nullptr, nullptr),
            "clEnqueueWriteBuffer");
    }
    void read(std::span<const Piece> pieces) override {
        for (const Piece& piece : pieces)
            if (piece.bytes > 0)
                check(clEnqueueReadBuffer(launcher_.queue(), memory_of(piece.from), CL_FALSE, piece.offset, piece.bytes,
                                          piece.to, 0, nullptr, nullptr),
                      "clEnqueueReadBuffer");
        finish();
    }
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override {
        check(
            clEnqueueCopyBuffer(launcher_.queue(), memory_of(&from), memory_of(&to), 0, 0, bytes, 0, nullptr, nullptr),
            "clEnqueueCopyBuffer");
    }
    void launch(KernelId id, Count count, std::span<const Argument> arguments) override {
        cl_kernel kernel = program_.kernel(id);
        if (!kernel) throw std::logic_error("a kernel that this device cannot run");
        set_count(kernel, count);
        cl_uint at = 2;
        for (const Argument& argument : arguments) {
            if (argument.is_scalar)
                set_argument(kernel, at++, argument.scalar);
            else
                set_argument(kernel, at++, memory_of(argument.buffer));
        }
        launcher_.over_items(kernel, Program::name_of(id),
                             std::size_t{count.most} * (is_over_vertices(id) ? block_items_ : 1));
    }
    kernels::uint scan(const ScanOf& scan) override {
        return scan_.run(launcher_, scan);
    }
    void finish() override {
        check(clFinish(launcher_.queue()), "clFinish");
        launcher_.add_up();
    }
    double busy_ms() const override {
        return launcher_.busy_ms();
    }

    DeviceInfo info_;
    DeviceTraits traits_;
    Context context_;
    Program program_;
    std::size_t block_items_; ///< of a block of vertices, in the kernels over vertices
    Launcher launcher_;
    Scan scan_;
};

} // namespace

std::vector<DeviceInfo> describe() {
    std::vector<DeviceInfo> infos;
    for (const Listed& listed : devices()) infos.push_back(listed.info);
    return infos;
}

std::unique_ptr<Device> open(std::string_view id, bool inexact, const std::function<void(Source&)>& change) {
    const Listed& listed = find(id);
    const auto refuse = [&](const DeviceInfo& info) {
        throw InputError("device '" + info.id + "' (" + info.name + ") cannot be used: " + info.why_not);
    };
    if (!listed.info.usable && !(inexact && listed.runs)) refuse(listed.info);
    Source source = exact_source(listed.id);
    if (change) change(source);
    std::unique_ptr<DriverDevice> device;
    try {
        device = std::make_unique<DriverDevice>(listed, source);
        if (device->info().usable || inexact) device->launch_all();
    } catch (const std::runtime_error& error) {
        throw std::runtime_error("device '" + listed.info.id + "' (" + listed.info.name
                                 + ") did not open: " + error.what());
    }
    if (!device->info().usable && !inexact) refuse(device->info());
    return device;
}

} // namespace raycontact::opencl
