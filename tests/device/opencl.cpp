// SPDX-License-Identifier: Apache-2.0
#include "device/opencl.h"

#include "device/trace.h"

#include <array>
#include <stdexcept>
#include <type_traits>

namespace raycontact::device_test {

namespace {

void check(cl_int status, const char* call) {
    if (status != CL_SUCCESS) throw std::runtime_error(std::string(call) + ": OpenCL error " + std::to_string(status));
}

template <auto release>
struct Release {
    template <typename T>
    void operator()(T* object) const {
        release(object);
    }
};
template <typename T, auto release>
using Owned = std::unique_ptr<std::remove_pointer_t<T>, Release<release>>;

std::string text_of(cl_device_id device, cl_device_info what) {
    std::size_t size = 0;
    check(clGetDeviceInfo(device, what, 0, nullptr, &size), "clGetDeviceInfo");
    std::string text(size, '\0');
    check(clGetDeviceInfo(device, what, size, text.data(), nullptr), "clGetDeviceInfo");
    text.resize(text.find_last_not_of('\0') + 1);
    return text;
}

OpenClInfo describe(cl_device_id id) {
    OpenClInfo info;
    info.id = id;
    info.name = text_of(id, CL_DEVICE_NAME) + ", " + text_of(id, CL_DEVICE_VERSION);
    check(clGetDeviceInfo(id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof info.single, &info.single, nullptr),
          "clGetDeviceInfo");
    return info;
}

class OpenClBuffer : public Buffer {
public:
    OpenClBuffer(cl_context context, std::size_t bytes) : bytes_(bytes) {
        cl_int status = CL_SUCCESS;
        memory_.reset(clCreateBuffer(context, CL_MEM_READ_WRITE, bytes, nullptr, &status));
        check(status, "clCreateBuffer");
    }
    std::size_t bytes() const override { return bytes_; }
    cl_mem memory() const { return memory_.get(); }

private:
    Owned<cl_mem, clReleaseMemObject> memory_;
    std::size_t bytes_;
};

cl_mem memory_of(const Buffer& buffer) {
    return static_cast<const OpenClBuffer&>(buffer).memory();
}

class OpenClDevice : public Device, private Queue {
public:
    OpenClDevice(const OpenClInfo& device, const std::string& text, const std::string& options) {
        info_.name = device.name;
        cl_int status = CL_SUCCESS;
        context_.reset(clCreateContext(nullptr, 1, &device.id, nullptr, nullptr, &status));
        check(status, "clCreateContext");
        queue_.reset(clCreateCommandQueue(context_.get(), device.id, 0, &status));
        check(status, "clCreateCommandQueue");
        build(device.id, text, options);
        for (std::size_t i = 0; i < kernels_.size(); ++i) {
            kernels_[i].reset(clCreateKernel(program_.get(), kernel_name(static_cast<KernelId>(i)), &status));
            check(status, kernel_name(static_cast<KernelId>(i)));
        }
    }

    const DeviceInfo& info() const override { return info_; }
    std::unique_ptr<Buffer> make_buffer(std::size_t bytes) override {
        return std::make_unique<OpenClBuffer>(context_.get(), bytes);
    }
    Queue& queue() override { return *this; }

private:
    void build(cl_device_id device, const std::string& text, const std::string& options) {
        cl_int status = CL_SUCCESS;
        const char* source = text.c_str();
        program_.reset(clCreateProgramWithSource(context_.get(), 1, &source, nullptr, &status));
        check(status, "clCreateProgramWithSource");
        status = clBuildProgram(program_.get(), 1, &device, options.c_str(), nullptr, nullptr);
        if (status == CL_SUCCESS) return;
        std::string log(1 << 16, '\0');
        clGetProgramBuildInfo(program_.get(), device, CL_PROGRAM_BUILD_LOG, log.size(), log.data(), nullptr);
        log.resize(log.find_last_not_of('\0') + 1);
        throw std::runtime_error("clBuildProgram: OpenCL error " + std::to_string(status) + "\n" + log);
    }

    void write(Buffer& to, std::size_t offset, const void* from, std::size_t bytes) override {
        check(clEnqueueWriteBuffer(queue_.get(), memory_of(to), CL_TRUE, offset, bytes, from, 0, nullptr, nullptr),
              "clEnqueueWriteBuffer");
    }
    void read(void* to, const Buffer& from, std::size_t offset, std::size_t bytes) override {
        check(clEnqueueReadBuffer(queue_.get(), memory_of(from), CL_TRUE, offset, bytes, to, 0, nullptr, nullptr),
              "clEnqueueReadBuffer");
    }
    void copy(Buffer& to, const Buffer& from, std::size_t bytes) override {
        check(clEnqueueCopyBuffer(queue_.get(), memory_of(from), memory_of(to), 0, 0, bytes, 0, nullptr, nullptr),
              "clEnqueueCopyBuffer");
    }
    void launch(KernelId id, kernels::uint count, std::span<const Argument> arguments) override {
        cl_kernel kernel = kernels_[static_cast<std::size_t>(id)].get();
        check(clSetKernelArg(kernel, 0, sizeof count, &count), kernel_name(id));
        for (std::size_t i = 0; i < arguments.size(); ++i) {
            const cl_mem memory = arguments[i].buffer ? memory_of(*arguments[i].buffer) : nullptr;
            const auto at = static_cast<cl_uint>(i + 1);
            check(memory ? clSetKernelArg(kernel, at, sizeof(cl_mem), &memory)
                         : clSetKernelArg(kernel, at, sizeof arguments[i].scalar, &arguments[i].scalar),
                  kernel_name(id));
        }
        const std::size_t size = (std::size_t{count} + 63) / 64 * 64; // a count without divisors makes groups of one
        check(clEnqueueNDRangeKernel(queue_.get(), kernel, 1, nullptr, &size, nullptr, 0, nullptr, nullptr),
              kernel_name(id));
    }
    void finish() override { check(clFinish(queue_.get()), "clFinish"); }

    DeviceInfo info_;
    Owned<cl_context, clReleaseContext> context_;
    Owned<cl_command_queue, clReleaseCommandQueue> queue_;
    Owned<cl_program, clReleaseProgram> program_;
    std::array<Owned<cl_kernel, clReleaseKernel>, static_cast<std::size_t>(KernelId::count)> kernels_;
};

} // namespace

std::string OpenClInfo::lacks() const {
    std::string missing;
    const auto need = [&](cl_device_fp_config bit, const char* what) {
        if ((single & bit) == 0) missing += (missing.empty() ? "" : ", ") + std::string(what);
    };
    need(CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT, "correctly rounded divide and square root");
    need(CL_FP_DENORM, "denormals");
    need(CL_FP_ROUND_TO_NEAREST, "rounding to nearest");
    need(CL_FP_INF_NAN, "infinities and NaN");
    return missing;
}

std::vector<OpenClInfo> opencl_devices() {
    cl_uint count = 0;
    const cl_int status = clGetPlatformIDs(0, nullptr, &count);
    if (status != CL_SUCCESS || count == 0)
        throw std::runtime_error("no OpenCL platform is installed; on Debian: apt-get install pocl-opencl-icd");
    std::vector<cl_platform_id> platforms(count);
    check(clGetPlatformIDs(count, platforms.data(), nullptr), "clGetPlatformIDs");
    std::vector<OpenClInfo> found;
    for (cl_platform_id platform : platforms) {
        cl_uint devices = 0;
        if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &devices) != CL_SUCCESS) continue;
        std::vector<cl_device_id> ids(devices);
        check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, devices, ids.data(), nullptr), "clGetDeviceIDs");
        for (cl_device_id id : ids) found.push_back(describe(id));
    }
    return found;
}

std::vector<OpenClInfo> opencl_parts(const OpenClInfo& device) {
    const cl_device_partition_property equally[] = {CL_DEVICE_PARTITION_EQUALLY, 1, 0};
    cl_uint count = 0;
    check(clCreateSubDevices(device.id, equally, 0, nullptr, &count), "clCreateSubDevices");
    std::vector<cl_device_id> ids(count);
    check(clCreateSubDevices(device.id, equally, count, ids.data(), nullptr), "clCreateSubDevices");
    std::vector<OpenClInfo> parts;
    parts.reserve(count);
    for (cl_device_id id : ids) parts.push_back(describe(id));
    return parts;
}

std::string exact_options(const OpenClInfo& device) {
    const bool rounds = (device.single & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
    return rounds ? "-cl-std=CL1.2 -cl-fp32-correctly-rounded-divide-sqrt" : "-cl-std=CL1.2";
}

std::unique_ptr<Device> open_opencl(const OpenClInfo& device, const std::string& text, const std::string& options) {
    return std::make_unique<OpenClDevice>(device, text, options);
}

} // namespace raycontact::device_test
