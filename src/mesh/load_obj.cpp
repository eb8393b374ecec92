// SPDX-License-Identifier: Apache-2.0
// Our own reader: tinyobjloader reads `v 1 abc nan` as 1 0 0 without an error, and names no line for a damaged face.
// The tests compare with it on valid files.
#include "mesh/check.h"
#include "mesh/groups.h"
#include "mesh/polygon.h"
#include "mesh/text_scanner.h"
#include "number_text.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

// The format's statements that say nothing of where faces are. Any other word is damage: a lost `v` would shift every
// index after it.
constexpr auto other_statements = std::to_array<std::string_view>(
    {"vt",     "vn",     "vp",  "cstype",   "deg",      "bmat",   "step",       "curv2",     "parm",  "trim",
     "hole",   "scrv",   "sp",  "end",      "con",      "s",      "mg",         "bevel",     "lod",   "usemtl",
     "mtllib", "usemap", "res", "c_interp", "d_interp", "maplib", "shadow_obj", "trace_obj", "ctech", "stech"});

/// Statements that make what is no triangle, and what repairs call it.
struct LeftOut {
    const char *noun, *more;
    std::vector<std::string_view> statements;
    std::size_t count = 0;
};

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
            } else if (statement == "o" || statement == "g") {
                (statement == "o" ? objects_ : groups_).begin(rest_as_name(), mesh_.triangles.size());
            } else if (!statement.empty() && !is_left_out(statement)
                       && std::ranges::find(other_statements, statement) == other_statements.end()) {
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
        nonfinite_.finish(mesh_, file_);
        for (const LeftOut& kind : left_out_)
            if (kind.count > 0) mesh_.repairs.push_back("left out " + counted(kind.count, kind.noun) + kind.more);
        // Of this format alone no end is known: a disk that filled up may have left zeros.
        if (scanner_.padding() > 0)
            mesh_.repairs.push_back("left out " + counted(scanner_.padding(), "padding byte") + " at the end");
        return std::move(mesh_);
    }

    /// Objects where there are several, else groups.
    std::vector<AssemblyPart> parts(Mesh&& mesh, std::vector<std::string>& notes) const {
        return (objects_.names(mesh.triangles.size()) > 1 ? objects_ : groups_).parts(std::move(mesh), notes);
    }

private:
    std::string rest_as_name() {
        std::string name;
        for (std::string_view word = scanner_.word_on_line(); !word.empty(); word = scanner_.word_on_line())
            name.append(name.empty() ? "" : " ").append(printable(word));
        return name.empty() ? Groups::unnamed : name;
    }

    /// And counts it; of points each.
    bool is_left_out(std::string_view statement) {
        for (LeftOut& kind : left_out_) {
            if (std::ranges::find(kind.statements, statement) == kind.statements.end()) continue;
            ++kind.count;
            if (statement == "p" && !scanner_.word_on_line().empty())
                while (!scanner_.word_on_line().empty()) ++kind.count;
            return true;
        }
        return false;
    }

    // x y z, then perhaps w, or a colour, or both.
    void read_vertex() {
        scanner_.vertex_on_line(mesh_.vertices, nonfinite_);
        if (scanner_.numbers_on_line("vertex weight or colour") > 5) scanner_.fail("too many numbers for a vertex");
    }

    void read_face() {
        corners_.clear();
        for (std::string_view word = scanner_.word_on_line(); !word.empty(); word = scanner_.word_on_line()) {
            const std::size_t slash = word.find('/');
            corners_.push_back(resolve(scanner_.integer(word.substr(0, slash), "vertex index")));
            if (slash != std::string_view::npos) check_others(word.substr(slash + 1));
        }
        if (corners_.size() < 2) scanner_.fail("a face needs at least 3 vertices");
        if (corners_.size() == 2)
            ++left_out_[0].count;
        else
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

    // Texture and normal indices are not used and may be missing (`1//`), but one that is not a number is damage.
    void check_others(std::string_view rest) {
        const std::size_t slash = std::min(rest.find('/'), rest.size());
        const std::string_view texture = rest.substr(0, slash), normal = rest.substr(std::min(slash + 1, rest.size()));
        if (!texture.empty()) scanner_.integer(texture, "texture index");
        if (!normal.empty()) scanner_.integer(normal, "normal index");
    }

    const InputFile& file_;
    TextScanner scanner_;
    Mesh mesh_;
    PolygonCutter polygons_;
    NonfiniteVertices nonfinite_;
    Groups objects_, groups_;
    std::array<LeftOut, 5> left_out_{
        {{"face", " of two corners", {}},
         {"point", " (p)", {"p"}},
         {"line", " (l)", {"l"}},
         {"free-form element", " (curv, surf)", {"curv", "surf", "bsp", "bzp", "cdc", "cdp"}},
         {"call", " of other files or commands", {"call", "csh"}}}};
    std::vector<std::uint32_t> corners_;
    /// Vertices that come later in the file than a face that uses them, which is legal; with the line of the face.
    std::vector<std::pair<std::uint32_t, std::size_t>> forward_;
};

} // namespace

Mesh read_obj(const InputFile& file) {
    InputFile room;
    return ObjReader(as_utf8(file, room)).read();
}

std::vector<AssemblyPart> read_obj_parts(const InputFile& file, std::vector<std::string>& notes) {
    InputFile room;
    ObjReader reader(as_utf8(file, room));
    Mesh mesh = reader.read();
    check_mesh(mesh, file.shown);
    mesh.name = file.name();
    return reader.parts(std::move(mesh), notes);
}

} // namespace raycontact
