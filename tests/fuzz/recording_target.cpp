// SPDX-License-Identifier: Apache-2.0
// A recording, with its checksums made right: opened, read step by step, and replayed where it is small.
#include "fuzz/recording_input.h"
#include "temporary_folder.h"

#include <recording/reader.h>
#include <recording/replay.h>

using namespace raycontact;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const TemporaryFolder folder;
    const recording::Bytes bytes = fuzz::recording_file({data, size});
    const auto file = folder.write("recording.glb", fuzz::text_of(bytes));
    fuzz::taken([&] {
        recording::Reader reader(file);
        std::vector<Pose> poses;
        std::vector<Pair> pairs;
        for (std::uint32_t i = 0; i < std::min(reader.steps(), 64u); ++i) reader.read_step(i, poses, pairs);
        if (reader.steps() > 64 || reader.bodies().size() > 64) return;
        recording::ReplayOptions options;
        options.settings = reader.info().settings;
        options.settings.execution.devices = "cpu";
        options.settings.execution.threads = 1;
        recording::replay(reader, options);
    });
    return 0;
}
