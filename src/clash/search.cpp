// SPDX-License-Identifier: Apache-2.0
#include <raycontact/clash.h>

#include "clash/duplicates.h"
#include "clash/nudged.h"
#include "clash/overlap.h"
#include "clash/parts.h"
#include "clash/selection.h"
#include "executor/executor.h"

#include <raycontact/collide.h>
#include <raycontact/scene.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace raycontact {

namespace {

using namespace clash;

/// Depths are float32: a tenth is a little more.
constexpr double slack = 1 + 1e-6;

void set_contacts(Clash& clash, std::span<const Contact> contacts) {
    clash.depth = 0;
    clash.contacts = contacts.size();
    for (const Contact& contact : contacts) {
        if (double(contact.depth) <= *clash.depth) continue;
        clash.depth = double(contact.depth);
        clash.point = contact.point();
        clash.point_a = contact.point_a;
        clash.point_b = contact.point_b;
        clash.normal = contact.normal;
    }
}

Clash clash_of(const PartPair& pair) {
    Clash clash;
    clash.a = pair.a;
    clash.b = pair.b;
    return clash;
}

/// What a pair's contacts tell.
struct Answer {
    std::optional<Clash> clash; ///< none: they share no point, and are not near
    double depth = 0;           ///< of the contacts
    bool may_coincide = false;  ///< so that contacts_when_nudged() decides
    bool is_doubtful = false;   ///< they cross without a contact: only parts that are sound touch
    BodyId body_a{};            ///< of a in the scene
};

Answer near_answer(const PartPair& pair, const Part& a, const Part& b, const ClashOptions& options) {
    const double reach = std::max(pair.clearance, options.tolerance);
    Answer answer;
    if (!(reach > 0)) return answer;
    const auto gap = distance(*a.shape, a.pose, *b.shape, b.pose, reach);
    if (!gap || (gap->distance > options.tolerance && gap->distance > pair.clearance)) return answer;
    Clash clash = clash_of(pair);
    clash.distance = gap->distance;
    clash.point = clash.point_a = gap->point_a;
    clash.point_b = gap->point_b;
    if (gap->distance > options.tolerance) {
        clash.kind = ClashKind::nearby;
        clash.depth = -gap->distance;
        clash.normal = unit(gap->point_b - gap->point_a);
    }
    answer.clash = clash;
    return answer;
}

Answer answer_of(const PartPair& pair, const Part& a, const Part& b, std::span<const Contact> contacts,
                 const ClashOptions& options) {
    // Contacts of two open parts tell of sheets behind each other, which may be apart.
    const bool sheets = !a.shape->has_inside() && !b.shape->has_inside();
    Clash clash = clash_of(pair);
    set_contacts(clash, contacts);
    const double depth = *clash.depth, size = smaller_size(a, b);
    std::optional<Vec3> shared;
    if (sheets || depth <= noise * size) shared = common_point(*a.shape, a.pose, *b.shape, b.pose);
    if (!shared && (sheets || contacts.empty())) return near_answer(pair, a, b, options);
    Answer answer;
    answer.depth = depth;
    if (are_duplicates(a, b)) clash.kind = ClashKind::duplicate;
    // Where all faces coincide, rounding draws the loops, and their depth is any.
    if (clash.kind == ClashKind::duplicate) answer.depth = 0;
    answer.may_coincide = answer.depth <= shallow * size && a.shape->has_inside() && b.shape->has_inside();
    if (depth <= noise * size) {
        const Vec3 point = shared ? *shared : clash.point;
        set_contacts(clash, {});
        clash.normal = {};
        clash.point = clash.point_a = clash.point_b = point;
    }
    answer.clash = clash;
    return answer;
}

/// Where faces may coincide, nudges tell.
void decide_shallow(Scene& scene, const std::vector<Part>& parts, std::span<Answer> answers) {
    std::vector<ShallowPair> asked;
    std::vector<Clash*> clashes;
    for (Answer& answer : answers) {
        if (!answer.may_coincide) continue;
        Clash& clash = *answer.clash;
        asked.push_back({&parts[clash.a], &parts[clash.b], answer.body_a, answer.depth});
        clashes.push_back(&clash);
    }
    const auto nudged = contacts_when_nudged(scene, asked);
    for (std::size_t i = 0; i < nudged.size(); ++i)
        if (!nudged[i].empty()) set_contacts(*clashes[i], nudged[i]);
}

std::optional<AxisBox> axis_box(const std::optional<Box>& box) {
    return box ? std::optional(AxisBox{box->low, box->high}) : std::nullopt;
}

/// Points of contacts are those of float32, and what is opposite may lie beside its face: of the surfaces those next to
/// them count. One of the two lies in the other part, or some other point does.
void set_points(Clash& clash, const Part& a, const Part& b) {
    if (clash.contacts == 0) return; // it is a point that both share
    const bool a_first = clash.point == clash.point_a;
    const auto on = [](const Part& part, const Vec3& point) {
        const auto closest = closest_point(*part.shape, part.pose, point);
        return closest ? closest->point : point;
    };
    clash.point_a = on(a, clash.point_a);
    clash.point_b = on(b, clash.point_b);
    const auto take = [&](const Vec3& point, const Part& other) {
        if (!contains(*other.shape, other.pose, point)) return false;
        clash.point = point;
        return true;
    };
    if (a_first ? take(clash.point_a, b) || take(clash.point_b, a) : take(clash.point_b, a) || take(clash.point_a, b))
        return;
    clash.point = common_point(*a.shape, a.pose, *b.shape, b.pose).value_or(clash.point);
}

/// Of two parts that share a point.
void set_kind(Answer& answer, const Part& a, const Part& b, const ClashOptions& options) {
    Clash& clash = *answer.clash;
    clash.open_a = !a.shape->has_inside();
    clash.open_b = !b.shape->has_inside();
    if (clash.kind == ClashKind::nearby || clash.distance > 0) return;
    set_points(clash, a, b);
    const bool solid = a.shape->has_inside() && b.shape->has_inside();
    const auto touch = [&] {
        clash.kind = ClashKind::touching;
        clash.depth = 0;
    };
    // Contacts of two open parts do not tell how deep they cross.
    const bool tells = clash.contacts > 0 && (a.shape->has_inside() || b.shape->has_inside());
    if (clash.kind != ClashKind::duplicate && tells && *clash.depth <= options.tolerance * slack) return touch();
    const Overlap overlap = overlap_of(a, b);
    clash.box = axis_box(overlap.box);
    if (clash.kind != ClashKind::duplicate)
        clash.kind = overlap.inside    ? ClashKind::inside
                     : overlap.pierces ? ClashKind::piercing
                                       : ClashKind::overlapping;
    if (clash.contacts == 0) {
        if (clash.kind != ClashKind::duplicate && !overlap.crosses && !overlap.inside) {
            clash.box.reset();
            return touch();
        }
        answer.is_doubtful = solid;
        clash.depth.reset();
    }
}

/// Parts that cross without a contact touch if both are sound: closed, wound outward and not self-intersecting. Looks
/// into each mesh once; where the search is stopped before that is known, they have no depth.
void settle_doubts(std::span<Answer> answers, const std::vector<Part>& parts, Executor& executor,
                   const std::function<bool()>& stop) {
    std::unordered_map<const Mesh*, std::size_t> places;
    std::vector<const Part*> asked;
    for (const Answer& answer : answers) {
        if (!answer.is_doubtful) continue;
        for (const std::size_t i : {answer.clash->a, answer.clash->b})
            if (places.try_emplace(parts[i].mesh.get(), asked.size()).second) asked.push_back(&parts[i]);
    }
    std::vector<char> sound(asked.size(), 0);
    const std::uint32_t of_one = executor.threads_of_each(asked.size());
    executor.each(asked.size(), 1, [&](std::uint32_t i) {
        if (stop()) return;
        sound[i] = verdict_of(prepare_mesh(*asked[i]->mesh, {.threads = of_one}).report).good;
    });
    const auto is_sound = [&](std::size_t part) { return sound[places.at(parts[part].mesh.get())] != 0; };
    for (Answer& answer : answers) {
        if (!answer.is_doubtful || !is_sound(answer.clash->a) || !is_sound(answer.clash->b)) continue;
        Clash& clash = *answer.clash;
        if (clash.kind != ClashKind::duplicate) clash.kind = ClashKind::touching;
        clash.depth = 0;
        clash.box.reset();
    }
}

/// What is asked for of solids that share more than points; it takes longer than to find them.
void measure(std::span<Answer> answers, const std::vector<Part>& parts, const ClashOptions& options, Executor& executor,
             const std::function<void(double)>& progress) {
    std::mutex mutex;
    std::size_t done = 0;
    executor.each(answers.size(), 1, [&](std::uint32_t i) {
        Clash& clash = *answers[i].clash;
        const Part &a = parts[clash.a], &b = parts[clash.b];
        if (options.stop()) return;
        if (clash.box && a.shape->has_inside() && b.shape->has_inside()) {
            if (options.volumes) clash.volume = overlap_volume(*a.shape, a.pose, *b.shape, b.pose);
            if (options.separations) clash.separation = separation(*a.shape, a.pose, *b.shape, b.pose);
        }
        const std::lock_guard lock(mutex);
        progress(double(++done) / double(answers.size()));
    });
}

/// The bodies of the parts that are asked about.
class Bodies {
public:
    // In the parts' order, so that normals run from a to b.
    Bodies(Scene& scene, const std::vector<Part>& parts, std::span<const PartPair> pairs) : of_(parts.size()) {
        std::vector<char> used(parts.size(), 0);
        for (const PartPair& pair : pairs)
            if (!pair.apart()) used[pair.a] = used[pair.b] = 1;
        for (std::size_t i = 0; i < parts.size(); ++i)
            if (used[i] != 0) of_[i] = scene.add(parts[i].shape, parts[i].pose);
    }
    Pair of(const PartPair& pair) const { return {of_[pair.a], of_[pair.b]}; }

private:
    std::vector<BodyId> of_;
};

std::vector<Answer> search(const std::vector<Part>& parts, std::span<const PartPair> pairs, const ClashOptions& options,
                           Executor& executor, const std::function<void(double)>& progress) {
    const bool measures = options.volumes || options.separations;
    const double to_find = measures ? 0.2 : 1;
    Settings settings;
    settings.method = Method::standard;
    settings.direction = Direction::refined; // the depths of threads and tubes obey their bound
    settings.execution.devices = "cpu";
    settings.execution.threads = options.threads;
    Scene scene(settings);
    const Bodies bodies(scene, parts, pairs);
    std::vector<Answer> found;
    constexpr std::size_t at_once = 256;
    for (std::size_t first = 0; first < pairs.size() && !options.stop(); first += at_once) {
        const std::span some = pairs.subspan(first, std::min(at_once, pairs.size() - first));
        std::vector<Pair> list;
        for (const PartPair& pair : some)
            if (!pair.apart()) list.push_back(bodies.of(pair));
        scene.find_contacts(list);
        std::vector<Answer> answers(some.size());
        const auto each = [&](auto&& work) {
            executor.each(some.size(), 1, [&](std::uint32_t i) {
                if (!options.stop()) work(answers[i], some[i], parts[some[i].a], parts[some[i].b]);
            });
        };
        each([&](Answer& answer, const PartPair& pair, const Part& a, const Part& b) {
            if (pair.apart()) {
                answer = near_answer(pair, a, b, options);
                return;
            }
            const auto [body_a, body_b] = bodies.of(pair);
            answer = answer_of(pair, a, b, scene.contacts(body_a, body_b), options);
            answer.body_a = body_a;
        });
        decide_shallow(scene, parts, answers);
        each([&](Answer& answer, const PartPair&, const Part& a, const Part& b) {
            if (answer.clash) set_kind(answer, a, b, options);
        });
        for (const Answer& answer : answers)
            if (answer.clash) found.push_back(answer);
        progress(to_find * double(first + some.size()) / double(pairs.size()));
    }
    settle_doubts(found, parts, executor, options.stop);
    if (measures)
        measure(found, parts, options, executor, [&](double done) { progress(to_find + (1 - to_find) * done); });
    return found;
}

} // namespace

const char* to_string(ClashKind kind) {
    constexpr std::array names{"touching", "overlapping", "piercing", "inside", "duplicate", "near"};
    return names.at(static_cast<std::size_t>(kind));
}

ClashReport find_clashes(std::span<const AssemblyPart> given, const ClashOptions& options) {
    check_assembly(given, options);
    const Selection selection(given, options);
    std::vector<Part> parts = parts_of(given);
    std::vector<PartPair> pairs = near_boxes(parts, std::max(selection.largest_clearance(), options.tolerance));
    for (PartPair& pair : pairs) pair.clearance = selection.clearance(pair.a, pair.b);
    std::erase_if(pairs, [&](const PartPair& pair) {
        return !selection.has(pair.a, pair.b) || pair.gap > std::max(pair.clearance, options.tolerance);
    });
    ClashReport report;
    report.pairs = pairs.size();
    // Shapes take most of the time.
    constexpr double shapes = 0.7;
    make_shapes(parts, pairs, options,
                [&](std::size_t done, std::size_t total) { options.progress(shapes * double(done) / double(total)); });
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (!parts[i].fault.empty()) report.faults.emplace_back(i, parts[i].fault);
        if (parts[i].shape && !parts[i].shape->has_inside()) report.open.push_back(i);
    }
    std::erase_if(pairs, [&](const PartPair& pair) { return !parts[pair.a].shape || !parts[pair.b].shape; });
    Executor executor(options.threads);
    for (const Answer& answer :
         search(parts, pairs, options, executor, [&](double done) { options.progress(shapes + (1 - shapes) * done); }))
        report.clashes.push_back(*answer.clash);
    std::sort(report.clashes.begin(), report.clashes.end(), [](const Clash& p, const Clash& q) {
        const auto rank = [](const Clash& c) { return -c.depth.value_or(1e-300); }; // any depth is more
        return std::tuple(rank(p), p.a, p.b) < std::tuple(rank(q), q.a, q.b);
    });
    return report;
}

} // namespace raycontact
