// SPDX-License-Identifier: Apache-2.0
#include "device/opencl/device.h"

#include "device/gpu/every_kernel.h"
#include "device/gpu/run_probe.h"
#include "device/gpu/run_scan.h"
#include "device/opencl/launcher.h"
#include "device/opencl/list.h"
#include "device/opencl/program.h"

#include <raycontact/error.h>

#include <array>
#include <stdexcept>

namespace raycontact::opencl {

namespace {

Context make_context(cl_device_id device) {
    cl_int status = CL_SUCCESS;
    Context context(clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status));
    check(status, "clCreateContext");
    return context;
}

// SCAN_GROUP, as the kernel's text sets it.
std::size_t group_size_of(cl_kernel kernel, cl_device_id device) {
    std::array<std::size_t, 3> size{};
    check(
        clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, sizeof size, size.data(), nullptr),
        "clGetKernelWorkGroupInfo");
    return size[0];
}

class DriverDevice : public Device, private Queue {
public:
    DriverDevice(const Listed& listed, const Source& source)
        : info_(listed.info), context_(make_context(listed.id)), program_(context_.get(), listed.id, source),
          block_items_(VERTEX_LANES / source.vertices_at_once), launcher_(context_.get(), listed.id),
          scan_group_(group_size_of(program_.scan_kernel(0), listed.id)),
          scan_sums_(context_.get(), gpu::scan_sums_bytes(scan_group_)) {
        const gpu::Probed probed = gpu::run_probe(
            *this, source.has_double, [&](const char* name, kernels::uint count, std::span<const Argument> arguments) {
                const Kernel kernel = program_.entry(name);
                launcher_.over_items(kernel.get(), name, count, count, arguments);
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
        return std::make_unique<DeviceBuffer>(context_.get(), bytes);
    }
    Queue& queue() override { return *this; }

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
        launcher_.over_items(kernel, gpu::name_of(id),
                             std::size_t{count.most} * (is_over_vertices(id) ? block_items_ : 1), count, arguments);
    }
    kernels::uint scan(const ScanOf& scan) override {
        return gpu::run_scan(
            scan, scan_sums_, scan_group_,
            [&](std::size_t kernel, std::size_t groups, const Count& count, std::span<const Argument> arguments) {
                launcher_.in_groups(program_.scan_kernel(kernel), gpu::scan_kernels[kernel], scan_group_, groups, count,
                                    arguments);
            });
    }
    void finish() override {
        check(clFinish(launcher_.queue()), "clFinish");
        launcher_.add_up();
    }
    double busy_ms() const override { return launcher_.busy_ms(); }

    DeviceInfo info_;
    DeviceTraits traits_;
    Context context_;
    Program program_;
    std::size_t block_items_; ///< of a block of vertices, in the kernels over vertices
    Launcher launcher_;
    std::size_t scan_group_;
    DeviceBuffer scan_sums_;
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
