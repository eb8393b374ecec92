// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <recording/reader.h>
#include <scenes/run_log.h>
#include <view/clashes.h>
#include <view/run_view.h>

#include <raycontact/settings.h>

#include <cstdint>
#include <functional>
#include <string>

namespace raycontact::view {

struct ViewOptions {
    Settings settings;             ///< with which the contacts of the layers are found
    std::uint32_t layer_every = 1; ///< steps between two with layers; 0: no layers
    std::uint32_t stride = 1;      ///< steps between two whose poses are kept
    /// Triangles of all shapes together that the finest level may have; coarser ones are drawn of more.
    std::uint32_t triangles = 400'000;
    std::function<void(std::uint32_t)> progress; ///< told how many of work_of() are done
};

/// Units of work, for a progress bar.
std::uint32_t work_of(const recording::Reader& reader, const ViewOptions& options);

struct View {
    std::string html;               ///< one document that needs no other file and no network
    std::uint64_t motion_bytes = 0; ///< of it, for poses
    std::uint64_t shape_bytes = 0;
    std::uint64_t layer_bytes = 0;
    std::uint64_t contacts = 0, predictions = 0; ///< in the layers
    std::uint32_t standing = 0;                  ///< bodies that never move
};

/// Throws InputError for a damaged recording, one without steps, or unusable settings.
View make_view(recording::Reader& reader, const ViewOptions& options);
/// Of a run that gathered it, for its report. The log has a step.
View make_view(const scenes::RunLog& log, const RunView& run, const Settings& settings);
/// Of what raycontact clash wrote: a list of its clashes, those parts red, the others faint. name: of the file.
View make_clash_view(const ClashFile& file, const std::string& name, const ViewOptions& options);

} // namespace raycontact::view
