// SPDX-License-Identifier: Apache-2.0
#include <recording/system_file.h>

#include <cerrno>

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

namespace raycontact::recording::system {

#ifdef _WIN32

namespace {

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
int open_shared(const std::filesystem::path& path, DWORD access, DWORD how, int flags) {
    const HANDLE handle = CreateFileW(path.c_str(), access, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                                      nullptr, how, FILE_ATTRIBUTE_NORMAL, nullptr);
    if (handle == INVALID_HANDLE_VALUE) return failed();
    const int file = _open_osfhandle(reinterpret_cast<std::intptr_t>(handle), flags | _O_BINARY);
    if (file < 0) CloseHandle(handle);
    return file;
}

} // namespace

int open_to_read(const std::filesystem::path& path) {
    return open_shared(path, GENERIC_READ, OPEN_EXISTING, _O_RDONLY);
}

int open_to_write(const std::filesystem::path& path) {
    return open_shared(path, GENERIC_READ | GENERIC_WRITE, OPEN_ALWAYS, _O_RDWR);
}

void close(int file) {
    _close(file);
}

bool is_regular(int file) {
    struct _stat64 status {};
    return _fstat64(file, &status) == 0 && (status.st_mode & _S_IFMT) == _S_IFREG;
}

bool make_empty(int file) {
    return _chsize_s(file, 0) == 0;
}

bool size_of(int file, std::uint64_t& bytes) {
    struct _stat64 status {};
    if (_fstat64(file, &status) != 0) return false;
    bytes = static_cast<std::uint64_t>(status.st_size);
    return true;
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

bool sync(int file) {
    return _commit(file) == 0;
}

#else

// Without waiting for somebody at the other end, should it be a pipe.
int open_to_read(const std::filesystem::path& path) {
    return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
}

int open_to_write(const std::filesystem::path& path) {
    return ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK, 0666);
}

void close(int file) {
    ::close(file);
}

bool is_regular(int file) {
    struct stat status {};
    return ::fstat(file, &status) == 0 && S_ISREG(status.st_mode);
}

bool make_empty(int file) {
    return ::ftruncate(file, 0) == 0;
}

bool size_of(int file, std::uint64_t& bytes) {
    struct stat status {};
    if (::fstat(file, &status) != 0) return false;
    bytes = static_cast<std::uint64_t>(status.st_size);
    return true;
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

bool sync(int file) {
    return ::fsync(file) == 0;
}

#endif

} // namespace raycontact::recording::system
