// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"
#include "platform/system.h"

#include <string>
#include <string_view>

namespace raycontact::cuda {

// The driver's binary interface, as far as it is used. Handles are opaque; status 0 is success.
using Status = int;
using DeviceNumber = int;
using Address = unsigned long long; ///< of device memory
using ContextHandle = struct ContextObject*;
using StreamHandle = struct StreamObject*;
using EventHandle = struct EventObject*;
using ModuleHandle = struct ModuleObject*;
using FunctionHandle = struct FunctionObject*;

using platform::Function;

/// The driver that is installed, its functions named as in NVIDIA's documentation. Its library is loaded once and kept
/// for the process. A symbol's suffix is part of the binary interface: without it, several of these are older
/// functions.
struct Driver {
    static constexpr const char* library_name = platform::on_windows ? "nvcuda.dll" : "libcuda.so.1";

    platform::Library library{library_name};
    Function<Status(unsigned flags)> cuInit{library, "cuInit"};
    Function<Status(int* version)> cuDriverGetVersion{library, "cuDriverGetVersion"}; ///< 1000 * major + 10 * minor
    Function<Status(Status status, const char** text)> cuGetErrorName{library, "cuGetErrorName"};
    Function<Status(Status status, const char** text)> cuGetErrorString{library, "cuGetErrorString"};
    Function<Status(int* count)> cuDeviceGetCount{library, "cuDeviceGetCount"};
    Function<Status(DeviceNumber* device, int index)> cuDeviceGet{library, "cuDeviceGet"};
    Function<Status(char* text, int size, DeviceNumber device)> cuDeviceGetName{library, "cuDeviceGetName"};
    Function<Status(char* text, int size, DeviceNumber device)> cuDeviceGetPCIBusId{library, "cuDeviceGetPCIBusId"};
    Function<Status(int* value, int attribute, DeviceNumber device)> cuDeviceGetAttribute{library,
                                                                                          "cuDeviceGetAttribute"};
    Function<Status(std::size_t* bytes, DeviceNumber device)> cuDeviceTotalMem{library, "cuDeviceTotalMem_v2"};
    Function<Status(ContextHandle* context, DeviceNumber device)> cuDevicePrimaryCtxRetain{library,
                                                                                           "cuDevicePrimaryCtxRetain"};
    Function<Status(DeviceNumber device)> cuDevicePrimaryCtxRelease{library, "cuDevicePrimaryCtxRelease_v2"};
    Function<Status(ContextHandle context)> cuCtxPushCurrent{library, "cuCtxPushCurrent_v2"};
    Function<Status(ContextHandle* context)> cuCtxPopCurrent{library, "cuCtxPopCurrent_v2"};
    Function<Status()> cuCtxSynchronize{library, "cuCtxSynchronize"};
    Function<Status(StreamHandle* stream, unsigned flags)> cuStreamCreate{library, "cuStreamCreate"};
    Function<Status(StreamHandle stream)> cuStreamSynchronize{library, "cuStreamSynchronize"};
    Function<Status(StreamHandle stream)> cuStreamDestroy{library, "cuStreamDestroy_v2"};
    Function<Status(EventHandle* event, unsigned flags)> cuEventCreate{library, "cuEventCreate"};
    Function<Status(EventHandle event, StreamHandle stream)> cuEventRecord{library, "cuEventRecord"};
    Function<Status(EventHandle event)> cuEventSynchronize{library, "cuEventSynchronize"};
    Function<Status(float* milliseconds, EventHandle begin, EventHandle end)> cuEventElapsedTime{library,
                                                                                                 "cuEventElapsedTime"};
    Function<Status(EventHandle event)> cuEventDestroy{library, "cuEventDestroy_v2"};
    Function<Status(ModuleHandle* module, const void* image, unsigned count, int* options, void** values)>
        cuModuleLoadDataEx{library, "cuModuleLoadDataEx"};
    Function<Status(FunctionHandle* function, ModuleHandle module, const char* name)> cuModuleGetFunction{
        library, "cuModuleGetFunction"};
    Function<Status(ModuleHandle module)> cuModuleUnload{library, "cuModuleUnload"};
    Function<Status(int* value, int attribute, FunctionHandle function)> cuFuncGetAttribute{library,
                                                                                            "cuFuncGetAttribute"};
    Function<Status(Address* memory, std::size_t bytes)> cuMemAlloc{library, "cuMemAlloc_v2"};
    Function<Status(Address memory)> cuMemFree{library, "cuMemFree_v2"};
    Function<Status(void** memory, std::size_t bytes, unsigned flags)> cuMemHostAlloc{library, "cuMemHostAlloc"};
    Function<Status(void* memory)> cuMemFreeHost{library, "cuMemFreeHost"};
    Function<Status(Address to, const void* from, std::size_t bytes, StreamHandle stream)> cuMemcpyHtoDAsync{
        library, "cuMemcpyHtoDAsync_v2"};
    Function<Status(void* to, Address from, std::size_t bytes, StreamHandle stream)> cuMemcpyDtoHAsync{
        library, "cuMemcpyDtoHAsync_v2"};
    Function<Status(Address to, Address from, std::size_t bytes, StreamHandle stream)> cuMemcpyDtoDAsync{
        library, "cuMemcpyDtoDAsync_v2"};
    Function<Status(void* value, int attribute, Address memory)> cuPointerGetAttribute{library,
                                                                                       "cuPointerGetAttribute"};
    Function<Status(FunctionHandle function, unsigned blocks_x, unsigned blocks_y, unsigned blocks_z,
                    unsigned threads_x, unsigned threads_y, unsigned threads_z, unsigned shared_bytes,
                    StreamHandle stream, void** arguments, void** extra)>
        cuLaunchKernel{library, "cuLaunchKernel"};

    /// Why it cannot be used; empty: it can.
    std::string why_not() const {
        if (!library) return "no CUDA driver is installed here (" + std::string(library_name) + ")";
        if (library.missing().empty()) return "";
        return "the CUDA driver is too old: it has no " + library.missing() + "; install one of CUDA 11";
    }
};
inline const Driver& driver() {
    static const Driver installed;
    return installed;
}

/// Throws DeviceError that names what failed, and how.
inline void check(Status status, std::string_view what) {
    if (status == 0) return;
    const char *name = nullptr, *text = nullptr;
    driver().cuGetErrorName(status, &name);
    driver().cuGetErrorString(status, &text);
    throw DeviceError(std::string(what) + ": " + (name ? name : "CUDA status " + std::to_string(status))
                      + (text ? " (" + std::string(text) + ")" : ""));
}

} // namespace raycontact::cuda
