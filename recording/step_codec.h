// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/bytes.h>
#include <recording/recording.h>

#include <raycontact/pose.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace raycontact::recording {

/// The 12 numbers of a pose as bits: the rotation row by row, then the translation.
using PoseBits = std::array<std::uint64_t, 12>;

/// Codes consecutive steps into the payload of one block, which is decodable on its own. Of each number of a pose the
/// difference of its bits to the step before is kept, as whole numbers, so that nothing is lost: small for small
/// motions, zero in the bits that the poses do not use.
class StepEncoder {
public:
    /// Of the bodies numbered in `live` (ascending); `pairs` sorted, each once, first < second.
    void add(std::span<const std::uint32_t> live, std::span<const Pose> poses, std::span<const NumberPair> pairs);
    std::uint32_t steps() const { return steps_; }
    std::size_t bytes() const { return residuals_.size() * 8 + pair_bytes_.size(); }
    /// Payload: the residuals' highest bytes, then their next, ... the lowest; then the pairs. Starts a new block.
    Bytes take();

private:
    void add_pairs(std::span<const NumberPair> pairs);

    std::vector<PoseBits> last_;           ///< by body, zero where the block has none yet
    std::vector<std::uint64_t> residuals_; ///< by step, then number of the pose, then body
    Bytes pair_bytes_;
    std::vector<NumberPair> pairs_; ///< of the step before, in this block
    std::uint32_t steps_ = 0;
};

/// The way back, one step at a time. Throws Damage for bytes that no encoder wrote.
class StepDecoder {
public:
    /// `residuals`: how many the block's steps have: 12 per live body and step.
    void open(Bytes payload, std::uint64_t residuals, std::size_t bodies);
    /// The next step's; poses[body] is written for the bodies in `live` only.
    void next(std::span<const std::uint32_t> live, std::span<Pose> poses);
    const std::vector<NumberPair>& pairs() const { return pairs_; }

private:
    void next_pairs(std::size_t bodies);

    std::vector<PoseBits> last_; ///< by body, of this block where `block_of_` says so, else to be taken as zero
    std::vector<std::uint64_t> block_of_;
    std::uint64_t block_ = 0; ///< counts the blocks that were opened
    Bytes payload_;
    std::size_t residuals_ = 0, residual_at_ = 0, pair_at_ = 0;
    std::vector<NumberPair> pairs_, before_;
    std::vector<std::size_t> gone_;
};

} // namespace raycontact::recording
