// SPDX-License-Identifier: Apache-2.0
// Our own reader: assimp reads OFF as float32 and accepts damaged lines.
#include "mesh/polygon.h"
#include "mesh/text_scanner.h"

#include <string_view>
#include <vector>

namespace raycontact {
namespace {

void check_header(TextScanner& scanner) {
    const std::string_view word = scanner.word();
    if (word.size() < 3 || word.substr(word.size() - 3) != "OFF")
        scanner.fail("does not start with OFF; is it an OFF file?");
    // ST, C, N: texture, colour and normal after the position, all skipped. 4 and n: other dimensions.
    if (word.find_first_not_of("STCN") != word.size() - 3)
        scanner.fail(in_quotes(word) + " is not in three dimensions; export as OFF");
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
    check_header(scanner);
    // The shortest vertex or face line has six characters (`0 0 0\n`): no count may exceed what the file can contain.
    const auto limit = static_cast<std::int64_t>(file.bytes.size() / 6 + 1);
    const std::int64_t vertices = read_count(scanner, scanner.word(), "vertex count", limit);
    const std::int64_t faces = read_count(scanner, scanner.word_on_line(), "face count", limit);
    scanner.next_line(); // the edge count is not used

    Mesh mesh;
    mesh.vertices.reserve(static_cast<std::size_t>(vertices));
    for (std::int64_t i = 0; i < vertices; ++i) {
        if (scanner.at_end())
            scanner.fail("the file ends at vertex " + std::to_string(i) + " of " + std::to_string(vertices));
        mesh.vertices.push_back(scanner.point_on_line());
        scanner.numbers_on_line("colour or normal");
    }
    mesh.triangles.reserve(static_cast<std::size_t>(faces));
    std::vector<std::uint32_t> corners;
    PolygonCutter polygons;
    for (std::int64_t i = 0; i < faces; ++i) {
        if (scanner.at_end())
            scanner.fail("the file ends at face " + std::to_string(i) + " of " + std::to_string(faces));
        const std::int64_t count = scanner.integer(scanner.word(), "corner count");
        if (count < 3) scanner.fail("a face needs at least 3 vertices, this one has " + std::to_string(count));
        corners.clear();
        for (std::int64_t k = 0; k < count; ++k) { // a count too large runs out of words on its line
            const std::int64_t index = scanner.integer(scanner.word_on_line(), "vertex index");
            if (index < 0 || index >= vertices) scanner.fail(no_vertex(index, mesh.vertices.size()));
            corners.push_back(static_cast<std::uint32_t>(index));
        }
        polygons.append(mesh, corners);
        scanner.next_line(); // colours
    }
    if (!scanner.at_end())
        scanner.fail("more lines than the " + std::to_string(faces) + " faces of the header; it is damaged");
    return mesh;
}

} // namespace raycontact
