// SPDX-License-Identifier: Apache-2.0
// Our own reader: assimp welds and reorders vertices by its own rules, keeps text coordinates as float32 and accepts
// truncated files without an error.
#include "interruption.h"
#include "mesh/groups.h"
#include "mesh/text_scanner.h"
#include "mesh/vector.h"
#include "number_text.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

constexpr std::size_t header_size = 84, facet_size = 50;

std::string unnamed_solid(std::size_t number) {
    return "solids[" + std::to_string(number) + "]";
}

std::uint32_t announced_facets(const InputFile& file) {
    return read_bytes<std::uint32_t>(file.bytes.data() + 80);
}

/// The bytes that a facet's attribute says follow it, where it counts any.
std::size_t payload_at(const InputFile& file, std::size_t facet) {
    return read_bytes<std::uint16_t>(file.bytes.data() + facet + 48);
}

/// Whether each facet has a payload as long as its attribute says, up to the very end of the file.
bool has_payloads(const InputFile& file) {
    std::size_t at = header_size;
    for (std::uint64_t left = announced_facets(file); left > 0; --left) {
        if (file.bytes.size() - at < facet_size) return false;
        at += facet_size + payload_at(file, at);
        if (at > file.bytes.size()) return false;
    }
    return at == file.bytes.size();
}

/// Facets that follow each other.
struct Run {
    std::size_t begin, count; ///< byte of the first
};

/// A run for each of the files that were joined end to end to this one; none where they do not fill it exactly.
std::vector<Run> joined_files(const InputFile& file) {
    std::vector<Run> runs;
    for (std::size_t at = 0; at < file.bytes.size();) {
        const std::size_t left = file.bytes.size() - at;
        if (left < header_size) return {};
        const std::size_t count = read_bytes<std::uint32_t>(file.bytes.data() + at + 80);
        if (count == 0 || count > (left - header_size) / facet_size) return {};
        runs.push_back({at + header_size, count});
        at += header_size + count * facet_size;
    }
    return runs;
}

void add_facets(Mesh& mesh, const InputFile& file, const Run& run, bool payloads) {
    std::size_t facet = run.begin;
    const InterruptionCheck check;
    for (std::size_t i = 0; i < run.count; ++i) {
        check();
        const char* const corners = file.bytes.data() + facet + 12; // past the normal
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (std::size_t k = 0; k < 3; ++k) {
            const char* const at = corners + 12 * k;
            const Vec3 point{read_bytes<float>(at), read_bytes<float>(at + 4), read_bytes<float>(at + 8)};
            if (!is_finite(point))
                file.fail("facet " + std::to_string(mesh.triangles.size()) + ": a coordinate is not finite");
            mesh.vertices.push_back(point);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
        facet += facet_size + (payloads ? payload_at(file, facet) : 0);
    }
}

Mesh read_facets(const InputFile& file, std::size_t facets, bool payloads) {
    Mesh mesh;
    mesh.vertices.reserve(3 * facets);
    mesh.triangles.reserve(facets);
    add_facets(mesh, file, {header_size, facets}, payloads);
    return mesh;
}

Mesh read_binary(const InputFile& file, Groups& solids) {
    if (const std::vector<Run> runs = joined_files(file); !runs.empty()) {
        Mesh mesh;
        mesh.vertices.reserve(3 * (file.bytes.size() / facet_size));
        mesh.triangles.reserve(file.bytes.size() / facet_size);
        std::size_t number = 0;
        for (const Run& run : runs) {
            solids.begin(unnamed_solid(number++), mesh.triangles.size());
            add_facets(mesh, file, run, false);
        }
        return mesh;
    }
    const std::size_t announced = announced_facets(file), size = file.bytes.size() - header_size;
    if (has_payloads(file)) {
        Mesh mesh = read_facets(file, announced, true);
        mesh.repairs.push_back("skipped the attributes behind the facets, "
                               + counted(size - announced * facet_size, "byte"));
        return mesh;
    }
    // Writers that do not know the count beforehand leave one of these.
    const bool open = announced == 0 || announced == 0xffffffffu;
    if (!open && size < announced * facet_size) {
        file.fail("a binary STL file of " + std::to_string(announced) + " facets has "
                  + std::to_string(header_size + announced * facet_size) + " bytes, this one "
                  + std::to_string(file.bytes.size()) + "; it is truncated or damaged");
    }
    const std::size_t room = size / facet_size, facets = open || size % facet_size == 0 ? room : announced;
    Mesh mesh = read_facets(file, facets, false);
    if (facets != announced) {
        mesh.repairs.push_back("counted " + counted(facets, "facet") + " from the file's size, as its header says "
                               + std::to_string(announced));
    }
    if (const std::size_t rest = size - facets * facet_size; rest > 0)
        mesh.repairs.push_back("left out " + counted(rest, "byte") + " behind the last facet");
    return mesh;
}

class AsciiStl {
public:
    explicit AsciiStl(const InputFile& file) : file_(file), scanner_(file) {}

    Mesh read() {
        for (std::string_view word = first_word(); !word.empty(); word = scanner_.word()) {
            if (!same(word, "solid")) complain(word, "solid");
            std::string name = printable(scanner_.rest_of_line());
            if (name.empty()) name = unnamed_solid(solids_);
            ++solids_;
            groups_.begin(std::move(name), mesh_.triangles.size());
            while (read_facet()) {
            }
            scanner_.next_line(); // the name again
        }
        return std::move(mesh_);
    }
    const Groups& groups() const { return groups_; }

private:
    /// Lines before the first one of the format are comments.
    std::string_view first_word() {
        constexpr std::array<std::string_view, 7> statements{"solid",   "facet",    "outer",   "vertex",
                                                             "endloop", "endfacet", "endsolid"};
        for (std::string_view word = scanner_.word(); !word.empty(); word = scanner_.word()) {
            if (std::ranges::any_of(statements, [&](std::string_view statement) { return same(word, statement); }))
                return word;
            scanner_.next_line();
        }
        file_.fail(
            "is neither a text STL file, which has a line `solid`, nor a binary one; it is damaged or of another "
            "format");
    }

    // False at `endsolid`.
    bool read_facet() {
        const std::string_view word = scanner_.word();
        if (same(word, "endsolid")) return false;
        if (!same(word, "facet")) complain(word, "facet or endsolid");
        expect("normal");
        // The numbers are not read: the winding gives the normal, and exporters write nan for slivers.
        for (int i = 0; i < 3; ++i) {
            if (scanner_.word().empty()) complain({}, "a normal");
        }
        expect("outer");
        expect("loop");
        const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
        for (int i = 0; i < 3; ++i) {
            expect("vertex");
            mesh_.vertices.push_back(scanner_.point_on_line());
        }
        expect("endloop");
        expect("endfacet");
        mesh_.triangles.push_back({first, first + 1, first + 2});
        return true;
    }

    static bool same(std::string_view word, std::string_view lower) {
        return std::ranges::equal(word, lower, [](char found, char wanted) { return (found | 0x20) == wanted; });
    }

    void expect(std::string_view lower) {
        const std::string_view word = scanner_.word();
        if (!same(word, lower)) complain(word, std::string(lower));
    }

    [[noreturn]] void complain(std::string_view found, const std::string& wanted) const {
        scanner_.fail(found.empty() ? "the file ends where " + wanted + " should be; it is truncated"
                                    : in_quotes(found) + " where " + wanted + " should be");
    }

    const InputFile& file_;
    TextScanner scanner_;
    Mesh mesh_;
    Groups groups_;
    std::size_t solids_ = 0;
};

/// Many binary files start with the word `solid`, too. Their count tells them apart: its last byte is less than any of
/// a text up to 150 million facets. Larger files are told by their length.
bool is_binary(const InputFile& file) {
    const std::size_t announced = announced_facets(file);
    const bool utf16 = file.bytes.starts_with("\xff\xfe") || file.bytes.starts_with("\xfe\xff");
    return file.bytes.size() == header_size + announced * facet_size
           || (!utf16 && (announced < 0x09000000u || announced == 0xffffffffu));
}

/// With its solids.
std::pair<Mesh, Groups> read_solids(const InputFile& file) {
    if (file.bytes.size() < header_size)
        file.fail("has " + counted(file.bytes.size(), "byte")
                  + ", fewer than an STL file with a facet; it is truncated or of another format");
    if (is_binary(file)) {
        Groups solids;
        Mesh mesh = read_binary(file, solids);
        return {std::move(mesh), std::move(solids)};
    }
    InputFile room;
    AsciiStl text(as_utf8(file, room));
    Mesh mesh = text.read();
    return {std::move(mesh), text.groups()};
}

} // namespace

Mesh read_stl(const InputFile& file) {
    return read_solids(file).first;
}

std::vector<AssemblyPart> read_stl_parts(const InputFile& file, std::vector<std::string>& notes) {
    auto [mesh, solids] = read_solids(file);
    mesh.name = file.name();
    return solids.parts(std::move(mesh), notes);
}

} // namespace raycontact
