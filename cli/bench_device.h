// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

/// Registers `bench device` and `bench roofline`: what steps and kernels take on each device, and what a ray needs.
void add_bench_device(CLI::App& bench);
