// SPDX-License-Identifier: Apache-2.0
#include <recording/block.h>

#include <xxhash.h>
#include <zlib.h>

#include <algorithm>
#include <memory>
#include <new>

namespace raycontact::recording {

namespace {

constexpr std::uint32_t coding_zlib = 1;
constexpr std::uint64_t most_expansion = 64; // of what describes something; deflate can reach 1032

/// How long a payload may be, so that no small file fills the memory: what writers pack stays below by far, but for the
/// poses of bodies at rest, of which there is a block at a time.
std::uint64_t most_raw(BlockType type, std::uint64_t stored) {
    if (type == BlockType::info || type == BlockType::end) return most_text;
    const std::uint64_t always = type == BlockType::steps ? std::uint64_t{16} << 20 : std::uint64_t{64} << 10;
    return always + most_expansion * stored;
}

/// A header as it lies in the file, but for the checksum.
Bytes bytes_of(const BlockHeader& header) {
    Bytes bytes;
    put(bytes, static_cast<std::uint32_t>(header.type));
    put(bytes, coding_zlib);
    put(bytes, header.stored);
    put(bytes, header.raw);
    put(bytes, header.first_step);
    put(bytes, header.step_count);
    return bytes;
}

std::uint64_t checksum_of(const BlockHeader& header, std::span<const unsigned char> padded, std::uint64_t place) {
    const std::unique_ptr<XXH64_state_t, decltype(&XXH64_freeState)> state(XXH64_createState(), XXH64_freeState);
    if (!state) throw std::bad_alloc();
    const Bytes bytes = bytes_of(header);
    XXH64_reset(state.get(), place);
    XXH64_update(state.get(), bytes.data(), bytes.size());
    if (!padded.empty()) XXH64_update(state.get(), padded.data(), padded.size());
    return XXH64_digest(state.get());
}

/// Appends `raw`, compressed, to `to`.
void deflate_onto(Bytes& to, std::span<const unsigned char> raw, Effort effort) {
    z_stream stream{};
    // Residuals are noise with a skewed distribution: runs and Huffman codes find all there is, and fast.
    const int level = effort == Effort::none ? Z_NO_COMPRESSION : effort == Effort::quick ? 1 : 6;
    const int strategy = effort == Effort::quick ? Z_RLE : Z_DEFAULT_STRATEGY;
    if (deflateInit2(&stream, level, Z_DEFLATED, 15, 9, strategy) != Z_OK) throw std::bad_alloc();
    const std::size_t before = to.size(), most = deflateBound(&stream, static_cast<uLong>(raw.size()));
    to.resize(before + most);
    stream.next_in = const_cast<unsigned char*>(raw.data()); // zlib's type; it only reads
    stream.avail_in = static_cast<uInt>(raw.size());
    stream.next_out = to.data() + before;
    stream.avail_out = static_cast<uInt>(most);
    const bool fits = raw.size() == stream.avail_in && most == stream.avail_out; // zlib counts in 32 bits
    const int status = fits ? deflate(&stream, Z_FINISH) : Z_BUF_ERROR;
    to.resize(to.size() - stream.avail_out);
    deflateEnd(&stream);
    if (status != Z_STREAM_END) throw std::runtime_error("recording: zlib could not compress a block");
}

} // namespace

Bytes make_block(BlockType type, std::uint32_t first_step, std::uint32_t step_count, std::span<const unsigned char> raw,
                 std::uint64_t place, Effort effort) {
    Bytes block(BlockHeader::size);
    deflate_onto(block, raw, effort);
    if (raw.size() > most_raw(type, block.size() - BlockHeader::size)) {
        block.resize(BlockHeader::size);
        deflate_onto(block, raw, Effort::none);
    }
    BlockHeader header{type, block.size() - BlockHeader::size, raw.size(), first_step, step_count};
    block.resize(BlockHeader::size + header.padded());
    Bytes start = bytes_of(header);
    put(start, checksum_of(header, std::span<const unsigned char>(block).subspan(BlockHeader::size), place));
    std::copy(start.begin(), start.end(), block.begin());
    return block;
}

BlockHeader read_block_header(std::span<const unsigned char> bytes) {
    ByteSource from(bytes);
    BlockHeader header;
    header.type = static_cast<BlockType>(from.get<std::uint32_t>());
    const auto coding = from.get<std::uint32_t>();
    header.stored = from.get<std::uint64_t>();
    header.raw = from.get<std::uint64_t>();
    header.first_step = from.get<std::uint32_t>();
    header.step_count = from.get<std::uint32_t>();
    header.checksum = from.get<std::uint64_t>();
    switch (header.type) {
    case BlockType::info:
    case BlockType::shape:
    case BlockType::bodies:
    case BlockType::steps:
    case BlockType::end:
        break;
    default:
        throw Damage("is of no known type");
    }
    if (coding != coding_zlib) throw Damage("is coded in a way this version does not know");
    if (header.stored > UINT32_MAX) throw Damage("has an impossible length");
    if (header.raw > most_raw(header.type, header.stored)) throw Damage("would unpack to more than any writer packs");
    return header;
}

bool block_is_intact(const BlockHeader& header, std::span<const unsigned char> stored, std::uint64_t place) {
    return stored.size() == header.padded() && checksum_of(header, stored, place) == header.checksum;
}

Bytes unpack_block(const BlockHeader& header, std::span<const unsigned char> stored, std::uint64_t place) {
    if (!block_is_intact(header, stored, place)) throw Damage("does not match its checksum");
    Bytes raw(static_cast<std::size_t>(header.raw));
    auto unpacked = static_cast<uLong>(header.raw), used = static_cast<uLong>(header.stored);
    const int status = uncompress2(raw.data(), &unpacked, stored.data(), &used);
    if (status == Z_MEM_ERROR) throw std::bad_alloc();
    if (status != Z_OK || used != header.stored || unpacked != header.raw) throw Damage("cannot be unpacked");
    return raw;
}

} // namespace raycontact::recording
