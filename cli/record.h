// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <raycontact/settings.h>
#include <scenes/avalanche.h>

#include <cstdint>
#include <memory>
#include <string>

/// Records an avalanche as it runs; does nothing where no file was asked for.
class Recorder {
public:
    /// Throws InputError when the file cannot be made. An empty name: nothing is recorded.
    Recorder(const std::string& file, const raycontact::scenes::Avalanche& scene, std::uint64_t seed,
             const raycontact::Settings& settings);
    ~Recorder();
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    void step();   ///< after each step of the scene
    void finish(); ///< says on standard error what was written and what it cost

private:
    struct State;
    std::unique_ptr<State> state_;
};
