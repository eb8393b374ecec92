// SPDX-License-Identifier: Apache-2.0
#include "platform/system.h"

#include <cstdlib>
#include <fstream>

#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#include <malloc.h>
#include <windows.h>
#else
#include <dlfcn.h>
#include <unistd.h>
#ifdef __linux__
#include <sched.h>
#endif
#ifdef __GLIBC__
#include <malloc.h>
#endif
#endif

namespace raycontact::platform {

namespace {

std::filesystem::path variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

} // namespace

#ifdef _WIN32

CoreSet thread_cores() {
    // A thread's own mask can only be read by setting another one.
    DWORD_PTR process = 0, system = 0;
    if (GetProcessAffinityMask(GetCurrentProcess(), &process, &system) == 0) return {};
    const DWORD_PTR before = SetThreadAffinityMask(GetCurrentThread(), process);
    if (before != 0) SetThreadAffinityMask(GetCurrentThread(), before);
    return before != 0 ? before : process;
}

bool set_thread_cores(const CoreSet& cores) {
    constexpr CoreSet first_group = ~DWORD_PTR{0};
    if ((cores & first_group) != cores) return false;
    return SetThreadAffinityMask(GetCurrentThread(), static_cast<DWORD_PTR>(cores.to_ullong())) != 0;
}

std::string processor_name() {
    char name[256] = {};
    DWORD bytes = sizeof name;
    const bool known = RegGetValueA(HKEY_LOCAL_MACHINE, R"(HARDWARE\DESCRIPTION\System\CentralProcessor\0)",
                                    "ProcessorNameString", RRF_RT_REG_SZ, nullptr, name, &bytes)
                       == ERROR_SUCCESS;
    return known && name[0] != '\0' ? name : "processor";
}

std::uint64_t physical_memory() {
    MEMORYSTATUSEX status{};
    status.dwLength = sizeof status;
    return GlobalMemoryStatusEx(&status) != 0 ? status.ullTotalPhys : 0;
}

void trim_heap() {
    _heapmin();
}

std::uint64_t process_id() {
    return GetCurrentProcessId();
}

std::filesystem::path cache_folder() {
    return variable("LOCALAPPDATA");
}

// Never from the current folder, where anyone may have left a library of that name. What a library given by its path
// needs may lie beside it.
Library::Library(const std::filesystem::path& name) {
    const bool is_path = name.has_parent_path();
    std::error_code error;
    const std::filesystem::path place = is_path ? std::filesystem::absolute(name, error) : name;
    const DWORD folders = LOAD_LIBRARY_SEARCH_DEFAULT_DIRS | (is_path ? LOAD_LIBRARY_SEARCH_DLL_LOAD_DIR : 0);
    handle_ = LoadLibraryExW(place.c_str(), nullptr, folders);
}

Library::Symbol Library::symbol(const char* name) const {
    return reinterpret_cast<Symbol>(GetProcAddress(static_cast<HMODULE>(handle_), name));
}

#else

#ifdef __linux__
CoreSet thread_cores() {
    cpu_set_t allowed;
    CoreSet cores;
    if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return cores;
    for (std::size_t core = 0; core < cores.size() && core < CPU_SETSIZE; ++core)
        if (CPU_ISSET(core, &allowed)) cores.set(core);
    return cores;
}

bool set_thread_cores(const CoreSet& cores) {
    cpu_set_t wanted;
    CPU_ZERO(&wanted);
    for (std::size_t core = 0; core < cores.size() && core < CPU_SETSIZE; ++core)
        if (cores[core]) CPU_SET(core, &wanted);
    return sched_setaffinity(0, sizeof wanted, &wanted) == 0;
}
#else
CoreSet thread_cores() {
    return {};
}

bool set_thread_cores(const CoreSet& /*cores*/) {
    return false;
}
#endif

std::string processor_name() {
    std::ifstream file("/proc/cpuinfo"); // Linux; elsewhere there is none
    for (std::string text; std::getline(file, text);)
        if (text.starts_with("model name"))
            if (const auto colon = text.find(": "); colon != std::string::npos) return text.substr(colon + 2);
    return "processor";
}

std::uint64_t physical_memory() {
    const long pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGE_SIZE);
    return pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) : 0;
}

void trim_heap() {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}

std::uint64_t process_id() {
    return static_cast<std::uint64_t>(getpid());
}

std::filesystem::path cache_folder() {
    if (auto all = variable("XDG_CACHE_HOME"); all.is_absolute()) return all;
    auto home = variable("HOME");
    return home.empty() ? home : home / ".cache";
}

Library::Library(const std::filesystem::path& name) : handle_(dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL)) {}

Library::Symbol Library::symbol(const char* name) const {
    return reinterpret_cast<Symbol>(dlsym(handle_, name));
}

#endif

} // namespace raycontact::platform
