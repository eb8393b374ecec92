// SPDX-License-Identifier: Apache-2.0
#include "edges/edge_stage.h"

#include "contacts/write_contact.h"
#include "speculative/edge_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <tuple>

namespace raycontact {

namespace {

constexpr std::size_t pairs_in_block = 32, most_work = 64;

// Of an edge, the area of its faces.
double area_at(const ShapeData& shape, std::uint32_t edge) {
    const auto [own, across] = faces_of(shape, edge);
    return 0.5 * length(area_normal(shape, own)) + (across == NONE ? 0 : 0.5 * length(area_normal(shape, across)));
}

float weight_of(const ShapeData& source, const ShapeData& target, const FeatureContact& found) {
    if (found.kind != FeatureKind::edges) return source.vertex_areas[found.index];
    return static_cast<float>((area_at(source, found.index) + area_at(target, found.other)) / 12);
}

// As the file counts it.
std::uint32_t file_edge(const ShapeData& shape, std::uint32_t edge) {
    return 3 * shape.mesh.triangle_index[edge / 3] + edge % 3;
}

// A cell of the outside grid that holds the point is outside as a whole.
bool known_outside(const Accelerators* mesh, const Vec3& p) {
    if (mesh == nullptr || mesh->header.grid_size[0] == 0) return false;
    const kernels::ShapeHeader& h = mesh->header;
    std::size_t cell[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const double at = (axis(p, k) - double(h.grid_low[k])) * double(h.grid_scale);
        if (!(at >= 0 && at < double(h.grid_size[k]))) return false;
        cell[k] = static_cast<std::size_t>(at);
    }
    const std::size_t bit = (cell[2] * h.grid_size[1] + cell[1]) * h.grid_size[0] + cell[0];
    return (mesh->outside_cells[bit >> 5] >> (bit & 31u) & 1u) != 0;
}

bool is_inside(const SourceMesh& placed, const Vec3& p) {
    const ShapeData& mesh = placed.target;
    return !known_outside(placed.target_accelerators, p) && encloses(mesh, p);
}

// Whether a component of the source lies in the target; needs surfaces that do not cross, and a closed target.
bool has_part_inside(const SourceMesh& placed) {
    return std::ranges::any_of(placed.source.component_vertices,
                               [&](std::uint32_t v) { return is_inside(placed, placed.vertex(v)); });
}

// The contact of a source of which a component lies wholly inside the target: its deepest vertex, the nearest face.
std::optional<FeatureContact> contact_of_inside(const SourceMesh& placed, Side source) {
    std::optional<FeatureContact> deepest;
    const ShapeData& target = placed.target;
    for (std::uint32_t v = 0; v < placed.source.points.size(); ++v) {
        if (placed.source.vertex_triangle[v] == Shape::no_triangle) continue;
        const Vec3 p = placed.vertex(v);
        if (!box_of(target).touches({p, p})) continue;
        const NearestFace nearest = nearest_face(target, p, deepest ? deepest->depth : 0);
        if (deepest && nearest.distance <= deepest->depth) continue;
        if (!is_inside(placed, p)) continue; // of another component
        const Vec3 out = nearest_point(p, target.corner(nearest.face, 0), target.corner(nearest.face, 1),
                                       target.corner(nearest.face, 2))
                         - p;
        const double depth = length(out);
        const Vec3 normal =
            depth > 1e-3 * placed.perturbation ? (1 / depth) * out : unit(area_normal(target, nearest.face));
        if (!(depth > 0)) continue;
        deepest = {source, FeatureKind::inside, v, nearest.face, p, normal, depth};
    }
    return deepest;
}

// Whether either body has a part inside the other. Of bodies whose surfaces do not cross.
bool find_inside(const PlacedBody& a, const PlacedBody& b, std::vector<FeatureContact>& found) {
    bool any = false;
    for (const Side side : {Side::a, Side::b}) {
        const SourceMesh placed = side == Side::a ? SourceMesh(a, b) : SourceMesh(b, a);
        if (placed.target.header.closed == 0 || !has_part_inside(placed)) continue;
        any = true;
        if (const auto inside = contact_of_inside(placed, side)) found.push_back(*inside);
    }
    return any;
}

void sort(std::span<NearEdge> near) {
    const auto key = [](const NearEdge& edge) { return std::tie(edge.edge, edge.face); };
    if (!std::ranges::is_sorted(near, {}, key)) std::ranges::sort(near, {}, key);
}

void place(Contact& contact, const FeatureContact& found, BodyId a, BodyId b, const PlacedBody& source,
           const PlacedBody& target, Direction direction) {
    const ShapeData &shape = source.shape->data(), &other = target.shape->data();
    const bool edges = found.kind == FeatureKind::edges;
    const ContactFeature feature =
        edges ? ContactFeature{found.kind, Side::a, file_edge(shape, found.index), file_edge(other, found.other)}
              : vertex_feature(found.source == Side::a, shape.mesh.vertex_index[found.index],
                               other.mesh.triangle_index[found.other], found.kind);
    const auto depth = static_cast<float>(found.depth);
    Vec3 out = rotated(target.centred.rotation, found.normal);
    if (found.when > 0) out = part_of_turn(out, rotated(target.next.rotation, found.normal), found.when);
    contact.is_new = false; // it awaits nothing
    write_contact(contact, a, b, feature, transform_point(target.centred, found.point), out, depth, std::fabs(depth),
                  direction == Direction::weighted ? weight_of(shape, other, found) : 1);
}

} // namespace

void EdgeStage::run(const Update& update, const ByPair<kernels::LocalContact>& local,
                    const SpeculativeVertices& speculative, std::span<const AskedPair> asked) {
    // By the places of the pairs: so a block has in most steps what it had before, and allocates nothing.
    block_count_ = asked.empty() ? 0 : (update.pairs.size() + pairs_in_block - 1) / pairs_in_block;
    if (blocks_.size() < block_count_) blocks_.resize(block_count_);
    const Question question{update, local, speculative, asked};
    // A thread takes every most_work-th block: so it is not chance what a workspace has room for.
    const std::size_t work_count = std::min(block_count_, most_work);
    if (work_.size() < work_count) work_.resize(work_count);
    update.executor.each(work_count, 1, [&](std::uint32_t w) {
        for (std::size_t b = w; b < block_count_; b += most_work) find(work_[w], question, b);
    });
    list_found(update.executor);
}

void EdgeStage::find(Workspace& work, const Question& question, std::size_t number) {
    Block& block = blocks_[number];
    block.contacts.clear();
    block.ends.clear();
    const auto at = [&](std::size_t pair) {
        return std::ranges::lower_bound(question.asked, pair, {}, &AskedPair::pair);
    };
    for (const AskedPair& asked : std::span(at(number * pairs_in_block), at((number + 1) * pairs_in_block))) {
        const std::size_t before = block.contacts.size();
        find(work, block, question, asked);
        if (block.contacts.size() > before) block.ends.emplace_back(asked.pair, block.contacts.size());
    }
}

void EdgeStage::find(Workspace& work, Block& block, const Question& question, const AskedPair& asked) {
    const SlotPair& pair = question.update.pairs[asked.pair];
    const PlacedBody &a = question.update.bodies[pair.first], &b = question.update.bodies[pair.second];
    const std::array vertices{question.local.of(2 * asked.pair), question.local.of(2 * asked.pair + 1)};
    for (const std::span<NearEdge>& near : asked.near) sort(near);
    const bool in_contact = !vertices[0].empty() || !vertices[1].empty();
    work.found.clear();
    const NearEdges near{asked.near[0], asked.near[1]};
    const Settings& settings = question.update.settings;
    // Surfaces that do not cross are apart, or one is inside the other.
    if (asked.edges && !work.edges.find(PairMeshes(a, b), near, vertices, work.found) && !in_contact) {
        const bool apart = !find_inside(a, b, work.found);
        if (asked.apart != nullptr) *asked.apart = apart && near[0].empty() && near[1].empty();
    }
    const std::span<const FeatureContact> speculative = question.speculative.of(asked.pair);
    // A vertex that edges found inside is no longer near.
    const auto is_inside = [&](const FeatureContact& ahead) {
        return std::ranges::any_of(work.found, [&](const FeatureContact& c) {
            return c.kind == FeatureKind::vertex && c.source == ahead.source && c.index == ahead.index;
        });
    };
    work.ahead.clear();
    std::ranges::copy_if(speculative, std::back_inserter(work.ahead), std::not_fn(is_inside));
    // Of two sheets vertices alone look ahead.
    if (settings.is_speculative() && asked.edges && (a.shape->has_inside() || b.shape->has_inside())) {
        find_speculative_edges({a, b, speculative_margin(settings, a, b)}, near,
                               in_contact ? least_hidden * smaller_size(a, b) : -1, work.found);
    }
    work.found.insert(work.found.end(), work.ahead.begin(), work.ahead.end());
    const auto first = static_cast<std::ptrdiff_t>(block.contacts.size());
    for (const FeatureContact& found : work.found) {
        const bool from_a = found.source == Side::a;
        place(block.contacts.emplace_back(), found, id_in(question.update.bodies, pair.first),
              id_in(question.update.bodies, pair.second), from_a ? a : b, from_a ? b : a,
              question.update.settings.direction);
    }
    std::ranges::sort(block.contacts.begin() + first, block.contacts.end(), [](const Contact& p, const Contact& q) {
        return p.key() != q.key() ? p.key() < q.key() : p.depth > q.depth;
    });
    // Parts of one edge of the file have one name: the deepest stands for all.
    const auto same = [](const Contact& p, const Contact& q) { return p.key() == q.key(); };
    block.contacts.erase(std::unique(block.contacts.begin() + first, block.contacts.end(), same), block.contacts.end());
}

std::uint64_t EdgeStage::bytes() const {
    std::uint64_t bytes = found_.size() * sizeof(PlacedContacts);
    for (std::size_t b = 0; b < block_count_; ++b) bytes += blocks_[b].contacts.capacity() * sizeof(Contact);
    return bytes;
}

void EdgeStage::list_found(Executor& executor) {
    std::size_t pairs = 0, contacts = 0;
    for (Block& block : std::span(blocks_).first(block_count_)) {
        block.first_pair = std::exchange(pairs, pairs + block.ends.size());
        block.first_contact = std::exchange(contacts, contacts + block.contacts.size());
    }
    found_.resize(pairs);
    executor.each(block_count_, 256, [&](std::uint32_t b) {
        const Block& block = blocks_[b];
        std::size_t to = block.first_pair, begin = 0;
        for (const auto& [pair, end] : block.ends) {
            found_[to++] = {pair, static_cast<std::uint32_t>(block.first_contact + begin),
                            std::span(block.contacts).subspan(begin, end - begin)};
            begin = end;
        }
    });
}

} // namespace raycontact
