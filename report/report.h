// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <output/out_folder.h>
#include <report/page.h>
#include <scenes/run_log.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

namespace raycontact::report {

/// Claims what write_report will write, as far as its names are known.
void claim_report(output::OutFolder& folder);

/// What a report is to have, beside the numbers.
struct ReportOptions {
    std::uint32_t pictures = 4; ///< large ones, evenly over the log's frames; 0: neither these nor the film
    Comparison comparison;
    std::function<void(std::uint32_t)> progress = [](std::uint32_t) {}; ///< told how much of work_of() is drawn
    std::function<bool()> stop = [] { return false; }; ///< asked before each picture: true leaves out those to come
};

/// Frames that a log should have for a film, and for so many pictures.
constexpr std::uint32_t film_frames = 24;

/// Units of drawing, for a progress bar.
std::uint32_t work_of(const scenes::RunLog& log, const ReportOptions& options);

/// Writes report.html, one file that needs no network and no other file, and the pictures in it once more as
/// pictures/step-NNN.png. About 24 of the log's frames are a film, pictures/film.webp, too. The caller keeps them.
/// The log has a step and a frame. Throws as OutFolder::write does.
void write_report(output::OutFolder& folder, const scenes::RunLog& log, const ReportOptions& options = {});

} // namespace raycontact::report
