// SPDX-License-Identifier: Apache-2.0
#include "mesh/byte_reader.h"
#include "mesh/gltf_json.h"
#include "mesh/input_file.h"

#include <raycontact/error.h>

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace raycontact {
namespace {

using Matrix = std::array<double, 16>; // row-major, affine

Matrix multiply(const Matrix& a, const Matrix& b) {
    Matrix product{};
    for (std::size_t r = 0; r < 4; ++r) {
        for (std::size_t c = 0; c < 4; ++c) {
            for (std::size_t k = 0; k < 4; ++k) product[4 * r + c] += a[4 * r + k] * b[4 * k + c];
        }
    }
    return product;
}

/// Numbers of an accessor: `components` a record, `stride` bytes apart, all inside the buffer.
struct Records {
    const unsigned char* data = nullptr; ///< null: all zero (a sparse accessor without a base)
    std::size_t count = 0, stride = 0, components = 0;
    int component_type = 0;
    bool normalized = false;
};

class GltfReader {
public:
    GltfReader(const InputFile& file, const tinygltf::Model& model) : file_(file), model_(model) {}

    Mesh read() {
        for (const std::string& extension : model_.extensionsRequired) {
            if (extension != "KHR_mesh_quantization" && extension.find("materials") == std::string::npos
                && extension.find("texture") == std::string::npos && extension.find("lights") == std::string::npos) {
                file_.fail("needs the extension " + in_quotes(extension) + "; export without it");
            }
        }
        find_parents();
        mark_scene();
        for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
            const int mesh = model_.nodes[n].mesh;
            if (!placed_[n] || mesh < 0) continue;
            if (static_cast<std::size_t>(mesh) >= model_.meshes.size())
                fail_node(n, "mesh " + std::to_string(mesh) + " does not exist");
            const Matrix& to_root = placement(n);
            for (const double entry : to_root) {
                if (!std::isfinite(entry)) fail_node(n, "its transform is not finite");
            }
            for (const tinygltf::Primitive& primitive : model_.meshes[static_cast<std::size_t>(mesh)].primitives) {
                read_primitive(primitive, to_root);
            }
        }
        return std::move(mesh_);
    }

private:
    [[noreturn]] void fail_node(std::size_t node, const std::string& what) const {
        file_.fail("node " + std::to_string(node) + ": " + what);
    }

    void find_parents() {
        constexpr int none = -1;
        parents_.assign(model_.nodes.size(), none);
        known_.assign(model_.nodes.size(), 0);
        to_root_.resize(model_.nodes.size());
        for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
            for (const int child : model_.nodes[n].children) {
                if (child < 0 || static_cast<std::size_t>(child) >= model_.nodes.size()) {
                    fail_node(n, "child " + std::to_string(child) + " does not exist");
                }
                int& parent = parents_[static_cast<std::size_t>(child)];
                if (parent != none)
                    fail_node(static_cast<std::size_t>(child), "has two parents; nodes must form a tree");
                parent = static_cast<int>(n);
            }
        }
        // With one parent each, a node from which the way up does not end lies on or below a cycle.
        std::vector<char> ends(model_.nodes.size(), 0);
        for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
            std::size_t steps = 0;
            int at = static_cast<int>(n);
            while (at != none && !ends[static_cast<std::size_t>(at)]) {
                if (++steps > model_.nodes.size()) fail_node(n, "is its own ancestor; nodes must form a tree");
                at = parents_[static_cast<std::size_t>(at)];
            }
            for (at = static_cast<int>(n); at != none && !ends[static_cast<std::size_t>(at)];
                 at = parents_[static_cast<std::size_t>(at)]) {
                ends[static_cast<std::size_t>(at)] = 1;
            }
        }
    }

    // The nodes of the default scene, or the first; all of them where the file has no scene.
    void mark_scene() {
        placed_.assign(model_.nodes.size(), model_.scenes.empty() ? 1 : 0);
        if (model_.scenes.empty()) return;
        const int scene = model_.defaultScene >= 0 ? model_.defaultScene : 0;
        if (static_cast<std::size_t>(scene) >= model_.scenes.size())
            file_.fail("scene " + std::to_string(scene) + " does not exist");
        std::vector<int> open(model_.scenes[static_cast<std::size_t>(scene)].nodes);
        while (!open.empty()) {
            const int node = open.back();
            open.pop_back();
            if (node < 0 || static_cast<std::size_t>(node) >= model_.nodes.size()) {
                file_.fail("scene " + std::to_string(scene) + ": node " + std::to_string(node) + " does not exist");
            }
            char& placed = placed_[static_cast<std::size_t>(node)];
            if (placed) continue;
            placed = 1;
            const std::vector<int>& children = model_.nodes[static_cast<std::size_t>(node)].children;
            open.insert(open.end(), children.begin(), children.end());
        }
    }

    Matrix local_matrix(std::size_t n) const {
        const tinygltf::Node& node = model_.nodes[n];
        Matrix m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
        if (!node.matrix.empty()) {
            if (node.matrix.size() != 16) fail_node(n, "its matrix has not 16 numbers");
            for (std::size_t r = 0; r < 4; ++r) {
                for (std::size_t c = 0; c < 4; ++c) m[4 * r + c] = node.matrix[4 * c + r]; // the file is column-major
            }
            return m;
        }
        const auto check = [&](const std::vector<double>& list, std::size_t size, const char* what) {
            if (!list.empty() && list.size() != size)
                fail_node(n, std::string("its ") + what + " has not " + std::to_string(size) + " numbers");
            return !list.empty();
        };
        if (check(node.rotation, 4, "rotation")) {
            const double x = node.rotation[0], y = node.rotation[1], z = node.rotation[2], w = node.rotation[3];
            const double norm = x * x + y * y + z * z + w * w;
            if (!(norm > 0)) fail_node(n, "its rotation is zero");
            const double s = 2 / norm;
            m = {1 - s * (y * y + z * z),
                 s * (x * y - z * w),
                 s * (x * z + y * w),
                 0,
                 s * (x * y + z * w),
                 1 - s * (x * x + z * z),
                 s * (y * z - x * w),
                 0,
                 s * (x * z - y * w),
                 s * (y * z + x * w),
                 1 - s * (x * x + y * y),
                 0,
                 0,
                 0,
                 0,
                 1};
        }
        if (check(node.scale, 3, "scale")) {
            for (std::size_t r = 0; r < 3; ++r) {
                for (std::size_t c = 0; c < 3; ++c) m[4 * r + c] *= node.scale[c];
            }
        }
        if (check(node.translation, 3, "translation")) {
            for (std::size_t r = 0; r < 3; ++r) m[4 * r + 3] = node.translation[r];
        }
        return m;
    }

    // Kept for every node on the way up, so that a deep chain costs each of its nodes once.
    const Matrix& placement(std::size_t n) {
        std::vector<std::size_t> chain;
        for (int up = static_cast<int>(n); up >= 0; up = parents_[static_cast<std::size_t>(up)]) {
            if (known_[static_cast<std::size_t>(up)]) break;
            chain.push_back(static_cast<std::size_t>(up));
        }
        std::reverse(chain.begin(), chain.end());
        for (const std::size_t node : chain) {
            const Matrix local = local_matrix(node);
            const int parent = parents_[node];
            to_root_[node] = parent < 0 ? local : multiply(to_root_[static_cast<std::size_t>(parent)], local);
            known_[node] = 1;
        }
        return to_root_[n];
    }

    // A range of a buffer, checked: `count` records of `size` bytes, `stride` apart.
    const unsigned char* view(int index, std::size_t offset, std::size_t count, std::size_t size,
                              std::size_t& stride) const {
        const std::string where = "buffer view " + std::to_string(index) + " ";
        if (index < 0 || static_cast<std::size_t>(index) >= model_.bufferViews.size())
            file_.fail(where + "does not exist");
        const tinygltf::BufferView& range = model_.bufferViews[static_cast<std::size_t>(index)];
        if (range.buffer < 0 || static_cast<std::size_t>(range.buffer) >= model_.buffers.size()) {
            file_.fail(where + "names a buffer that does not exist");
        }
        const std::vector<unsigned char>& bytes = model_.buffers[static_cast<std::size_t>(range.buffer)].data;
        if (range.byteOffset > bytes.size() || range.byteLength > bytes.size() - range.byteOffset) {
            file_.fail(where + "reaches beyond its buffer of " + std::to_string(bytes.size()) + " bytes");
        }
        stride = range.byteStride != 0 ? range.byteStride : size;
        if (stride < size) file_.fail(where + "has a stride of " + std::to_string(stride) + ", less than a record");
        const bool fits = offset <= range.byteLength && size <= range.byteLength - offset
                          && count - 1 <= (range.byteLength - offset - size) / stride;
        if (count > 0 && !fits) file_.fail(where + "is too short for the " + std::to_string(count) + " records in it");
        return bytes.data() + range.byteOffset + offset;
    }

    Records records(int index, int type, const char* what) const {
        const std::string where = "accessor " + std::to_string(index) + " ";
        if (index < 0 || static_cast<std::size_t>(index) >= model_.accessors.size())
            file_.fail(where + "does not exist");
        const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
        if (accessor.type != type) file_.fail(where + "has not the type of " + what);
        Records found;
        found.count = accessor.count;
        found.components = type == TINYGLTF_TYPE_VEC3 ? 3 : 1;
        found.component_type = accessor.componentType;
        found.normalized = accessor.normalized;
        if (accessor.bufferView >= 0) {
            const std::size_t size = found.components * component_size(found.component_type);
            found.data = view(accessor.bufferView, accessor.byteOffset, found.count, size, found.stride);
        } else if (found.count > most_zeros) {
            file_.fail(where + "has " + std::to_string(found.count) + " records and no data");
        }
        return found;
    }

    std::size_t component_size(int type) const {
        switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            file_.fail("component type " + std::to_string(type) + " is unknown");
        }
    }

    // glTF is little endian. Normalised whole numbers become -1 to 1, as KHR_mesh_quantization says.
    static double component(const unsigned char* raw, int type, bool normalized) {
        const char* const at = reinterpret_cast<const char*>(raw);
        switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE: {
            const double value = read_bytes<std::int8_t>(at);
            return normalized ? std::max(value / 127, -1.0) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return read_bytes<std::uint8_t>(at) / (normalized ? 255.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_SHORT: {
            const double value = read_bytes<std::int16_t>(at);
            return normalized ? std::max(value / 32767, -1.0) : value;
        }
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return read_bytes<std::uint16_t>(at) / (normalized ? 65535.0 : 1.0);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return read_bytes<std::uint32_t>(at);
        default:
            return read_bytes<float>(at);
        }
    }

    static Vec3 point_at(const unsigned char* at, std::size_t size, int type, bool normalized) {
        return {component(at, type, normalized), component(at + size, type, normalized),
                component(at + 2 * size, type, normalized)};
    }

    std::vector<Vec3> positions(int index) const {
        const Records list = records(index, TINYGLTF_TYPE_VEC3, "positions");
        const std::size_t size = component_size(list.component_type);
        std::vector<Vec3> points(list.count);
        for (std::size_t i = 0; list.data != nullptr && i < list.count; ++i) {
            points[i] = point_at(list.data + i * list.stride, size, list.component_type, list.normalized);
        }
        const auto& sparse = model_.accessors[static_cast<std::size_t>(index)].sparse;
        if (sparse.isSparse) {
            if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0) {
                file_.fail("accessor " + std::to_string(index) + " has a negative count or offset");
            }
            const auto count = static_cast<std::size_t>(sparse.count);
            std::size_t index_stride = 0, value_stride = 0;
            const unsigned char* const at =
                view(sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count,
                     component_size(sparse.indices.componentType), index_stride);
            const unsigned char* const values =
                view(sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), count, 3 * size,
                     value_stride);
            for (std::size_t i = 0; i < count; ++i) {
                const double where = component(at + i * index_stride, sparse.indices.componentType, false);
                if (!(where >= 0 && where < static_cast<double>(points.size())))
                    file_.fail("accessor " + std::to_string(index) + " replaces a record it has not");
                points[static_cast<std::size_t>(where)] =
                    point_at(values + i * value_stride, size, list.component_type, list.normalized);
            }
        }
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!std::isfinite(points[i].x) || !std::isfinite(points[i].y) || !std::isfinite(points[i].z)) {
                file_.fail("accessor " + std::to_string(index) + ", record " + std::to_string(i)
                           + ": a coordinate is not finite");
            }
        }
        return points;
    }

    std::vector<std::uint32_t> corners(const tinygltf::Primitive& primitive, std::size_t vertices) const {
        std::vector<std::uint32_t> list;
        if (primitive.indices < 0) {
            list.resize(vertices);
            for (std::size_t i = 0; i < vertices; ++i) list[i] = static_cast<std::uint32_t>(i);
            return list;
        }
        const Records found = records(primitive.indices, TINYGLTF_TYPE_SCALAR, "indices");
        const int type = found.component_type;
        if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT
            && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
            file_.fail("accessor " + std::to_string(primitive.indices)
                       + ": indices must be whole numbers without sign");
        }
        if (found.data == nullptr)
            file_.fail("accessor " + std::to_string(primitive.indices) + ": indices without data");
        list.reserve(found.count);
        for (std::size_t i = 0; i < found.count; ++i) {
            const double index = component(found.data + i * found.stride, type, false);
            if (!(index < static_cast<double>(vertices))) {
                file_.fail("accessor " + std::to_string(primitive.indices) + ", record " + std::to_string(i)
                           + ": vertex index " + std::to_string(static_cast<std::uint32_t>(index)) + " is not in 0 to "
                           + std::to_string(vertices) + " - 1");
            }
            list.push_back(static_cast<std::uint32_t>(index));
        }
        return list;
    }

    void read_primitive(const tinygltf::Primitive& primitive, const Matrix& m) {
        const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
        if (mode != TINYGLTF_MODE_TRIANGLES && mode != TINYGLTF_MODE_TRIANGLE_STRIP
            && mode != TINYGLTF_MODE_TRIANGLE_FAN)
            return;
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) return; // allowed, and nothing to see
        const std::vector<Vec3> points = positions(position->second);
        const std::vector<std::uint32_t> list = corners(primitive, points.size());

        const std::size_t base = mesh_.vertices.size();
        if (base + points.size() >= 0xffffffffu) file_.fail("has too many vertices; split or reduce it");
        for (const Vec3& p : points) {
            const Vec3 placed{m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3], m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
                              m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
            if (!std::isfinite(placed.x) || !std::isfinite(placed.y) || !std::isfinite(placed.z)) {
                file_.fail("vertex " + std::to_string(mesh_.vertices.size())
                           + " is not finite once placed by its node");
            }
            mesh_.vertices.push_back(placed);
        }
        // A mirroring node turns the winding over (glTF 2.0, section 3.7.4).
        const double determinant = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8])
                                   + m[2] * (m[4] * m[9] - m[5] * m[8]);
        const auto add = [&](std::size_t i, std::size_t j, std::size_t k) {
            if (determinant < 0) std::swap(j, k);
            const auto first = static_cast<std::uint32_t>(base);
            mesh_.triangles.push_back({first + list[i], first + list[j], first + list[k]});
        };
        if (mode == TINYGLTF_MODE_TRIANGLES) {
            if (list.size() % 3 != 0)
                file_.fail("a primitive of triangles has " + std::to_string(list.size())
                           + " corners, not a multiple of 3");
            for (std::size_t i = 0; i + 2 < list.size(); i += 3) add(i, i + 1, i + 2);
        } else {
            for (std::size_t i = 0; i + 2 < list.size(); ++i) {
                if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
                    add(i, i + 1 + i % 2, i + 2 - i % 2);
                } else {
                    add(0, i + 1, i + 2);
                }
            }
        }
    }

    static constexpr std::size_t most_zeros = 1u << 24; // a sparse accessor may start from nothing, within reason

    const InputFile& file_;
    const tinygltf::Model& model_;
    std::vector<int> parents_;
    std::vector<char> placed_, known_;
    std::vector<Matrix> to_root_;
    Mesh mesh_;
};

bool file_exists(const std::string& path, void*) {
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
}

std::string same_path(const std::string& path, void*) {
    return path;
}

// Buffers beside the file are read with the same care as the file itself.
bool read_whole_file(std::vector<unsigned char>* out, std::string* message, const std::string& path, void*) {
    try {
        const InputFile file = InputFile::read(path);
        out->assign(file.bytes.begin(), file.bytes.end());
        return true;
    } catch (const InputError& error) {
        *message += error.what();
        return false;
    }
}

// Pictures are of no use here and would only be one more thing that can be damaged.
bool skip_image(tinygltf::Image*, const int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
    return true;
}

} // namespace

Mesh read_gltf(const InputFile& file) {
    if (file.bytes.size() >= 0xffffffffu) file.fail("has more than 4 GiB, the limit of the format");
    check_gltf_json(file);
    tinygltf::TinyGLTF loader;
    loader.SetFsCallbacks({&file_exists, &same_path, &read_whole_file, nullptr, nullptr});
    loader.SetImageLoader(&skip_image, nullptr);
    tinygltf::Model model;
    std::string error, warning;
    const auto length = static_cast<unsigned int>(file.bytes.size());
    const std::string folder = file.path.parent_path().string();
    bool loaded = false;
    try {
        loaded =
            file.bytes.starts_with("glTF")
                ? loader.LoadBinaryFromMemory(&model, &error, &warning,
                                              reinterpret_cast<const unsigned char*>(file.bytes.data()), length, folder)
                : loader.LoadASCIIFromString(&model, &error, &warning, file.bytes.data(), length, folder);
    } catch (const std::exception& damage) { // the JSON parser's own
        error = damage.what();
    }
    if (!loaded) {
        while (!error.empty() && (error.back() == '\n' || error.back() == ' ')) error.pop_back();
        file.fail("is no sound glTF file: " + (error.empty() ? "it is damaged" : printable(error)));
    }
    return GltfReader(file, model).read();
}

} // namespace raycontact
