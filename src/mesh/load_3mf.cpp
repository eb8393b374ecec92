// SPDX-License-Identifier: Apache-2.0
// 3MF: core specification 1.3, production extension 1.1. Our own reader over a ZIP and an XML library: lib3mf reads
// float32.
#include "mesh/input_file.h"

#ifdef RAYCONTACT_3MF

#include "mesh/part_path.h"
#include "mesh/placement.h"
#include "mesh/xml_reader.h"
#include "mesh/zip_file.h"

#include <algorithm>
#include <array>
#include <map>
#include <memory>
#include <optional>
#include <ranges>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace raycontact {
namespace {

constexpr std::string_view production = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06";
/// Extensions that neither make nor move a surface.
constexpr std::array harmless{production, std::string_view("http://schemas.microsoft.com/3dmanufacturing/core/2015/02"),
                              std::string_view("http://schemas.microsoft.com/3dmanufacturing/material/2015/02"),
                              std::string_view("http://schemas.microsoft.com/3dmanufacturing/trianglesets/2021/07")};

/// An object where the build or another object places it.
struct Component {
    std::string model; ///< key of the part of the package that has the object
    std::uint32_t object = 0;
    Placement placement;
    std::string where; ///< for messages
};

struct Object {
    std::string name;
    Mesh mesh;
    std::vector<Component> components;
    std::map<std::string, std::size_t> left_out; ///< elements that are not read, by name
    bool is_open = false;                        ///< is being placed
    bool is_placed = false;
};

struct Model {
    std::map<std::uint32_t, Object> objects;
    std::vector<Component> items;
};

/// The key of the package's root model.
class RelationshipReader : public XmlReader {
public:
    using XmlReader::XmlReader;
    std::string root;

private:
    void begin(std::string_view, const Attributes& attributes) override {
        const auto type = attributes.find("Type"), target = attributes.find("Target");
        if (type && target && type->ends_with("/3dmodel") && root.empty()) root = ZipFile::key_of(*target);
    }
};

class ModelReader : public XmlReader {
public:
    ModelReader(const InputFile& file, const std::string& key) : XmlReader(file, printable(key)), key_(key) {}
    Model model;

private:
    enum class Kind {
        other,
        model,
        resources,
        object,
        mesh,
        vertices,
        vertex,
        triangles,
        triangle,
        components,
        component,
        build,
        item
    };
    struct Element {
        Kind in;
        std::string_view name;
        Kind kind;
        void (ModelReader::*read)(const Attributes&);
    };

    void begin(std::string_view full, const Attributes& attributes) override {
        const std::size_t bar = full.find('|');
        const std::string_view name = bar == full.npos ? full : full.substr(bar + 1),
                               name_space = bar == full.npos ? std::string_view() : full.substr(0, bar);
        if (open_.empty()) {
            if (name != "model") fail("is no 3MF model: its root is " + in_quotes(name));
            name_space_ = name_space;
            open_.push_back(Kind::model);
            return read_model(attributes);
        }
        static constexpr std::array elements{
            Element{Kind::triangles, "triangle", Kind::triangle, &ModelReader::read_triangle},
            Element{Kind::vertices, "vertex", Kind::vertex, &ModelReader::read_vertex},
            Element{Kind::components, "component", Kind::component, &ModelReader::read_component},
            Element{Kind::build, "item", Kind::item, &ModelReader::read_item},
            Element{Kind::resources, "object", Kind::object, &ModelReader::read_object},
            Element{Kind::object, "mesh", Kind::mesh, nullptr},
            Element{Kind::object, "components", Kind::components, nullptr},
            Element{Kind::mesh, "vertices", Kind::vertices, nullptr},
            Element{Kind::mesh, "triangles", Kind::triangles, nullptr},
            Element{Kind::model, "resources", Kind::resources, nullptr},
            Element{Kind::model, "build", Kind::build, nullptr}};
        const Kind in = open_.back();
        const auto found = std::ranges::find_if(elements, [&](const Element& element) {
            return element.in == in && element.name == name && name_space == name_space_;
        });
        if (found == elements.end()) {
            open_.push_back(Kind::other);
            if ((in == Kind::object || in == Kind::mesh) && name != "metadatagroup" && name != "trianglesets")
                ++object_
                      ->left_out[printable(name) + (name_space == name_space_ ? "" : " of " + printable(name_space))];
            return;
        }
        open_.push_back(found->kind);
        if (found->read) (this->*found->read)(attributes);
    }

    void end() override { open_.pop_back(); }

    void declare(std::string_view prefix, std::string_view name_space) override {
        if (open_.empty()) prefixes_.emplace(prefix, name_space);
    }

    void read_model(const Attributes& attributes) {
        std::string_view prefixes = attributes.find("requiredextensions").value_or("");
        for (std::string_view prefix = next_word(prefixes); !prefix.empty(); prefix = next_word(prefixes)) {
            const std::string extension = prefixes_[std::string(prefix)];
            if (std::ranges::find(harmless, extension) == harmless.end())
                fail("needs the extension " + in_quotes(prefix) + " (" + printable(extension.substr(0, 100))
                     + "), which is not read; export without it");
        }
        const std::string_view unit = attributes.find("unit").value_or("millimeter");
        const auto found = std::ranges::find(units, unit, &Unit::name);
        if (found == units.end())
            fail("unit " + in_quotes(unit) + " is unknown; it is micron, millimeter, centimeter, inch, foot or meter");
        unit_ = *found;
    }

    void read_object(const Attributes& attributes) {
        const std::uint32_t id = whole(attributes, "id");
        const auto [made, is_new] = model.objects.try_emplace(id);
        if (!is_new) fail("object " + std::to_string(id) + " is there twice");
        object_ = &made->second;
        object_->name = printable(attributes.find("name").value_or(""));
        if (object_->name.empty()) object_->name = "object " + std::to_string(id);
    }

    void read_vertex(const Attributes& attributes) {
        if (object_->mesh.vertices.size() == most_vertices) fail("has too many vertices; split or reduce it");
        const auto metres = [&](const char* name) { return in_metres(number(attributes, name)); };
        object_->mesh.vertices.push_back({metres("x"), metres("y"), metres("z")});
    }

    void read_triangle(const Attributes& attributes) {
        Mesh& mesh = object_->mesh;
        if (mesh.triangles.size() == most_triangles) fail("has too many triangles; split or reduce it");
        const std::array corners{whole(attributes, "v1"), whole(attributes, "v2"), whole(attributes, "v3")};
        for (const std::uint32_t v : corners)
            if (v >= mesh.vertices.size()) fail(no_vertex(v, mesh.vertices.size()));
        mesh.triangles.push_back(corners);
    }

    void read_component(const Attributes& attributes) { object_->components.push_back(placed(attributes)); }
    void read_item(const Attributes& attributes) { model.items.push_back(placed(attributes)); }

    Component placed(const Attributes& attributes) {
        const auto path = attributes.find(std::string(production) + "|path");
        return {path ? ZipFile::key_of(*path) : key_, whole(attributes, "objectid"), placement(attributes),
                printable(key_) + ": line " + std::to_string(line())};
    }

    /// Rows of 4 x 3 numbers: where the axes go, then the origin.
    Placement placement(const Attributes& attributes) const {
        const auto text = attributes.find("transform");
        if (!text) return {};
        std::string_view words = *text;
        std::array<double, 12> m{};
        std::size_t count = 0;
        for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
            const double value = number(word, "transform");
            if (count < m.size()) m[count] = value;
            ++count;
        }
        if (count != m.size()) fail("transform has " + std::to_string(count) + " numbers, not 12");
        return {{m[0], m[1], m[2]},
                {m[3], m[4], m[5]},
                {m[6], m[7], m[8]},
                {in_metres(m[9]), in_metres(m[10]), in_metres(m[11])}};
    }

    static std::string_view next_word(std::string_view& words) {
        constexpr std::string_view blanks = " \t\r\n";
        words.remove_prefix(std::min(words.find_first_not_of(blanks), words.size()));
        const std::string_view word = words.substr(0, words.find_first_of(blanks));
        words.remove_prefix(word.size());
        return word;
    }

    /// Two whole numbers, so that 25.4 mm become 0.0254 m with one rounding.
    struct Unit {
        std::string_view name;
        double times, per;
    };
    static constexpr std::array units{Unit{"micron", 1, 1e6}, Unit{"millimeter", 1, 1e3}, Unit{"centimeter", 1, 1e2},
                                      Unit{"inch", 254, 1e4}, Unit{"foot", 3048, 1e4},    Unit{"meter", 1, 1}};
    double in_metres(double length) const { return length * unit_.times / unit_.per; }

    std::string key_;
    std::string name_space_; ///< of the core: the root's
    std::map<std::string, std::string> prefixes_;
    std::vector<Kind> open_;
    Unit unit_{};
    Object* object_ = nullptr; ///< the one that is being read
};

class PackageReader {
public:
    explicit PackageReader(const InputFile& file) : file_(file), zip_(file) {
        RelationshipReader relationships(file, relations);
        read(relations, relationships);
        if (relationships.root.empty()) file.fail("names no 3D model in " + std::string(relations));
        root_ = relationships.root;
    }

    Mesh read_mesh() {
        Mesh mesh;
        for_each_placed_object([&](const Object& object, const Placement& placement) { add(mesh, object, placement); });
        add_left_out(mesh.repairs);
        return mesh;
    }

    std::vector<AssemblyPart> read_parts(std::vector<std::string>& notes) {
        std::map<std::pair<const Object*, std::array<double, 9>>, std::shared_ptr<const Mesh>> known;
        PartScales scales;
        std::vector<AssemblyPart> parts;
        for_each_placed_object([&](const Object& object, const Placement& placement) {
            if (object.mesh.triangles.empty()) return;
            if (!is_finite(placement.origin)) file_.fail(object.name + ": is placed where no number is finite");
            const auto [pose, own] = scales.split(placement);
            const auto& [x, y, z, origin] = own;
            auto& made = known[{&object, {x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}}];
            if (!made) {
                Mesh mesh;
                mesh.name = object.name;
                add(mesh, object, own);
                notes.insert(notes.end(), mesh.repairs.begin(), mesh.repairs.end());
                made = std::make_shared<const Mesh>(std::move(mesh));
            }
            Ancestors above;
            for (const Object* outer : open_ | std::views::reverse)
                if (!above.add(outer->name)) break;
            parts.push_back({object.name, made, pose, {}, AssemblyPart::no_part, std::move(above).from_root()});
        });
        add_left_out(notes);
        return parts;
    }

private:
    static constexpr const char* relations = "_rels/.rels";

    void read(const std::string& key, XmlReader& reader) {
        zip_.read(key, [&](std::string_view piece) { reader.feed(piece); });
        reader.finish();
    }

    Model& model(const std::string& key) {
        const auto [found, is_new] = models_.try_emplace(key);
        if (is_new) {
            ModelReader reader(file_, key);
            read(key, reader);
            found->second = std::move(reader.model);
        }
        return found->second;
    }

    /// Calls visit(object, placement) for each object with a mesh, as often as the build places it, in its order.
    template <class Visit>
    void for_each_placed_object(Visit&& visit) {
        for (const Component& item : model(root_).items) place(item, {}, 0, visit);
    }

    template <class Visit>
    void place(const Component& component, const Placement& outer, std::size_t depth, Visit&& visit) {
        const auto fail = [&](const std::string& what) {
            file_.fail(component.where + ": object " + std::to_string(component.object) + " " + what);
        };
        std::map<std::uint32_t, Object>& objects = model(component.model).objects;
        const auto found = objects.find(component.object);
        if (found == objects.end()) fail("does not exist");
        Object& object = found->second;
        if (object.is_open) fail("is a component of itself");
        constexpr std::size_t deepest = 1000; // components in one another
        if (depth == deepest) fail("lies more than " + std::to_string(deepest) + " components deep");
        // Components of components grow faster than any file.
        constexpr std::size_t always = 1u << 16, bytes_for_one = 16;
        if (++placed_ > std::max(always, zip_.bytes() / bytes_for_one))
            file_.fail("places more than " + std::to_string(placed_ - 1) + " objects; split it");
        if (object.mesh.triangles.empty() && object.components.empty() && !object.left_out.empty())
            fail("is made of " + object.left_out.begin()->first + ", which is not read; export a mesh");
        const Placement placement = outer.after(component.placement);
        visit(object, placement);
        object.is_open = object.is_placed = true;
        open_.push_back(&object);
        for (const Component& inner : object.components) place(inner, placement, depth + 1, visit);
        open_.pop_back();
        object.is_open = false;
    }

    /// The objects that nothing places, and those that have nothing.
    void add_left_out(std::vector<std::string>& notes) const {
        std::string unplaced, empty;
        for (const auto& [key, model] : models_)
            for (const auto& [id, object] : model.objects) {
                if (object.is_placed && !(object.mesh.triangles.empty() && object.components.empty())) continue;
                std::string& names = object.is_placed ? empty : unplaced;
                names += (names.empty() ? "" : ", ") + in_quotes(object.name);
            }
        if (!unplaced.empty()) notes.push_back("left out " + unplaced + ": not in the build");
        if (!empty.empty()) notes.push_back("left out what has no triangles: " + empty);
    }

    void add(Mesh& mesh, const Object& object, const Placement& placement) {
        const Mesh& own = object.mesh;
        constexpr std::size_t always = 1u << 20, for_a_byte = 4;
        made_ += own.vertices.size() + own.triangles.size();
        const std::size_t base = mesh.vertices.size();
        if (made_ > std::max(always, for_a_byte * zip_.bytes()) || base + own.vertices.size() > most_vertices
            || mesh.triangles.size() + own.triangles.size() > most_triangles)
            file_.fail("places the same meshes so often that " + std::to_string(made_)
                       + " vertices and triangles come of it; split it or reduce the meshes");
        for (const Vec3& v : own.vertices) {
            mesh.vertices.push_back(placement.placed(v));
            if (!is_finite(mesh.vertices.back()))
                file_.fail(object.name + ": vertex " + std::to_string(mesh.vertices.size() - 1 - base)
                           + " is not finite where it is placed");
        }
        for (auto [a, b, c] : own.triangles) {
            if (placement.mirrors()) std::swap(b, c);
            const auto offset = static_cast<std::uint32_t>(base);
            mesh.triangles.push_back({offset + a, offset + b, offset + c});
        }
        for (const auto& [name, count] : object.left_out)
            mesh.repairs.push_back("left out " + std::to_string(count) + " x " + name + " of " + object.name
                                   + ", which is not read");
    }

    const InputFile& file_;
    ZipFile zip_;
    std::string root_;
    std::map<std::string, Model> models_;
    std::vector<const Object*> open_;   ///< those that are being placed, each in the one before
    std::size_t placed_ = 0, made_ = 0; ///< objects; vertices and triangles
};

} // namespace

Mesh read_3mf(const InputFile& file) {
    return PackageReader(file).read_mesh();
}

std::vector<AssemblyPart> read_3mf_parts(const InputFile& file, std::vector<std::string>& notes) {
    return PackageReader(file).read_parts(notes);
}

} // namespace raycontact

#else

namespace raycontact {

namespace {
[[noreturn]] void fail_without(const InputFile& file) {
    file.fail("3MF is not read by this build of the library (RAYCONTACT_3MF is off); convert it to GLB or STL");
}
} // namespace

Mesh read_3mf(const InputFile& file) {
    fail_without(file);
}

std::vector<AssemblyPart> read_3mf_parts(const InputFile& file, std::vector<std::string>&) {
    fail_without(file);
}

} // namespace raycontact

#endif
