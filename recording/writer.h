// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "src/body_slots.h"
#include <recording/file.h>
#include <recording/recording.h>
#include <recording/step_codec.h>
#include <recording/viewer_part.h>

#include <raycontact/scene.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace raycontact::recording {

/// How much a crash may lose, and how large the viewer's animation may become.
struct WriterOptions {
    std::uint32_t flush_steps = 16; ///< steps are written at the latest when so many are waiting, ...
    double flush_seconds = 1;       ///< ... or when the first of them has waited so long
    /// The animation leaves out steps, evenly, where it would need more than this. The exact data never does.
    std::uint64_t animation_bytes = std::uint64_t{128} << 20;
};

/// Writes a recording as the simulation goes. At each flush the file is whole: a still .glb to viewers, all steps so
/// far to Reader. finish() adds the run's hash and the viewers' animation. Not thread-safe. A file that cannot be
/// written later on (a full disk, more than the 4 GiB of a .glb) throws std::runtime_error naming it, from then on in
/// each call; what was flushed stays readable.
class Writer {
public:
    /// Throws InputError when the file cannot be made, or info makes no sense or is too long. What was there is lost.
    Writer(const std::filesystem::path& file, const Info& info, const WriterOptions& options = {});
    /// Without finish(): writes what is waiting, as far as it can, and leaves a recording without a hash.
    ~Writer();
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;

    /// Its index. Shapes must be added before the bodies that have them.
    std::uint32_t add_shape(const Shape& shape);
    /// Takes part from the next step on. Bodies come and go here in the order in which they do in the scene; the id is
    /// then the one that Scene::add gives.
    BodyId add_body(std::uint32_t shape);
    void remove_body(BodyId body);

    /// One step: poses by slot (those of slots without a body are ignored) and the pairs, as a scene was given them.
    /// Throws InputError for a pose that is not rigid or a pair of bodies that are not there.
    void step(std::span<const Pose> poses, std::span<const Pair> pairs);
    /// The step that the scene has just done. It must have the bodies that were added here.
    void step(const Scene& scene);
    /// 16 hex digits, as ContactHash gives them. Nothing can be added afterwards. Throws InputError the second time,
    /// and where the file is gone or damaged.
    void finish(std::string_view hash);

    std::uint32_t steps() const { return steps_; }
    std::uint64_t bytes() const { return end_; } ///< length of the file now
    double seconds() const { return seconds_; }  ///< spent in step()
    double finish_seconds() const { return finish_seconds_; }

private:
    using Clock = std::chrono::steady_clock;

    void begin();
    void commit(const Bytes& blocks, std::uint64_t most);
    void check_whole() const;
    void flush();
    std::uint32_t number_of(BodyId body) const;
    void check_and_keep(std::span<const Pose> by_slot, std::span<const Pair> given);
    std::uint64_t place() const { return end_ - data_; }
    std::uint32_t frame_stride() const;
    Bytes picture(std::span<const float> times, std::span<const ViewerTrack> tracks) const;
    Bytes animated_part() const;
    void animate();

    Info info_;
    WriterOptions options_;
    File file_;
    bool begun_ = false, finished_ = false;
    bool cut_off_ = false; ///< steps were lost in a write that failed: none that come later can follow on those before
    std::uint64_t data_ = 0; ///< where the side chunk's data starts
    std::uint64_t end_ = 0;  ///< where the next block goes

    std::vector<std::shared_ptr<const Shape>> shapes_;
    std::vector<Bytes> waiting_shapes_;
    std::vector<BodyEvent> waiting_events_;
    BodySlots slots_;                      ///< as the scene has them
    std::vector<std::uint32_t> number_in_; ///< by slot: the body that has it, or had it last
    std::vector<Body> bodies_;
    std::vector<std::uint32_t> live_; ///< numbers, ascending
    std::vector<ViewerBody> viewer_bodies_;
    std::vector<char> moves_; ///< has left its first pose
    StepEncoder encoder_;
    Clock::time_point oldest_; ///< of the steps in the encoder
    std::uint32_t steps_ = 0;
    std::vector<Pose> poses_; ///< of the step, by number
    std::vector<NumberPair> pairs_;
    std::vector<Pose> scene_poses_;
    double seconds_ = 0, finish_seconds_ = 0;
};

} // namespace raycontact::recording
