// SPDX-License-Identifier: Apache-2.0
// The scene of a glTF file: where its nodes place meshes, and their triangles.
#include "mesh/gltf_file.h"
#include "mesh/gltf_moves.h"
#include "mesh/nonfinite_vertices.h"
#include "mesh/part_path.h"
#include "mesh/vector.h"

#include <raycontact/assembly.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

using nlohmann::json;

class GltfReader : GltfFile {
public:
    using GltfFile::GltfFile;

    Mesh read() {
        for_each_placed_mesh([&](const PlacedMesh& placed) { read_mesh(placed, placed.placement); });
        mesh_.repairs = notes();
        return std::move(mesh_);
    }

    /// Each node that places a mesh by itself, but for those without triangles.
    std::vector<AssemblyPart> read_parts(std::vector<std::string>& told) {
        std::map<std::string, std::shared_ptr<const Mesh>> known;
        std::vector<AssemblyPart> parts;
        std::vector<std::size_t> places; // of their nodes
        for_each_placed_mesh([&](const PlacedMesh& placed) {
            if (!is_finite(placed.placement.origin)) fail(placed.node, "is placed where no number is finite");
            const auto [pose, own] = scales_.split(placed.placement);
            auto& made = known[key_of(placed, own)];
            if (!made) {
                read_mesh(placed, own);
                before_ += mesh_.vertices.size() + mesh_.triangles.size();
                mesh_.name = placed.name;
                made = std::make_shared<const Mesh>(std::exchange(mesh_, {}));
            }
            if (made->triangles.empty()) return;
            std::size_t& part = nodes_[placed.place].part;
            if (part == AssemblyPart::no_part) part = parts.size(); // of instances the first
            places.push_back(placed.place);
            parts.push_back({placed.name, made, pose});
        });
        for (const std::size_t n : from_roots_) {
            if (nodes_[n].parent == AssemblyPart::no_part) continue;
            const Node& parent = nodes_[nodes_[n].parent];
            nodes_[n].above = parent.part != AssemblyPart::no_part ? parent.part : parent.above;
        }
        name_nodes();
        for (std::size_t i = 0; i < parts.size(); ++i) {
            parts[i].parent = nodes_[places[i]].above;
            parts[i].under = ancestors_of(places[i]);
        }
        const std::vector<std::string> own = notes();
        told.insert(told.end(), own.begin(), own.end());
        return parts;
    }

private:
    struct Node {
        std::vector<std::size_t> children;
        bool waits = false; ///< for its parent to be placed
        bool in_scene = false;
        const char* left_out = nullptr;             ///< why it is, with all below it
        Placement placement;                        ///< in its parent, then in the scene
        std::size_t parent = AssemblyPart::no_part; ///< a node
        std::size_t part = AssemblyPart::no_part;   ///< that it is
        std::size_t above = AssemblyPart::no_part;  ///< the nearest part that it is under
    };

    /// A mesh as a node has it.
    struct PlacedMesh {
        Item node, mesh;
        std::size_t place;               ///< of the node
        std::string name;                ///< of the node, and of which of its instances
        std::size_t number;              ///< of the mesh
        std::optional<std::size_t> skin; ///< which places each vertex by itself
        std::vector<double> weights;     ///< of its morph targets
        Placement placement;             ///< in the scene; none where a skin places it
    };

    /// Calls visit(PlacedMesh) in node order.
    template <class Visit>
    void for_each_placed_mesh(Visit&& visit) {
        read_buffers();
        place_nodes();
        constexpr std::size_t most_primitives = 1u << 22; // empty ones cost time, too
        std::size_t primitives = 0;
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            const Item node = item("nodes", n);
            const std::optional<Item> named = member(node, "mesh"), skin = member(node, "skin");
            if (!named) continue;
            const std::size_t number = whole(*named);
            const Item mesh = item("meshes", number);
            const char* const left_out = nodes_[n].left_out;
            if (left_out || !nodes_[n].in_scene) {
                left_out_[left_out ? left_out : "not in the scene"].push_back(name_of(node));
                continue;
            }
            const bool is_instanced = has_extension(node, instancing);
            if (is_instanced && skin) fail(node, "has instances of a mesh with a skin; export them as nodes");
            const std::vector<Placement> instances =
                is_instanced ? own_instances(node) : std::vector<Placement>(1, Placement());
            for (std::size_t i = 0; i < instances.size(); ++i) {
                primitives += list(mesh, "primitives").size();
                if (primitives > most_primitives) file().fail("places too many primitives; split or reduce it");
                PlacedMesh placed{node, mesh, n, name_of(node), number, {}, morph_weights(*this, node, mesh), {}};
                if (is_instanced) placed.name.append("[").append(std::to_string(i)).append("]");
                count_moves(placed.weights.size());
                if (skin)
                    read_skin(placed.skin.emplace(whole(*skin)));
                else
                    placed.placement = nodes_[n].placement.after(instances[i]);
                visit(placed);
            }
            if (with_others_.contains(number)) left_out_["points, lines or no positions"].push_back(name_of(node));
        }
    }

    /// Names of nodes; those that stand beside each other under one name are numbered.
    void name_nodes() {
        std::map<std::pair<std::size_t, std::string>, std::size_t> count, number;
        const auto key_of = [&](std::size_t n) { return std::pair(nodes_[n].parent, name_of(item("nodes", n))); };
        for (std::size_t n = 0; n < nodes_.size(); ++n)
            if (nodes_[n].in_scene && !nodes_[n].children.empty()) ++count[key_of(n)];
        shown_.resize(nodes_.size());
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            if (!nodes_[n].in_scene || nodes_[n].children.empty()) continue;
            const auto key = key_of(n);
            shown_[n] = key.second;
            if (count[key] > 1) shown_[n].append(" #").append(std::to_string(++number[key]));
        }
    }

    std::vector<std::string> ancestors_of(std::size_t node) const {
        Ancestors found;
        for (std::size_t n = nodes_[node].parent; n != AssemblyPart::no_part; n = nodes_[n].parent)
            if (!found.add(shown_[n])) break;
        return std::move(found).from_root();
    }

    /// In the node's frame (EXT_mesh_gpu_instancing).
    std::vector<Placement> own_instances(const Item& node) const {
        const Item attributes = needed(*extension(node, instancing), "attributes");
        std::optional<std::size_t> count;
        const auto read_list = [&](const char* key, const char* type, std::size_t width) -> std::vector<double> {
            const std::optional<Item> named = member(attributes, key);
            if (!named) return {};
            const Item accessor = item("accessors", whole(*named));
            std::vector<double> found = read_accessor(accessor, type, width);
            if (count && *count != found.size() / width) fail(accessor, "has not as many instances as the others");
            count = found.size() / width;
            return found;
        };
        const std::vector<double> moves = read_list("TRANSLATION", "VEC3", 3), turns = read_list("ROTATION", "VEC4", 4),
                                  scales = read_list("SCALE", "VEC3", 3);
        if (!count) fail(attributes, "has no TRANSLATION, ROTATION or SCALE; export the instances as nodes");
        const auto of = [](const std::vector<double>& list, std::size_t i, std::size_t width) {
            return list.empty() ? std::span<const double>() : std::span(list).subspan(i * width, width);
        };
        std::vector<Placement> found;
        for (std::size_t i = 0; i < *count; ++i)
            found.push_back(placement_of(node, of(moves, i, 3), of(turns, i, 4), of(scales, i, 3)));
        return found;
    }

    /// What was left out or not understood, in words.
    std::vector<std::string> notes() const {
        std::vector<std::string> found;
        for (const auto& [why, names] : left_out_) {
            std::string text = "left out";
            for (const std::string& name : names)
                text.append(&name == &names[0] ? " '" : ", '").append(name).append("'");
            found.push_back(text + ": " + why);
        }
        for (const std::string& name : unread_extensions())
            found.push_back("left out what the extension " + in_quotes(name) + " moves or adds; it is not read");
        if (nonfinite_ > 0) found.push_back(left_out_nonfinite(nonfinite_));
        return found;
    }

    void read_skin(std::size_t number) {
        if (skins_.contains(number)) return;
        const Item skin = item("skins", number);
        std::vector<Placement> joints;
        for (const std::size_t n : node_list(skin, "joints")) joints.push_back(nodes_[n].placement);
        if (const std::optional<Item> matrices = member(skin, "inverseBindMatrices"))
            count_moves(whole(item("accessors", whole(*matrices)), "count"));
        skins_.emplace(number, GltfSkin(*this, skin, std::move(joints)));
    }

    void read_mesh(const PlacedMesh& placed, const Placement& placement) {
        const json& primitives = list(placed.mesh, "primitives");
        for (std::size_t i = 0; i < primitives.size(); ++i) {
            const std::string name = placed.mesh.name + ".primitives[" + std::to_string(i) + "]";
            read_primitive({primitives[i], name}, placed, placement);
        }
    }

    /// The same for meshes that are the same once `own` is done to them.
    static std::string key_of(const PlacedMesh& placed, const Placement& own) {
        std::string key;
        const auto add = [&](const auto& value) { key.append(reinterpret_cast<const char*>(&value), sizeof value); };
        add(placed.number);
        add(placed.skin ? *placed.skin + 1 : std::size_t{0});
        for (const Vec3& v : {own.x, own.y, own.z}) add(v);
        for (const double weight : placed.weights) add(weight);
        return key;
    }

    /// A list of nodes.
    std::vector<std::size_t> node_list(const Item& of, const char* key) const {
        std::vector<std::size_t> found;
        for (const json& entry : list(of, key)) {
            found.push_back(whole({entry, of.name + "." + key}));
            if (found.back() >= nodes_.size()) fail(of, "node " + std::to_string(found.back()) + " does not exist");
        }
        return found;
    }

    // From the roots down, so that a deep chain costs each of its nodes once.
    void place_nodes() {
        nodes_.resize(list(root(), "nodes").size());
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            const Item node = item("nodes", n);
            const std::optional<Item> visible = extension(node, visibility), lod = extension(node, levels);
            if (visible && member(*visible, "visible") && !flag(*visible, "visible"))
                nodes_[n].left_out = "hidden (KHR_node_visibility)";
            if (lod)
                for (const std::size_t level : node_list(*lod, "ids"))
                    nodes_[level].left_out = "lower levels of detail (MSFT_lod)";
            nodes_[n].placement = own_placement(node);
            nodes_[n].children = node_list(node, "children");
            for (const std::size_t child : nodes_[n].children) {
                if (nodes_[child].waits)
                    fail(node, "its child " + std::to_string(child) + " has two parents; nodes must form a tree");
                nodes_[child].waits = true;
                nodes_[child].parent = n;
            }
        }
        // The default scene, or the first; all nodes where the file has no scene.
        std::vector<std::size_t> order(nodes_.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        const bool has_scene = !list(root(), "scenes").empty() || member(root(), "scene");
        for (const std::size_t n : has_scene ? node_list(item("scenes", whole(root(), "scene", 0)), "nodes") : order)
            nodes_[n].in_scene = true;
        std::erase_if(order, [&](std::size_t n) { return nodes_[n].waits; });
        if (const std::optional<Item> moved = extension(root(), centre)) {
            const std::vector<double> to = numbers(*moved, "center", 3);
            if (to.empty()) fail(*moved, "has no center");
            for (const std::size_t n : order)
                nodes_[n].placement.origin = nodes_[n].placement.origin + Vec3{to[0], to[1], to[2]};
        }
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Node& parent = nodes_[order[i]];
            for (const std::size_t c : parent.children) {
                Node& child = nodes_[c];
                child.placement = parent.placement.after(child.placement);
                child.in_scene = child.in_scene || parent.in_scene;
                if (parent.left_out) child.left_out = parent.left_out;
                child.waits = false;
                order.push_back(c);
            }
        }
        for (std::size_t n = 0; n < nodes_.size(); ++n) {
            if (nodes_[n].waits) fail(item("nodes", n), "is its own ancestor; nodes must form a tree");
        }
        from_roots_ = std::move(order);
    }

    Placement own_placement(const Item& node) const {
        if (const std::vector<double> m = numbers(node, "matrix", 16); !m.empty()) // by columns
            return Placement::of_matrix(m);
        return placement_of(node, numbers(node, "translation", 3), numbers(node, "rotation", 4),
                            numbers(node, "scale", 3));
    }

    /// Any of the three may be empty.
    Placement placement_of(const Item& node, std::span<const double> t, std::span<const double> q,
                           std::span<const double> scale) const {
        Placement own;
        if (!q.empty()) {
            const double x = q[0], y = q[1], z = q[2], w = q[3];
            const double norm = x * x + y * y + z * z + w * w;
            if (!(norm > 0)) fail(node, "its rotation is zero");
            const double s = 2 / norm;
            own.x = {1 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)};
            own.y = {s * (x * y - z * w), 1 - s * (x * x + z * z), s * (y * z + x * w)};
            own.z = {s * (x * z + y * w), s * (y * z - x * w), 1 - s * (x * x + y * y)};
        }
        if (!scale.empty()) {
            own.x = scale[0] * own.x;
            own.y = scale[1] * own.y;
            own.z = scale[2] * own.z;
        }
        if (!t.empty()) own.origin = {t[0], t[1], t[2]};
        return own;
    }

    std::vector<std::uint32_t> corners(const Item& primitive, std::size_t vertices) const {
        std::vector<std::uint32_t> list(vertices);
        std::iota(list.begin(), list.end(), 0u);
        const std::optional<Item> indices = member(primitive, "indices");
        if (!indices) return list;
        const Item accessor = item("accessors", whole(*indices));
        index_type(accessor);
        if (flag(accessor, "normalized")) fail(accessor, "indices must not be normalized");
        list.clear();
        for (const double index : read_accessor(accessor, "SCALAR", 1)) {
            if (index >= static_cast<double>(vertices)) {
                fail(accessor, "record " + std::to_string(list.size()) + ": "
                                   + no_vertex(static_cast<std::int64_t>(index), vertices));
            }
            list.push_back(static_cast<std::uint32_t>(index));
        }
        return list;
    }

    /// Nodes times primitives grow faster than any file: what they place is bounded by what the file holds.
    void check_growth(std::size_t more) const {
        constexpr std::size_t always = 1u << 20, for_a_byte = 4;
        const std::size_t most = std::max(always, for_a_byte * bytes());
        if (before_ + mesh_.vertices.size() + mesh_.triangles.size() + more > most) {
            file().fail("places the same meshes so often that over " + std::to_string(most)
                        + " vertices and triangles come of its " + std::to_string(bytes())
                        + " bytes; split it or reduce the meshes");
        }
    }

    /// What morph targets and joints do grows so, too.
    void count_moves(std::size_t more) {
        constexpr std::size_t always = 1u << 24, for_a_byte = 16;
        moves_ += more;
        if (moves_ > std::max(always, for_a_byte * bytes())) {
            file().fail("moves its vertices by morph targets and joints more often than its " + std::to_string(bytes())
                        + " bytes allow; export it without them");
        }
    }

    /// Appends the vertices of a primitive. Returns which of them are mirrored.
    std::vector<char> place_vertices(const Item& primitive, const Item& accessor, std::span<double> positions,
                                     std::span<const std::uint32_t> corners, const PlacedMesh& placed,
                                     const Placement& placement) {
        const std::size_t count = positions.size() / 3;
        const Item attributes = needed(primitive, "attributes");
        const auto idle = static_cast<std::size_t>(std::ranges::count(placed.weights, 0.0));
        const std::size_t lists = placed.weights.size() - idle + (placed.skin ? attributes.value.size() : 0);
        constexpr std::size_t to_open = 64; // a list takes the time of so many of its records
        count_moves(placed.weights.size() + lists * (to_open + count));
        add_morph_targets(*this, primitive, placed.weights, positions);
        std::vector<Placement> by_joints;
        if (placed.skin) by_joints = skins_.at(*placed.skin).placements(*this, attributes, count);
        std::vector<char> mirrored, used;
        mirrored.reserve(count);
        for (std::size_t v = 0; v < count; ++v) {
            const Placement& own = placed.skin ? by_joints[v] : placement;
            mirrored.push_back(own.mirrors() ? 1 : 0);
            mesh_.vertices.push_back(own.placed({positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]}));
            if (is_finite(mesh_.vertices.back())) continue;
            if (used.empty()) {
                used.resize(count);
                for (const std::uint32_t corner : corners) used[corner] = 1;
            }
            if (used[v] != 0) {
                fail(accessor,
                     "record " + std::to_string(v) + " is not finite where " + placed.node.name + " places it");
            }
            ++nonfinite_;
            mesh_.vertices.back() = placement.origin;
        }
        return mirrored;
    }

    void read_primitive(const Item& primitive, const PlacedMesh& placed, const Placement& placement) {
        constexpr std::size_t triangles = 4, strip = 5, fan = 6;
        const std::size_t mode = whole(primitive, "mode", triangles);
        if (mode > fan) fail(primitive, "mode " + std::to_string(mode) + " is not in 0 to 6");
        const std::optional<Item> position = member(needed(primitive, "attributes"), "POSITION");
        if (mode < triangles || !position) { // allowed, and nothing to see
            with_others_.insert(placed.number);
            return;
        }
        const Item accessor = item("accessors", whole(*position));
        if (has_extension(primitive, draco) && !member(accessor, "bufferView")) fail_of_compression("Draco");
        std::vector<double> points = read_accessor(accessor, "VEC3", 3);
        const std::size_t base = mesh_.vertices.size();
        if (base + points.size() / 3 > most_vertices) file().fail("has too many vertices; split or reduce it");
        check_growth(points.size() / 3);
        const std::vector<std::uint32_t> list = corners(primitive, points.size() / 3);
        const std::size_t more = mode == triangles ? list.size() / 3 : std::max<std::size_t>(list.size(), 2) - 2;
        if (mesh_.triangles.size() + more > most_triangles) file().fail("has too many triangles; split or reduce it");
        check_growth(points.size() / 3 + more);
        const std::vector<char> mirrored = place_vertices(primitive, accessor, points, list, placed, placement);
        if (mode == triangles && list.size() % 3 != 0) {
            fail(primitive, "triangles have " + std::to_string(list.size()) + " corners, not a multiple of 3");
        }
        for (std::size_t i = 0; i + 2 < list.size(); i += mode == triangles ? 3 : 1) {
            const std::size_t odd = mode == strip ? i % 2 : 0;
            std::array triangle{list[mode == fan ? 0 : i], list[i + 1 + odd], list[i + 2 - odd]};
            // Mirrored, its winding turns over (glTF 2.0, section 3.7.4).
            if (mirrored[triangle[0]] + mirrored[triangle[1]] + mirrored[triangle[2]] > 1)
                std::swap(triangle[1], triangle[2]);
            for (std::uint32_t& corner : triangle) corner += static_cast<std::uint32_t>(base);
            mesh_.triangles.push_back(triangle);
        }
    }

    std::vector<Node> nodes_;
    std::vector<std::string> shown_;                           ///< names of nodes in paths
    std::vector<std::size_t> from_roots_;                      ///< nodes, each after its parent
    std::map<std::size_t, GltfSkin> skins_;                    ///< that were read
    std::map<std::string, std::vector<std::string>> left_out_; ///< why, and the names of the nodes
    std::set<std::size_t> with_others_;                        ///< meshes that hold more than triangles
    std::size_t nonfinite_ = 0;                                ///< vertices that no triangle uses
    std::size_t moves_ = 0;                                    ///< steps of morph targets and skins
    PartScales scales_;
    std::size_t before_ = 0; ///< vertices and triangles of the meshes before this one, where they are read apart
    Mesh mesh_;
};

template <class Read>
auto told(const InputFile& file, Read&& read) {
    try {
        return read();
    } catch (const json::parse_error& damage) {
        file.fail("is no sound glTF file: its JSON is damaged at byte " + std::to_string(damage.byte));
    } catch (const json::out_of_range&) {
        file.fail("is no sound glTF file: a number of its JSON is too large");
    } catch (const json::exception& error) {
        file.fail("is no sound glTF file: " + printable(error.what()));
    }
}

} // namespace

Mesh read_gltf(const InputFile& file) {
    return told(file, [&] { return GltfReader(file).read(); });
}

std::vector<AssemblyPart> read_gltf_parts(const InputFile& file, std::vector<std::string>& notes) {
    return told(file, [&] { return GltfReader(file).read_parts(notes); });
}

} // namespace raycontact
