// SPDX-License-Identifier: Apache-2.0
#include <output/out_file.h>

#include <raycontact/error.h>

#include <algorithm>
#include <cerrno>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace fs = std::filesystem;

namespace raycontact::output {

namespace {

const char* const longest_ending = ".last.part"; // a recording's last draft

fs::path with(const fs::path& path, const std::string& ending) {
    fs::path result = path;
    return result += ending;
}

std::string reason(int error) {
    return std::generic_category().message(error);
}

[[noreturn]] void refuse(const fs::path& name, const std::string& why) {
    throw InputError(name.string() + ": cannot be written: " + why
                     + "; name a file that can be, in a folder that can be written");
}

/// A link's target is what is replaced, not the link.
fs::path behind_links(const fs::path& name) {
    std::error_code error;
    if (!fs::is_symlink(name, error)) return name;
    const fs::path target = fs::weakly_canonical(name, error);
    return error ? name : target;
}

/// As a folder of results is made where it is missing.
void make_folder_of(const fs::path& name) {
    if (!name.has_parent_path()) return;
    std::error_code error;
    fs::create_directories(name.parent_path(), error);
    if (error) refuse(name, "its folder cannot be made: " + error.message());
}

void check_name(const fs::path& name) {
    struct stat status {};
    if (::lstat(with(name, longest_ending).c_str(), &status) != 0 && errno == ENAMETOOLONG)
        refuse(name, std::string("with ") + longest_ending + " at its end the name is too long");
    if (::stat(name.c_str(), &status) != 0) return;
    if (!S_ISREG(status.st_mode)) refuse(name, "it is not a regular file");
    if (::access(name.c_str(), W_OK) != 0) refuse(name, reason(errno));
}

/// Whether the open file is the one that has the name now.
bool is_still(int descriptor, const fs::path& path, struct stat& status) {
    struct stat named {};
    return ::fstat(descriptor, &status) == 0 && ::lstat(path.c_str(), &named) == 0 && status.st_dev == named.st_dev
           && status.st_ino == named.st_ino;
}

void move_aside(const fs::path& name, const fs::path& part) {
    for (int k = 1;; ++k) {
        const fs::path aside = with(with(name, "."), std::to_string(k) + ".part");
        std::error_code error;
        if (fs::exists(fs::symlink_status(aside, error))) continue;
        fs::rename(part, aside, error);
        if (error) refuse(name, part.string() + " was left there and cannot be moved: " + error.message());
        return;
    }
}

/// The part, empty, and locked for as long as it is open.
int claim(const fs::path& name, const fs::path& part) {
    while (true) {
        const int descriptor = ::open(part.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NONBLOCK | O_NOFOLLOW, 0666);
        if (descriptor < 0) refuse(name, reason(errno));
        // Where a file system knows no locks, the claim is worth nothing, but the file is written.
        const bool taken = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
        struct stat status {};
        const bool current = is_still(descriptor, part, status);
        if (!taken && current && S_ISREG(status.st_mode) && status.st_size == 0) return descriptor;
        const bool left = !taken && current && S_ISREG(status.st_mode);
        if (left) move_aside(name, part);
        ::close(descriptor);
        if (taken) refuse(name, "another run is writing it");
        if (current && !left) refuse(name, part.string() + " is in the way");
    }
}

} // namespace

OutFile::OutFile(const fs::path& name) : name_(behind_links(name)), part_(with(name_, ".part")) {
    check_name(name_);
    make_folder_of(name_);
    descriptor_ = claim(name_, part_);
}

OutFile::OutFile(OutFile&& other) noexcept
    : name_(std::move(other.name_)), part_(std::move(other.part_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

OutFile& OutFile::operator=(OutFile&& other) noexcept {
    std::swap(name_, other.name_);
    std::swap(part_, other.part_);
    std::swap(descriptor_, other.descriptor_);
    return *this;
}

OutFile::~OutFile() {
    if (descriptor_ < 0) return;
    std::error_code ignored;
    fs::remove(part_, ignored); // still locked, so it is ours
    close();
}

void OutFile::close() {
    if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
}

std::vector<fs::path> OutFile::left_overs() const {
    std::vector<fs::path> found;
    const std::string start = name_.filename().string() + ".";
    const fs::path folder = name_.has_parent_path() ? name_.parent_path() : fs::path(".");
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        const std::string file = at->path().filename().string();
        if (file.starts_with(start) && file.ends_with(".part") && file != part_.filename())
            found.push_back(name_.has_parent_path() ? at->path() : at->path().filename());
    }
    std::sort(found.begin(), found.end());
    return found;
}

bool OutFile::is_there() const {
    std::error_code error;
    return fs::exists(fs::symlink_status(name_, error));
}

void OutFile::write(std::string_view bytes) {
    const auto fail = [&] { throw std::runtime_error(name_.string() + ": cannot be written: " + reason(errno)); };
    off_t at = 0;
    while (!bytes.empty()) {
        const ssize_t put = ::pwrite(descriptor_, bytes.data(), bytes.size(), at);
        if (put < 0 && errno == EINTR) continue;
        if (put <= 0) fail();
        at += put;
        bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    if (::ftruncate(descriptor_, at) != 0 || ::fsync(descriptor_) != 0) fail();
}

fs::path OutFile::keep(bool as_cut) {
    fs::path kept = as_cut ? with(name_, ".cut") : name_;
    std::error_code error;
    fs::rename(part_, kept, error);
    if (error)
        throw std::runtime_error(kept.string() + ": cannot be written: " + error.message() + "; it is still "
                                 + part_.string());
    close();
    return kept;
}

void OutFile::leave() {
    close();
}

} // namespace raycontact::output
