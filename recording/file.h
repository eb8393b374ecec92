// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace raycontact::recording {

/// An open regular file, read and written at given places. Move-only.
class File {
public:
    /// Throws InputError naming the file where it cannot be opened or is no regular file.
    static File open(const std::filesystem::path& path);
    /// Empties what was there; readable too. Throws InputError likewise.
    static File create(const std::filesystem::path& path);

    File(File&& other) noexcept;
    File& operator=(File&& other) noexcept;
    ~File();

    std::uint64_t size() const;
    /// All of `to`, or false where the file ends before.
    bool read(std::uint64_t offset, std::span<unsigned char> to) const;
    /// Throws std::runtime_error naming the file: a full disk is a failed run, not bad input.
    void write(std::uint64_t offset, std::span<const unsigned char> bytes);
    /// Waits until the disk has it.
    void sync();
    void close();
    const std::filesystem::path& path() const { return path_; }

private:
    File(int descriptor, std::filesystem::path path) : descriptor_(descriptor), path_(std::move(path)) {}
    static File checked(int descriptor, const std::filesystem::path& path, const char* what, const char* advice);

    int descriptor_ = -1;
    std::filesystem::path path_;
};

} // namespace raycontact::recording
