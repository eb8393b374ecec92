// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>

/// What a recording asks the operating system for; only system_file.cpp includes its headers. Files are the C library's
/// numbers; -1 or false: it failed, and errno says why.
namespace raycontact::recording::system {

int open_to_read(const std::filesystem::path& path);
/// Creates it where it is missing, and keeps what it holds.
int open_to_write(const std::filesystem::path& path);
void close(int file);

/// Not a folder, pipe or device.
bool is_regular(int file);
bool make_empty(int file);
bool size_of(int file, std::uint64_t& bytes);
/// Bytes that were read or written, perhaps fewer than asked for. Several threads may do it at once.
std::ptrdiff_t read_at(int file, std::uint64_t offset, void* to, std::size_t bytes);
std::ptrdiff_t write_at(int file, std::uint64_t offset, const void* from, std::size_t bytes);
/// Waits until the disk has it.
bool sync(int file);

} // namespace raycontact::recording::system
