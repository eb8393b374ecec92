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

} // namespace raycontact::platform
