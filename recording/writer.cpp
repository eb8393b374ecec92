// SPDX-License-Identifier: Apache-2.0
#include <recording/writer.h>

#include <recording/layout.h>
#include <recording/reader.h>
#include <recording/shape_codec.h>

#include <raycontact/error.h>

#include <algorithm>
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

const Info& checked(const Info& info) {
    if (!std::isfinite(info.dt) || info.dt <= 0)
        throw InputError("recording: the time step must be a positive number of seconds");
    check_settings(info.settings); // a reader would refuse them
    encode_info(info);             // throws if it is too long, before any step is lost
    return info;
}

// Of NAME, and of a NAME.part that takes its name later.
std::filesystem::path last_draft(std::filesystem::path file) {
    if (file.extension() == ".part") file.replace_extension();
    return file += ".last.part";
}

Bytes word(std::uint64_t value) {
    Bytes bytes;
    put(bytes, static_cast<std::uint32_t>(value));
    return bytes;
}

} // namespace

Bytes Writer::picture(std::span<const float> times, std::span<const ViewerTrack> tracks) const {
    try {
        return viewer_part(shapes_, viewer_bodies_, times, tracks);
    } catch (const std::length_error& error) {
        throw std::runtime_error(file_.path().string() + ": " + error.what());
    }
}

// The still picture, then the side chunk with what is known from the start. From here on the file only grows, and only
// two lengths are ever overwritten.
void Writer::begin() {
    Bytes start = picture({}, {});
    const Bytes description =
        make_block(BlockType::info, 0, 0, encode_info(info_), side_chunk_start.size(), Effort::thorough);
    data_ = start.size() + glb::chunk_header_bytes;
    end_ = data_ + side_chunk_start.size() + description.size();
    append(start, word(end_ - data_));
    append(start, word(side_chunk));
    start.insert(start.end(), side_chunk_start.begin(), side_chunk_start.end());
    append(start, description);
    const Bytes whole = word(end_);
    std::copy(whole.begin(), whole.end(), start.begin() + glb::length_at);
    file_.write(0, start);
    begun_ = true;
}

// First the blocks, then the lengths that make them part of the file: whoever reads, and a crash, meets whole blocks.
void Writer::commit(const Bytes& blocks, std::uint64_t most) {
    if (end_ + blocks.size() > most)
        throw std::runtime_error(file_.path().string()
                                 + ": full, a .glb file ends at 4 GiB; record fewer steps (what was written stays)");
    file_.write(end_, blocks);
    end_ += blocks.size();
    file_.write(data_ - glb::chunk_header_bytes, word(end_ - data_));
    file_.write(glb::length_at, word(end_));
}

void Writer::check_whole() const {
    if (cut_off_)
        throw std::runtime_error(file_.path().string()
                                 + ": ends where it could not be written; begin another (what was written stays)");
}

void Writer::flush() {
    check_whole();
    if (!begun_) begin();
    cut_off_ = true; // until all is written
    Bytes blocks;
    for (const Bytes& shape : waiting_shapes_)
        append(blocks, make_block(BlockType::shape, 0, 0, shape, place() + blocks.size(), Effort::thorough));
    if (!waiting_events_.empty())
        append(blocks, make_block(BlockType::bodies, 0, 0, encode_events(waiting_events_), place() + blocks.size(),
                                  Effort::thorough));
    waiting_shapes_.clear();
    waiting_events_.clear();
    if (encoder_.steps() > 0) {
        const std::uint32_t count = encoder_.steps();
        append(blocks, make_block(BlockType::steps, steps_ - count, count, encoder_.take(), place() + blocks.size(),
                                  Effort::quick));
    }
    if (!blocks.empty()) commit(blocks, most_bytes - reserve);
    cut_off_ = false;
}

// Throws InputError where no body has the id now.
std::uint32_t Writer::number_of(BodyId body) const {
    if (!slots_.is_there(body))
        throw InputError("recording: body " + std::to_string(body.slot) + " (generation "
                         + std::to_string(body.generation) + ") is not there; use the ids that add_body() gave");
    return number_in_[body.slot];
}

void Writer::check_and_keep(std::span<const Pose> by_slot, std::span<const Pair> given) {
    poses_.resize(bodies_.size());
    for (const std::uint32_t number : live_) {
        const std::uint32_t slot = bodies_[number].id.slot;
        if (slot >= by_slot.size())
            throw InputError("recording: " + std::to_string(by_slot.size()) + " poses, and a body in slot "
                             + std::to_string(slot) + "; give one for each slot, those without a body too");
        check_pose(by_slot[slot], ("recording, body " + std::to_string(slot)).c_str());
        poses_[number] = by_slot[slot];
    }
    pairs_.clear();
    for (const auto& [first, second] : given) {
        const std::uint32_t a = number_of(first), b = number_of(second);
        if (a == b)
            throw InputError("recording: body " + std::to_string(first.slot)
                             + " is paired with itself; pairs need two bodies");
        pairs_.emplace_back(std::min(a, b), std::max(a, b));
    }
    if (!std::is_sorted(pairs_.begin(), pairs_.end())) std::sort(pairs_.begin(), pairs_.end());
    pairs_.erase(std::unique(pairs_.begin(), pairs_.end()), pairs_.end());
    for (const std::uint32_t number : live_) {
        if (bodies_[number].first_step == steps_)
            viewer_bodies_[number].start = poses_[number];
        else if (!(viewer_bodies_[number].start == poses_[number]))
            moves_[number] = 1;
    }
}

void Writer::step(std::span<const Pose> by_slot, std::span<const Pair> given) {
    if (finished_) throw InputError("recording: a step after its end");
    check_whole();
    const auto start = Clock::now();
    check_and_keep(by_slot, given);
    if (encoder_.steps() == 0) oldest_ = start;
    encoder_.add(live_, poses_, pairs_);
    ++steps_;
    slots_.step_done();
    // The first step at once: a recording exists from then on.
    if (!begun_ || encoder_.steps() >= std::min(options_.flush_steps, most_block_steps)
        || encoder_.bytes() >= block_bytes || seconds_since(oldest_) >= options_.flush_seconds)
        flush();
    seconds_ += seconds_since(start);
}

// Of every so many steps one becomes a frame of the animation, so that it keeps to its size.
std::uint32_t Writer::frame_stride() const {
    const auto moving = static_cast<std::uint64_t>(std::count(moves_.begin(), moves_.end(), char{1}));
    const std::uint64_t per_frame = 4 + 28 * moving + 12 * bodies_.size();
    const std::uint64_t room = std::min(options_.animation_bytes, (most_bytes - end_) / 2);
    const std::uint64_t most_frames = std::max<std::uint64_t>(2, room / per_frame);
    return static_cast<std::uint32_t>(std::max<std::uint64_t>(1, (steps_ + most_frames - 1) / most_frames));
}

Bytes Writer::animated_part() const {
    if (steps_ == 0) return picture({}, {});
    Reader reader(file_.path());
    const std::uint32_t stride = frame_stride();
    std::vector<float> times;
    std::vector<ViewerTrack> tracks(bodies_.size());
    std::vector<Pose> now, last(bodies_.size()); // by slot; by number
    for (std::size_t i = 0; i < bodies_.size(); ++i) last[i] = viewer_bodies_[i].start;
    std::vector<Pair> ignored;
    for (std::uint32_t i = 0; i < steps_; ++i) {
        if (i % stride != 0 && i + 1 != steps_) continue;
        reader.read_step(i, now, ignored);
        times.push_back(static_cast<float>(i * info_.dt));
        for (std::size_t k = 0; k < bodies_.size(); ++k) {
            const Body& body = bodies_[k];
            if (body.alive(i)) last[k] = now[body.id.slot];
            if (moves_[k]) tracks[k].add(last[k]);
            if (body.first_step > 0 || body.end_step < steps_) tracks[k].sizes.push_back(body.alive(i) ? 1.f : 0.f);
        }
    }
    return picture(times, tracks);
}

// The same side chunk behind a new viewer's part, beside the file, then in its place: there is a whole file throughout.
void Writer::animate() {
    const Bytes start = animated_part();
    const std::uint64_t length = end_ - data_;
    const std::uint64_t whole = start.size() + glb::chunk_header_bytes + length;
    if (whole > most_bytes) return;
    const std::filesystem::path part = last_draft(file_.path());
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
            if (!file_.read(data_ + done, piece))
                throw std::runtime_error(file_.path().string() + ": was cut short while it was written");
            to.write(start.size() + glb::chunk_header_bytes + done, piece);
            done += piece.size();
        }
        to.sync();
        to.close();
        file_.close(); // Windows does not replace an open file
        std::filesystem::rename(part, file_.path());
    } catch (...) {
        std::error_code ignored;
        std::filesystem::remove(part, ignored);
        throw;
    }
    end_ = whole;
}

Writer::Writer(const std::filesystem::path& file, const Info& info, const WriterOptions& options)
    : info_(checked(info)), options_(options), file_(File::create(file)) {}

Writer::~Writer() {
    if (finished_ || (!begun_ && steps_ == 0)) return;
    try {
        flush();
    } catch (const std::exception&) {
        // What was flushed before stays readable; a destructor can do no more.
    }
}

std::uint32_t Writer::add_shape(const Shape& shape) {
    waiting_shapes_.push_back(encode_shape(shape));
    shapes_.push_back(shape.shared_from_this());
    return static_cast<std::uint32_t>(shapes_.size() - 1);
}

BodyId Writer::add_body(std::uint32_t shape) {
    if (shape >= shapes_.size()) throw InputError("recording: shape " + std::to_string(shape) + " was not added");
    const auto number = static_cast<std::uint32_t>(bodies_.size());
    const BodyId id = slots_.next();
    if (id.slot >= number_in_.size()) number_in_.resize(id.slot + std::size_t{1});
    bodies_.push_back({shape, steps_, Body::never, id});
    waiting_events_.push_back({steps_, BodyEvent::comes, number, shape});
    live_.push_back(number);
    viewer_bodies_.push_back({shape, {}});
    moves_.push_back(0);
    number_in_[id.slot] = number;
    return slots_.give();
}

void Writer::remove_body(BodyId body) {
    const std::uint32_t number = number_of(body);
    waiting_events_.push_back({steps_, BodyEvent::goes, number, 0});
    live_.erase(std::ranges::lower_bound(live_, number));
    bodies_[number].end_step = steps_;
    slots_.take_back(body.slot);
}

void Writer::step(const Scene& scene) {
    scene_poses_.resize(slots_.end());
    for (const std::uint32_t number : live_) {
        const BodyId id = bodies_[number].id;
        scene_poses_[id.slot] = scene.pose(id);
    }
    step(scene_poses_, scene.pairs());
}

void Writer::finish(std::string_view hash) {
    if (!is_hash(hash)) throw InputError("recording: \"" + std::string(hash) + "\" is no hash of 16 hex digits");
    if (finished_) throw InputError("recording: it has been finished already");
    const auto start = Clock::now();
    flush();
    commit(make_block(BlockType::end, 0, 0, encode_end(steps_, hash), place(), Effort::thorough), most_bytes);
    finished_ = true;
    animate();
    finish_seconds_ = seconds_since(start);
}

} // namespace raycontact::recording
