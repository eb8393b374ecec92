// SPDX-License-Identifier: Apache-2.0
#include <recording/reader.h>

#include <recording/file.h>
#include <recording/layout.h>
#include <recording/live_bodies.h>
#include <recording/shape_codec.h>
#include <recording/step_codec.h>
#include <recording/viewer_part.h>

#include <raycontact/error.h>

#include <algorithm>
#include <array>

namespace raycontact::recording {

namespace {

/// A block where it lies.
struct Found {
    BlockHeader header;
    std::array<unsigned char, BlockHeader::size> header_bytes{};
    std::uint64_t offset = 0; ///< in the file
    std::uint64_t end() const { return offset + BlockHeader::size + header.padded(); }
};

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

struct Reader::State {
    explicit State(const std::filesystem::path& path) : file(File::open(path)), size(file.size()) {}

    [[noreturn]] void fail_truncated(std::uint64_t at) const {
        throw InputError(file.path().string() + ": truncated: it has " + std::to_string(size)
                         + " bytes, and more should follow at byte " + std::to_string(at)
                         + "; copy it again or record anew");
    }
    [[noreturn]] void fail_damaged(std::uint64_t at, const std::string& what) const {
        throw InputError(file.path().string() + ": damaged at byte " + std::to_string(at) + ": " + what
                         + "; copy it again or record anew");
    }
    [[noreturn]] void fail_foreign(const std::string& what) const {
        throw InputError(file.path().string() + ": is no recording (" + what
                         + "); name a file made by `raycontact run --record`");
    }

    std::uint32_t word_at(std::uint64_t offset) const;
    void find_side_chunk();
    Found find_block(std::uint64_t offset) const;
    Bytes stored_bytes(const Found& block) const;
    Bytes unpack(const Found& block) const;
    bool is_whole(std::uint64_t offset) const;
    void enter(const Found& block);
    void read_blocks();
    void open_steps(std::size_t block);
    void read_step(std::uint32_t i, std::vector<Pose>& poses, std::vector<Pair>& pairs);
    void place(std::uint32_t i, std::vector<Pose>& poses, std::vector<Pair>& pairs);

    File file;
    std::uint64_t size;                 ///< when it was last asked
    std::uint64_t data = 0, length = 0; ///< of the side chunk, as far as it was committed
    std::uint32_t version = 0;
    bool described = false;
    Info info;
    std::vector<std::shared_ptr<const Shape>> shapes;
    std::vector<BodyEvent> events;
    std::vector<Body> bodies;
    std::size_t slots = 0; ///< that bodies ever had
    std::vector<Found> step_blocks;
    std::uint32_t steps = 0;
    std::optional<std::string> hash;

    StepDecoder decoder;
    std::size_t open_block = SIZE_MAX;
    std::uint32_t next_step = 0; ///< of the open block
    std::vector<Pose> poses;     ///< of the step before, by number
    LiveBodies live, ahead;      ///< of the step that is read; of those that are only counted
};

std::uint32_t Reader::State::word_at(std::uint64_t offset) const {
    std::array<unsigned char, 4> bytes{};
    if (!file.read(offset, bytes)) fail_truncated(offset);
    return ByteSource(bytes).get<std::uint32_t>();
}

void Reader::State::find_side_chunk() {
    if (size < glb::header_bytes) fail_truncated(size);
    if (word_at(0) != glb::magic || word_at(4) != glb::version) fail_foreign("not a .glb file of glTF 2.0");
    for (std::uint64_t at = glb::header_bytes;; at += glb::chunk_header_bytes + length) {
        if (at == size && word_at(glb::length_at) == size) fail_foreign("a .glb file without exact data");
        if (at + glb::chunk_header_bytes > size) fail_truncated(size);
        length = word_at(at);
        if (word_at(at + 4) != side_chunk) continue;
        data = at + glb::chunk_header_bytes;
        break;
    }
    // Asked again: it may have grown since, and the length counts what has been written.
    size = file.size();
    if (data + length > size) fail_truncated(size);
    auto start = side_chunk_start;
    if (length < start.size()) fail_damaged(data, "the side chunk is too short");
    if (!file.read(data, start)) fail_truncated(data);
    version = ByteSource(std::span(start).subspan(8, 4)).get<std::uint32_t>();
    const bool known = version >= oldest_version && version <= format_version;
    if (std::equal(start.begin(), start.begin() + 8, side_chunk_start.begin()) && !known)
        throw InputError(file.path().string() + ": is a recording of version " + std::to_string(version)
                         + ", this program reads versions " + std::to_string(oldest_version) + " to "
                         + std::to_string(format_version)
                         + "; use the program that made it, or copy it again if it is damaged");
    start[8] = side_chunk_start[8];
    if (start != side_chunk_start) fail_damaged(data, "the side chunk does not start as it should");
}

// Throws Damage; the caller knows what the place means.
Found Reader::State::find_block(std::uint64_t offset) const {
    Found block;
    block.offset = offset;
    if (offset + BlockHeader::size > size || !file.read(offset, block.header_bytes)) throw Damage("a block is cut off");
    try {
        block.header = read_block_header(block.header_bytes);
    } catch (const Damage& damage) {
        throw Damage(std::string("a block ") + damage.what());
    }
    if (block.end() > size) throw Damage(std::string(name_of(block.header.type)) + " is cut off");
    return block;
}

Bytes Reader::State::stored_bytes(const Found& block) const {
    Bytes stored(static_cast<std::size_t>(block.header.padded()));
    if (!file.read(block.offset + BlockHeader::size, stored)) fail_truncated(block.offset);
    return stored;
}

Bytes Reader::State::unpack(const Found& block) const {
    return unpack_block(block.header, block.header_bytes, stored_bytes(block), block.offset - data);
}

bool Reader::State::is_whole(std::uint64_t offset) const {
    try {
        const Found block = find_block(offset);
        return block_is_intact(block.header, block.header_bytes, stored_bytes(block), block.offset - data);
    } catch (const Damage&) {
        return false;
    }
}

void Reader::State::enter(const Found& block) {
    const BlockHeader& header = block.header;
    if (described != (header.type != BlockType::info)) throw Damage("is not where it belongs");
    switch (header.type) {
    case BlockType::info:
        info = decode_info(unpack(block), version);
        break;
    case BlockType::shape:
        shapes.push_back(Shape::make(decode_mesh(unpack(block))));
        break;
    case BlockType::bodies:
        apply_events(unpack(block), shapes.size(), events, bodies);
        break;
    case BlockType::steps:
        // Already here, though it is unpacked later: the count of steps must be right before any is read.
        if (!block_is_intact(header, block.header_bytes, stored_bytes(block), block.offset - data))
            throw Damage("does not match its checksum");
        if (header.first_step != steps || header.step_count == 0 || header.step_count > Body::never - steps)
            throw Damage("does not follow on the steps before");
        // Each has two counts of pairs at least, and with a block's header for every 16 it takes 3 bytes of the file.
        if (header.step_count > header.raw / 2 || steps + header.step_count > (block.end() - data) / 3)
            throw Damage("counts more steps than it has room for");
        steps += header.step_count;
        step_blocks.push_back(block);
        break;
    case BlockType::end:
        hash = decode_end(unpack(block), steps);
        break;
    }
    described = true;
}

void Reader::State::read_blocks() {
    const std::uint64_t committed = data + length;
    std::uint64_t at = data + side_chunk_start.size();
    // Beyond what was committed there may be blocks whose writer died before it could say so: whole ones count.
    while (!hash && (at < committed || (described && is_whole(at)))) {
        Found block;
        try {
            block = find_block(at);
        } catch (const Damage& damage) {
            fail_damaged(at, damage.what());
        }
        try {
            if (at < committed && block.end() > committed) throw Damage("reaches beyond the side chunk");
            enter(block);
        } catch (const UnknownSetting& unknown) {
            throw InputError(file.path().string() + ": was recorded with a setting this version does not know: "
                             + unknown.what() + "; replay it with the program that made it");
        } catch (const Damage& damage) {
            fail_damaged(at, std::string(name_of(block.header.type)) + " " + damage.what());
        } catch (const InputError& error) {
            fail_damaged(at, std::string(name_of(block.header.type)) + ": " + error.what());
        }
        at = block.end();
    }
    if (!described) fail_damaged(data, "the side chunk is empty");
    if (at < committed) fail_damaged(at, "something follows the end block");
    give_ids(version, events, bodies);
    if (info.bodies == 0) info.bodies = static_cast<std::uint32_t>(bodies.size()); // it began with an empty scene
    for (const Body& body : bodies) slots = std::max(slots, body.id.slot + std::size_t{1});
}

void Reader::State::open_steps(std::size_t index) {
    open_block = SIZE_MAX; // until it is known to be sound
    const BlockHeader& header = step_blocks[index].header;
    Bytes payload = unpack(step_blocks[index]);
    std::uint64_t residuals = 0;
    for (std::uint32_t i = 0; i < header.step_count && residuals <= payload.size(); ++i)
        residuals += 12 * ahead.at(header.first_step + i, events, bodies).size();
    decoder.open(std::move(payload), residuals, bodies.size());
    poses.resize(bodies.size());
    open_block = index;
    next_step = header.first_step;
}

void Reader::State::read_step(std::uint32_t i, std::vector<Pose>& to_poses, std::vector<Pair>& to_pairs) {
    if (i >= steps)
        throw InputError(file.path().string() + ": has no step " + std::to_string(i) + ", only "
                         + std::to_string(steps));
    const auto after = std::upper_bound(step_blocks.begin(), step_blocks.end(), i,
                                        [](std::uint32_t step, const Found& b) { return step < b.header.first_step; });
    const auto index = static_cast<std::size_t>(after - step_blocks.begin() - 1);
    try {
        if (index != open_block || i < next_step) open_steps(index);
        for (; next_step <= i; ++next_step) decoder.next(live.at(next_step, events, bodies), poses);
        place(i, to_poses, to_pairs);
    } catch (const Damage& damage) {
        open_block = SIZE_MAX;
        const Found& block = step_blocks[index];
        fail_damaged(block.offset, std::string(name_of(block.header.type)) + " " + damage.what());
    }
}

// From numbers to slots and ids.
void Reader::State::place(std::uint32_t i, std::vector<Pose>& to_poses, std::vector<Pair>& to_pairs) {
    to_poses.resize(slots);
    for (const std::uint32_t body : live.at(i, events, bodies)) to_poses[bodies[body].id.slot] = poses[body];
    to_pairs.clear();
    for (const auto& [first, second] : decoder.pairs()) {
        const Body &a = bodies[first], &b = bodies[second];
        if (!a.alive(i) || !b.alive(i)) throw Damage("pairs bodies that are not there");
        const bool swapped = a.id.slot > b.id.slot;
        to_pairs.emplace_back(swapped ? b.id : a.id, swapped ? a.id : b.id);
    }
    const auto slots_of = [](const Pair& pair) { return std::pair(pair.first.slot, pair.second.slot); };
    std::sort(to_pairs.begin(), to_pairs.end(),
              [&](const Pair& p, const Pair& q) { return slots_of(p) < slots_of(q); });
}

Reader::Reader(const std::filesystem::path& file) : state_(std::make_unique<State>(file)) {
    state_->find_side_chunk();
    state_->read_blocks();
}

Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

const Info& Reader::info() const {
    return state_->info;
}
const std::vector<std::shared_ptr<const Shape>>& Reader::shapes() const {
    return state_->shapes;
}
const std::vector<Body>& Reader::bodies() const {
    return state_->bodies;
}
const std::vector<BodyEvent>& Reader::events() const {
    return state_->events;
}
std::uint32_t Reader::version() const {
    return state_->version;
}
std::uint32_t Reader::steps() const {
    return state_->steps;
}
const std::optional<std::string>& Reader::hash() const {
    return state_->hash;
}

void Reader::read_step(std::uint32_t i, std::vector<Pose>& poses, std::vector<Pair>& pairs) {
    state_->read_step(i, poses, pairs);
}

} // namespace raycontact::recording
