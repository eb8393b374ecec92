// SPDX-License-Identifier: Apache-2.0
// Our own reader: assimp reads OFF as float32 and accepts damaged lines.
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

std::uint64_t read_count(TextScanner& scanner, std::string_view word, const char* what, std::size_t limit) {
    if (word == "BINARY") scanner.fail("binary OFF is not read; export it as text");
    const std::int64_t count = scanner.integer(word, what);
    if (count < 0 || static_cast<std::uint64_t>(count) > limit) {
        scanner.fail(std::string(what) + " " + std::to_string(count) + " does not fit the size of the file");
    }
    return static_cast<std::uint64_t>(count);
}

} // namespace

Mesh read_off(const InputFile& file) {
    TextScanner scanner(file, 0, 1);
    scanner.comment = '#';
    check_header(scanner);
    // The shortest vertex or face line has six characters (`0 0 0\n`): no count may promise more than the file holds.
    const std::size_t limit = file.bytes.size() / 6 + 1;
    const std::uint64_t vertices = read_count(scanner, scanner.word(), "vertex count", limit);
    const std::uint64_t faces = read_count(scanner, scanner.word_on_line(), "face count", limit);
    scanner.next_line(); // the edge count is not used

    Mesh mesh;
    mesh.vertices.reserve(vertices);
    for (std::uint64_t i = 0; i < vertices; ++i) {
        const std::string_view x = scanner.word();
        if (x.empty()) scanner.fail("the file ends at vertex " + std::to_string(i) + " of " + std::to_string(vertices));
        Vec3 point;
        point.x = scanner.number(x, "coordinate");
        point.y = scanner.number(scanner.word_on_line(), "coordinate");
        point.z = scanner.number(scanner.word_on_line(), "coordinate");
        mesh.vertices.push_back(point);
        for (std::string_view more = scanner.word_on_line(); !more.empty(); more = scanner.word_on_line()) {
            scanner.number(more, "colour or normal");
        }
    }
    mesh.triangles.reserve(faces);
    std::vector<std::uint32_t> corners;
    for (std::uint64_t i = 0; i < faces; ++i) {
        const std::string_view first = scanner.word();
        if (first.empty()) scanner.fail("the file ends at face " + std::to_string(i) + " of " + std::to_string(faces));
        const std::int64_t count = scanner.integer(first, "corner count");
        if (count < 3) scanner.fail("a face needs at least 3 vertices, this one has " + std::to_string(count));
        corners.clear();
        for (std::int64_t k = 0; k < count; ++k) { // a count too large runs out of words on its line
            const std::int64_t index = scanner.integer(scanner.word_on_line(), "vertex index");
            if (index < 0 || static_cast<std::uint64_t>(index) >= vertices) {
                scanner.fail("vertex index " + std::to_string(index) + " is not in 0 to " + std::to_string(vertices)
                             + " - 1");
            }
            corners.push_back(static_cast<std::uint32_t>(index));
        }
        append_fan(mesh, corners);
        scanner.next_line(); // colours
    }
    if (!scanner.at_end()) {
        scanner.word();
        scanner.fail("more lines than the " + std::to_string(faces) + " faces of the header; it is damaged");
    }
    return mesh;
}

} // namespace raycontact
