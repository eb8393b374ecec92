// SPDX-License-Identifier: Apache-2.0
// A driver whose device memory is host memory. It runs no kernel, and copies as late as it may: when somebody waits.
#include "device/cuda/fakes.h"
#include "device/cuda/image_reader.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <set>

using namespace raycontact::cuda_test;

namespace {

using Address = unsigned long long;

struct Copy {
    std::byte* to = nullptr;
    const std::byte* from = nullptr;
    std::size_t bytes = 0;
};
struct Stream {
    std::deque<Copy> pending;
    std::size_t done = 0;
};
struct Event {
    Stream* stream = nullptr;
    std::size_t after = 0; ///< copies of the stream
};
struct Function {
    std::string name;
    std::vector<bool> pointers;
};
struct Module {
    std::string image;
    std::map<std::string, Function> functions;
};
using Bytes = std::vector<std::byte>;

struct State : FakeCuda {
    std::map<const std::byte*, Bytes> memory, host;
    std::map<const void*, std::unique_ptr<Stream>> streams;
    Stream default_stream; ///< null
    std::map<const void*, std::unique_ptr<Event>> events;
    std::map<const void*, std::unique_ptr<Module>> modules;
    int retained = 0, current = 0;

    void count_alive() {
        alive = memory.size() + host.size() + streams.size() + events.size() + modules.size() + retained + current;
    }
};

State& fake() {
    static State state;
    state.reset = [] {
        state = {};
        fake(); // sets this again
    };
    return state;
}

constexpr int error = 999, invalid = 1;

// Not for a call that needs no context.
bool misused(const char* name, bool wrong) {
    if (fake().current == 0) fake().misuse.push_back(std::string(name) + " without a context");
    if (wrong) fake().misuse.push_back(std::string(name) + " of what is not there");
    return wrong || fake().current == 0;
}

bool lies_in(const std::map<const std::byte*, Bytes>& places, const void* at, std::size_t bytes) {
    const auto* begin = static_cast<const std::byte*>(at);
    auto next = places.upper_bound(begin);
    if (next == places.begin()) return false;
    const auto& [place, content] = *--next;
    return begin + bytes <= place + content.size();
}
void* pointer(Address address) {
    return reinterpret_cast<void*>(address);
}

// Null: there is none.
Stream* find_stream(Stream* handle) {
    if (handle == nullptr) return &fake().default_stream;
    return fake().streams.count(handle) ? handle : nullptr;
}

void run_until(Stream& stream, std::size_t after) {
    for (; stream.done < after && !stream.pending.empty(); ++stream.done) {
        const Copy& copy = stream.pending.front();
        std::memmove(copy.to, copy.from, copy.bytes);
        stream.pending.pop_front();
    }
}

int enqueue(const char* name, Stream* stream, void* to, const void* from, std::size_t bytes, bool wrong) {
    if (misused(name, wrong || !find_stream(stream) || bytes == 0)) return invalid;
    find_stream(stream)->pending.push_back({static_cast<std::byte*>(to), static_cast<const std::byte*>(from), bytes});
    return 0;
}

template <typename T>
int make(std::map<const void*, std::unique_ptr<T>>& owners, T** made, T content) {
    auto object = std::make_unique<T>(std::move(content));
    *made = object.get();
    owners.emplace(*made, std::move(object));
    fake().count_alive();
    return 0;
}
template <typename Owners, typename Key>
int release(const char* name, Owners& owners, Key key) {
    if (misused(name, !owners.count(key))) return invalid;
    owners.erase(key);
    fake().count_alive();
    return 0;
}

template <typename At>
int allocate(std::map<const std::byte*, Bytes>& places, std::size_t bytes, At& at) {
    Bytes content(bytes, std::byte{0xcd});
    std::byte* begin = content.data();
    places.emplace(begin, std::move(content));
    if constexpr (std::is_pointer_v<At>)
        at = begin;
    else
        at = reinterpret_cast<Address>(begin);
    fake().count_alive();
    return 0;
}

int free_memory(const char* name, std::map<const std::byte*, Bytes>& places, const void* at) {
    const auto* begin = static_cast<const std::byte*>(at);
    if (misused(name, !places.count(begin))) return invalid;
    const std::byte* end = begin + places.at(begin).size();
    for (const auto& [key, stream] : fake().streams)
        for (const Copy& copy : stream->pending)
            for (const std::byte* used : {static_cast<const std::byte*>(copy.to), copy.from})
                if (used >= begin && used < end) fake().misuse.push_back(std::string(name) + " of memory in use");
    return release(name, places, begin);
}

} // namespace

#define ENTER                                                                                                          \
    if (fake().enter(__func__)) return error

extern "C" {

FakeCuda* raycontact_fake_cuda() {
    return &fake();
}

int cuInit(unsigned) {
    ENTER;
    return 0;
}
int cuDriverGetVersion(int* version) {
    ENTER;
    *version = fake().version;
    return 0;
}
int cuGetErrorName(int status, const char** text) {
    ENTER;
    *text = status == invalid ? "CUDA_ERROR_INVALID_VALUE" : "CUDA_ERROR_FAKE";
    return 0;
}
int cuGetErrorString(int, const char** text) {
    ENTER;
    *text = "it was told to fail";
    return 0;
}
int cuDeviceGetCount(int* count) {
    ENTER;
    *count = fake().devices;
    return 0;
}
int cuDeviceGet(int* device, int index) {
    ENTER;
    *device = 40 + index;
    return 0;
}
int cuDeviceGetName(char* text, int, int) {
    ENTER;
    std::strcpy(text, "Test GPU");
    return 0;
}
int cuDeviceGetPCIBusId(char* text, int, int device) {
    ENTER;
    std::strcpy(text, ("0000:6A:0" + std::to_string(device - 40) + ".0").c_str());
    return 0;
}
int cuDeviceGetAttribute(int* value, int attribute, int) {
    ENTER;
    *value = attribute == 16   ? 132
             : attribute == 75 ? fake().architecture / 10
             : attribute == 76 ? fake().architecture % 10
                               : -1;
    return 0;
}
int cuDeviceTotalMem_v2(std::size_t* bytes, int) {
    ENTER;
    *bytes = std::size_t{80} << 30;
    return 0;
}
int cuDevicePrimaryCtxRetain(void** context, int) {
    ENTER;
    *context = &fake();
    ++fake().retained;
    fake().count_alive();
    return 0;
}
int cuDevicePrimaryCtxRelease_v2(int) {
    ENTER;
    --fake().retained;
    fake().count_alive();
    return 0;
}
int cuCtxPushCurrent_v2(void* context) {
    ENTER;
    if (context != &fake() || fake().retained == 0) fake().misuse.emplace_back("no such context");
    ++fake().current;
    fake().count_alive();
    return 0;
}
int cuCtxPopCurrent_v2(void** context) {
    ENTER;
    *context = &fake();
    --fake().current;
    fake().count_alive();
    return 0;
}
int cuCtxSynchronize() {
    ENTER;
    if (misused(__func__, false)) return invalid;
    run_until(fake().default_stream, ~std::size_t{0});
    for (auto& [handle, stream] : fake().streams) run_until(*stream, ~std::size_t{0});
    return 0;
}
int cuStreamCreate(Stream** stream, unsigned) {
    ENTER;
    return misused(__func__, false) ? invalid : make(fake().streams, stream, Stream());
}
int cuStreamSynchronize(Stream* stream) {
    ENTER;
    if (misused(__func__, !find_stream(stream))) return invalid;
    run_until(*find_stream(stream), ~std::size_t{0});
    return 0;
}
int cuStreamDestroy_v2(Stream* stream) {
    ENTER;
    return release(__func__, fake().streams, stream);
}
int cuEventCreate(Event** event, unsigned) {
    ENTER;
    return misused(__func__, false) ? invalid : make(fake().events, event, Event());
}
int cuEventRecord(Event* event, Stream* stream) {
    ENTER;
    if (misused(__func__, !fake().events.count(event) || !fake().streams.count(stream))) return invalid;
    *event = {stream, stream->done + stream->pending.size()};
    return 0;
}
int cuEventSynchronize(Event* event) {
    ENTER;
    if (misused(__func__, !fake().events.count(event) || !event->stream)) return invalid;
    run_until(*event->stream, event->after);
    return 0;
}
int cuEventElapsedTime(float* milliseconds, Event* begin, Event* end) {
    ENTER;
    if (misused(__func__, !begin->stream || !end->stream || end->after > end->stream->done)) return invalid;
    *milliseconds = 0.5F;
    return 0;
}
int cuEventDestroy_v2(Event* event) {
    ENTER;
    return release(__func__, fake().events, event);
}
int cuModuleLoadDataEx(Module** module, const void* image, unsigned, int*, void** values) {
    ENTER;
    const std::string text = static_cast<const char*>(image);
    const std::string why = refuses(text, fake().version, fake().architecture);
    if (!why.empty()) std::strcpy(static_cast<char*>(values[0]), why.c_str());
    return misused(__func__, false) || !why.empty() ? error : make(fake().modules, module, Module{text, {}});
}
int cuModuleGetFunction(Function** function, Module* module, const char* name) {
    ENTER;
    const std::vector<bool> pointers = parameters_of(module->image, name);
    if (misused(__func__, !fake().modules.count(module) || pointers.empty())) return invalid;
    *function = &(module->functions[name] = {name, pointers});
    return 0;
}
int cuModuleUnload(Module* module) {
    ENTER;
    return release(__func__, fake().modules, module);
}
int cuFuncGetAttribute(int* value, int attribute, Function*) {
    ENTER;
    *value = attribute == 0 ? 1024 : -1;
    return 0;
}
int cuMemAlloc_v2(Address* address, std::size_t bytes) {
    ENTER;
    return misused(__func__, bytes == 0) ? invalid : allocate(fake().memory, bytes, *address);
}
int cuMemFree_v2(Address address) {
    ENTER;
    return free_memory(__func__, fake().memory, pointer(address));
}
int cuMemHostAlloc(void** memory, std::size_t bytes, unsigned) {
    ENTER;
    return misused(__func__, bytes == 0) ? invalid : allocate(fake().host, bytes, *memory);
}
int cuMemFreeHost(void* memory) {
    ENTER;
    return free_memory(__func__, fake().host, memory);
}
int cuMemcpyHtoDAsync_v2(Address to, const void* from, std::size_t bytes, Stream* stream) {
    ENTER;
    return enqueue(__func__, stream, pointer(to), from, bytes, !lies_in(fake().memory, pointer(to), bytes));
}
int cuMemcpyDtoHAsync_v2(void* to, Address from, std::size_t bytes, Stream* stream) {
    ENTER;
    return enqueue(__func__, stream, to, pointer(from), bytes, !lies_in(fake().memory, pointer(from), bytes));
}
int cuMemcpyDtoDAsync_v2(Address to, Address from, std::size_t bytes, Stream* stream) {
    ENTER;
    const bool there = lies_in(fake().memory, pointer(to), bytes) && lies_in(fake().memory, pointer(from), bytes);
    return enqueue(__func__, stream, pointer(to), pointer(from), bytes, !there);
}
int cuPointerGetAttribute(void* value, int attribute, Address memory) {
    ENTER;
    constexpr int ordinal = 9;
    if (attribute != ordinal || !lies_in(fake().memory, pointer(memory), 1)) return invalid;
    *static_cast<int*>(value) = 0;
    return 0;
}
int cuLaunchKernel(Function* function, unsigned groups, unsigned y, unsigned z, unsigned group_size, unsigned threads_y,
                   unsigned threads_z, unsigned, Stream* stream, void** arguments, void**) {
    ENTER;
    const bool flat = y == 1 && z == 1 && threads_y == 1 && threads_z == 1;
    const bool fits = groups > 0 && group_size > 0 && group_size <= 1024;
    if (misused(__func__, !flat || !fits || !fake().streams.count(stream))) return invalid;
    Launch launch{function->name, groups, group_size, {}};
    for (std::size_t i = 0; i < function->pointers.size(); ++i) {
        std::uint64_t value = 0;
        std::memcpy(&value, arguments[i], function->pointers[i] ? 8 : 4);
        if (function->pointers[i] && value != 0 && misused(__func__, !lies_in(fake().memory, pointer(value), 1)))
            return invalid;
        launch.arguments.push_back(value);
    }
    fake().launches.push_back(std::move(launch));
    return 0;
}

} // extern "C"
