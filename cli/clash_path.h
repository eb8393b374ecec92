// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/clash.h>

#include <span>
#include <string>
#include <vector>

namespace raycontact {

/// What moves in `clash`, and where: --along and --range.
struct ClashPath {
    std::vector<std::string> moving; ///< patterns
    std::vector<Pose> moves;         ///< from where the files place it
    double first = 0, step = 1;      ///< of the value that is printed: at time 0, and by unit of time
    std::string word;                ///< before that value, as "pose", or after it, as "deg"
    bool word_is_first = false;

    std::string at(double time) const;
};

/// Of a file: {"moving": "NAME" or [...], "moves": [[16 numbers, row-major], ...]}, or "poses" in place of "moves", of
/// one part, which loses the pose that it has. Throws InputError that names what is wrong.
ClashPath clash_path_along(const std::string& file, std::vector<AssemblyPart>& parts);

/// Of words: NAME=turn:AXIS:POINT:FROM:TO in degrees, or NAME=slide:WAY:FROM:TO in lengths. Throws InputError.
ClashPath clash_path_of_range(const std::string& words, const std::string& unit);

/// A line each; --json: a line of JSON each.
std::string path_table(const PathClashReport& report, std::span<const AssemblyPart> parts, const ClashPath& path,
                       const std::string& unit);
std::string path_json(const PathClashReport& report, std::span<const AssemblyPart> parts, const ClashPath& path);
std::string path_summary(const PathClashReport& report, std::span<const AssemblyPart> parts, const ClashPath& path,
                         const std::string& unit);

} // namespace raycontact
