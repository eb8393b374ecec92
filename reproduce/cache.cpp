// SPDX-License-Identifier: Apache-2.0
#include <reproduce/cache.h>

#include <raycontact/error.h>

#include <fmt/format.h>
#include <xxhash.h>

#include <fstream>
#include <stdexcept>

#include <unistd.h>

namespace raycontact::reproduce {

Cache::Cache(const std::filesystem::path& folder) : folder_(folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error || !std::filesystem::is_directory(folder))
        throw InputError(folder.string() + ": cannot be made a folder; name another with --out");
}

std::filesystem::path Cache::file(const std::string& name, const Json& key, const std::string& ending) const {
    const std::string text = key.dump();
    return folder_ / fmt::format("{}-{:016x}{}", name, XXH64(text.data(), text.size(), 0), ending);
}

std::optional<Json> Cache::find(const std::string& name, const Json& key) const {
    std::ifstream in(file(name, key, ".json"), std::ios::binary);
    if (!in) return std::nullopt;
    Json entry = Json::parse(in, nullptr, false);
    if (!entry.is_object() || !entry.contains("result") || entry.value("key", Json()) != key) return std::nullopt;
    return std::move(entry["result"]);
}

void Cache::keep(const std::string& name, const Json& key, const Json& result) const {
    write_whole(file(name, key, ".json"), Json{{"key", key}, {"result", result}}.dump());
}

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
