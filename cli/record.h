// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/simulation.h>

#include <memory>
#include <string>

/// Records a simulation as it runs; does nothing where no file was asked for.
class Recorder {
public:
    /// Throws InputError when the file cannot be made. An empty name: nothing is recorded.
    Recorder(const std::string& file, const raycontact::scenes::Simulation& scene);
    ~Recorder();
    Recorder(const Recorder&) = delete;
    Recorder& operator=(const Recorder&) = delete;

    void step();   ///< after each step of the scene
    void finish(); ///< says on standard error what was written and what it cost

private:
    struct State;
    std::unique_ptr<State> state_;
};
