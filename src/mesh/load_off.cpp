// SPDX-License-Identifier: Apache-2.0
// Our own reader: assimp reads OFF as float32 and accepts damaged lines.
#include "mesh/polygon.h"
#include "mesh/text_scanner.h"
#include "number_text.h"

#include <string>
#include <string_view>
#include <vector>

namespace raycontact {
namespace {

/// Returns the vertex count, which may follow without a blank, as in a data set of many: OFF8 12 0.
std::string_view read_header(TextScanner& scanner) {
    const std::string_view word = scanner.word();
    const std::string lower = lower_case(std::string(word));
    const std::size_t off = lower.find("off"), end = off + 3;
    if (off == std::string::npos || lower.find_first_not_of("0123456789", end) != std::string::npos)
        scanner.fail("does not start with OFF; is it an OFF file?");
    // ST, C, N: texture, colour and normal after the position, all skipped. 4 and n: other dimensions.
    if (lower.find_first_not_of("stcn") != off || word.substr(0, off).find('n') != std::string::npos)
        scanner.fail(in_quotes(word) + " is not in three dimensions; export as OFF");
    return word.size() > end ? word.substr(end) : scanner.word();
}

std::int64_t read_count(TextScanner& scanner, std::string_view word, const char* what, std::int64_t limit) {
    if (word == "BINARY") scanner.fail("binary OFF is not read; export it as text");
    const std::int64_t count = scanner.integer(word, what);
    if (count < 0 || count > limit)
        scanner.fail(std::string(what) + " " + std::to_string(count) + " does not fit the size of the file");
    return count;
}

} // namespace

Mesh read_off(const InputFile& as_stored) {
    InputFile room;
    const InputFile& file = as_utf8(as_stored, room);
    TextScanner scanner(file);
    scanner.comment = '#';
    // The shortest vertex or face line has six characters (`0 0 0\n`): no count may exceed what the file can contain.
    const auto limit = static_cast<std::int64_t>(file.bytes.size() / 6 + 1);
    const std::int64_t vertices = read_count(scanner, read_header(scanner), "vertex count", limit);
    const std::int64_t faces = read_count(scanner, scanner.word_on_line(), "face count", limit);
    scanner.next_line(); // the edge count is not used

    Mesh mesh;
    NonfiniteVertices nonfinite;
    mesh.vertices.reserve(static_cast<std::size_t>(vertices));
    for (std::int64_t i = 0; i < vertices; ++i) {
        if (scanner.at_end())
            scanner.fail("the file ends at vertex " + std::to_string(i) + " of " + std::to_string(vertices));
        scanner.vertex_on_line(mesh.vertices, nonfinite);
        scanner.numbers_on_line("colour or normal");
    }
    mesh.triangles.reserve(static_cast<std::size_t>(faces));
    std::vector<std::uint32_t> corners;
    PolygonCutter polygons;
    std::size_t edges = 0;
    for (std::int64_t i = 0; i < faces; ++i) {
        if (scanner.at_end())
            scanner.fail("the file ends at face " + std::to_string(i) + " of " + std::to_string(faces));
        const std::int64_t count = scanner.integer(scanner.word(), "corner count");
        if (count < 2) scanner.fail("a face needs at least 3 vertices, this one has " + std::to_string(count));
        corners.clear();
        for (std::int64_t k = 0; k < count; ++k) { // a count too large runs out of words on its line
            const std::int64_t index = scanner.integer(scanner.word_on_line(), "vertex index");
            if (index < 0 || index >= vertices) scanner.fail(no_vertex(index, mesh.vertices.size()));
            corners.push_back(static_cast<std::uint32_t>(index));
        }
        if (count == 2)
            ++edges;
        else
            polygons.append(mesh, corners);
        scanner.next_line(); // colours
    }
    if (!scanner.at_end())
        scanner.fail("more lines than the " + std::to_string(faces) + " faces of the header; it is damaged");
    nonfinite.finish(mesh, file);
    if (edges > 0) mesh.repairs.push_back("left out " + counted(edges, "face") + " of two corners");
    return mesh;
}

} // namespace raycontact
