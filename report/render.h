// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/image.h>
#include <scenes/run_log.h>

#include <cstdint>
#include <memory>

namespace raycontact::report {

/// Draws frames of one run with Embree: sun with soft shadows, light from the sky, an endless ground with a grid of 1
/// m. Fixed seeds: the same frame gives the same picture on the same machine. Pictures decide no result.
class Renderer {
public:
    explicit Renderer(const scenes::RunLog& log); ///< `log` must outlive the renderer
    ~Renderer();
    Renderer(const Renderer&) = delete;
    Renderer& operator=(const Renderer&) = delete;

    Image render(const scenes::Frame& frame, std::uint32_t width, std::uint32_t height) const;
    /// Seen from one place that has all frames of the run in view, with a quarter of the rays: for a film.
    Image render_for_film(const scenes::Frame& frame, std::uint32_t width, std::uint32_t height) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace raycontact::report
