// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/pose.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

/// One body of a pair of a batch query.
struct PairBody {
    std::filesystem::path file;
    raycontact::Pose pose;
    double scale = 1;  ///< of the file's coordinates, about the body's origin; > 0, finite
    std::string where; ///< for messages: "pairs.json: pair 3, b"; empty on the command line
};

/// What `collide` is to test: bodies 0 (a) and 1 (b), as given.
using QueryPair = std::array<PairBody, 2>;

/// Reads a batch query: [{"a": file, "b": file, "pose_a": [16 numbers, row-major], "pose_b": ..., "scale_a": number,
/// "scale_b": number}, ...]; paths are relative to the file. Throws InputError naming the file, the pair and the key
/// (or the line) for whatever is not exactly that. Mesh files are not opened here.
std::vector<QueryPair> read_pairs_file(const std::filesystem::path& file);
