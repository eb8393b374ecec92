// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/recording.h>

#include <raycontact/scene.h>
#include <raycontact/shape.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace raycontact::recording {

/// Reads a recording, finished or not, also while it is written (then what was flushed when it was opened). Keeps one
/// block of steps in memory. Every byte it relies on is checked when it is opened: InputError names the file and the
/// place of damage.
class Reader {
public:
    /// Throws InputError when the file is missing, no recording, of a newer version, truncated or damaged.
    explicit Reader(const std::filesystem::path& file);
    ~Reader();
    Reader(Reader&&) noexcept;
    Reader& operator=(Reader&&) noexcept;

    const Info& info() const;
    /// The very shapes that were recorded, bit for bit.
    const std::vector<std::shared_ptr<const Shape>>& shapes() const;
    /// Every body there ever was.
    const std::vector<Body>& bodies() const;
    /// How they came and went, in that order.
    const std::vector<BodyEvent>& events() const;
    /// Of the format. In version 1 a slot was never given twice.
    std::uint32_t version() const;
    std::uint32_t steps() const;
    /// The run's; none where the run did not end well.
    const std::optional<std::string>& hash() const;

    /// Of step i < steps(): poses by slot, with something arbitrary for slots without a body; pairs of ids, sorted by
    /// slots, each once, the lower slot first. Cheap in ascending order; otherwise decodes a block from its start.
    /// Throws InputError where the file is damaged.
    void read_step(std::uint32_t i, std::vector<Pose>& poses, std::vector<Pair>& pairs);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact::recording
