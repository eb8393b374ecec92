// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/recording.h>

#include <raycontact/scene.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

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

    /// Its index. Throws std::runtime_error for one that cannot be recorded to the bit. Shapes must be added before the
    /// bodies that have them.
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
    void flush();
    /// 16 hex digits, as ContactHash gives them. Nothing can be added afterwards. Throws InputError the second time,
    /// and where the file is gone or damaged.
    void finish(std::string_view hash);

    std::uint32_t steps() const;
    std::uint64_t bytes() const; ///< length of the file now
    double seconds() const;      ///< spent in step() and flush()
    double finish_seconds() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact::recording
