// SPDX-License-Identifier: Apache-2.0
// Our own reader: tinyobjloader reads `v 1 abc nan` as 1 0 0 without an error, and names no line for a damaged face.
// The tests compare with it on valid files.
#include "mesh/polygon.h"
#include "mesh/text_scanner.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

// The format's statements besides `v` and `f`. Any other word is damage: a lost `v` would shift every index after it.
constexpr auto other_statements = std::to_array<std::string_view>(
    {"vt",   "vn",    "vp",       "cstype",   "deg",  "bmat",       "step",      "p",      "l",      "curv", "curv2",
     "surf", "parm",  "trim",     "hole",     "scrv", "sp",         "end",       "con",    "g",      "s",    "mg",
     "o",    "bevel", "c_interp", "d_interp", "lod",  "usemtl",     "mtllib",    "usemap", "maplib", "call", "csh",
     "res",  "bsp",   "bzp",      "cdc",      "cdp",  "shadow_obj", "trace_obj", "ctech",  "stech"});

class ObjReader {
public:
    explicit ObjReader(const InputFile& file) : file_(file), scanner_(file) {
        scanner_.comment = '#';
        scanner_.joins_lines = true;
    }

    Mesh read() {
        do {
            const std::string_view statement = scanner_.word_on_line();
            if (statement == "v") {
                read_vertex();
            } else if (statement == "f" || statement == "fo") {
                read_face();
            } else if (!statement.empty() && std::ranges::find(other_statements, statement) == other_statements.end()) {
                scanner_.fail(in_quotes(statement) + " is no OBJ statement; the file is damaged or of another format");
            }
            while (!scanner_.word_on_line().empty()) continue; // a statement may go on on the next line
        } while (scanner_.next_line());
        for (const auto& [vertex, line] : forward_) {
            if (vertex >= mesh_.vertices.size()) {
                file_.fail_at(line, "vertex " + std::to_string(vertex + 1)
                                        + " (counted from 1, as OBJ does) does not exist; the file has "
                                        + std::to_string(mesh_.vertices.size()));
            }
        }
        polygons_.finish(mesh_);
        return std::move(mesh_);
    }

private:
    // x y z, then perhaps w, or a colour, or both.
    void read_vertex() {
        mesh_.vertices.push_back(scanner_.point_on_line());
        if (scanner_.numbers_on_line("vertex weight or colour") > 5) scanner_.fail("too many numbers for a vertex");
    }

    void read_face() {
        corners_.clear();
        for (std::string_view word = scanner_.word_on_line(); !word.empty(); word = scanner_.word_on_line()) {
            const std::size_t slash = word.find('/');
            corners_.push_back(resolve(scanner_.integer(word.substr(0, slash), "vertex index")));
            if (slash != std::string_view::npos) check_others(word.substr(slash + 1));
        }
        if (corners_.size() < 3) scanner_.fail("a face needs at least 3 vertices");
        polygons_.append(mesh_, corners_);
    }

    std::uint32_t resolve(std::int64_t index) {
        const auto count = static_cast<std::int64_t>(mesh_.vertices.size());
        if (index == 0) scanner_.fail("vertex index 0; OBJ counts from 1");
        if (index < -count) {
            scanner_.fail("vertex index " + std::to_string(index) + " reaches before the first of "
                          + std::to_string(count));
        }
        if (index > 0xffffffffll) scanner_.fail("vertex index " + std::to_string(index) + " is out of range");
        const auto vertex = static_cast<std::uint32_t>(index > 0 ? index - 1 : count + index);
        if (index > count) forward_.emplace_back(vertex, scanner_.line());
        return vertex;
    }

    // Texture and normal indices are not used, but one that is not a number is damage.
    void check_others(std::string_view rest) {
        const std::size_t slash = rest.find('/');
        const std::string_view texture = rest.substr(0, slash);
        if (!texture.empty()) scanner_.integer(texture, "texture index");
        if (slash != std::string_view::npos) scanner_.integer(rest.substr(slash + 1), "normal index");
    }

    const InputFile& file_;
    TextScanner scanner_;
    Mesh mesh_;
    PolygonCutter polygons_;
    std::vector<std::uint32_t> corners_;
    /// Vertices that come later in the file than a face that uses them, which is legal; with the line of the face.
    std::vector<std::pair<std::uint32_t, std::size_t>> forward_;
};

} // namespace

Mesh read_obj(const InputFile& file) {
    InputFile room;
    return ObjReader(as_utf8(file, room)).read();
}

} // namespace raycontact
