// SPDX-License-Identifier: Apache-2.0
// Our own reader: assimp welds and reorders vertices by its own rules, keeps text coordinates as float32 and accepts
// truncated files without an error.
#include "mesh/text_scanner.h"
#include "mesh/vector.h"

#include <algorithm>
#include <string_view>

namespace raycontact {
namespace {

constexpr std::size_t header_size = 84, facet_size = 50;

Mesh read_binary(const InputFile& file, std::size_t facets) {
    Mesh mesh;
    mesh.vertices.reserve(3 * facets);
    mesh.triangles.reserve(facets);
    for (std::size_t i = 0; i < facets; ++i) {
        const char* const corners = file.bytes.data() + header_size + i * facet_size + 12; // past the normal
        const auto first = static_cast<std::uint32_t>(3 * i);
        for (std::size_t k = 0; k < 3; ++k) {
            const char* const at = corners + 12 * k;
            const Vec3 point{read_bytes<float>(at), read_bytes<float>(at + 4), read_bytes<float>(at + 8)};
            if (!is_finite(point)) file.fail("facet " + std::to_string(i) + ": a coordinate is not finite");
            mesh.vertices.push_back(point);
        }
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    return mesh;
}

class AsciiStl {
public:
    explicit AsciiStl(const InputFile& file) : scanner_(file) {}

    Mesh read() {
        while (!scanner_.at_end()) {
            expect("solid");
            scanner_.next_line(); // the name is free text
            while (read_facet()) {
            }
            scanner_.next_line(); // the name again
        }
        return std::move(mesh_);
    }

private:
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

    TextScanner scanner_;
    Mesh mesh_;
};

} // namespace

Mesh read_stl(const InputFile& file) {
    // Many binary files start with the word `solid` too: only the length tells them apart.
    const std::size_t size = file.bytes.size();
    const std::uint64_t facets = size >= header_size ? read_bytes<std::uint32_t>(file.bytes.data() + 80) : 0;
    if (size >= header_size && size == header_size + facets * facet_size) return read_binary(file, facets);
    InputFile room;
    const InputFile& text = as_utf8(file, room);
    const std::size_t mark = text.bytes.starts_with("\xef\xbb\xbf") ? 3 : 0; // of the byte order
    const std::size_t start = text.bytes.find_first_not_of(" \t\r\n", mark);
    if (start != std::string::npos
        && (text.bytes.compare(start, 5, "solid") == 0 || text.bytes.compare(start, 5, "SOLID") == 0)) {
        return AsciiStl(text).read();
    }
    if (size < header_size) {
        file.fail("is neither an ASCII STL file (`solid`) nor long enough for a binary one; it is truncated or of "
                  "another format");
    }
    file.fail("a binary STL file of " + std::to_string(facets) + " facets has "
              + std::to_string(header_size + facets * facet_size) + " bytes, this one " + std::to_string(size)
              + "; it is truncated or damaged");
}

} // namespace raycontact
