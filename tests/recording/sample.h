// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/block.h>
#include <recording/reader.h>
#include <recording/writer.h>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

/// What a recording should hold: bodies that come and go, poses with all 53 bits in use, pairs that change.
struct Sample {
    raycontact::recording::Info info;
    std::vector<std::shared_ptr<const raycontact::Shape>> shapes;
    std::vector<raycontact::recording::Body> bodies;
    std::vector<std::vector<raycontact::Pose>> poses; ///< by step, then body
    std::vector<std::vector<raycontact::Pair>> pairs; ///< by step, sorted, each once
    std::string hash = "0123456789abcdef";

    std::uint32_t steps() const { return static_cast<std::uint32_t>(poses.size()); }
};

/// Seven bodies: 0 never moves, 5 comes at step 7, 2 goes at step 12, 6 comes at step 9 and goes at step 20.
Sample make_sample(std::uint32_t steps);

/// Hands the steps from `first` on to a writer, shapes and bodies as they come.
class Feeder {
public:
    Feeder(const Sample& sample, raycontact::recording::Writer& writer);
    void step(); ///< the next one
    std::uint32_t steps() const { return next_; }

private:
    const Sample& sample_;
    raycontact::recording::Writer& writer_;
    std::uint32_t next_ = 0;
};

/// All of it; with or without its end.
void record(const Sample& sample, const std::filesystem::path& file, bool finish,
            const raycontact::recording::WriterOptions& options = {5, 1e9, std::uint64_t{128} << 20});

/// Empty when the recording holds exactly the sample's first `steps` steps, else the first thing that differs.
std::string difference(const Sample& sample, raycontact::recording::Reader& reader, std::uint32_t steps);

/// A file name of its own, gone with the test.
class TemporaryFile {
public:
    TemporaryFile();
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

std::vector<unsigned char> bytes_of(const std::filesystem::path& file);
void write_bytes(const std::filesystem::path& file, const std::vector<unsigned char>& bytes);

/// Where the side chunk's header starts; the file's length where there is none.
std::size_t side_chunk_at(const std::vector<unsigned char>& glb);

/// Changes the JSON of the blocks of this type; everything around them, checksums too, is as it should be.
void edit_json(const std::filesystem::path& file, raycontact::recording::BlockType type,
               const std::function<void(nlohmann::ordered_json&)>& change);
