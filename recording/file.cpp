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
#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#ifndef NOMINMAX // MinGW has it
#define NOMINMAX
#endif
#include <algorithm>
#include <io.h>
#include <windows.h>
#else
#include <unistd.h>
#endif

namespace raycontact::recording {

namespace {

// Of the C library's numbers of files; where one fails, errno says why.
#ifdef _WIN32

using Status = struct _stat64;
auto* const close_file = _close;
auto* const sync_file = _commit;
constexpr unsigned kinds_of_files = _S_IFMT, regular = _S_IFREG;
bool make_empty(int file) {
    return _chsize_s(file, 0) == 0;
}
bool find_status(int file, Status& status) {
    return _fstat64(file, &status) == 0;
}

HANDLE handle_of(int file) {
    return reinterpret_cast<HANDLE>(_get_osfhandle(file));
}

OVERLAPPED place(std::uint64_t offset) {
    OVERLAPPED place{};
    place.Offset = static_cast<DWORD>(offset);
    place.OffsetHigh = static_cast<DWORD>(offset >> 32);
    return place;
}

DWORD at_once(std::size_t bytes) {
    return static_cast<DWORD>(std::min<std::size_t>(bytes, 1u << 30));
}

int failed() {
    switch (GetLastError()) {
    case ERROR_DISK_FULL:
        errno = ENOSPC;
        break;
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_NAME:
        errno = ENOENT;
        break;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
    case ERROR_WRITE_PROTECT:
        errno = EACCES;
        break;
    default:
        errno = EIO;
    }
    return -1;
}

// Others may read, rename or remove it meanwhile, as elsewhere; the C library's own functions forbid it.
int open_shared(const std::filesystem::path& path, bool to_write) {
    const HANDLE handle = CreateFileW(path.c_str(), GENERIC_READ | (to_write ? GENERIC_WRITE : 0),
                                      FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr,
                                      to_write ? OPEN_ALWAYS : OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
    if (handle == INVALID_HANDLE_VALUE) return failed();
    const int file =
        _open_osfhandle(reinterpret_cast<std::intptr_t>(handle), (to_write ? _O_RDWR : _O_RDONLY) | _O_BINARY);
    if (file < 0) CloseHandle(handle);
    return file;
}

std::ptrdiff_t read_at(int file, std::uint64_t offset, void* to, std::size_t bytes) {
    OVERLAPPED at = place(offset);
    DWORD done = 0;
    if (ReadFile(handle_of(file), to, at_once(bytes), &done, &at) == 0 && GetLastError() != ERROR_HANDLE_EOF)
        return failed();
    return static_cast<std::ptrdiff_t>(done);
}

std::ptrdiff_t write_at(int file, std::uint64_t offset, const void* from, std::size_t bytes) {
    OVERLAPPED at = place(offset);
    DWORD done = 0;
    if (WriteFile(handle_of(file), from, at_once(bytes), &done, &at) == 0) return failed();
    return static_cast<std::ptrdiff_t>(done);
}

#else

using Status = struct stat;
auto* const close_file = ::close;
auto* const sync_file = ::fsync;
constexpr unsigned kinds_of_files = S_IFMT, regular = S_IFREG;
bool make_empty(int file) {
    return ::ftruncate(file, 0) == 0;
}
bool find_status(int file, Status& status) {
    return ::fstat(file, &status) == 0;
}

// Without waiting for somebody at the other end, should it be a pipe.
int open_shared(const std::filesystem::path& path, bool to_write) {
    return ::open(path.c_str(), (to_write ? O_RDWR | O_CREAT : O_RDONLY) | O_CLOEXEC | O_NONBLOCK, 0666);
}

std::ptrdiff_t read_at(int file, std::uint64_t offset, void* to, std::size_t bytes) {
    for (;;)
        if (const ssize_t got = ::pread(file, to, bytes, static_cast<off_t>(offset)); got >= 0 || errno != EINTR)
            return got;
}

std::ptrdiff_t write_at(int file, std::uint64_t offset, const void* from, std::size_t bytes) {
    for (;;)
        if (const ssize_t put = ::pwrite(file, from, bytes, static_cast<off_t>(offset)); put >= 0 || errno != EINTR)
            return put;
}

#endif

std::string reason() {
    return std::generic_category().message(errno);
}

} // namespace

File File::checked(int descriptor, const std::filesystem::path& path, const char* what, const char* advice) {
    if (descriptor < 0) throw InputError(path.string() + ": " + what + ": " + reason() + "; " + advice);
    File file(descriptor, path);
    Status status{};
    if (!find_status(descriptor, status) || (status.st_mode & kinds_of_files) != regular)
        throw InputError(path.string() + ": " + what + ": it is not a regular file; " + advice);
    return file;
}

File File::open(const std::filesystem::path& path) {
    return checked(open_shared(path, false), path, "cannot be read",
                   "name a recording made by `raycontact run --record`");
}

File File::create(const std::filesystem::path& path) {
    const char* advice = "name a file in a folder that can be written";
    File file = checked(open_shared(path, true), path, "cannot be written", advice);
    // Emptied only now, when it is known to be a file.
    if (!make_empty(file.descriptor_))
        throw InputError(path.string() + ": cannot be written: " + reason() + "; " + advice);
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
    if (descriptor_ >= 0) close_file(std::exchange(descriptor_, -1));
}

std::uint64_t File::size() const {
    Status status{};
    if (!find_status(descriptor_, status))
        throw std::runtime_error(path_.string() + ": its size cannot be read: " + reason());
    return static_cast<std::uint64_t>(status.st_size);
}

bool File::read(std::uint64_t offset, std::span<unsigned char> to) const {
    while (!to.empty()) {
        const std::ptrdiff_t got = read_at(descriptor_, offset, to.data(), to.size());
        if (got < 0) throw std::runtime_error(path_.string() + ": cannot be read: " + reason());
        if (got == 0) return false;
        offset += static_cast<std::uint64_t>(got);
        to = to.subspan(static_cast<std::size_t>(got));
    }
    return true;
}

void File::write(std::uint64_t offset, std::span<const unsigned char> bytes) {
    while (!bytes.empty()) {
        const std::ptrdiff_t put = write_at(descriptor_, offset, bytes.data(), bytes.size());
        if (put <= 0) throw std::runtime_error(path_.string() + ": cannot be written: " + reason());
        offset += static_cast<std::uint64_t>(put);
        bytes = bytes.subspan(static_cast<std::size_t>(put));
    }
}

void File::sync() {
    if (sync_file(descriptor_) != 0) throw std::runtime_error(path_.string() + ": cannot be written: " + reason());
}

} // namespace raycontact::recording
