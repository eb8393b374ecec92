// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <scenes/simulation.h>

#include <memory>
#include <string>

/// Records a simulation as it runs; does nothing where no file was asked for.
class RunRecorder {
public:
    /// Throws InputError when the file cannot be made. An empty name: nothing is recorded.
    RunRecorder(const std::string& file, const raycontact::scenes::Simulation& scene);
    ~RunRecorder();
    RunRecorder(const RunRecorder&) = delete;
    RunRecorder& operator=(const RunRecorder&) = delete;

    void step();   ///< after each step of the scene
    void finish(); ///< says on standard error what was written and what it cost

private:
    struct State;
    std::unique_ptr<State> state_;
};
