// SPDX-License-Identifier: Apache-2.0
// Our own reader: assimp keeps double coordinates as float32, and reads truncated or damaged elements without an error.
#include "interruption.h"
#include "mesh/polygon.h"
#include "mesh/text_scanner.h"
#include "mesh/vector.h"
#include "number_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact {
namespace {

struct NamedType {
    std::string_view name, other_name;
    NumberType type;
};

constexpr std::array types{
    NamedType{"char", "int8", number_type<std::int8_t>},    NamedType{"uchar", "uint8", number_type<std::uint8_t>},
    NamedType{"short", "int16", number_type<std::int16_t>}, NamedType{"ushort", "uint16", number_type<std::uint16_t>},
    NamedType{"int", "int32", number_type<std::int32_t>},   NamedType{"uint", "uint32", number_type<std::uint32_t>},
    NamedType{"float", "float32", number_type<float>},      NamedType{"double", "float64", number_type<double>}};

struct Property {
    NumberType type;
    std::optional<NumberType> count_type; ///< of a list
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
    /// The properties that are read: x, y and z of a vertex; the list of corners of a face. All others are skipped.
    static constexpr std::size_t none = ~std::size_t{0}, corners = 3;
    std::array<std::size_t, 4> used{none, none, none, none};
    bool is_of_vertices = false; ///< has a list of them: it is geometry, read or not
};

constexpr std::string_view strips = "tristrips";

class PlyReader {
public:
    explicit PlyReader(const InputFile& file) : file_(file), text_(file) {
        text_.comment = '{'; // as in the description of the format, where `{ ... }` explains a line
    }

    Mesh read() {
        read_header();
        for (const Element& element : elements_) read_element(element);
        if (ascii_ ? !text_.at_end()
                   : rest().find_first_not_of(" \t\r\n" + std::string(text_padding)) != std::string::npos)
            file_.fail("more data than its header announces; it is damaged");
        polygons_.finish(mesh_);
        nonfinite_.finish(mesh_, file_);
        if (edges_ > 0) mesh_.repairs.push_back("left out " + counted(edges_, "face") + " of two corners");
        return std::move(mesh_);
    }

private:
    void read_header() {
        if (text_.word_on_line() != "ply") file_.fail("does not start with `ply`; is it a PLY file?");
        bool format_seen = false;
        for (;;) {
            if (!text_.next_line()) text_.fail("the header has no end_header; the file is truncated");
            const std::string_view word = text_.word_on_line();
            if (word == "end_header") break;
            if (word.empty() || is_comment(word)) continue;
            if (word == "format") {
                read_format();
                format_seen = true;
            } else if (word == "element") {
                const std::string name(text_.word_on_line());
                const std::int64_t count = text_.integer(text_.word_on_line(), "element count");
                if (count < 0) text_.fail("element count " + std::to_string(count) + " is negative");
                elements_.push_back({name, static_cast<std::uint64_t>(count), {}});
            } else if (word == "property") {
                read_property();
            } else if (!elements_.empty()) { // before, exporters have left out the word `comment`
                text_.fail(in_quotes(word) + " is no PLY header line; the file is damaged");
            }
        }
        if (!format_seen) text_.fail("the header names no format; the file is damaged");
        // The data starts after this very line end, whatever bytes follow. The end of the first line tells of which
        // kind.
        const std::string& bytes = file_.bytes;
        const std::size_t first = bytes.find_first_of("\r\n");
        const bool returns = bytes[first] == '\r' && bytes.compare(first, 2, "\r\n") != 0; // alone, as on old Macs
        at_ = std::min(bytes.find(returns ? '\r' : '\n', text_.offset()), bytes.size() - 1) + 1;
        if (ascii_) text_.next_line();
    }

    /// `comment` and `obj_info`, in capitals, with a colon, or a # as in other formats.
    static bool is_comment(std::string_view word) {
        const std::string lower = lower_case(std::string(word));
        return lower.starts_with("comment") || lower.starts_with("obj_info") || lower.starts_with("#");
    }

    void read_format() {
        const std::string_view format = text_.word_on_line();
        ascii_ = format == "ascii";
        little_endian_ = format == "binary_little_endian";
        if (!ascii_ && !little_endian_ && format != "binary_big_endian")
            text_.fail("format " + in_quotes(format) + " is unknown; export as ascii or binary_little_endian");
    }

    void read_property() {
        if (elements_.empty()) text_.fail("a property before the first element; the file is damaged");
        Element& element = elements_.back();
        Property property;
        std::string_view word = text_.word_on_line();
        if (word == "list") {
            property.count_type = type_of(text_.word_on_line());
            if (!property.count_type->whole) text_.fail("a list is counted in whole numbers");
            word = text_.word_on_line();
        }
        property.type = type_of(word);
        const std::string_view name = text_.word_on_line();
        if (element.name == "vertex" && !property.count_type && (name == "x" || name == "y" || name == "z")) {
            element.used[static_cast<std::size_t>(name[0] - 'x')] = element.properties.size();
        } else if (property.count_type && (name == "vertex_indices" || name == "vertex_index")) {
            element.is_of_vertices = true;
            if (element.name == "face" || element.name == strips) {
                if (!property.type.whole) text_.fail("vertex indices must be whole numbers");
                element.used[Element::corners] = element.properties.size();
            }
        }
        element.properties.push_back(property);
    }

    NumberType type_of(std::string_view word) const {
        for (const NamedType& known : types) {
            if (known.name == word || known.other_name == word) return known.type;
        }
        text_.fail("property type " + in_quotes(word) + " is unknown");
    }

    // Before anything is allocated: no element may promise more than the rest of the file can hold.
    void check(const Element& element) const {
        std::size_t least = 0;
        for (const Property& property : element.properties)
            least += ascii_ ? 2 : property.count_type.value_or(property.type).size;
        const std::size_t left = ascii_ ? file_.bytes.size() + 1 : rest().size();
        if (element.count > 0 && (least == 0 || element.count > left / least)) {
            file_.fail("element " + in_quotes(element.name) + " announces " + std::to_string(element.count)
                       + " records, more than the file holds; it is truncated or damaged");
        }
        const auto lacks = [&](std::size_t use) { return element.used[use] == Element::none; };
        if (element.name == "vertex" && (lacks(0) || lacks(1) || lacks(2)))
            file_.fail("element 'vertex' lacks x, y or z");
        if (element.name == "vertex" && !mesh_.vertices.empty())
            file_.fail("two elements named 'vertex'; it is damaged");
        if ((element.name == "face" || element.name == strips) && lacks(Element::corners))
            file_.fail("element " + in_quotes(element.name) + " lacks a list vertex_indices");
    }

    void read_element(const Element& element) {
        check(element);
        name_ = element.name;
        if (name_ == "vertex") mesh_.vertices.reserve(element.count);
        if (name_ == "face") mesh_.triangles.reserve(mesh_.triangles.size() + element.count);
        const bool is_read = name_ == "vertex" || element.used[Element::corners] != Element::none;
        if (!is_read && (name_ == "edge" || element.is_of_vertices) && element.count > 0)
            mesh_.repairs.push_back("left out " + counted(element.count, "record") + " of element " + in_quotes(name_));
        const InterruptionCheck check;
        for (record_ = 0; record_ < element.count; ++record_) {
            check();
            Vec3 point;
            for (std::size_t i = 0; i < element.properties.size(); ++i) {
                const Property& property = element.properties[i];
                const auto use = static_cast<std::size_t>(std::ranges::find(element.used, i) - element.used.begin());
                if (use < Element::corners) {
                    read_coordinate(*std::array{&point.x, &point.y, &point.z}[use], property.type);
                } else if (use == Element::corners) {
                    name_ == strips ? read_strips(property) : read_face(property);
                } else {
                    skip(property);
                }
            }
            if (name_ == "vertex") mesh_.vertices.push_back(is_finite(point) ? point : Vec3{});
        }
    }

    void read_face(const Property& property) {
        const std::uint64_t count = read_list_count(property);
        if (count < 2) fail("a face needs at least 3 vertices, this one has " + std::to_string(count));
        if (count > file_.bytes.size()) fail("a face of " + std::to_string(count) + " vertices; it is damaged");
        corners_.clear();
        for (std::uint64_t k = 0; k < count; ++k) corners_.push_back(vertex(read_whole(property.type)));
        if (count == 2)
            ++edges_;
        else
            polygons_.append(mesh_, corners_);
    }

    /// Of a list: every three vertices that follow each other are a triangle, every second of them turned over, until
    /// -1 starts a new strip.
    void read_strips(const Property& property) {
        std::array<std::uint32_t, 2> last{};
        std::size_t length = 0; // of the strip so far
        for (std::uint64_t left = read_list_count(property); left > 0; --left) {
            const std::int64_t index = read_whole(property.type);
            if (index == -1 || index == 0xffffffffll) {
                length = 0;
                continue;
            }
            const std::uint32_t v = vertex(index);
            if (length >= 2) {
                const std::size_t odd = length % 2;
                mesh_.triangles.push_back({last[odd], last[1 - odd], v});
            }
            last = {last[1], v};
            ++length;
        }
    }

    /// Of an index; faces may come before vertices.
    std::uint32_t vertex(std::int64_t index) const {
        if (index < 0 || index >= 0xffffffffll) fail("vertex index " + std::to_string(index) + " is out of range");
        return static_cast<std::uint32_t>(index);
    }

    void skip(const Property& property) {
        const std::uint64_t count = property.count_type ? read_list_count(property) : 1;
        if (!ascii_) take(count * property.type.size); // count fits 32 bits
        for (std::uint64_t i = 0; ascii_ && i < count; ++i) {
            if (text_.word().empty()) fail("the file ends here; it is truncated");
        }
    }

    std::uint64_t read_list_count(const Property& property) {
        const std::int64_t count = read_whole(*property.count_type);
        if (count < 0) fail("a list of " + std::to_string(count) + " entries");
        return static_cast<std::uint64_t>(count);
    }

    void read_coordinate(double& coordinate, const NumberType& type) {
        const std::string_view word = ascii_ ? text_.word() : std::string_view();
        coordinate = ascii_ ? text_.any_number(word, "number") : type.read(take(type.size), little_endian_);
        if (!std::isfinite(coordinate)) nonfinite_.add(record_, ascii_ ? text_.line() : 0, word);
    }

    std::int64_t read_whole(const NumberType& type) {
        return ascii_ ? text_.integer(text_.word(), "number")
                      : static_cast<std::int64_t>(type.read(take(type.size), little_endian_));
    }

    const char* take(std::size_t size) {
        if (rest().size() < size) fail("the file ends here; it is truncated");
        const char* const at = file_.bytes.data() + at_;
        at_ += size;
        return at;
    }

    std::string_view rest() const { return std::string_view(file_.bytes).substr(at_); }

    [[noreturn]] void fail(const std::string& what) const {
        const std::string where = "element " + in_quotes(name_) + " " + std::to_string(record_) + ": ";
        if (ascii_) text_.fail(where + what);
        file_.fail(where + what);
    }

    const InputFile& file_;
    TextScanner text_;
    bool ascii_ = true;
    bool little_endian_ = true;
    std::size_t at_ = 0;       ///< next byte of a binary file
    std::string name_;         ///< of the current element
    std::uint64_t record_ = 0; ///< in it
    std::vector<Element> elements_;
    std::vector<std::uint32_t> corners_;
    Mesh mesh_;
    PolygonCutter polygons_;
    NonfiniteVertices nonfinite_;
    std::size_t edges_ = 0; ///< faces of two corners
};

} // namespace

Mesh read_ply(const InputFile& file) {
    InputFile room;
    return PlyReader(as_utf8(file, room)).read();
}

} // namespace raycontact
