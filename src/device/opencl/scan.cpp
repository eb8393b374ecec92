// SPDX-License-Identifier: Apache-2.0
#include "device/opencl/scan.h"

#include "device/opencl/arguments.h"

#include <array>

namespace raycontact::opencl {

namespace {

std::size_t group_size_of(cl_kernel kernel, cl_device_id device) {
    std::array<std::size_t, 3> size{};
    check(
        clGetKernelWorkGroupInfo(kernel, device, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, sizeof size, size.data(), nullptr),
        "clGetKernelWorkGroupInfo");
    return size[0];
}

} // namespace

Scan::Scan(const Program& program, cl_context context, cl_device_id device)
    : at_once_(program.entry("scan_at_once")), blocks_(program.entry("scan_blocks")), sums_(program.entry("scan_sums")),
      firsts_(program.entry("scan_firsts")), group_size_(group_size_of(at_once_.get(), device)) {
    cl_int status = CL_SUCCESS;
    const std::size_t bytes = sizeof(cl_ulong) * MOST_COLUMNS * group_size_;
    block_sums_.reset(clCreateBuffer(context, CL_MEM_READ_WRITE, bytes, nullptr, &status));
    check(status, "clCreateBuffer");
}

kernels::uint Scan::run(Launcher& launcher, const ScanOf& scan) {
    const cl_mem values = memory_of(scan.values), firsts = memory_of(scan.firsts), totals = memory_of(scan.totals);
    const cl_mem sums = block_sums_.get();
    if (scan.count.most <= SCAN_AT_ONCE) {
        set_arguments(at_once_.get(), scan.count, scan.columns, scan.stride, values, firsts, totals, scan.at,
                      scan.room);
        launcher.in_groups(at_once_.get(), "scan_at_once", group_size_, 1);
        return 1;
    }
    set_arguments(blocks_.get(), scan.count, scan.columns, scan.stride, values, sums);
    launcher.in_groups(blocks_.get(), "scan_blocks", group_size_, group_size_);
    set_arguments(sums_.get(), scan.count, scan.columns, sums, totals, scan.at, scan.room);
    launcher.in_groups(sums_.get(), "scan_sums", group_size_, 1);
    set_arguments(firsts_.get(), scan.count, values, sums, firsts);
    launcher.in_groups(firsts_.get(), "scan_firsts", group_size_, group_size_);
    return 3;
}

} // namespace raycontact::opencl
