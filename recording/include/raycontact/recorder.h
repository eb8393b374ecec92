// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/export.h>
#include <raycontact/scene.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

namespace raycontact {

/// What a recording says of itself; for people, and for the clock of viewers.
struct RecorderOptions {
    std::string scene = "recording"; ///< a name
    double dt = 1.0 / 60;            ///< seconds between two steps, > 0
    std::uint64_t seed = 0;          ///< of what drives the bodies, where there is one
    std::string mesh_source;         ///< what the meshes are and where they came from
    /// As a person counts them, without the ground; else those in the scene at the start; if it is empty then, a reader
    /// counts all that ever came.
    std::optional<std::uint32_t> bodies;
};

/// Records what a scene does: `raycontact replay` finds its contacts again, `raycontact view` shows it, and any glTF
/// viewer plays it. Link raycontact::recording. Bodies may come and go as they like. Between two flushes (16 steps or a
/// second) a crash loses steps; what was written stays readable. Not thread-safe, as the scene.
class RAYCONTACT_API Recorder {
public:
    /// Records from the scene's next step on; the scene must outlive it. The file's name should end in .glb; what was
    /// there is lost. Throws InputError when the file cannot be made, for dt <= 0, for more than 1 MiB of text, and for
    /// a scene of `iterative` or `predictive` whose last step had pairs: a replay would not know what they kept.
    Recorder(const std::filesystem::path& file, const Scene& scene, const RecorderOptions& options = {});
    /// Without finish(): leaves a recording without a hash, which can be replayed and viewed.
    ~Recorder();
    /// Of the one that is moved from, only its destructor and operator= may be called.
    Recorder(Recorder&&) noexcept;
    /// Ends what was recorded here as ~Recorder() does.
    Recorder& operator=(Recorder&&) noexcept;

    /// After each Scene::find_contacts(), before bodies go: adds its step. Throws InputError when method, direction,
    /// features or thresholds were changed since the start, when a body of the step's pairs is gone, when a new body's
    /// slot had 100 000 bodies that were not recorded, and after finish(); std::runtime_error naming the file when it
    /// cannot be written (a full disk, more than the 4 GiB of a .glb), after which it ends there, or naming a mesh that
    /// cannot be recorded to the bit.
    void record();
    /// Adds the contacts' hash and the animation for viewers. Nothing can be recorded afterwards. Throws InputError the
    /// second time and when the file is gone or was changed, and std::runtime_error when it cannot be written.
    void finish();

    std::uint32_t steps() const;   ///< recorded so far
    std::uint64_t bytes() const;   ///< of the file
    double seconds() const;        ///< spent in record()
    double finish_seconds() const; ///< spent in finish()
    std::string hash() const;      ///< of the contacts so far, as ContactHash gives it

private:
    struct RAYCONTACT_HIDDEN State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact
