// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "pairs/displacement.h"
#include "pairs/pair_table.h"
#include "pairs/separating_normal.h"
#include "pairs/update.h"

#include <array>
#include <memory>

namespace raycontact {

/// The rays that one direction of a pair had in a step.
struct CandidateRays {
    std::uint32_t first = 0, count = 0;
    std::uint64_t held = 0; ///< the step that stored `Held` data for them; 0: none did
};

/// What the certified method keeps for one direction of a pair: the vertex blocks near its target, its candidates, and
/// a clock that counts metres moved since the pair's reference pose.
struct Candidates {
    double clock = 0;       ///< at the reference pose
    double valid_until = 0; ///< no block is due before the clock reaches this
    double expiry = -1;     ///< a new list of blocks is due when the clock reaches this; below 0: at once
    std::uint32_t first = 0, count = 0, capacity = 0; ///< the list
    CandidateRays rays;
};

/// The near edges, or vertices, that are kept of a pair: a range of NearLists.
struct KeptNear {
    std::uint32_t first = 0, capacity = 0;
    std::array<std::uint32_t, 2> counts{}; ///< of the first body, of the second
    float reach = 1; ///< of how far a list of nothing is sought: less where so much was near that it did not pay
    std::uint32_t count() const { return counts[0] + counts[1]; }
};

struct CertifiedPair {
    Candidates directions[2];
    KeptNear edges, points;
    SeparatingNormal normal, normal_of_near; ///< of rays; of near edges and vertices
    double speed = 0;                        ///< metres a step, smoothed; decides how far a list reaches
    PairPlace reference;
    std::uint32_t as_standard = 0; ///< steps for which it is still left to `standard`
};

/// What is read for every pair in every step.
struct Slack {
    double metres = -1;      ///< that the pair may move, by the cheap bound, before the exact one is computed
    double edges = -1;       ///< that it may come nearer before its near edges are sought anew
    double points = -1;      ///< the same of its near vertices
    float margin = 0;        ///< within which it has speculative contacts
    float least_exit = 0;    ///< of both shapes: what is thinner sees farther (docs/internals/speculative.md)
    bool known = false;      ///< it was asked about in a step before
    bool open = false;       ///< it has lists
    bool casts = false;      ///< it has rays, to be decided in every step
    bool apart = false;      ///< as AskedPair's, while its near edges last
    bool all = false;        ///< its near edges have those that hide little, too (docs/internals/edges.md)
    bool has_points = false; ///< it has near vertices
};

/// A direction of a pair that has work in this step: rays to decide, blocks to test, or a list to make.
struct Due {
    Candidates* own;
    std::uint32_t directed;    ///< directed index of the pair
    float now;                 ///< the clock
    float margin, radius;      ///< metres: of rounding; of swept clearances to seek, 0: none
    kernels::uint tests_cones; ///< 1: its rays test normal-cone balls
    double longest;            ///< metres that a new list may last
};

/// Near edges last while the pair moves this share of the margin by which they were sought.
inline constexpr double edge_share = 0.998;
inline constexpr double never = 1e300; ///< metres

/// A pair whose near vertices and edges may be sought in this step.
struct DueNear {
    std::uint32_t pair; ///< its place
    double size, speed; ///< of the smaller body's box; metres a step
    bool points, edges; ///< they are due; edges: else they are sought only if some are missing
    bool moves;         ///< it hurries
    bool once;          ///< this may be its only step
};

using CertifiedPairs = PairTable<CertifiedPair, Slack>;

/// Finds which directions of which pairs are due in a step, in the order of the pairs: by slices of the pairs, each on
/// one thread.
class DuePairs {
public:
    /// A list in memory that has room for all that it can hold.
    template <class T>
    class List {
    public:
        List() = default;
        explicit List(T* first) : first_(first) {}
        T& add() { return first_[size_++]; }
        std::uint32_t size() const { return size_; }
        T& operator[](std::uint32_t i) const { return first_[i]; }
        T* begin() const { return first_; }
        T* end() const { return first_ + size_; }

    private:
        T* first_ = nullptr;
        std::uint32_t size_ = 0;
    };
    struct Slice {
        List<Due> due;
        List<kernels::DirectedPair> places; ///< of due
        List<std::uint32_t> stale;          ///< indices of due: those that need a new list
        List<std::uint32_t> as_standard;    ///< places of pairs that are left to `standard`
        List<DueNear> near;
        std::size_t first = 0;         ///< place of its first due among all
        std::size_t segment_first = 0; ///< place of its first segment among all
        std::uint64_t blocks = 0;      ///< vertex blocks tested
    };

    void run(const Update& update, CertifiedPairs& table);
    std::span<Slice> slices() { return std::span(slices_).first(slice_count_); }
    std::span<const Slice> slices() const { return std::span(slices_).first(slice_count_); }
    /// Calls work(slice) for each slice, on all threads.
    template <class Work>
    void each_slice(Executor& executor, Work&& work) {
        executor.each(slice_count_, 8, [&](std::uint32_t s) { work(slices_[s]); });
    }

private:
    static constexpr std::uint32_t slice_size = 128; // pairs
    /// Of the lists of a slice. Not initialised, so that what no step has used takes no memory.
    struct Room {
        Due due[2 * slice_size];
        kernels::DirectedPair places[2 * slice_size];
        std::uint32_t stale[2 * slice_size], as_standard[slice_size];
        DueNear near[slice_size];
    };
    static void check_slice(const Update& update, CertifiedPairs& table, std::uint32_t begin, std::uint32_t end,
                            Slice& slice);
    static void check_pair(const Update& update, CertifiedPairs& table, std::uint32_t i, double speed, Slice& slice);

    std::unique_ptr<Room[]> rooms_;
    std::vector<Slice> slices_; ///< one for each room
    std::uint32_t slice_count_ = 0;
};

} // namespace raycontact
