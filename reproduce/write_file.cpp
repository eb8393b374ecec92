// SPDX-License-Identifier: Apache-2.0
#include <reproduce/write_file.h>

#include <fstream>
#include <stdexcept>

#include <unistd.h>

namespace raycontact::reproduce {

void write_whole(const std::filesystem::path& file, const std::string& bytes) {
    // The process id keeps two programs with one folder from writing into one draft.
    const std::filesystem::path draft = file.string() + "." + std::to_string(::getpid()) + ".part";
    std::ofstream out(draft, std::ios::binary | std::ios::trunc);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    std::error_code error;
    if (out) std::filesystem::rename(draft, file, error);
    if (!out || error) {
        std::filesystem::remove(draft, error);
        throw std::runtime_error(file.string() + ": cannot be written; is the folder writable, is the disk full?");
    }
}

} // namespace raycontact::reproduce
