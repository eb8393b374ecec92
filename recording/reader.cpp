// SPDX-License-Identifier: Apache-2.0
#include <recording/reader.h>

#include <recording/layout.h>
#include <recording/shape_codec.h>
#include <recording/viewer_part.h>

#include <raycontact/error.h>

#include <algorithm>
#include <array>

namespace raycontact::recording {

namespace {

const char* name_of(BlockType type) {
    switch (type) {
    case BlockType::info:
        return "the description of the recording";
    case BlockType::shape:
        return "a mesh";
    case BlockType::bodies:
        return "a list of bodies";
    case BlockType::steps:
        return "a block of steps";
    case BlockType::end:
        return "the end block";
    }
    return "a block";
}

} // namespace

Reader::Reader(const std::filesystem::path& file) : file_(File::open(file)), size_(file_.size()) {
    find_side_chunk();
    read_blocks();
}

void Reader::fail(const std::string& what) const {
    throw InputError(file_.path().string() + ": " + what);
}

void Reader::fail_truncated(std::uint64_t at) const {
    fail("truncated: it has " + std::to_string(size_) + " bytes, and more should follow at byte " + std::to_string(at)
         + "; copy it again or record anew");
}

void Reader::fail_damaged(std::uint64_t at, const std::string& what) const {
    fail("damaged at byte " + std::to_string(at) + ": " + what + "; copy it again or record anew");
}

void Reader::fail_foreign(const std::string& what) const {
    fail("is no recording (" + what + "); name a file made by `raycontact run --record`");
}

std::uint32_t Reader::word_at(std::uint64_t offset) const {
    std::array<unsigned char, 4> bytes{};
    if (!file_.read(offset, bytes)) fail_truncated(offset);
    return ByteSource(bytes).get<std::uint32_t>();
}

void Reader::find_side_chunk() {
    if (size_ < glb::header_bytes) fail_truncated(size_);
    if (word_at(0) != glb::magic || word_at(4) != glb::version) fail_foreign("not a .glb file of glTF 2.0");
    for (std::uint64_t at = glb::header_bytes;; at += glb::chunk_header_bytes + length_) {
        if (at == size_ && word_at(glb::length_at) == size_) fail_foreign("a .glb file without exact data");
        if (at + glb::chunk_header_bytes > size_) fail_truncated(size_);
        length_ = word_at(at);
        if (word_at(at + 4) != side_chunk) continue;
        data_ = at + glb::chunk_header_bytes;
        break;
    }
    // Asked again: it may have grown since, and the length counts what has been written.
    size_ = file_.size();
    if (data_ + length_ > size_) fail_truncated(size_);
    auto start = side_chunk_start;
    if (length_ < start.size()) fail_damaged(data_, "the side chunk is too short");
    if (!file_.read(data_, start)) fail_truncated(data_);
    version_ = ByteSource(std::span(start).subspan(8, 4)).get<std::uint32_t>();
    const bool known = version_ >= oldest_version && version_ <= format_version;
    if (std::equal(start.begin(), start.begin() + 8, side_chunk_start.begin()) && !known)
        fail("is a recording of version " + std::to_string(version_) + ", this program reads versions "
             + std::to_string(oldest_version) + " to " + std::to_string(format_version)
             + "; use the program that made it, or copy it again if it is damaged");
    start[8] = side_chunk_start[8];
    if (start != side_chunk_start) fail_damaged(data_, "the side chunk does not start as it should");
}

// Throws Damage; the caller knows what the place means.
Reader::Block Reader::find_block(std::uint64_t offset) const {
    Block block;
    block.offset = offset;
    std::array<unsigned char, BlockHeader::size> header_bytes{};
    if (offset + BlockHeader::size > size_ || !file_.read(offset, header_bytes)) throw Damage("a block is cut off");
    try {
        block.header = read_block_header(header_bytes);
    } catch (const Damage& damage) {
        throw Damage(std::string("a block ") + damage.what());
    }
    if (block.end() > size_) throw Damage(std::string(name_of(block.header.type)) + " is cut off");
    return block;
}

Bytes Reader::stored_bytes(const Block& block) const {
    Bytes stored(static_cast<std::size_t>(block.header.padded()));
    if (!file_.read(block.offset + BlockHeader::size, stored)) fail_truncated(block.offset);
    return stored;
}

Bytes Reader::unpack(const Block& block) const {
    return unpack_block(block.header, stored_bytes(block), block.offset - data_);
}

bool Reader::is_intact(const Block& block) const {
    return block_is_intact(block.header, stored_bytes(block), block.offset - data_);
}

bool Reader::is_whole(std::uint64_t offset) const {
    try {
        return is_intact(find_block(offset));
    } catch (const Damage&) {
        return false;
    }
}

void Reader::enter(const Block& block) {
    const BlockHeader& header = block.header;
    if (described_ != (header.type != BlockType::info)) throw Damage("is not where it belongs");
    switch (header.type) {
    case BlockType::info:
        info_ = decode_info(unpack(block), version_);
        break;
    case BlockType::shape:
        shapes_.push_back(decode_shape(unpack(block)));
        break;
    case BlockType::bodies:
        apply_events(unpack(block), shapes_.size(), events_, bodies_);
        break;
    case BlockType::steps:
        // Already here, though it is unpacked later: the count of steps must be right before any is read.
        if (!is_intact(block)) throw Damage("does not match its checksum");
        if (header.first_step != steps_ || header.step_count == 0 || header.step_count > Body::never - steps_)
            throw Damage("does not follow on the steps before");
        // Each has two counts of pairs at least, and with a block's header for every 16 it takes 3 bytes of the file.
        if (header.step_count > header.raw / 2 || steps_ + header.step_count > (block.end() - data_) / 3)
            throw Damage("counts more steps than it has room for");
        steps_ += header.step_count;
        step_blocks_.push_back(block);
        break;
    case BlockType::end:
        hash_ = decode_end(unpack(block), steps_);
        break;
    }
    described_ = true;
}

void Reader::read_blocks() {
    const std::uint64_t committed = data_ + length_;
    std::uint64_t at = data_ + side_chunk_start.size();
    // Beyond what was committed there may be blocks whose writer died before it could say so: whole ones count.
    while (!hash_ && (at < committed || (described_ && is_whole(at)))) {
        Block block;
        try {
            block = find_block(at);
        } catch (const Damage& damage) {
            fail_damaged(at, damage.what());
        }
        try {
            if (at < committed && block.end() > committed) throw Damage("reaches beyond the side chunk");
            enter(block);
        } catch (const UnknownSetting& unknown) {
            fail(std::string("was recorded with a setting this version does not know: ") + unknown.what()
                 + "; replay it with the program that made it");
        } catch (const Damage& damage) {
            fail_damaged(at, std::string(name_of(block.header.type)) + " " + damage.what());
        } catch (const InputError& error) {
            fail_damaged(at, std::string(name_of(block.header.type)) + ": " + error.what());
        }
        at = block.end();
    }
    if (!described_) fail_damaged(data_, "the side chunk is empty");
    if (at < committed) fail_damaged(at, "something follows the end block");
    give_ids(version_, events_, bodies_);
    if (info_.bodies == 0) info_.bodies = static_cast<std::uint32_t>(bodies_.size()); // it began with an empty scene
    for (const Body& body : bodies_) slots_ = std::max(slots_, body.id.slot + std::size_t{1});
}

void Reader::open_steps(std::size_t index) {
    open_block_ = SIZE_MAX; // until it is known to be sound
    const BlockHeader& header = step_blocks_[index].header;
    Bytes payload = unpack(step_blocks_[index]);
    std::uint64_t residuals = 0;
    for (std::uint32_t i = 0; i < header.step_count && residuals <= payload.size(); ++i)
        residuals += 12 * ahead_.at(header.first_step + i, events_, bodies_).size();
    decoder_.open(std::move(payload), residuals, bodies_.size());
    poses_.resize(bodies_.size());
    open_block_ = index;
    next_step_ = header.first_step;
}

void Reader::read_step(std::uint32_t i, std::vector<Pose>& poses, std::vector<Pair>& pairs) {
    if (i >= steps_) fail("has no step " + std::to_string(i) + ", only " + std::to_string(steps_));
    const auto after = std::upper_bound(step_blocks_.begin(), step_blocks_.end(), i,
                                        [](std::uint32_t step, const Block& b) { return step < b.header.first_step; });
    const auto index = static_cast<std::size_t>(after - step_blocks_.begin() - 1);
    try {
        if (index != open_block_ || i < next_step_) open_steps(index);
        for (; next_step_ <= i; ++next_step_) decoder_.next(live_.at(next_step_, events_, bodies_), poses_);
        place(i, poses, pairs);
    } catch (const Damage& damage) {
        open_block_ = SIZE_MAX;
        const Block& block = step_blocks_[index];
        fail_damaged(block.offset, std::string(name_of(block.header.type)) + " " + damage.what());
    }
}

// From numbers to slots and ids.
void Reader::place(std::uint32_t i, std::vector<Pose>& poses, std::vector<Pair>& pairs) {
    poses.resize(slots_);
    for (const std::uint32_t body : live_.at(i, events_, bodies_)) poses[bodies_[body].id.slot] = poses_[body];
    pairs.clear();
    for (const auto& [first, second] : decoder_.pairs()) {
        const Body &a = bodies_[first], &b = bodies_[second];
        if (!a.alive(i) || !b.alive(i)) throw Damage("pairs bodies that are not there");
        const bool swapped = a.id.slot > b.id.slot;
        pairs.emplace_back(swapped ? b.id : a.id, swapped ? a.id : b.id);
    }
    const auto slots_of = [](const Pair& pair) { return std::pair(pair.first.slot, pair.second.slot); };
    std::sort(pairs.begin(), pairs.end(), [&](const Pair& p, const Pair& q) { return slots_of(p) < slots_of(q); });
}

} // namespace raycontact::recording
