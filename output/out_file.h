// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace raycontact::output {

/// A file that is written as NAME.part and takes its name when it is whole: what was there before stays until then.
/// Nobody else can claim the name while this lives, in this process or another. Move-only.
class OutFile {
public:
    /// Claims the name: makes its folder where missing, and NAME.part, empty. Throws InputError naming the file where
    /// that cannot be, where the name has no room for its endings, where something other than a file of ours to write
    /// has it, or where another run has claimed it. A NAME.part that a run left is moved aside, to NAME.1.part, ...
    explicit OutFile(const std::filesystem::path& name);
    OutFile(OutFile&& other) noexcept;
    OutFile& operator=(OutFile&& other) noexcept;
    ~OutFile(); ///< removes NAME.part, unless it was kept or left

    const std::filesystem::path& name() const { return name_; }
    const std::filesystem::path& part() const { return part_; } ///< where to write
    /// What ended runs left of this name.
    std::vector<std::filesystem::path> left_overs() const;
    bool is_there() const; ///< a file of that name

    /// All there is to write, down to the disk. Throws std::runtime_error naming the file: a full disk is no bad input.
    void write(std::string_view bytes);
    /// NAME.part becomes NAME, or NAME.cut beside it; returns which. Throws std::runtime_error naming the file.
    std::filesystem::path keep(bool as_cut = false);
    /// NAME.part stays as it is, for a person to use.
    void leave();

private:
    void close();
    std::filesystem::path name_, part_;
    int descriptor_ = -1; ///< of the part, locked
};

} // namespace raycontact::output
