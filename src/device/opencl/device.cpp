// SPDX-License-Identifier: Apache-2.0
#include "device/opencl/device.h"

#include "device/device_id.h"
#include "device/gpu/launches.h"
#include "device/gpu/run_probe.h"
#include "device/opencl/launcher.h"
#include "device/opencl/program.h"

#include <raycontact/error.h>

#include <array>
#include <cstdio>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <vector>

namespace raycontact::opencl {

namespace {

// A device of some driver, or a part of one. Kept for the process: drivers count references to parts wrongly.
struct Listed {
    cl_device_id id = nullptr;
    DeviceInfo info;
    bool runs = false; // our kernels, perhaps with other bits
};

// What its float32 lacks to give our bits, as its driver reports it; empty if nothing.
std::string lacks(cl_device_id id) {
    const auto config = value_of<cl_device_fp_config>(id, CL_DEVICE_SINGLE_FP_CONFIG);
    std::string missing;
    const auto need = [&](cl_device_fp_config bit, const char* what) {
        if ((config & bit) == 0) missing += (missing.empty() ? "" : ", ") + std::string(what);
    };
    need(CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, "correctly rounded division and root");
    need(CL_FP_DENORM, "denormals");
    need(CL_FP_ROUND_TO_NEAREST, "rounding to nearest");
    need(CL_FP_INF_NAN, "infinities");
    return missing;
}

// Why it cannot run our kernels at all.
std::string cannot_run(cl_device_id id) {
    const std::string version = text_of(id, CL_DEVICE_VERSION); // "OpenCL 1.2 ..."
    if (version.starts_with("OpenCL 1.0") || version.starts_with("OpenCL 1.1"))
        return "it speaks " + version + ", and the kernels OpenCL 1.2";
    if (value_of<cl_bool>(id, CL_DEVICE_AVAILABLE) == CL_FALSE) return "its driver says that it is not available";
    if (value_of<cl_bool>(id, CL_DEVICE_COMPILER_AVAILABLE) == CL_FALSE) return "its driver has no compiler";
    if (value_of<cl_bool>(id, CL_DEVICE_ENDIAN_LITTLE) == CL_FALSE) return "it is big-endian";
    return "";
}

// The PCI address, as "0000:65:00.0", if the driver reports it.
std::string bus_of(cl_device_id id) {
    constexpr cl_device_info pci_khr = 0x410F, bus_nv = 0x4008, slot_nv = 0x4009, domain_nv = 0x400A;
    constexpr cl_device_info topology_amd = 0x4037;
    const auto address = [](unsigned domain, unsigned bus, unsigned device, unsigned function) {
        std::array<char, 40> text{};
        std::snprintf(text.data(), text.size(), "%04x:%02x:%02x.%x", domain, bus, device, function);
        return std::string(text.data());
    };
    const std::string extensions = text_of(id, CL_DEVICE_EXTENSIONS);
    const auto has = [&](const char* extension) { return extensions.find(extension) != std::string::npos; };
    if (has("cl_khr_pci_bus_info")) {
        const auto at = value_of<std::array<cl_uint, 4>>(id, pci_khr);
        return address(at[0], at[1], at[2], at[3]);
    }
    if (has("cl_nv_device_attribute_query")) {
        const auto slot = value_of<cl_uint>(id, slot_nv); // device and function in one
        return address(value_of<cl_uint>(id, domain_nv), value_of<cl_uint>(id, bus_nv), slot >> 3, slot & 7);
    }
    if (has("cl_amd_device_attribute_query")) {
        const auto topology = value_of<std::array<unsigned char, 24>>(id, topology_amd); // its last bytes, if of PCI
        if (topology[0] == 1) return address(0, topology[21], topology[22], topology[23]);
    }
    return "";
}

Listed describe(cl_device_id id, std::string name) {
    Listed listed;
    listed.id = id;
    DeviceInfo& info = listed.info;
    info.id = std::move(name);
    info.kind = "opencl";
    const auto type = value_of<cl_device_type>(id, CL_DEVICE_TYPE);
    info.type = (type & CL_DEVICE_TYPE_GPU) != 0 ? "gpu" : (type & CL_DEVICE_TYPE_CPU) != 0 ? "cpu" : "other";
    info.bus = bus_of(id);
    info.name = text_of(id, CL_DEVICE_NAME);
    info.driver = text_of(id, CL_DEVICE_VERSION) + ", " + text_of(id, CL_DRIVER_VERSION);
    info.cores = value_of<cl_uint>(id, CL_DEVICE_MAX_COMPUTE_UNITS);
    info.memory_bytes = value_of<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE);
    info.why_not = cannot_run(id);
    listed.runs = info.why_not.empty();
    const std::string missing = lacks(id);
    if (listed.runs && !missing.empty()) info.why_not = "its float32 lacks " + missing + "; its contacts would differ";
    info.exact = missing.empty();
    info.usable = info.why_not.empty();
    return listed;
}

std::vector<Listed> list_devices() {
    std::vector<Listed> found;
    cl_uint count = 0;
    if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS) return found; // no driver
    std::vector<cl_platform_id> platforms(count);
    if (clGetPlatformIDs(count, platforms.data(), nullptr) != CL_SUCCESS) return found;
    for (cl_platform_id platform : platforms) {
        cl_uint size = 0;
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &size) != CL_SUCCESS) continue;
        std::vector<cl_device_id> ids(size);
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, size, ids.data(), nullptr) != CL_SUCCESS) continue;
        for (cl_device_id id : ids) found.push_back(describe(id, "opencl:" + std::to_string(found.size())));
    }
    return found;
}

std::vector<Listed> list_parts(const Listed& whole) {
    const cl_device_partition_property equally[] = {CL_DEVICE_PARTITION_EQUALLY, 1, 0};
    std::vector<Listed> found;
    cl_uint count = 0;
    if (clCreateSubDevices(whole.id, equally, 0, nullptr, &count) != CL_SUCCESS) return found;
    std::vector<cl_device_id> ids(count);
    if (clCreateSubDevices(whole.id, equally, count, ids.data(), nullptr) != CL_SUCCESS) return found;
    for (cl_device_id id : ids) found.push_back(describe(id, whole.info.id + "/" + std::to_string(found.size())));
    return found;
}

const std::vector<Listed>& devices() {
    static const std::vector<Listed> found = list_devices();
    return found;
}

const std::vector<Listed>& parts(std::size_t index) {
    static std::mutex mutex;
    static std::vector<std::optional<std::vector<Listed>>> made(devices().size());
    const std::lock_guard lock(mutex);
    if (!made.at(index)) made[index] = list_parts(devices()[index]);
    return *made[index];
}

const Listed& find(std::string_view id) {
    const std::string named = "device '" + std::string(id) + "': ";
    const auto [kind, index, part] = DeviceId::read(id);
    if (devices().empty())
        throw InputError(named + "no OpenCL driver is installed here (on Debian, of the CPU: pocl-opencl-icd)");
    if (index >= devices().size())
        throw InputError(named + "there is none; " + use_one_of("opencl:", devices().size()));
    if (!part) return devices()[index];
    if (parts(index).empty()) throw InputError(named + "its driver does not divide it into cores; use it whole");
    if (*part >= parts(index).size())
        throw InputError(named + "it has no such core; "
                         + use_one_of("opencl:" + std::to_string(index) + "/", parts(index).size()));
    return parts(index)[*part];
}

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
    return gpu::open(listed.info, listed.runs, inexact, [&] {
        Source source = exact_source(listed.id);
        if (change) change(source);
        return std::make_unique<DriverDevice>(listed, source);
    });
}

} // namespace raycontact::opencl
