// SPDX-License-Identifier: Apache-2.0
#include <raycontact/clash.h>

#include "broadphase/world_box.h"
#include "clash/parts.h"
#include "clash/selection.h"
#include "executor/executor.h"
#include "query/checks.h"
#include "query/shape_pair.h"

#include <raycontact/error.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <tuple>

namespace raycontact {

namespace {

using namespace clash;

/// The pose that `then` has once `outer` has moved it.
Pose moved(const Pose& outer, const Pose& then) {
    return {product_of(outer.rotation, then.rotation), transform_point(outer, then.translation)};
}

/// About all places of a part on its way: of some of them, grown by how far arcs leave their chords.
Box box_on_the_way(const Part& part, std::span<const Pose> path) {
    const Box own = box_of(Part{part.mesh, {}, nullptr, {}});
    Box all = world_box(own, path[0], 0);
    constexpr int some = 8;
    double grow = 0;
    for (std::size_t piece = 0; piece + 1 < path.size(); ++piece) {
        const RigidMotion motion = screw_motion(path[piece], path[piece + 1]);
        for (int k = 1; k <= some; ++k) all.add(world_box(own, pose_at(motion, double(k) / some), 0));
        // No point changes its distance from the axis of a screw.
        const double rate = length(motion.angular_velocity);
        const Vec3 arm = transform_point(motion.from, own.middle()) - motion.from.translation - motion.centre;
        const double farthest = length(cross(motion.angular_velocity, arm)) + 0.5 * rate * length(own.high - own.low);
        grow = std::max(grow, rate * farthest / (8 * some * some));
    }
    const Vec3 more{grow, grow, grow};
    return {all.low - more, all.high + more};
}

/// Parts that move, and what they may meet.
class PathSearch {
public:
    PathSearch(std::span<const AssemblyPart> given, const std::vector<std::string>& moving, std::span<const Pose> moves,
               const ClashOptions& options)
        : options_(options), parts_(parts_of(given)), paths_(given.size()) {
        ClashOptions how = options;
        how.against = moving;
        const Selection selection(given, how, "what moves");
        std::vector<Box> boxes(given.size());
        for (std::size_t i = 0; i < given.size(); ++i) {
            if (selection.is_against(i))
                for (const Pose& move : moves) paths_[i].push_back(moved(move, parts_[i].pose));
            boxes[i] = selection.is_against(i) ? box_on_the_way(parts_[i], paths_[i]) : box_of(parts_[i]);
        }
        for (std::size_t a = 0; a < given.size(); ++a) {
            if (!selection.is_against(a)) continue;
            for (std::size_t b = 0; b < given.size(); ++b) // has() leaves out those that move, too
                if (selection.has(a, b))
                    pairs_.push_back({a, b, gap_between(boxes[a], boxes[b]), selection.clearance(a, b)});
        }
        std::ranges::stable_sort(pairs_, {}, &PartPair::gap);
    }

    PathClashReport operator()() {
        PathClashReport report;
        const auto is_near = [](const PartPair& pair) { return pair.gap <= pair.clearance; };
        std::vector<PartPair> near;
        std::ranges::copy_if(pairs_, std::back_inserter(near), is_near);
        report.pairs = near.size();
        make_shapes_of(near);
        std::vector<std::optional<PathClash>> found(near.size());
        Executor executor(options_.threads);
        executor.each(near.size(), 1, [&](std::uint32_t i) {
            if (!options_.stop()) found[i] = ask(near[i], near[i].clearance);
        });
        for (const auto& one : found)
            if (one) report.clashes.push_back(*one);
        auto next = found.begin();
        for (std::size_t i = 0; i < pairs_.size() && !options_.stop(); ++i) {
            std::optional<PathClash> other = is_near(pairs_[i]) ? *next++ : std::nullopt;
            const double least = report.nearest ? report.nearest->place.distance : any_distance;
            if (pairs_[i].gap >= least) break;
            make_shapes_of({&pairs_[i], 1});
            if (!other) other = ask(pairs_[i], least);
            if (other && !other->meet && other->place.distance < least) report.nearest = other;
        }
        for (std::size_t i = 0; i < parts_.size(); ++i)
            if (!parts_[i].fault.empty()) report.faults.emplace_back(i, parts_[i].fault);
        std::ranges::stable_sort(report.clashes, {}, [](const PathClash& c) {
            return std::tuple(!c.meet, c.meet ? c.place.time : c.place.distance, c.moving, c.other);
        });
        return report;
    }

private:
    void make_shapes_of(std::span<const PartPair> pairs) {
        std::vector<PartPair> wanted;
        for (const PartPair& pair : pairs)
            for (const std::size_t i : {pair.a, pair.b})
                if (!parts_[i].shape && parts_[i].fault.empty()) wanted.push_back({i, i});
        const bool many = pairs.size() > 1;
        make_shapes(parts_, wanted, options_, [&](std::size_t done, std::size_t total) {
            if (many) options_.progress(double(done) / double(total));
        });
    }

    std::optional<PathClash> ask(const PartPair& pair, double max) const {
        const Part &a = parts_[pair.a], &b = parts_[pair.b];
        if (!a.shape || !b.shape) return std::nullopt;
        const auto place = path_clearance(*a.shape, paths_[pair.a], *b.shape, std::span(&b.pose, 1), max);
        return place ? std::optional(PathClash{pair.a, pair.b, place->meet, *place}) : std::nullopt;
    }

    const ClashOptions& options_;
    std::vector<Part> parts_;
    std::vector<std::vector<Pose>> paths_; ///< of parts that move
    std::vector<PartPair> pairs_;          ///< the nearest boxes first
};

} // namespace

PathClashReport find_path_clashes(std::span<const AssemblyPart> parts, const std::vector<std::string>& moving,
                                  std::span<const Pose> moves, const ClashOptions& options) {
    check_assembly(parts, options);
    if (moves.empty()) throw InputError("clash: a path has no move; give one at least");
    for (const Pose& move : moves) check_placed(move, "move of a path");
    if (moving.empty()) throw InputError("clash: no part moves; give a name or a pattern");
    return PathSearch(parts, moving, moves, options)();
}

} // namespace raycontact
