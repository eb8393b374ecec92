// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <output/out_file.h>

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact::output {

/// A folder of results, all of which take their names together, when they are whole.
class OutFolder {
public:
    /// Makes the folder where missing. Throws InputError naming it.
    explicit OutFolder(const std::filesystem::path& folder);
    ~OutFolder(); ///< removes the folders it made, where nothing came into them
    OutFolder(const OutFolder&) = delete;
    OutFolder& operator=(const OutFolder&) = delete;

    /// Claims a file before the work that fills it: what cannot be written is known at once. Throws as OutFile does.
    void claim(const std::string& name);
    /// Claims the file, if that was not done before, and writes all of it. Throws as OutFile does.
    void write(const std::string& name, std::string_view bytes);
    /// What was written takes its name; NAME.cut, all of it, where results were cut short and any of the names exists.
    /// Returns where it all is now.
    std::vector<std::filesystem::path> keep(bool cut_short = false);

    std::filesystem::path kept(const std::string& name) const; ///< where it is, after keep()
    std::vector<std::filesystem::path> left_overs() const;     ///< what ended runs left of the claimed names

private:
    struct Entry {
        OutFile file;
        bool written = false;
    };
    void make(const std::filesystem::path& folder);
    std::filesystem::path folder_;
    std::vector<std::filesystem::path> made_; ///< outermost first
    std::string ending_;
    std::map<std::string, Entry> files_;
};

} // namespace raycontact::output
