// SPDX-License-Identifier: Apache-2.0
#include "cli/commands.h"

#include "cli/cavities_option.h"
#include "cli/common_options.h"
#include "cli/pairs_file.h"
#include "cli/separation.h"
#include "cli/weld_option.h"

#include <raycontact/collide.h>
#include <raycontact/error.h>
#include <raycontact/scene.h>
#include <raycontact/separation.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>
#include <memory>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace raycontact;
using Json = nlohmann::ordered_json;

struct CollideCommand {
    std::string a, b, pairs_file;
    std::vector<double> at, turn; ///< of b
    bool json = false, separation = false;
    Settings settings;
    std::optional<Nesting> nested;
    std::optional<double> weld; ///< metres
};

/// Shapes by file and scale: a batch usually names a few meshes in thousands of pairs.
class ShapeCache {
public:
    ShapeCache(Nesting nesting, std::optional<double> weld, std::uint32_t threads)
        : nesting_(nesting), weld_(weld), threads_(threads) {}
    std::shared_ptr<const Shape> get(const PairBody& body) {
        auto& shape = shapes_[{body.file.string(), body.scale}];
        if (!shape) shape = make(body);
        return shape;
    }
    void warn(const Settings& settings) const {
        for (const auto& [body, shape] : shapes_) warn_if_coarse(*shape, settings);
    }

private:
    std::shared_ptr<const Shape> make(const PairBody& body) const {
        try {
            Mesh mesh = load_mesh(body.file);
            for (Vec3& v : mesh.vertices) {
                v = {v.x * body.scale, v.y * body.scale, v.z * body.scale};
                if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z)) {
                    throw InputError(body.file.string() + fmt::format(": too large to be scaled by {}", body.scale));
                }
            }
            if (weld_) mesh = weld_mesh(std::move(mesh), *weld_);
            return Shape::make(prepare_mesh(mesh, {.nesting = nesting_, .check = Check::topology, .threads = threads_}),
                               threads_);
        } catch (const InputError& error) {
            throw InputError(body.where.empty() ? error.what() : body.where + ": " + error.what());
        }
    }

    Nesting nesting_;
    std::optional<double> weld_;
    std::uint32_t threads_;
    std::map<std::pair<std::string, double>, std::shared_ptr<const Shape>> shapes_;
};

Json to_json(const Vec3& p) {
    return {p.x, p.y, p.z};
}

const char* name_of(FeatureKind kind) {
    constexpr const char* names[] = {"vertex", "edges", "inside", "vertex_face", "faces", "round"};
    return names[static_cast<std::size_t>(kind)];
}

Json to_json(const Contact& contact) {
    Json json{{"feature", name_of(contact.feature.kind)},
              {"point", to_json(contact.point())},
              {"point_a", to_json(contact.point_a)},
              {"point_b", to_json(contact.point_b)},
              {"normal", {contact.normal.x, contact.normal.y, contact.normal.z}},
              {"depth", contact.depth},
              {"ray_length", contact.ray_length},
              {"weight", contact.weight},
              {"key", fmt::format("{:016x}", contact.key())}};
    if (contact.feature.kind == FeatureKind::edges) {
        json["edge_a"] = contact.feature.index_a;
        json["edge_b"] = contact.feature.index_b;
    } else if (contact.feature.kind == FeatureKind::faces) {
        json["triangle_a"] = contact.feature.index_a;
        json["triangle_b"] = contact.feature.index_b;
    } else {
        json["vertex_body"] = contact.feature.source == Side::a ? "a" : "b";
        json["vertex"] = contact.feature.source_index();
        json["triangle"] = contact.feature.other_index();
    }
    return json;
}

/// apart: how far they are, metres; 0: they intersect.
void print_json(std::size_t index, double apart, std::span<const Contact> contacts,
                const std::optional<Separation>& separation) {
    Json list = Json::array();
    for (const Contact& contact : contacts) list.push_back(to_json(contact));
    Json line{{"pair", index},
              {"colliding", !contacts.empty()},
              {"intersecting", apart == 0},
              {"distance", apart},
              {"contacts", std::move(list)}};
    if (separation) line["separation"] = separation_json(*separation);
    std::cout << line.dump() << '\n';
}

/// Columns as wide as their longest text, to the right but for the first two.
void print_rows(const std::vector<std::vector<std::string>>& rows) {
    std::vector<std::size_t> widths(rows[0].size(), 0);
    for (const auto& row : rows)
        for (std::size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
    for (const auto& row : rows) {
        for (std::size_t k = 0; k < row.size(); ++k)
            std::cout << (k < 2 ? fmt::format("  {:<{}}", row[k], widths[k])
                                : fmt::format("  {:>{}}", row[k], widths[k]));
        std::cout << '\n';
    }
}

/// Numbers in full: six digits are metres where coordinates are of a country's map.
void print_table(std::size_t index, const QueryPair& pair, double apart, std::span<const Contact> contacts,
                 const std::optional<Separation>& separation, bool weighted) {
    const bool intersecting = apart == 0;
    const std::string distance = fmt::format("apart by {} m", apart);
    const std::string end =
        separation && intersecting ? "; " + separation_words(*separation, "m") + "\n" : std::string("\n");
    std::cout << fmt::format("pair {}: {} and {}: ", index, pair[0].file.string(), pair[1].file.string());
    if (contacts.empty()) {
        std::cout << (intersecting ? "intersecting, 0 contacts (touching, or no rule of contact applies)" : distance)
                  << end;
        return;
    }
    const auto deepest = std::max_element(contacts.begin(), contacts.end(),
                                          [](const Contact& p, const Contact& q) { return p.depth < q.depth; });
    std::cout << fmt::format("{}, {} contact{}{}, deepest {} m{}", intersecting ? "intersecting" : distance,
                             contacts.size(), contacts.size() == 1 ? "" : "s",
                             intersecting ? "" : " of open meshes, each behind the other", deepest->depth, end);
    std::vector<std::vector<std::string>> rows{{"body", "feature", "number", "triangle", "depth (m)", "ray (m)",
                                                "x (m)", "y (m)", "z (m)", "normal x", "normal y", "normal z"}};
    if (weighted) rows[0].emplace_back("weight (m^2)");
    for (const Contact& c : contacts) {
        std::vector<std::string>& row = rows.emplace_back();
        const auto add = [&](auto value) { row.push_back(fmt::format("{}", value)); };
        add(c.feature.source == Side::a ? "a" : "b");
        add(name_of(c.feature.kind));
        add(c.feature.source_index());
        add(c.feature.other_index());
        for (const float number : {c.depth, c.ray_length}) add(number);
        for (const double number : {c.point().x, c.point().y, c.point().z}) add(number);
        for (const float number : {c.normal.x, c.normal.y, c.normal.z}) add(number + 0.0f); // no -0
        if (weighted) add(c.weight);
    }
    print_rows(rows);
}

/// Bodies 2i and 2i + 1 are a and b of pair i, so a is always the lower one. One batch is one step; its size bounds
/// the memory of a query of any length.
StepStats collide_batch(const Settings& settings, std::span<const QueryPair> pairs, ShapeCache& shapes,
                        std::size_t first, const CollideCommand& options) {
    Scene scene(settings);
    std::vector<Pair> list;
    list.reserve(pairs.size());
    for (const QueryPair& pair : pairs) {
        const BodyId a = scene.add(shapes.get(pair[0]), pair[0].pose);
        const BodyId b = scene.add(shapes.get(pair[1]), pair[1].pose);
        list.emplace_back(a, b);
    }
    const std::span<const Contact> contacts = scene.find_contacts(list);
    std::size_t begin = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        std::size_t end = begin;
        while (end < contacts.size() && contacts[end].body_a == list[i].first) ++end;
        const auto own = contacts.subspan(begin, end - begin);
        const auto [a, b] = list[i];
        // A contact shows that they intersect, unless neither has an inside.
        const bool solid = scene.shape(a).has_inside() || scene.shape(b).has_inside();
        const double apart = solid && !own.empty() ? 0 : scene.distance(a, b)->distance;
        std::optional<Separation> parted;
        if (options.separation) parted = separation(scene.shape(a), pairs[i][0].pose, scene.shape(b), pairs[i][1].pose);
        if (options.json)
            print_json(first + i, apart, own, parted);
        else
            print_table(first + i, pairs[i], apart, own, parted, settings.direction == Direction::weighted);
        begin = end;
    }
    return scene.stats();
}

/// Turned about x, then y, then z, all through its origin, and then moved.
Pose pose_of(const CollideCommand& options) {
    for (const auto& [name, numbers] : {std::pair{"--at", &options.at}, std::pair{"--turn", &options.turn}})
        for (const double x : *numbers)
            if (!std::isfinite(x)) throw InputError(fmt::format("{}: {} is not a finite number", name, x));
    Pose pose;
    for (std::size_t k = 0; k < options.turn.size(); ++k) {
        const double angle = options.turn[k] * std::numbers::pi / 180;
        // A quarter turn exactly, so that faces stay aligned.
        const double quarters = std::fmod(options.turn[k] / 90, 4);
        const bool whole = quarters == std::floor(quarters);
        const double c = whole ? std::round(std::cos(angle)) : std::cos(angle);
        const double s = whole ? std::round(std::sin(angle)) : std::sin(angle);
        const std::size_t u = (k + 1) % 3, v = (k + 2) % 3;
        for (std::size_t column = 0; column < 3; ++column) {
            double &p = pose.rotation[3 * u + column], &q = pose.rotation[3 * v + column];
            const double turned = c * p - s * q;
            q = s * p + c * q;
            p = turned;
        }
    }
    if (!options.at.empty()) pose.translation = {options.at[0], options.at[1], options.at[2]};
    return pose;
}

std::vector<QueryPair> query_of(const CollideCommand& options) {
    if (!options.pairs_file.empty()) return read_pairs_file(options.pairs_file);
    if (options.a.empty() || options.b.empty()) {
        throw InputError("collide: give two mesh files, or --pairs with a pairs file");
    }
    QueryPair pair;
    pair[0].file = options.a;
    pair[1].file = options.b;
    pair[1].pose = pose_of(options);
    return {pair};
}

void collide(const CollideCommand& options) {
    check_common_options(options.settings);
    const std::vector<QueryPair> pairs = query_of(options);
    if (pairs.empty() && !options.json) std::cout << "0 pairs\n";
    ShapeCache shapes(options.nested.value_or(Nesting::as_wound), options.weld, options.settings.execution.threads);
    for (const QueryPair& pair : pairs) {
        for (const PairBody& body : pair) shapes.get(body);
    }
    const Scene checks_the_settings(options.settings);
    shapes.warn(options.settings);
    std::uint64_t kept = 0, left_out = 0;
    constexpr std::size_t batch = 4096;
    for (std::size_t first = 0; first < pairs.size(); first += batch) {
        const std::size_t count = std::min(batch, pairs.size() - first);
        const StepStats stats =
            collide_batch(options.settings, std::span(pairs).subspan(first, count), shapes, first, options);
        kept += stats.contacts;
        left_out += stats.contacts_reduced;
    }
    if (left_out > 0)
        std::cerr << fmt::format("collide: {} of {} contacts are left out by --max-contacts-per-pair or "
                                 "--max-contacts\n",
                                 left_out, kept + left_out);
}

} // namespace

void add_collide(CLI::App& app) {
    CLI::App* command = app.add_subcommand("collide", "Find the contacts of two meshes, or of many pairs at once");
    auto options = std::make_shared<CollideCommand>();
    CLI::Option* a = command->add_option("A", options->a, "the first mesh file");
    CLI::Option* b = command->add_option("B", options->b, "the second mesh file");
    command
        ->add_option("--pairs", options->pairs_file,
                     "a JSON file of pairs: [{\"a\", \"b\", \"pose_a\", \"pose_b\", \"scale_a\", \"scale_b\"}, ...]")
        ->type_name("FILE")
        ->excludes(a)
        ->excludes(b);
    const auto three = [&](const char* name, std::vector<double>& numbers, const char* help) {
        command->add_option(name, numbers, help)->delimiter(',')->expected(3)->type_name("X,Y,Z")->needs(b);
    };
    three("--at", options->at, "move B there, metres");
    three("--turn", options->turn, "turn B first, degrees: about the axes x, then y, then z, through its origin");
    command->add_flag("--separation", options->separation,
                      "also find the translation that parts two meshes (slow: seconds for large ones)");
    command->add_flag("--json", options->json, "print one JSON line a pair on stdout");
    add_cavities_option(*command, options->nested);
    add_weld_option(*command, options->weld);
    add_common_options(*command, options->settings);
    command->callback([options] { collide(*options); });
}
