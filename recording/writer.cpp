// SPDX-License-Identifier: Apache-2.0
#include <recording/writer.h>

#include <recording/file.h>
#include <recording/layout.h>
#include <recording/reader.h>
#include <recording/shape_codec.h>
#include <recording/step_codec.h>
#include <recording/viewer_part.h>

#include "body_slots.h"

#include <raycontact/error.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

namespace raycontact::recording {

namespace {

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

constexpr std::uint64_t most_bytes = 0xffffffff;          // of a .glb file
constexpr std::uint64_t reserve = 4096;                   // of those, kept for the end block
constexpr std::uint32_t most_block_steps = 16;            // a reader takes one step for 3 bytes at most
constexpr std::size_t block_bytes = std::size_t{4} << 20; // of poses and pairs, before a block is closed anyway

void append(Bytes& to, const Bytes& more) {
    to.insert(to.end(), more.begin(), more.end());
}

Bytes word(std::uint64_t value) {
    Bytes bytes;
    put(bytes, static_cast<std::uint32_t>(value));
    return bytes;
}

} // namespace

struct Writer::State {
    State(const std::filesystem::path& path, const Info& i, const WriterOptions& o)
        : info(i), options(o), file(File::create(path)) {}

    void begin();
    void commit(const Bytes& blocks);
    void check_whole() const;
    void flush();
    std::uint32_t number_of(BodyId body) const;
    void check_and_keep(std::span<const Pose> by_slot, std::span<const Pair> given);
    void step(std::span<const Pose> by_slot, std::span<const Pair> given);
    std::uint64_t place() const { return end - data; }
    std::uint32_t frame_stride() const;
    Bytes picture(std::span<const float> times, std::span<const ViewerTrack> tracks) const;
    Bytes animated_part() const;
    void animate();

    Info info;
    WriterOptions options;
    File file;
    bool begun = false, finished = false;
    bool cut_off = false;   ///< steps were lost in a write that failed: none that come later can follow on those before
    std::uint64_t data = 0; ///< where the side chunk's data starts
    std::uint64_t end = 0;  ///< where the next block goes

    std::vector<ViewerMesh> meshes;
    std::vector<Bytes> waiting_shapes;
    std::vector<BodyEvent> waiting_events;
    BodySlots slots;                      ///< as the scene has them
    std::vector<std::uint32_t> number_in; ///< by slot: the body that has it, or had it last
    std::vector<Body> bodies;
    std::vector<std::uint32_t> live; ///< numbers, ascending
    std::vector<ViewerBody> viewer_bodies;
    std::vector<char> moves; ///< has left its first pose
    StepEncoder encoder;
    Clock::time_point oldest; ///< of the steps in the encoder
    std::uint32_t steps = 0;
    std::vector<Pose> poses; ///< of the step, by number
    std::vector<NumberPair> pairs;
    std::vector<Pose> scene_poses;
    double seconds = 0, finish_seconds = 0;
};

Bytes Writer::State::picture(std::span<const float> times, std::span<const ViewerTrack> tracks) const {
    try {
        return viewer_part(meshes, viewer_bodies, times, tracks);
    } catch (const std::length_error& error) {
        throw std::runtime_error(file.path().string() + ": " + error.what());
    }
}

// The still picture, then the side chunk with what is known from the start. From here on the file only grows, and only
// two lengths are ever overwritten.
void Writer::State::begin() {
    Bytes start = picture({}, {});
    const Bytes description =
        make_block(BlockType::info, 0, 0, encode_info(info), side_chunk_start.size(), Effort::thorough);
    data = start.size() + glb::chunk_header_bytes;
    end = data + side_chunk_start.size() + description.size();
    append(start, word(end - data));
    append(start, word(side_chunk));
    start.insert(start.end(), side_chunk_start.begin(), side_chunk_start.end());
    append(start, description);
    const Bytes whole = word(end);
    std::copy(whole.begin(), whole.end(), start.begin() + glb::length_at);
    file.write(0, start);
    begun = true;
}

// First the blocks, then the lengths that make them part of the file: whoever reads, and a crash, meets whole blocks.
void Writer::State::commit(const Bytes& blocks) {
    if (end + blocks.size() > most_bytes - reserve)
        throw std::runtime_error(file.path().string()
                                 + ": full, a .glb file ends at 4 GiB; record fewer steps (what was written stays)");
    file.write(end, blocks);
    end += blocks.size();
    file.write(data - glb::chunk_header_bytes, word(end - data));
    file.write(glb::length_at, word(end));
}

void Writer::State::check_whole() const {
    if (cut_off)
        throw std::runtime_error(file.path().string()
                                 + ": ends where it could not be written; begin another (what was written stays)");
}

void Writer::State::flush() {
    check_whole();
    if (!begun) begin();
    cut_off = true; // until all is written
    Bytes blocks;
    for (const Bytes& shape : waiting_shapes)
        append(blocks, make_block(BlockType::shape, 0, 0, shape, place() + blocks.size(), Effort::thorough));
    if (!waiting_events.empty())
        append(blocks, make_block(BlockType::bodies, 0, 0, encode_events(waiting_events), place() + blocks.size(),
                                  Effort::thorough));
    waiting_shapes.clear();
    waiting_events.clear();
    if (encoder.steps() > 0) {
        const std::uint32_t count = encoder.steps();
        append(blocks, make_block(BlockType::steps, steps - count, count, encoder.take(), place() + blocks.size(),
                                  Effort::quick));
    }
    if (!blocks.empty()) commit(blocks);
    cut_off = false;
}

// Throws InputError where no body has the id now.
std::uint32_t Writer::State::number_of(BodyId body) const {
    if (!slots.is_there(body))
        throw InputError("recording: body " + std::to_string(body.slot) + " (generation "
                         + std::to_string(body.generation) + ") is not there; use the ids that add_body() gave");
    return number_in[body.slot];
}

void Writer::State::check_and_keep(std::span<const Pose> by_slot, std::span<const Pair> given) {
    poses.resize(bodies.size());
    for (const std::uint32_t number : live) {
        const std::uint32_t slot = bodies[number].id.slot;
        if (slot >= by_slot.size())
            throw InputError("recording: " + std::to_string(by_slot.size()) + " poses, and a body in slot "
                             + std::to_string(slot) + "; give one for each slot, those without a body too");
        check_pose(by_slot[slot], ("recording, body " + std::to_string(slot)).c_str());
        poses[number] = by_slot[slot];
    }
    pairs.clear();
    for (const auto& [first, second] : given) {
        const std::uint32_t a = number_of(first), b = number_of(second);
        if (a == b)
            throw InputError("recording: body " + std::to_string(first.slot)
                             + " is paired with itself; pairs need two bodies");
        pairs.emplace_back(std::min(a, b), std::max(a, b));
    }
    if (!std::is_sorted(pairs.begin(), pairs.end())) std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    for (const std::uint32_t number : live) {
        if (bodies[number].first_step == steps)
            viewer_bodies[number].start = poses[number];
        else if (!(viewer_bodies[number].start == poses[number]))
            moves[number] = 1;
    }
}

void Writer::State::step(std::span<const Pose> by_slot, std::span<const Pair> given) {
    if (finished) throw InputError("recording: a step after its end");
    check_whole();
    const auto start = Clock::now();
    check_and_keep(by_slot, given);
    if (encoder.steps() == 0) oldest = start;
    encoder.add(live, poses, pairs);
    ++steps;
    slots.step_done();
    // The first step at once: a recording exists from then on.
    if (!begun || encoder.steps() >= std::min(options.flush_steps, most_block_steps) || encoder.bytes() >= block_bytes
        || seconds_since(oldest) >= options.flush_seconds)
        flush();
    seconds += seconds_since(start);
}

// Of every so many steps one becomes a frame of the animation, so that it keeps to its size.
std::uint32_t Writer::State::frame_stride() const {
    const auto moving = static_cast<std::uint64_t>(std::count(moves.begin(), moves.end(), char{1}));
    const std::uint64_t per_frame = 4 + 28 * moving + 12 * bodies.size();
    const std::uint64_t room = std::min(options.animation_bytes, (most_bytes - end) / 2);
    const std::uint64_t most_frames = std::max<std::uint64_t>(2, room / per_frame);
    return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, (steps + most_frames - 1) / most_frames));
}

Bytes Writer::State::animated_part() const {
    if (steps == 0) return picture({}, {});
    Reader reader(file.path());
    const std::uint32_t stride = frame_stride();
    std::vector<float> times;
    std::vector<ViewerTrack> tracks(bodies.size());
    std::vector<Pose> now, last(bodies.size()); // by slot; by number
    for (std::size_t i = 0; i < bodies.size(); ++i) last[i] = viewer_bodies[i].start;
    std::vector<Pair> ignored;
    for (std::uint32_t i = 0; i < steps; ++i) {
        if (i % stride != 0 && i + 1 != steps) continue;
        reader.read_step(i, now, ignored);
        times.push_back(static_cast<float>(i * info.dt));
        for (std::size_t k = 0; k < bodies.size(); ++k) {
            const Body& body = bodies[k];
            if (body.alive(i)) last[k] = now[body.id.slot];
            if (moves[k]) tracks[k].add(last[k]);
            if (body.first_step > 0 || body.end_step < steps) tracks[k].sizes.push_back(body.alive(i) ? 1.f : 0.f);
        }
    }
    return picture(times, tracks);
}

// The same side chunk behind a new viewer's part, beside the file, then in its place: there is a whole file throughout.
void Writer::State::animate() {
    const Bytes start = animated_part();
    const std::uint64_t length = end - data;
    const std::uint64_t whole = start.size() + glb::chunk_header_bytes + length;
    if (whole > most_bytes) return;
    std::filesystem::path part = file.path();
    part += ".part";
    try {
        File to = File::create(part);
        to.write(0, start);
        to.write(glb::length_at, word(whole));
        Bytes header = word(length);
        append(header, word(side_chunk));
        to.write(start.size(), header);
        Bytes buffer(std::size_t{1} << 20);
        for (std::uint64_t done = 0; done < length;) {
            const auto piece = std::span(buffer).first(
                static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), length - done)));
            if (!file.read(data + done, piece))
                throw std::runtime_error(file.path().string() + ": was cut short while it was written");
            to.write(start.size() + glb::chunk_header_bytes + done, piece);
            done += piece.size();
        }
        to.sync();
        to.close();
        file.close(); // Windows does not replace an open file
        std::filesystem::rename(part, file.path());
    } catch (...) {
        std::error_code ignored;
        std::filesystem::remove(part, ignored);
        throw;
    }
    end = whole;
}

Writer::Writer(const std::filesystem::path& file, const Info& info, const WriterOptions& options) {
    if (!std::isfinite(info.dt) || info.dt <= 0)
        throw InputError("recording: the time step must be a positive number of seconds");
    check_settings(info.settings); // a reader would refuse them
    encode_info(info);             // throws if it is too long, before any step is lost
    state_ = std::make_unique<State>(file, info, options);
}

Writer::~Writer() {
    if (state_->finished || (!state_->begun && state_->steps == 0)) return;
    try {
        state_->flush();
    } catch (const std::exception&) {
        // What was flushed before stays readable; a destructor can do no more.
    }
}

std::uint32_t Writer::add_shape(const Shape& shape) {
    state_->waiting_shapes.push_back(encode_mesh(remade_mesh(shape)));
    state_->meshes.push_back(viewer_mesh(shape));
    return static_cast<std::uint32_t>(state_->meshes.size() - 1);
}

BodyId Writer::add_body(std::uint32_t shape) {
    State& s = *state_;
    if (shape >= s.meshes.size()) throw InputError("recording: shape " + std::to_string(shape) + " was not added");
    const auto number = static_cast<std::uint32_t>(s.bodies.size());
    const BodyId id = s.slots.next();
    if (id.slot >= s.number_in.size()) s.number_in.resize(id.slot + std::size_t{1});
    s.bodies.push_back({shape, s.steps, Body::never, id});
    s.waiting_events.push_back({s.steps, BodyEvent::comes, number, shape});
    s.live.push_back(number);
    s.viewer_bodies.push_back({shape, {}});
    s.moves.push_back(0);
    s.number_in[id.slot] = number;
    return s.slots.give();
}

void Writer::remove_body(BodyId body) {
    State& s = *state_;
    const std::uint32_t number = s.number_of(body);
    s.waiting_events.push_back({s.steps, BodyEvent::goes, number, 0});
    s.live.erase(std::lower_bound(s.live.begin(), s.live.end(), number));
    s.bodies[number].end_step = s.steps;
    s.slots.take_back(body.slot);
}

void Writer::step(std::span<const Pose> poses, std::span<const Pair> pairs) {
    state_->step(poses, pairs);
}

void Writer::step(const Scene& scene) {
    std::vector<Pose>& poses = state_->scene_poses;
    poses.resize(state_->slots.end());
    for (const std::uint32_t number : state_->live) {
        const BodyId id = state_->bodies[number].id;
        poses[id.slot] = scene.pose(id);
    }
    state_->step(poses, scene.pairs());
}

void Writer::flush() {
    const auto start = Clock::now();
    state_->flush();
    state_->seconds += seconds_since(start);
}

void Writer::finish(std::string_view hash) {
    if (!is_hash(hash)) throw InputError("recording: \"" + std::string(hash) + "\" is no hash of 16 hex digits");
    State& s = *state_;
    if (s.finished) throw InputError("recording: it has been finished already");
    const auto start = Clock::now();
    s.flush();
    const Bytes last = make_block(BlockType::end, 0, 0, encode_end(s.steps, hash), s.place(), Effort::thorough);
    s.file.write(s.end, last);
    s.end += last.size();
    s.file.write(s.data - glb::chunk_header_bytes, word(s.end - s.data));
    s.file.write(glb::length_at, word(s.end));
    s.finished = true;
    s.animate();
    s.finish_seconds = seconds_since(start);
}

std::uint32_t Writer::steps() const {
    return state_->steps;
}
std::uint64_t Writer::bytes() const {
    return state_->end;
}
double Writer::seconds() const {
    return state_->seconds;
}
double Writer::finish_seconds() const {
    return state_->finish_seconds;
}

} // namespace raycontact::recording
