// SPDX-License-Identifier: Apache-2.0
#include "device/opencl/program.h"

#include "kernels_opencl.h"

namespace raycontact::opencl {

namespace {

bool is_built(KernelId id, bool has_double) {
    return gpu::name_of(id) && (has_double || !gpu::is_in_double[static_cast<std::size_t>(id)]);
}

bool claims_double(cl_device_id device) {
    const auto config = value_of<cl_device_fp_config>(device, CL_DEVICE_DOUBLE_FP_CONFIG);
    const cl_device_fp_config needed = CL_FP_ROUND_TO_NEAREST | CL_FP_DENORM | CL_FP_INF_NAN;
    return (config & needed) == needed;
}

} // namespace

Source exact_source(cl_device_id device) {
    const auto config = value_of<cl_device_fp_config>(device, CL_DEVICE_SINGLE_FP_CONFIG);
    const bool rounds = (config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT) != 0;
    const bool has_double = claims_double(device);
    std::string options = "-cl-std=CL1.2";
    if (rounds) options += " -cl-fp32-correctly-rounded-divide-sqrt";
    // With a vertex an item, a step takes PoCL twice the time.
    const kernels::uint vertices_at_once = is_cpu(device) ? VERTEX_LANES : 1;
    return {kernel_text(opencl_pieces, has_double), options, has_double, vertices_at_once};
}

Program::Program(cl_context context, cl_device_id device, const Source& source) {
    cl_int status = CL_SUCCESS;
    const char* text = source.text.c_str();
    program_.reset(clCreateProgramWithSource(context, 1, &text, nullptr, &status));
    check(status, "clCreateProgramWithSource");
    const std::string options = source.options + " -D VERTICES_AT_ONCE=" + std::to_string(source.vertices_at_once);
    status = clBuildProgram(program_.get(), 1, &device, options.c_str(), nullptr, nullptr);
    if (status != CL_SUCCESS) {
        std::size_t size = 0;
        clGetProgramBuildInfo(program_.get(), device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size);
        std::string log(size, '\0');
        clGetProgramBuildInfo(program_.get(), device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
        log.resize(log.find_last_not_of(std::string_view("\0\n ", 3)) + 1);
        check(status, "clBuildProgram" + (log.empty() ? "" : ":\n" + log + "\n"));
    }
    for (std::size_t i = 0; i < kernels_.size(); ++i)
        if (is_built(static_cast<KernelId>(i), source.has_double)) kernels_[i] = entry(gpu::kernel_names[i]);
    for (std::size_t i = 0; i < scan_kernels_.size(); ++i) scan_kernels_[i] = entry(gpu::scan_kernels[i]);
}

Kernel Program::entry(const char* name) const {
    cl_int status = CL_SUCCESS;
    Kernel kernel(clCreateKernel(program_.get(), name, &status));
    check(status, name);
    return kernel;
}

} // namespace raycontact::opencl
