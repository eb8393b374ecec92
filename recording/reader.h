// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/block.h>
#include <recording/file.h>
#include <recording/live_bodies.h>
#include <recording/recording.h>
#include <recording/step_codec.h>

#include <raycontact/scene.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace raycontact::recording {

/// Reads a recording, finished or not, also while it is written (then what was flushed when it was opened). Keeps one
/// block of steps in memory. Every byte it relies on is checked when it is opened: InputError names the file and the
/// place of damage.
class Reader {
public:
    /// Throws InputError when the file is missing, no recording, of a newer version, truncated or damaged.
    explicit Reader(const std::filesystem::path& file);

    const Info& info() const { return info_; }
    /// The very shapes that were recorded, bit for bit.
    const std::vector<std::shared_ptr<const Shape>>& shapes() const { return shapes_; }
    /// Every body there ever was.
    const std::vector<Body>& bodies() const { return bodies_; }
    /// How they came and went, in that order.
    const std::vector<BodyEvent>& events() const { return events_; }
    /// Of the format. In version 1 a slot was never given twice.
    std::uint32_t version() const { return version_; }
    std::uint32_t steps() const { return steps_; }
    /// The run's; none where the run did not end well.
    const std::optional<std::string>& hash() const { return hash_; }

    /// Of step i < steps(): poses by slot, with something arbitrary for slots without a body; pairs of ids, sorted by
    /// slots, each once, the lower slot first. Cheap in ascending order; otherwise decodes a block from its start.
    /// Throws InputError where the file is damaged.
    void read_step(std::uint32_t i, std::vector<Pose>& poses, std::vector<Pair>& pairs);

private:
    /// Where it lies in the file.
    struct Block {
        BlockHeader header;
        std::uint64_t offset = 0;
        std::uint64_t end() const { return offset + BlockHeader::size + header.padded(); }
    };
    [[noreturn]] void fail(const std::string& what) const;
    [[noreturn]] void fail_truncated(std::uint64_t at) const;
    [[noreturn]] void fail_damaged(std::uint64_t at, const std::string& what) const;
    [[noreturn]] void fail_foreign(const std::string& what) const;
    std::uint32_t word_at(std::uint64_t offset) const;
    void find_side_chunk();
    Block find_block(std::uint64_t offset) const;
    Bytes stored_bytes(const Block& block) const;
    Bytes unpack(const Block& block) const;
    bool is_intact(const Block& block) const;
    bool is_whole(std::uint64_t offset) const;
    void enter(const Block& block);
    void read_blocks();
    void open_steps(std::size_t index);
    void place(std::uint32_t i, std::vector<Pose>& poses, std::vector<Pair>& pairs);

    File file_;
    std::uint64_t size_;                  ///< when it was last asked
    std::uint64_t data_ = 0, length_ = 0; ///< of the side chunk, as far as it was committed
    std::uint32_t version_ = 0;
    bool described_ = false;
    Info info_;
    std::vector<std::shared_ptr<const Shape>> shapes_;
    std::vector<BodyEvent> events_;
    std::vector<Body> bodies_;
    std::size_t slots_ = 0; ///< that bodies ever had
    std::vector<Block> step_blocks_;
    std::uint32_t steps_ = 0;
    std::optional<std::string> hash_;

    StepDecoder decoder_;
    std::size_t open_block_ = SIZE_MAX;
    std::uint32_t next_step_ = 0; ///< of the open block
    std::vector<Pose> poses_;     ///< of the step before, by number
    LiveBodies live_, ahead_;     ///< of the step that is read; of those that are only counted
};

} // namespace raycontact::recording
