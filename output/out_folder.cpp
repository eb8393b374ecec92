// SPDX-License-Identifier: Apache-2.0
#include <output/out_folder.h>

#include <raycontact/error.h>

#include <algorithm>
#include <system_error>

namespace fs = std::filesystem;

namespace raycontact::output {

void OutFolder::make(const fs::path& folder) {
    std::error_code error;
    const std::size_t before = made_.size();
    for (fs::path at = folder; !at.empty() && !fs::exists(at, error); at = at.parent_path())
        if (at.has_filename()) made_.insert(made_.begin() + static_cast<std::ptrdiff_t>(before), at);
    fs::create_directories(folder, error);
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored))
        throw InputError(folder.string() + ": cannot be made a folder (" + error.message() + "); name another");
}

OutFolder::OutFolder(const fs::path& folder) : folder_(folder) {
    make(folder);
}

OutFolder::~OutFolder() {
    files_.clear();
    std::error_code ignored;
    std::for_each(made_.rbegin(), made_.rend(), [&](const fs::path& inner) { fs::remove(inner, ignored); });
}

void OutFolder::claim(const std::string& name) {
    if (files_.contains(name)) return;
    const fs::path file = folder_ / name;
    make(file.parent_path());
    files_.emplace(name, Entry{OutFile(file)});
}

void OutFolder::write(const std::string& name, std::string_view bytes) {
    claim(name);
    Entry& entry = files_.at(name);
    entry.file.write(bytes);
    entry.written = true;
}

std::vector<fs::path> OutFolder::keep(bool cut_short) {
    const bool beside =
        cut_short && std::ranges::any_of(files_, [](const auto& named) { return named.second.file.is_there(); });
    ending_ = beside ? ".cut" : "";
    std::vector<fs::path> kept;
    for (auto& [name, entry] : files_)
        if (entry.written) kept.push_back(entry.file.keep(beside));
    files_.clear();
    return kept;
}

fs::path OutFolder::kept(const std::string& name) const {
    fs::path file = folder_ / name;
    return file += ending_;
}

std::vector<fs::path> OutFolder::left_overs() const {
    std::vector<fs::path> all;
    for (const auto& [name, entry] : files_) {
        const std::vector<fs::path> some = entry.file.left_overs();
        all.insert(all.end(), some.begin(), some.end());
    }
    return all;
}

} // namespace raycontact::output
