// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "device/device.h"
#include "platform/library.h"

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

struct Driver;

/// A function of the driver; the driver's library has it under `symbol`, whose suffix is part of the binary interface:
/// without it, several of these are older functions.
template <typename Signature>
class Function;
template <typename... Parameters>
class Function<Status(Parameters...)> {
public:
    Function(Driver& driver, const char* symbol);
    Status operator()(Parameters... parameters) const { return function_(parameters...); }

private:
    Status (*function_)(Parameters...) = nullptr;
};

/// The driver that is installed, its functions named as in NVIDIA's documentation. Its library is loaded once and kept
/// for the process.
struct Driver {
    Driver();

    std::string why_not; ///< empty: it is there
    platform::Library library;
    Function<Status(unsigned flags)> cuInit{*this, "cuInit"};
    Function<Status(int* version)> cuDriverGetVersion{*this, "cuDriverGetVersion"}; ///< 1000 * major + 10 * minor
    Function<Status(Status status, const char** text)> cuGetErrorName{*this, "cuGetErrorName"};
    Function<Status(Status status, const char** text)> cuGetErrorString{*this, "cuGetErrorString"};
    Function<Status(int* count)> cuDeviceGetCount{*this, "cuDeviceGetCount"};
    Function<Status(DeviceNumber* device, int index)> cuDeviceGet{*this, "cuDeviceGet"};
    Function<Status(char* text, int size, DeviceNumber device)> cuDeviceGetName{*this, "cuDeviceGetName"};
    Function<Status(char* text, int size, DeviceNumber device)> cuDeviceGetPCIBusId{*this, "cuDeviceGetPCIBusId"};
    Function<Status(int* value, int attribute, DeviceNumber device)> cuDeviceGetAttribute{*this,
                                                                                          "cuDeviceGetAttribute"};
    Function<Status(std::size_t* bytes, DeviceNumber device)> cuDeviceTotalMem{*this, "cuDeviceTotalMem_v2"};
    Function<Status(ContextHandle* context, DeviceNumber device)> cuDevicePrimaryCtxRetain{*this,
                                                                                           "cuDevicePrimaryCtxRetain"};
    Function<Status(DeviceNumber device)> cuDevicePrimaryCtxRelease{*this, "cuDevicePrimaryCtxRelease_v2"};
    Function<Status(ContextHandle context)> cuCtxPushCurrent{*this, "cuCtxPushCurrent_v2"};
    Function<Status(ContextHandle* context)> cuCtxPopCurrent{*this, "cuCtxPopCurrent_v2"};
    Function<Status(StreamHandle* stream, unsigned flags)> cuStreamCreate{*this, "cuStreamCreate"};
    Function<Status(StreamHandle stream)> cuStreamSynchronize{*this, "cuStreamSynchronize"};
    Function<Status(StreamHandle stream)> cuStreamDestroy{*this, "cuStreamDestroy_v2"};
    Function<Status(EventHandle* event, unsigned flags)> cuEventCreate{*this, "cuEventCreate"};
    Function<Status(EventHandle event, StreamHandle stream)> cuEventRecord{*this, "cuEventRecord"};
    Function<Status(EventHandle event)> cuEventSynchronize{*this, "cuEventSynchronize"};
    Function<Status(float* milliseconds, EventHandle begin, EventHandle end)> cuEventElapsedTime{*this,
                                                                                                 "cuEventElapsedTime"};
    Function<Status(EventHandle event)> cuEventDestroy{*this, "cuEventDestroy_v2"};
    Function<Status(ModuleHandle* module, const void* image, unsigned count, int* options, void** values)>
        cuModuleLoadDataEx{*this, "cuModuleLoadDataEx"};
    Function<Status(FunctionHandle* function, ModuleHandle module, const char* name)> cuModuleGetFunction{
        *this, "cuModuleGetFunction"};
    Function<Status(ModuleHandle module)> cuModuleUnload{*this, "cuModuleUnload"};
    Function<Status(int* value, int attribute, FunctionHandle function)> cuFuncGetAttribute{*this,
                                                                                            "cuFuncGetAttribute"};
    Function<Status(Address* memory, std::size_t bytes)> cuMemAlloc{*this, "cuMemAlloc_v2"};
    Function<Status(Address memory)> cuMemFree{*this, "cuMemFree_v2"};
    Function<Status(void** memory, std::size_t bytes, unsigned flags)> cuMemHostAlloc{*this, "cuMemHostAlloc"};
    Function<Status(void* memory)> cuMemFreeHost{*this, "cuMemFreeHost"};
    Function<Status(Address to, const void* from, std::size_t bytes, StreamHandle stream)> cuMemcpyHtoDAsync{
        *this, "cuMemcpyHtoDAsync_v2"};
    Function<Status(void* to, Address from, std::size_t bytes, StreamHandle stream)> cuMemcpyDtoHAsync{
        *this, "cuMemcpyDtoHAsync_v2"};
    Function<Status(Address to, Address from, std::size_t bytes, StreamHandle stream)> cuMemcpyDtoDAsync{
        *this, "cuMemcpyDtoDAsync_v2"};
    Function<Status(FunctionHandle function, unsigned blocks_x, unsigned blocks_y, unsigned blocks_z,
                    unsigned threads_x, unsigned threads_y, unsigned threads_z, unsigned shared_bytes,
                    StreamHandle stream, void** arguments, void** extra)>
        cuLaunchKernel{*this, "cuLaunchKernel"};
};
const Driver& driver();

template <typename... Parameters>
Function<Status(Parameters...)>::Function(Driver& driver, const char* symbol) {
    if (!driver.library) return;
    driver.library.find(symbol, function_);
    if (!function_)
        driver.why_not = "the CUDA driver is too old: it has no " + std::string(symbol) + "; install one of CUDA 11";
}

/// Throws DeviceError that names what failed, and how.
void check(Status status, std::string_view what);

} // namespace raycontact::cuda
