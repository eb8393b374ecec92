// SPDX-License-Identifier: Apache-2.0
#include "cli/clash_tree.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <map>
#include <vector>

namespace raycontact {

namespace {

/// Places in a list, so that a deep tree is no deep recursion. Those under a node come in the order of their parts.
class Tree {
public:
    explicit Tree(std::span<const AssemblyPart> parts) : parts_(parts) {
        for (std::size_t i = 0; i < parts.size(); ++i) {
            std::size_t node = 0;
            for (const std::string& name : parts[i].under) node = child_of(node, name);
            nodes_[node].lines.push_back({true, i});
        }
    }

    std::string text() const {
        std::string text;
        std::vector<std::pair<std::size_t, std::size_t>> open{{0, 0}}; // a node, and which of its lines comes next
        while (!open.empty()) {
            auto& [node, next] = open.back();
            if (next == nodes_[node].lines.size()) {
                open.pop_back();
                continue;
            }
            const Line line = nodes_[node].lines[next++];
            text.append(2 * (open.size() - 1), ' ');
            if (line.is_part) {
                const AssemblyPart& part = parts_[line.number];
                text += fmt::format("{}  ({} triangles)\n", part.name, part.mesh->triangles.size());
            } else {
                text += nodes_[line.number].name + "/\n";
                open.emplace_back(line.number, 0);
            }
        }
        return text;
    }

private:
    struct Line {
        bool is_part;
        std::size_t number; ///< of a part, or of a node
    };
    struct Node {
        std::string name;
        std::vector<Line> lines;
        std::map<std::string, std::size_t> children;
    };

    std::size_t child_of(std::size_t node, const std::string& name) {
        const auto [found, is_new] = nodes_[node].children.try_emplace(name, nodes_.size());
        const std::size_t child = found->second;
        if (is_new) {
            nodes_[node].lines.push_back({false, child});
            nodes_.push_back({name, {}, {}});
        }
        return child;
    }

    std::span<const AssemblyPart> parts_;
    std::vector<Node> nodes_{1};
};

} // namespace

std::string tree_text(std::span<const AssemblyPart> parts) {
    return Tree(parts).text();
}

std::string tree_json(std::span<const AssemblyPart> parts) {
    std::string text;
    for (const AssemblyPart& part : parts) {
        const nlohmann::ordered_json line{{"name", part.name},
                                          {"path", path_of(part)},
                                          {"under", part.under},
                                          {"file", part.file},
                                          {"triangles", part.mesh->triangles.size()}};
        text += line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
    }
    return text;
}

} // namespace raycontact
