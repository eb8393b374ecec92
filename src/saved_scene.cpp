// SPDX-License-Identifier: Apache-2.0
#include "saved_scene.h"

#include "state_bytes.h"

#include <raycontact/error.h>

#include <array>
#include <string>
#include <xxhash.h>

namespace raycontact {

namespace {

constexpr std::uint64_t version = 0x3165746174734352; // "RCstate1"

[[noreturn]] void refuse(const std::string& what) {
    throw InputError("Scene::load_state: " + what);
}

std::uint64_t checksum_of(std::span<const std::byte> bytes) {
    return XXH64(bytes.data(), bytes.size(), sizeof(Contact));
}

/// On which later contacts depend.
std::vector<std::byte> bytes_of(const Settings& settings) {
    std::vector<std::byte> bytes;
    const auto put = [&](auto value) { put_bytes(bytes, double(value)); };
    put(int(settings.method));
    put(int(settings.direction));
    put(int(settings.features));
    put(settings.is_speculative());
    put(settings.speculative_margin.value_or(-1));
    put(settings.max_contacts_per_pair);
    put(settings.max_contacts);
    const PaperOptions& paper = settings.paper;
    for (const auto& length : {paper.displacement_threshold, paper.culling_distance, paper.distance_extension})
        put(length.value_or(-1));
    put(paper.confidence);
    put(paper.max_iterations);
    put(paper.cast_lost_walks);
    put(paper.skip_outside);
    return bytes;
}

/// By which it is known again.
std::vector<std::byte> bytes_of(const Shape& shape) {
    std::vector<std::byte> bytes;
    put_bytes(bytes, std::uint64_t{shape.vertices().size()});
    put_bytes(bytes, std::uint64_t{shape.triangles().size()});
    put_bytes(bytes, shape.box_min());
    put_bytes(bytes, shape.box_max());
    put_bytes(bytes, shape.radius());
    put_bytes(bytes, shape.round() != nullptr ? shape.round()->radius : -1.0);
    return bytes;
}

using Slots = std::array<BodySlot, 2>; // a std::pair cannot be copied by bytes

void put_pairs(std::vector<std::byte>& bytes, std::span<const SlotPair> pairs) {
    std::vector<Slots> list;
    for (const auto& [a, b] : pairs) list.push_back({a, b});
    put_list<Slots>(bytes, list);
}

std::vector<SlotPair> take_pairs(std::span<const std::byte>& bytes) {
    std::vector<SlotPair> pairs;
    for (const auto& [a, b] : take_list<Slots>(bytes)) pairs.emplace_back(a, b);
    return pairs;
}

} // namespace

std::vector<std::byte> SavedScene::encode(const Settings& settings,
                                          std::span<const std::shared_ptr<const Shape>> shapes) const {
    std::vector<std::byte> bytes;
    put_bytes(bytes, version);
    put_list<std::byte>(bytes, bytes_of(settings));
    put_bytes(bytes, std::uint64_t{shapes.size()});
    for (const auto& shape : shapes) put_list<std::byte>(bytes, bytes_of(*shape));
    put_list<SavedBody>(bytes, bodies);
    slots.save(bytes);
    next_poses.save(bytes);
    put_pairs(bytes, pairs);
    for (const auto* list : {&contacts.kept, &contacts.left_out, &contacts.sensed}) put_list<Contact>(bytes, *list);
    put_bytes(bytes, std::uint64_t{contacts.were_chosen});
    put_list<Touch>(bytes, touches);
    put_list<Touches::Place>(bytes, places);
    put_bytes(bytes, std::uint64_t{rays.size()});
    for (const SavedRays& own : rays) {
        put_pairs(bytes, own.pairs);
        put_list<std::byte>(bytes, own.state);
    }
    put_bytes(bytes, checksum_of(bytes));
    return bytes;
}

SavedScene SavedScene::decode(std::span<const std::byte> state, const Settings& settings,
                              std::span<const std::shared_ptr<const Shape>> shapes) {
    constexpr std::size_t least = 2 * sizeof(std::uint64_t);
    auto rest = state;
    if (state.size() < least || take_bytes<std::uint64_t>(rest) != version)
        refuse("these bytes are no state of a scene of this version; give what save_state() returned");
    rest = rest.first(rest.size() - sizeof(std::uint64_t));
    auto sum = state.last(sizeof(std::uint64_t));
    if (take_bytes<std::uint64_t>(sum) != checksum_of(state.first(state.size() - sizeof(std::uint64_t))))
        refuse("the state is damaged: its checksum is another; give all bytes that save_state() returned");
    if (take_list<std::byte>(rest) != bytes_of(settings))
        refuse("it was saved with other settings; make the scene with those, devices and threads aside");
    const auto count = take_bytes<std::uint64_t>(rest);
    if (count != shapes.size())
        refuse("it has " + std::to_string(count) + " shapes, but " + std::to_string(shapes.size())
               + " are given; give those that shapes() returned when it was saved");
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        const auto expected = take_list<std::byte>(rest);
        if (shapes[i] == nullptr || bytes_of(*shapes[i]) != expected)
            refuse("shape " + std::to_string(i)
                   + " is another one than it was; give those that shapes() returned when it was saved");
    }
    SavedScene saved;
    saved.bodies = take_list<SavedBody>(rest);
    saved.slots.load(rest);
    saved.next_poses.load(rest);
    saved.pairs = take_pairs(rest);
    for (auto* list : {&saved.contacts.kept, &saved.contacts.left_out, &saved.contacts.sensed})
        *list = take_list<Contact>(rest);
    saved.contacts.were_chosen = take_bytes<std::uint64_t>(rest) != 0;
    saved.touches = take_list<Touch>(rest);
    saved.places = take_list<Touches::Place>(rest);
    saved.rays.resize(take_bytes<std::uint64_t>(rest));
    for (SavedRays& own : saved.rays) {
        own.pairs = take_pairs(rest);
        own.state = take_list<std::byte>(rest);
    }
    return saved;
}

} // namespace raycontact
