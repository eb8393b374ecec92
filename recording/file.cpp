// SPDX-License-Identifier: Apache-2.0
#include <recording/file.h>

#include <recording/system_file.h>

#include <raycontact/error.h>

#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

namespace raycontact::recording {

namespace {

std::string reason(int error) {
    return std::generic_category().message(error);
}

} // namespace

File File::checked(int descriptor, const std::filesystem::path& path, const char* what, const char* advice) {
    if (descriptor < 0) throw InputError(path.string() + ": " + what + ": " + reason(errno) + "; " + advice);
    File file(descriptor, path);
    if (!system::is_regular(descriptor))
        throw InputError(path.string() + ": " + what + ": it is not a regular file; " + advice);
    return file;
}

File File::open(const std::filesystem::path& path) {
    return checked(system::open_to_read(path), path, "cannot be read",
                   "name a recording made by `raycontact run --record`");
}

File File::create(const std::filesystem::path& path) {
    const char* advice = "name a file in a folder that can be written";
    File file = checked(system::open_to_write(path), path, "cannot be written", advice);
    // Emptied only now, when it is known to be a file.
    if (!system::make_empty(file.descriptor_))
        throw InputError(path.string() + ": cannot be written: " + reason(errno) + "; " + advice);
    return file;
}

File::File(File&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)), path_(std::move(other.path_)) {}

File& File::operator=(File&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    std::swap(path_, other.path_);
    return *this;
}

File::~File() {
    close();
}

void File::close() {
    if (descriptor_ >= 0) system::close(std::exchange(descriptor_, -1));
}

std::uint64_t File::size() const {
    std::uint64_t bytes = 0;
    if (!system::size_of(descriptor_, bytes))
        throw std::runtime_error(path_.string() + ": its size cannot be read: " + reason(errno));
    return bytes;
}

bool File::read(std::uint64_t offset, std::span<unsigned char> to) const {
    while (!to.empty()) {
        const std::ptrdiff_t got = system::read_at(descriptor_, offset, to.data(), to.size());
        if (got < 0) throw std::runtime_error(path_.string() + ": cannot be read: " + reason(errno));
        if (got == 0) return false;
        offset += static_cast<std::uint64_t>(got);
        to = to.subspan(static_cast<std::size_t>(got));
    }
    return true;
}

void File::write(std::uint64_t offset, std::span<const unsigned char> bytes) {
    while (!bytes.empty()) {
        const std::ptrdiff_t put = system::write_at(descriptor_, offset, bytes.data(), bytes.size());
        if (put <= 0) throw std::runtime_error(path_.string() + ": cannot be written: " + reason(errno));
        offset += static_cast<std::uint64_t>(put);
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
}

void File::sync() {
    if (!system::sync(descriptor_)) throw std::runtime_error(path_.string() + ": cannot be written: " + reason(errno));
}

} // namespace raycontact::recording
