// SPDX-License-Identifier: Apache-2.0
#include "mesh/gltf_moves.h"

#include <optional>
#include <string>
#include <utility>

namespace raycontact {
namespace {

using Item = GltfFile::Item;

enum ComponentType : std::size_t { unsigned_byte = 5121, unsigned_short = 5123, float32 = 5126 };

void check_count(const GltfFile& file, const Item& accessor, std::size_t vertices, const char* records = "records") {
    const std::size_t count = file.whole(accessor, "count");
    if (count != vertices) {
        file.fail(accessor,
                  "has " + std::to_string(count) + " " + records + " for " + std::to_string(vertices) + " vertices");
    }
}

enum class Four { joints, weights };

/// Of each vertex.
std::vector<double> read_four(Four what, const GltfFile& file, const Item& accessor, std::size_t vertices) {
    const std::size_t type = file.whole(accessor, "componentType");
    const bool whole = type == unsigned_byte || type == unsigned_short;
    const bool normalized = whole && file.flag(accessor, "normalized");
    if (what == Four::joints && (!whole || normalized))
        file.fail(accessor, "joints must be whole numbers of 8 or 16 bits, unsigned and not normalized");
    if (what == Four::weights && type != float32 && !normalized)
        file.fail(accessor, "weights must be float32, or normalized and of 8 or 16 bits without a sign");
    check_count(file, accessor, vertices);
    return file.read_accessor(accessor, "VEC4", 4);
}

/// Adds `weight` times another.
void add(Placement& sum, double weight, const Placement& other) {
    sum.x = sum.x + weight * other.x;
    sum.y = sum.y + weight * other.y;
    sum.z = sum.z + weight * other.z;
    sum.origin = sum.origin + weight * other.origin;
}

} // namespace

std::vector<double> morph_weights(const GltfFile& file, const Item& node, const Item& mesh) {
    const Item& of = file.member(node, "weights") ? node : mesh;
    if (!file.member(of, "weights")) return {};
    std::vector<double> weights;
    const GltfFile::json& primitives = file.list(mesh, "primitives");
    for (std::size_t i = 0; i < primitives.size(); ++i) {
        const Item primitive{primitives[i], mesh.name + ".primitives[" + std::to_string(i) + "]"};
        const std::size_t targets = file.list(primitive, "targets").size();
        if (i == 0) weights = file.numbers(of, "weights", targets);
        if (targets != weights.size()) {
            file.fail(primitive, "has " + std::to_string(targets) + " morph targets, the first primitive "
                                     + std::to_string(weights.size()));
        }
    }
    return weights;
}

void add_morph_targets(const GltfFile& file, const Item& primitive, std::span<const double> weights,
                       std::span<double> positions) {
    for (std::size_t t = 0; t < weights.size(); ++t) {
        if (weights[t] == 0) continue;
        const Item target{file.list(primitive, "targets")[t], primitive.name + ".targets[" + std::to_string(t) + "]"};
        const std::optional<Item> position = file.member(target, "POSITION");
        if (!position) continue;
        const Item accessor = file.item("accessors", file.whole(*position));
        check_count(file, accessor, positions.size() / 3, "displacements");
        // Exporters write a target that moves nothing without any data: zeros.
        if (!file.member(accessor, "bufferView") && !file.member(accessor, "sparse")) continue;
        const std::vector<double> displacements = file.read_accessor(accessor, "VEC3", 3);
        for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += weights[t] * displacements[i];
    }
}

GltfSkin::GltfSkin(const GltfFile& file, const Item& skin, std::vector<Placement> joints) : joints_(std::move(joints)) {
    if (joints_.empty()) file.fail(skin, "has no joints");
    const std::optional<Item> inverse = file.member(skin, "inverseBindMatrices");
    if (!inverse) return;
    const Item accessor = file.item("accessors", file.whole(*inverse));
    if (file.whole(accessor, "componentType") != float32) file.fail(accessor, "matrices of a skin must be float32");
    const std::vector<double> matrices = file.read_accessor(accessor, "MAT4", 16);
    if (matrices.size() / 16 < joints_.size()) {
        file.fail(skin, "has " + std::to_string(joints_.size()) + " joints, but " + accessor.name + " has only "
                            + std::to_string(matrices.size() / 16) + " matrices");
    }
    for (std::size_t j = 0; j < joints_.size(); ++j)
        joints_[j] = joints_[j].after(Placement::of_matrix(std::span(matrices).subspan(16 * j, 16)));
}

// By the sum of a vertex's weights, so that float32 ones that miss 1 by rounding do not move it.
std::vector<Placement> GltfSkin::placements(const GltfFile& file, const Item& attributes, std::size_t vertices) const {
    std::vector<Placement> placed(vertices, {{}, {}, {}, {}});
    std::vector<double> sums(vertices, 0);
    for (std::size_t set = 0;; ++set) {
        const std::string joints_key = "JOINTS_" + std::to_string(set), weights_key = "WEIGHTS_" + std::to_string(set);
        const auto has = [&](const std::string& key) { return file.member(attributes, key.c_str()).has_value(); };
        if (set > 0 && !has(joints_key) && !has(weights_key)) break;
        const Item of_joints = file.item("accessors", file.whole(attributes, joints_key.c_str())),
                   of_weights = file.item("accessors", file.whole(attributes, weights_key.c_str()));
        const std::vector<double> joints = read_four(Four::joints, file, of_joints, vertices),
                                  weights = read_four(Four::weights, file, of_weights, vertices);
        for (std::size_t i = 0; i < joints.size(); ++i) {
            const auto record = [&] { return "record " + std::to_string(i / 4) + ": "; };
            if (joints[i] >= static_cast<double>(joints_.size())) {
                file.fail(of_joints, record() + "joint " + std::to_string(static_cast<std::size_t>(joints[i]))
                                         + " is not in 0 to " + std::to_string(joints_.size()) + " - 1");
            }
            if (!(weights[i] >= 0)) file.fail(of_weights, record() + "a weight is not a number of at least 0");
            if (weights[i] == 0) continue;
            add(placed[i / 4], weights[i], joints_[static_cast<std::size_t>(joints[i])]);
            sums[i / 4] += weights[i];
        }
    }
    for (std::size_t v = 0; v < vertices; ++v) {
        if (!(sums[v] > 0)) file.fail(attributes, "vertex " + std::to_string(v) + " has no weight for any joint");
        const Placement sum = std::exchange(placed[v], {{}, {}, {}, {}});
        add(placed[v], 1 / sums[v], sum);
    }
    return placed;
}

} // namespace raycontact
