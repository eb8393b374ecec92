// SPDX-License-Identifier: Apache-2.0
#include "device/cuda/cache.h"

#include "platform/system.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <xxhash.h>

namespace raycontact::cuda {

namespace {

namespace fs = std::filesystem;

// At the beginning of a file: length and hash of what follows.
using Head = std::array<std::uint64_t, 2>;
Head head_of(std::string_view bytes) {
    return {bytes.size(), XXH3_64bits(bytes.data(), bytes.size())};
}

} // namespace

Cache::Cache() {
    const char* own = std::getenv("RAYCONTACT_CACHE");
    if (own && *own != '\0')
        folder_ = own;
    else if (const fs::path all = platform::cache_folder(); !all.empty())
        folder_ = (all / "raycontact").string();
}

std::optional<std::string> Cache::load(const std::string& name) const {
    if (folder_.empty()) return std::nullopt;
    std::ifstream file(fs::path(folder_) / name, std::ios::binary);
    std::ostringstream all; // what throws where it cannot be read is caught in here
    all << file.rdbuf();
    std::string bytes = std::move(all).str();
    Head head{};
    if (bytes.size() < sizeof head) return std::nullopt;
    std::memcpy(head.data(), bytes.data(), sizeof head);
    bytes.erase(0, sizeof head);
    return head == head_of(bytes) ? std::optional(std::move(bytes)) : std::nullopt;
}

void Cache::store(const std::string& name, const std::string& bytes) const {
    if (folder_.empty()) return;
    std::error_code error;
    fs::create_directories(folder_, error);
    // A name that no other process or thread has; renamed when it is whole.
    static std::atomic<unsigned> number = 0;
    const fs::path whole = fs::path(folder_) / name;
    const fs::path part =
        whole.string() + "." + std::to_string(platform::process_id()) + "-" + std::to_string(number++);
    const Head head = head_of(bytes);
    std::ofstream file(part, std::ios::binary);
    file.write(reinterpret_cast<const char*>(head.data()), sizeof head);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (file) fs::rename(part, whole, error);
    if (!file || error) fs::remove(part, error);
}

} // namespace raycontact::cuda
