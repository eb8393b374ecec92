// SPDX-License-Identifier: Apache-2.0
#include "mesh/gltf_morph.h"

#include <optional>
#include <string>

namespace raycontact {

using Item = GltfFile::Item;

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
        const std::size_t count = file.whole(accessor, "count");
        if (count != positions.size() / 3) {
            file.fail(accessor, "has " + std::to_string(count) + " displacements for "
                                    + std::to_string(positions.size() / 3) + " vertices");
        }
        // Exporters write a target that moves nothing without any data: zeros.
        if (!file.member(accessor, "bufferView") && !file.member(accessor, "sparse")) continue;
        const std::vector<double> displacements = file.read_accessor(accessor, "VEC3", 3);
        for (std::size_t i = 0; i < positions.size(); ++i) positions[i] += weights[t] * displacements[i];
    }
}

} // namespace raycontact
