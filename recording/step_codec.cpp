// SPDX-License-Identifier: Apache-2.0
#include <recording/step_codec.h>

#include <algorithm>
#include <bit>
#include <iterator>

namespace raycontact::recording {

namespace {

constexpr std::size_t numbers = 12;

/// Of a pose that may be const, the i-th number.
auto& number_of(auto& pose, std::size_t i) {
    if (i < 9) return pose.rotation[i];
    return i == 9 ? pose.translation.x : i == 10 ? pose.translation.y : pose.translation.z;
}

// Small differences of either sign become small numbers.
std::uint64_t zigzag(std::uint64_t difference) {
    return difference << 1 ^ (difference >> 63 ? ~std::uint64_t{0} : 0);
}

std::uint64_t unzigzag(std::uint64_t code) {
    return code >> 1 ^ (code & 1 ? ~std::uint64_t{0} : 0);
}

} // namespace

void StepEncoder::add(std::span<const std::uint32_t> live, std::span<const Pose> poses,
                      std::span<const NumberPair> pairs) {
    last_.resize(poses.size());
    for (std::size_t i = 0; i < numbers; ++i) {
        for (const std::uint32_t body : live) {
            const auto bits = std::bit_cast<std::uint64_t>(number_of(poses[body], i));
            std::uint64_t& last = last_[body][i];
            residuals_.push_back(zigzag(bits - last));
            last = bits;
        }
    }
    add_pairs(pairs);
    ++steps_;
}

// The places in the list before that are gone, then the pairs that are new, both as gaps.
void StepEncoder::add_pairs(std::span<const NumberPair> pairs) {
    std::vector<NumberPair> fresh;
    std::set_difference(pairs.begin(), pairs.end(), pairs_.begin(), pairs_.end(), std::back_inserter(fresh));
    const std::size_t kept = pairs.size() - fresh.size();
    put_varint(pair_bytes_, pairs_.size() - kept);
    put_varint(pair_bytes_, fresh.size());
    std::size_t next = 0;
    for (std::size_t i = 0, j = 0; i < pairs_.size(); ++i) {
        while (j < pairs.size() && pairs[j] < pairs_[i]) ++j;
        if (j < pairs.size() && pairs[j] == pairs_[i]) continue;
        put_varint(pair_bytes_, i - next);
        next = i + 1;
    }
    NumberPair last{0, 0};
    for (const NumberPair& pair : fresh) {
        put_varint(pair_bytes_, pair.first - last.first);
        put_varint(pair_bytes_, pair.second - (pair.first == last.first ? last.second : pair.first));
        last = pair;
    }
    pairs_.assign(pairs.begin(), pairs.end());
}

Bytes StepEncoder::take() {
    Bytes payload(residuals_.size() * 8);
    for (std::size_t plane = 0; plane < 8; ++plane) {
        unsigned char* to = payload.data() + plane * residuals_.size();
        const unsigned shift = static_cast<unsigned>(56 - 8 * plane);
        for (const std::uint64_t residual : residuals_) *to++ = static_cast<unsigned char>(residual >> shift);
    }
    payload.insert(payload.end(), pair_bytes_.begin(), pair_bytes_.end());
    last_.clear();
    residuals_.clear();
    pair_bytes_.clear();
    pairs_.clear();
    steps_ = 0;
    return payload;
}

void StepDecoder::open(Bytes payload, std::uint64_t residuals, std::size_t bodies) {
    if (residuals > payload.size() / 8) throw Damage("holds fewer poses than its steps have bodies");
    payload_ = std::move(payload);
    residuals_ = static_cast<std::size_t>(residuals);
    residual_at_ = 0;
    pair_at_ = residuals_ * 8;
    pairs_.clear();
    last_.resize(bodies);
    block_of_.resize(bodies);
    ++block_; // in place of zeros for every body there ever was
}

void StepDecoder::next(std::span<const std::uint32_t> live, std::span<Pose> poses) {
    if (live.size() * numbers > residuals_ - residual_at_) throw Damage("holds fewer poses than its steps have bodies");
    for (const std::uint32_t body : live) {
        if (block_of_[body] != block_) last_[body] = {};
        block_of_[body] = block_;
    }
    for (std::size_t i = 0; i < numbers; ++i) {
        for (const std::uint32_t body : live) {
            std::uint64_t code = 0;
            for (std::size_t plane = 0; plane < 8; ++plane)
                code = code << 8 | payload_[plane * residuals_ + residual_at_];
            ++residual_at_;
            std::uint64_t& last = last_[body][i];
            last += unzigzag(code);
            number_of(poses[body], i) = std::bit_cast<double>(last);
        }
    }
    next_pairs(poses.size());
}

void StepDecoder::next_pairs(std::size_t bodies) {
    ByteSource from(std::span<const unsigned char>(payload_).subspan(pair_at_));
    const std::size_t all = from.left();
    const std::uint64_t gone = from.get_varint(), fresh = from.get_varint();
    if (gone > pairs_.size() || fresh > from.left()) throw Damage("has a list of pairs that cannot be");
    std::swap(pairs_, before_);
    pairs_.clear();
    gone_.clear();
    std::size_t next = 0;
    for (std::uint64_t i = 0; i < gone; ++i) {
        const std::uint64_t gap = from.get_varint();
        if (gap >= before_.size() - next) throw Damage("has a list of pairs that cannot be");
        gone_.push_back(next + static_cast<std::size_t>(gap));
        next = gone_.back() + 1;
    }
    auto skip = gone_.begin();
    for (std::size_t i = 0; i < before_.size(); ++i) {
        if (skip != gone_.end() && *skip == i)
            ++skip;
        else
            pairs_.push_back(before_[i]);
    }
    const auto middle = static_cast<std::ptrdiff_t>(pairs_.size());
    NumberPair last{0, 0};
    for (std::uint64_t i = 0; i < fresh; ++i) {
        const std::uint64_t step = from.get_varint(), gap = from.get_varint();
        if (step >= bodies || gap >= bodies) throw Damage("pairs bodies that do not exist");
        const std::uint64_t first = last.first + step, second = (step == 0 ? last.second : first) + gap;
        if (second >= bodies || first >= second) throw Damage("pairs bodies that do not exist");
        if (i > 0 && step == 0 && gap == 0) throw Damage("has a pair twice");
        last = {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(second)};
        pairs_.push_back(last);
    }
    std::inplace_merge(pairs_.begin(), pairs_.begin() + middle, pairs_.end());
    if (std::adjacent_find(pairs_.begin(), pairs_.end()) != pairs_.end()) throw Damage("has a pair twice");
    pair_at_ += all - from.left();
}

} // namespace raycontact::recording
