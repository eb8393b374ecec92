// SPDX-License-Identifier: Apache-2.0
#include <recording/file.h>

#include <raycontact/error.h>

#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace raycontact::recording {

namespace {

std::string reason(int error) {
    return std::generic_category().message(error);
}

} // namespace

File File::checked(int descriptor, const std::filesystem::path& path, const char* what, const char* advice) {
    if (descriptor < 0) throw InputError(path.string() + ": " + what + ": " + reason(errno) + "; " + advice);
    File file(descriptor, path);
    struct stat status {};
    if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode))
        throw InputError(path.string() + ": " + what + ": it is not a regular file; " + advice);
    return file;
}

// Without waiting for somebody at the other end, should it be a pipe.
File File::open(const std::filesystem::path& path) {
    return checked(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK), path, "cannot be read",
                   "name a recording made by `raycontact run --record`");
}

File File::create(const std::filesystem::path& path) {
    const char* advice = "name a file in a folder that can be written";
    File file = checked(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666), path,
                        "cannot be written", advice);
    // Emptied only now, when it is known to be a file.
    if (::ftruncate(file.descriptor_, 0) != 0)
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
    if (descriptor_ >= 0) ::close(descriptor_);
}

std::uint64_t File::size() const {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0)
        throw std::runtime_error(path_.string() + ": its size cannot be read: " + reason(errno));
    return static_cast<std::uint64_t>(status.st_size);
}

bool File::read(std::uint64_t offset, std::span<unsigned char> to) const {
    while (!to.empty()) {
        const ssize_t got = ::pread(descriptor_, to.data(), to.size(), static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) throw std::runtime_error(path_.string() + ": cannot be read: " + reason(errno));
        if (got == 0) return false;
        offset += static_cast<std::uint64_t>(got);
        to = to.subspan(static_cast<std::size_t>(got));
    }
    return true;
}

void File::write(std::uint64_t offset, std::span<const unsigned char> bytes) {
    while (!bytes.empty()) {
        const ssize_t put = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) throw std::runtime_error(path_.string() + ": cannot be written: " + reason(errno));
        offset += static_cast<std::uint64_t>(put);
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
}

void File::sync() {
    if (::fsync(descriptor_) != 0) throw std::runtime_error(path_.string() + ": cannot be written: " + reason(errno));
}

} // namespace raycontact::recording
