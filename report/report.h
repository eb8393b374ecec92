// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <report/page.h>
#include <scenes/run_log.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace raycontact::report {

/// Writes folder/report.html, one file that needs no network and no other file, and the pictures in it once more as
/// folder/pictures/step-NNN.png. Up to eight of the log's frames are drawn; all of them, up to 48, are a film, kept as
/// folder/pictures/film.webp, too. The folder is made where missing. Throws InputError naming the file that cannot be
/// written, or for a log without steps or frames.
void write_report(const std::filesystem::path& folder, const scenes::RunLog& log, const Comparison& comparison = {});

/// Frames that a log should have for a film.
constexpr std::uint32_t film_frames = 48;

/// The bytes of a PNG file of one of the log's frames. Throws InputError when there is no such frame or no area.
std::string picture_png(const scenes::RunLog& log, std::size_t frame, std::uint32_t width, std::uint32_t height);

} // namespace raycontact::report
