// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <output/out_folder.h>
#include <report/page.h>
#include <scenes/run_log.h>

#include <cstddef>
#include <cstdint>
#include <string>

namespace raycontact::report {

/// Claims what write_report will write, as far as its names are known.
void claim_report(output::OutFolder& folder);

/// Writes report.html, one file that needs no network and no other file, and the pictures in it once more as
/// pictures/step-NNN.png. Up to eight of the log's frames are drawn; all of them, up to 48, are a film,
/// pictures/film.webp, too. The caller keeps them. Throws InputError for a log without steps or frames, and as
/// OutFolder::write does.
void write_report(output::OutFolder& folder, const scenes::RunLog& log, const Comparison& comparison = {});

/// Frames that a log should have for a film.
constexpr std::uint32_t film_frames = 48;

/// The bytes of a PNG file of one of the log's frames. Throws InputError when there is no such frame or no area.
std::string picture_png(const scenes::RunLog& log, std::size_t frame, std::uint32_t width, std::uint32_t height);

} // namespace raycontact::report
