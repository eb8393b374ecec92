// SPDX-License-Identifier: Apache-2.0
// A shape as bytes. What takes long to find is written (what preparing the mesh found, the order of its trees, exit
// distances, accelerators); boxes, normals, adjacency and headers are made of it anew, in a small part of the time, so
// that no saved number is a place in memory: each index is checked, or orders what is checked.
#include "executor/float_environment.h"
#include "shape/build.h"
#include "shape/round_shape.h"
#include "state_bytes.h"

#include <raycontact/error.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <xxhash.h>

namespace raycontact {

namespace {

constexpr std::uint64_t mark = 0x3165706168534352; // "RCShape1"
constexpr std::uint64_t other_order = 0x5243536861706531;
constexpr std::string_view library = RAYCONTACT_VERSION;

[[noreturn]] void refuse(const std::string& what) {
    throw InputError("Shape::load: " + what);
}
[[noreturn]] void refuse_damaged() {
    refuse("the bytes are damaged: they are no shape; give what save() returned");
}

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
    return XXH64(bytes.data(), bytes.size(), mark);
}

/// Writes behind each other; without bytes it counts them, so that these need no room to grow.
class Writer {
public:
    explicit Writer(std::vector<std::byte>* bytes = nullptr) : bytes_(bytes) {}
    std::size_t count() const { return count_; }

    template <class T>
    void value(const T& value) {
        row(std::span<const T>(&value, 1));
    }
    template <class T>
    void list(std::span<const T> values) {
        value(std::uint64_t{values.size()});
        row(values);
    }
    void text(std::string_view text) { list(std::span(text.data(), text.size())); }

private:
    template <class T>
    void row(std::span<const T> values) {
        static_assert(std::is_trivially_copyable_v<T>);
        const auto own = std::as_bytes(values);
        count_ += own.size();
        if (bytes_ != nullptr) bytes_->insert(bytes_->end(), own.begin(), own.end());
    }

    std::vector<std::byte>* bytes_;
    std::size_t count_ = 0;
};

/// Reads them; what is cut off throws std::logic_error (state_bytes.h).
class Reader {
public:
    explicit Reader(std::span<const std::byte> bytes) : rest_(bytes) {}
    bool is_at_end() const { return rest_.empty(); }

    template <class T>
    void value(T& value) {
        value = take_bytes<T>(rest_);
    }
    template <class T>
    void list(std::vector<T>& values) {
        values = take_list<T>(rest_);
    }
    bool flag() {
        const auto byte = take_bytes<std::uint8_t>(rest_);
        if (byte > 1) refuse_damaged();
        return byte != 0;
    }
    std::string text() {
        const auto letters = take_list<char>(rest_);
        return {letters.begin(), letters.end()};
    }
    std::vector<std::string> texts() {
        std::vector<std::string> texts;
        for (auto count = take_bytes<std::uint64_t>(rest_); count > 0; --count) texts.push_back(text());
        return texts;
    }

private:
    std::span<const std::byte> rest_;
};

/// Visits its numbers, points and flags: whoever writes a report and whoever reads one agree.
template <class Report, class Numbers, class Flags>
void visit(Report& report, Numbers&& number, Flags&& flag) {
    for (auto* count : {&report.vertices, &report.triangles, &report.file_vertices, &report.file_triangles,
                        &report.border_edges, &report.holes, &report.spanning, &report.components})
        number(*count);
    for (auto* is : {&report.closed, &report.solid, &report.manifold, &report.oriented, &report.checked,
                     &report.self_intersecting, &report.outward})
        flag(*is);
    for (auto* size : {&report.volume, &report.area}) number(*size);
    for (auto* corner : {&report.box_min, &report.box_max}) number(*corner);
}

void write(Writer& to, const MeshReport& report) {
    const auto put = [&](const auto& number) { to.value(number); };
    visit(report, put, [&](bool is) { to.value(std::uint8_t{is}); });
    to.value(std::uint64_t{report.repairs.size()});
    for (const std::string& repair : report.repairs) to.text(repair);
}

MeshReport read_report(Reader& from) {
    MeshReport report;
    const auto take = [&](auto& number) { from.value(number); };
    visit(report, take, [&](bool& is) { is = from.flag(); });
    report.repairs = from.texts();
    return report;
}

template <class T>
std::span<const T> all(const std::vector<T>& list) {
    return list;
}

void write(Writer& to, const ShapeData& shape, const SlowParts& slow) {
    to.text(shape.mesh.name);
    to.list(all(shape.file_vertices.empty() ? shape.mesh.vertices : shape.file_vertices));
    to.list(all(shape.mesh.triangles));
    to.list(all(shape.mesh.vertex_index));
    to.list(all(shape.mesh.triangle_index));
    write(to, shape.mesh.report);
    for (const auto* order : {&slow.tree.triangles, &slow.tree.children, &slow.sources.vertices, &slow.sources.edges})
        to.list(all(*order));
    to.list(all(shape.exit_distances));
}

void write(Writer& to, const Accelerators& made) {
    to.value(std::uint8_t{made.header.outward != 0});
    for (const auto* list : {&made.normal_cones, &made.outside_cells, &made.clearances}) to.list(all(*list));
    to.list(made.supports.reaches());
}

SavedAccelerators read_accelerators(Reader& from) {
    SavedAccelerators saved;
    saved.outward = from.flag();
    for (auto* list : {&saved.normal_cones, &saved.outside_cells, &saved.clearances}) from.list(*list);
    from.list(saved.reaches);
    return saved;
}

/// A mesh and what was found of it.
struct SavedMesh {
    PreparedMesh mesh;
    SlowParts slow;

    explicit SavedMesh(Reader& from) {
        mesh.name = from.text();
        from.list(mesh.vertices);
        from.list(mesh.triangles);
        from.list(mesh.vertex_index);
        from.list(mesh.triangle_index);
        mesh.report = read_report(from);
        for (auto* order : {&slow.tree.triangles, &slow.tree.children, &slow.sources.vertices, &slow.sources.edges})
            from.list(*order);
        from.list(slow.exit_distances);
        const auto is_length = [](float exit) { return exit >= 0; }; // or infinite, but not NaN
        if (!std::ranges::is_sorted(mesh.vertex_index) || !std::ranges::is_sorted(mesh.triangle_index)
            || !std::ranges::all_of(slow.exit_distances, is_length))
            refuse_damaged();
    }
};

// Its picture, of a thousand triangles, is made in a few milliseconds.
Round read_round(Reader& from) {
    Round round;
    from.value(round);
    const auto is_on_axis = [](const Vec3& v) { return v.x == 0 && v.y == 0; };
    const auto is_measure = [](double metres, double least) { return metres >= least && metres <= 1e8; };
    if (!is_on_axis(round.from) || !is_on_axis(round.to) || round.from.z != -round.to.z || !is_measure(round.to.z, 0)
        || !is_measure(round.radius, 1e-6))
        refuse_damaged();
    return round;
}

/// What is between the mark and the checksum.
std::span<const std::byte> checked(std::span<const std::byte> bytes) {
    constexpr std::size_t word = sizeof(std::uint64_t);
    auto front = bytes, back = bytes.size() < word ? bytes : bytes.last(word);
    const std::uint64_t found = bytes.size() < 2 * word ? 0 : take_bytes<std::uint64_t>(front);
    if (found == other_order) refuse("these bytes are of a machine with another order of bytes; load the mesh there");
    if (found != mark) refuse("these bytes are no shape of this version; give what save() returned");
    if (take_bytes<std::uint64_t>(back) != checksum_of(bytes.first(bytes.size() - word)))
        refuse("the bytes are damaged: their checksum is another; give all that save() returned");
    return front.first(front.size() - word);
}

} // namespace

std::vector<std::byte> Shape::save() const {
    const ShapeData& shape = data();
    const Accelerators* made = accelerators_of(*this);
    const SlowParts slow = shape.round ? SlowParts{} : SlowParts{order_of(shape), source_order_of(shape), {}};
    const auto write_all = [&](Writer to) {
        to.value(mark);
        to.text(library);
        to.value(std::uint8_t{shape.round.has_value()});
        to.value(std::uint8_t{made != nullptr});
        if (shape.round)
            to.value(*shape.round);
        else
            write(to, shape, slow);
        if (made != nullptr) write(to, *made);
        return to.count();
    };
    std::vector<std::byte> bytes;
    bytes.reserve(write_all(Writer()) + sizeof(std::uint64_t));
    write_all(Writer(&bytes));
    put_bytes(bytes, checksum_of(bytes));
    return bytes;
}

std::shared_ptr<const Shape> Shape::load(std::span<const std::byte> bytes) {
    Reader from(checked(bytes));
    std::optional<SavedMesh> mesh;
    Round round;
    std::optional<SavedAccelerators> accelerators;
    try {
        if (const std::string version = from.text(); version != library)
            refuse("the bytes are of version " + version + " of the library, this is " + std::string(library)
                   + "; make the shape of its mesh");
        const bool is_round = from.flag(), is_prepared = from.flag();
        if (is_round)
            round = read_round(from);
        else
            mesh.emplace(from);
        if (is_prepared) accelerators = read_accelerators(from);
        if (!from.is_at_end()) refuse_damaged();
    } catch (const std::logic_error&) { // a list is longer than what is there
        refuse_damaged();
    }
    const FloatEnvironment environment;
    std::shared_ptr<const Shape> shape;
    if (mesh) {
        Executor executor(threads_for(mesh->mesh.triangles.size(), 0));
        shape.reset(new Shape(build_shape(std::move(mesh->mesh), executor, &mesh->slow)));
    } else {
        shape = make_round(round);
    }
    if (!accelerators) return shape;
    auto made = restore_accelerators(shape->data(), std::move(*accelerators));
    if (made == nullptr) refuse_damaged();
    shape->data().accelerators->set(std::move(made));
    return shape;
}

} // namespace raycontact
