// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstdint>
#include <filesystem>
#include <string>

/// What the library asks the operating system for. Only this folder's .cpp files include its headers.
namespace raycontact::platform {

#ifdef _WIN32
inline constexpr bool on_windows = true;
#else
inline constexpr bool on_windows = false;
#endif

/// By the system's numbers. On Windows those of one processor group: up to 64.
using CoreSet = std::bitset<1024>;

/// The cores that the calling thread may run on, or none if the system does not say.
CoreSet thread_cores();
/// Returns false, and changes nothing, where the system refuses.
bool set_thread_cores(const CoreSet& cores);

/// As people know it: "processor" if the system does not say.
std::string processor_name();
/// Bytes; 0: unknown.
std::uint64_t physical_memory();
/// Gives the memory that the allocator keeps, though it was freed, back to the system.
void trim_heap();

std::uint64_t process_id();
/// Where a user's programs keep what they can make again; empty: nowhere.
std::filesystem::path cache_folder();

template <typename Signature>
class Function;

/// A shared library, loaded at run time. It stays for as long as the process lives, so to load it again takes no time.
class Library {
public:
    /// By its path, or by a name that the system's loader looks for.
    explicit Library(const std::filesystem::path& name);

    /// Whether it is there and can be loaded.
    explicit operator bool() const { return handle_ != nullptr; }
    /// The last symbol that was sought and that it lacks; empty: none.
    const std::string& missing() const { return missing_; }

private:
    template <typename Signature>
    friend class Function;
    using Symbol = void (*)();
    Symbol symbol(const char* name) const;

    void* handle_;
    std::string missing_;
};

/// A function of a library, which has it under `symbol`. Whoever declares it vouches for the type.
template <typename Result, typename... Parameters>
class Function<Result(Parameters...)> {
public:
    Function(Library& library, const char* symbol)
        : function_(reinterpret_cast<Result (*)(Parameters...)>(library ? library.symbol(symbol) : nullptr)) {
        if (library && !function_) library.missing_ = symbol;
    }
    Result operator()(Parameters... parameters) const { return function_(parameters...); }

private:
    Result (*function_)(Parameters...);
};

} // namespace raycontact::platform
