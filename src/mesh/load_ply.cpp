// SPDX-License-Identifier: Apache-2.0
// Our own reader: assimp keeps double coordinates as float32, and reads truncated or damaged elements in silence.
#include "mesh/byte_reader.h"
#include "mesh/text_scanner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace raycontact {
namespace {

enum class Type : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

struct TypeName {
    std::string_view name;
    Type type;
    std::size_t size;
};

constexpr std::array type_names{
    TypeName{"char", Type::i8, 1},    TypeName{"int8", Type::i8, 1},     TypeName{"uchar", Type::u8, 1},
    TypeName{"uint8", Type::u8, 1},   TypeName{"short", Type::i16, 2},   TypeName{"int16", Type::i16, 2},
    TypeName{"ushort", Type::u16, 2}, TypeName{"uint16", Type::u16, 2},  TypeName{"int", Type::i32, 4},
    TypeName{"int32", Type::i32, 4},  TypeName{"uint", Type::u32, 4},    TypeName{"uint32", Type::u32, 4},
    TypeName{"float", Type::f32, 4},  TypeName{"float32", Type::f32, 4}, TypeName{"double", Type::f64, 8},
    TypeName{"float64", Type::f64, 8}};

struct Property {
    std::string name;
    Type type = Type::f32;
    std::size_t size = 0;
    bool list = false;
    Type count_type = Type::u8;
    std::size_t count_size = 0;
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

class PlyReader {
public:
    explicit PlyReader(const InputFile& file) : file_(file), text_(file, 0, 1) {}

    Mesh read() {
        read_header();
        for (const Element& element : elements_) {
            check_count(element);
            if (element.name == "vertex") {
                read_vertices(element);
            } else if (element.name == "face") {
                read_faces(element);
            } else {
                for (record_ = 0; record_ < element.count; ++record_) {
                    for (const Property& property : element.properties) skip(element, property);
                }
            }
        }
        if (ascii_ ? !text_.at_end() : rest().find_first_not_of(" \t\r\n") != std::string_view::npos) {
            file_.fail("more data than its header announces; it is damaged");
        }
        check_indices();
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
            if (word.empty() || word == "comment" || word == "obj_info") continue;
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
            } else {
                text_.fail(in_quotes(word) + " is no PLY header line; the file is damaged");
            }
        }
        if (!format_seen) text_.fail("the header names no format; the file is damaged");
        // The data starts after this very line end, whatever bytes follow.
        const std::size_t line_end = file_.bytes.find('\n', text_.offset());
        if (!ascii_) at_ = line_end == std::string::npos ? file_.bytes.size() : line_end + 1;
        if (ascii_) text_.next_line();
    }

    void read_format() {
        const std::string_view format = text_.word_on_line();
        if (format == "ascii") {
            ascii_ = true;
        } else if (format == "binary_little_endian" || format == "binary_big_endian") {
            ascii_ = false;
            little_endian_ = format == "binary_little_endian";
        } else {
            text_.fail("format " + in_quotes(format) + " is unknown; export as ascii or binary_little_endian");
        }
    }

    void read_property() {
        if (elements_.empty()) text_.fail("a property before the first element; the file is damaged");
        Property property;
        std::string_view word = text_.word_on_line();
        if (word == "list") {
            property.list = true;
            const TypeName count = type_of(text_.word_on_line());
            if (count.type == Type::f32 || count.type == Type::f64) text_.fail("a list is counted in whole numbers");
            property.count_type = count.type;
            property.count_size = count.size;
            word = text_.word_on_line();
        }
        const TypeName type = type_of(word);
        property.type = type.type;
        property.size = type.size;
        property.name = text_.word_on_line();
        elements_.back().properties.push_back(property);
    }

    TypeName type_of(std::string_view word) const {
        for (const TypeName& known : type_names) {
            if (known.name == word) return known;
        }
        text_.fail("property type " + in_quotes(word) + " is unknown");
    }

    // Before anything is allocated: no element may promise more than the rest of the file can hold.
    void check_count(const Element& element) const {
        std::size_t least = 0;
        for (const Property& property : element.properties) {
            least += ascii_ ? 2 : property.list ? property.count_size : property.size;
        }
        const std::size_t left = ascii_ ? file_.bytes.size() + 1 : rest().size();
        if (element.count > 0 && (least == 0 || element.count > left / least)) {
            file_.fail("element " + in_quotes(element.name) + " announces " + std::to_string(element.count)
                       + " records, more than the file holds; it is truncated or damaged");
        }
    }

    std::string_view rest() const { return std::string_view(file_.bytes).substr(at_); }

    [[noreturn]] void fail(const Element& element, const std::string& what) const {
        const std::string where = "element " + in_quotes(element.name) + " " + std::to_string(record_) + ": ";
        if (ascii_) text_.fail(where + what);
        file_.fail(where + what);
    }

    const char* take(const Element& element, std::size_t size) {
        if (rest().size() < size) fail(element, "the file ends here; it is truncated");
        const char* const at = file_.bytes.data() + at_;
        at_ += size;
        return at;
    }

    double read_real(const Element& element, Type type, std::size_t size) {
        if (ascii_) return text_.number(text_.word(), "number");
        if (type == Type::f32 || type == Type::f64) {
            const char* const at = take(element, size);
            const double value =
                type == Type::f32 ? read_bytes<float>(at, little_endian_) : read_bytes<double>(at, little_endian_);
            if (!std::isfinite(value)) fail(element, "a coordinate is not finite");
            return value;
        }
        return static_cast<double>(read_integer(element, type, size));
    }

    std::int64_t read_integer(const Element& element, Type type, std::size_t size) {
        if (ascii_) return text_.integer(text_.word(), "number");
        const char* const at = take(element, size);
        switch (type) {
        case Type::i8:
            return read_bytes<std::int8_t>(at, little_endian_);
        case Type::u8:
            return read_bytes<std::uint8_t>(at, little_endian_);
        case Type::i16:
            return read_bytes<std::int16_t>(at, little_endian_);
        case Type::u16:
            return read_bytes<std::uint16_t>(at, little_endian_);
        case Type::i32:
            return read_bytes<std::int32_t>(at, little_endian_);
        case Type::u32:
            return read_bytes<std::uint32_t>(at, little_endian_);
        case Type::f32:
        case Type::f64:
            break;
        }
        fail(element, "indices are whole numbers");
    }

    std::uint64_t read_list_count(const Element& element, const Property& property) {
        const std::int64_t count = read_integer(element, property.count_type, property.count_size);
        if (count < 0) fail(element, "a list of " + std::to_string(count) + " entries");
        return static_cast<std::uint64_t>(count);
    }

    void skip(const Element& element, const Property& property) {
        const std::uint64_t count = property.list ? read_list_count(element, property) : 1;
        if (!ascii_) {
            take(element, count * property.size); // count fits 32 bits
            return;
        }
        for (std::uint64_t i = 0; i < count; ++i) {
            if (text_.word().empty()) fail(element, "the file ends here; it is truncated");
        }
    }

    void read_vertices(const Element& element) {
        std::array<const Property*, 3> axes{};
        for (const Property& property : element.properties) {
            for (std::size_t k = 0; k < 3; ++k) {
                if (property.name == std::string_view("xyz").substr(k, 1) && !property.list) axes[k] = &property;
            }
        }
        for (const Property* axis : axes) {
            if (axis == nullptr) file_.fail("element 'vertex' lacks x, y or z");
        }
        if (!mesh_.vertices.empty()) file_.fail("two elements named 'vertex'; it is damaged");
        mesh_.vertices.reserve(element.count);
        for (record_ = 0; record_ < element.count; ++record_) {
            std::array<double, 3> point{};
            for (const Property& property : element.properties) {
                const auto axis = std::find(axes.begin(), axes.end(), &property);
                if (axis == axes.end()) {
                    skip(element, property);
                } else {
                    point[static_cast<std::size_t>(axis - axes.begin())] =
                        read_real(element, property.type, property.size);
                }
            }
            mesh_.vertices.push_back({point[0], point[1], point[2]});
        }
    }

    void read_faces(const Element& element) {
        const Property* indices = nullptr;
        for (const Property& property : element.properties) {
            if (property.list && (property.name == "vertex_indices" || property.name == "vertex_index"))
                indices = &property;
        }
        if (indices == nullptr) file_.fail("element 'face' lacks a list vertex_indices");
        if (indices->type == Type::f32 || indices->type == Type::f64)
            file_.fail("vertex indices must be whole numbers");
        mesh_.triangles.reserve(mesh_.triangles.size() + element.count);
        std::vector<std::uint32_t> corners;
        for (record_ = 0; record_ < element.count; ++record_) {
            for (const Property& property : element.properties) {
                if (&property != indices) {
                    skip(element, property);
                    continue;
                }
                const std::uint64_t count = read_list_count(element, property);
                if (count < 3) fail(element, "a face needs at least 3 vertices, this one has " + std::to_string(count));
                if (count > file_.bytes.size())
                    fail(element, "a face of " + std::to_string(count) + " vertices; it is damaged");
                corners.clear();
                for (std::uint64_t k = 0; k < count; ++k) {
                    const std::int64_t index = read_integer(element, property.type, property.size);
                    if (index < 0 || index >= 0xffffffffll)
                        fail(element, "vertex index " + std::to_string(index) + " is out of range");
                    corners.push_back(static_cast<std::uint32_t>(index));
                }
                append_fan(mesh_, corners);
            }
        }
    }

    // At the end, because faces may come before vertices.
    void check_indices() const {
        for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
            for (const std::uint32_t v : mesh_.triangles[i]) {
                if (v >= mesh_.vertices.size()) {
                    file_.fail("triangle " + std::to_string(i) + ": vertex index " + std::to_string(v)
                               + " is not in 0 to " + std::to_string(mesh_.vertices.size()) + " - 1");
                }
            }
        }
    }

    const InputFile& file_;
    TextScanner text_;
    bool ascii_ = true;
    bool little_endian_ = true;
    std::size_t at_ = 0;       ///< next byte of a binary file
    std::uint64_t record_ = 0; ///< in the element at hand
    std::vector<Element> elements_;
    Mesh mesh_;
};

} // namespace

Mesh read_ply(const InputFile& file) {
    return PlyReader(file).read();
}

} // namespace raycontact
